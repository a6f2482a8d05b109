// The unit at the end of a name.
#pragma once

#include <array>
#include <string>

namespace breakwater {

/// The unit of a key, a metric or a signal by its name, as people write it: "N" for
/// "peak_force_raw_N". Empty if the name ends with none.
inline std::string unit_of(const std::string& of) {
  struct Ending {
    const char* end;
    const char* unit;
  };
  // A longer ending first. "_per_m" is no length.
  static constexpr auto kEndings = std::to_array<Ending>({{"_per_rad", ""},
                                                          {"_per_m", ""},
                                                          {"_per_s", ""},
                                                          {"_Nms_rad", "N m s/rad"},
                                                          {"_Nm_rad", "N m/rad"},
                                                          {"_rad_s_s", "rad/s/s"},
                                                          {"_m_s_s", "m/s/s"},
                                                          {"_rad_s2", "rad/s^2"},
                                                          {"_m_s2", "m/s^2"},
                                                          {"_Nm_s", "N m/s"},
                                                          {"_N_s", "N/s"},
                                                          {"_rad_s", "rad/s"},
                                                          {"_Ns_m", "N s/m"},
                                                          {"_N_m", "N/m"},
                                                          {"_m_Ns", "m/(N s)"},
                                                          {"_s_m", "s/m"},
                                                          {"_m_s", "m/s"},
                                                          {"_Nm_A", "N m/A"},
                                                          {"_N_A", "N/A"},
                                                          {"_kgm2", "kg m^2"},
                                                          {"_sqrt_s", ""},
                                                          {"_Nm", "N m"},
                                                          {"_Ns", "N s"},
                                                          {"_rad", "rad"},
                                                          {"_us", "µs"},
                                                          {"_N", "N"},
                                                          {"_m", "m"},
                                                          {"_s", "s"},
                                                          {"_kg", "kg"},
                                                          {"_Hz", "Hz"},
                                                          {"_A", "A"},
                                                          {"_V", "V"},
                                                          {"_ohm", "ohm"},
                                                          {"_H", "H"},
                                                          {"_percent", "%"}});
  // "stiffness_N_m[2]" has the unit of the array.
  const std::string name = of.substr(0, of.find('['));
  for (const Ending& ending : kEndings) {
    if (name.ends_with(ending.end)) return ending.unit;
  }
  return "";
}

}  // namespace breakwater
