// The unit at the end of a name.
#pragma once

#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace breakwater {

/// The end of a name with this unit: "_rad_s" for "rad/s", "_percent" for "%".
inline std::string unit_suffix(const std::string& unit) {
  if (unit == "%") return "_percent";
  if (unit == "µs") return "_us";
  std::string suffix = "_";
  for (const char c : unit) {
    if (std::string_view(" ^()").find(c) == std::string_view::npos) suffix += c == '/' ? '_' : c;
  }
  return suffix;
}

/// The unit of a key, a metric or a signal by its name, as people write it: "N" for
/// "peak_force_raw_N". Empty if the name ends with none.
inline std::string unit_of(const std::string& of) {
  // A longer ending first.
  static constexpr const char* kUnits[] = {
      "N m s/rad", "N m/rad", "rad/s/s", "m/s/s",   "rad/s^2", "m/s^2", "N m/s", "N/s",
      "rad/s",     "N s/m",   "N/m",     "m/(N s)", "s/m",     "m/s",   "N m/A", "N/A",
      "kg m^2",    "N m",     "N s",     "rad",     "µs",      "N",     "m",     "s",
      "kg",        "Hz",      "A",       "V",       "ohm",     "H",     "%"};
  static const auto endings = [] {
    // "_per_m" is no length.
    std::vector<std::pair<std::string, std::string>> all = {
        {"_per_rad", ""}, {"_per_m", ""}, {"_per_s", ""}, {"_sqrt_s", ""}};
    for (const char* unit : kUnits) all.emplace_back(unit_suffix(unit), unit);
    return all;
  }();
  // "stiffness_N_m[2]" has the unit of the array.
  const std::string name = of.substr(0, of.find('['));
  for (const auto& [end, unit] : endings) {
    if (name.ends_with(end)) return unit;
  }
  return "";
}

}  // namespace breakwater
