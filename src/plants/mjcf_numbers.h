// Checks the numbers of an MJCF model before the engine reads them.
#pragma once

#include <cstdint>
#include <string>

namespace breakwater {

/// Throws std::invalid_argument `FILE[:LINE]: reason` if an MJCF file or one of its includes cannot
/// be read, is not XML or has a wrong number. More than `most_elements` elements are refused too,
/// with those of a <composite>. A number must be finite and within ±1e30. Masses, colours and sizes
/// in pixels must not be negative, and a size of <size> must fit into memory. The engine accepts
/// NaN, 1e300 and a negative mass without a warning.
void check_mjcf(const std::string& file, std::uint64_t most_elements);

}  // namespace breakwater
