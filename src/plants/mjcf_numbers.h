// The numbers of a model in MJCF, before the engine reads them.
#pragma once

#include <string>

namespace breakwater {

/// Throws std::invalid_argument `FILE[:LINE]: reason` if an MJCF file, or one that it includes,
/// cannot be read, is no XML, or has a number in an attribute that is not finite or beyond ±1e30,
/// or negative where it cannot be (a mass, a colour, a size in pixels): the engine takes NaN, 1e300
/// and a negative mass without a word.
void check_mjcf_numbers(const std::string& file);

}  // namespace breakwater
