// The scenario that a file is for.
#pragma once

#include <string>

namespace breakwater {

/// The key `scenario` of a scenario file. Throws std::invalid_argument `FILE[:LINE]: reason` if the
/// file cannot be read or parsed, or does not say.
std::string scenario_name_in(const std::string& file);

/// Whether a word of the command line is a scenario file rather than a name: "mine.toml".
inline bool is_scenario_file(const std::string& word) {
  return word.ends_with(".toml");
}

}  // namespace breakwater
