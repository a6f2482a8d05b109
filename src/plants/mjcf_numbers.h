// The numbers of a model in MJCF, before the engine reads them.
#pragma once

#include <cstdint>
#include <string>

namespace breakwater {

/// Throws std::invalid_argument `FILE[:LINE]: reason` if an MJCF file, or one that it includes,
/// cannot be read, is no XML, has more than `most_elements` elements altogether (those that a
/// <composite> makes count, too), or has a number in an attribute that is not finite or beyond
/// ±1e30, or negative where it cannot be (a mass, a colour, a size in pixels), or a size of <size>
/// that no memory holds: the engine takes NaN, 1e300 and a negative mass without a word.
void check_mjcf(const std::string& file, std::uint64_t most_elements);

}  // namespace breakwater
