// Names and units of an axis' quantities in logs and keys.
#pragma once

#include <string>

namespace breakwater {

/// Suffixes and units of a position, its rate and the force along it.
struct AxisUnits {
  std::string position_suffix;  ///< "rad"
  std::string position;         ///< "rad"
  std::string velocity_suffix;  ///< "rad_s"
  std::string velocity;         ///< "rad/s"
  std::string force_suffix;     ///< "Nm"
  std::string force;            ///< "N m"
};

inline AxisUnits rotation_units() {
  return {"rad", "rad", "rad_s", "rad/s", "Nm", "N m"};
}
inline AxisUnits translation_units() {
  return {"m", "m", "m_s", "m/s", "N", "N"};
}

}  // namespace breakwater
