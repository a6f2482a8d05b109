// Names and units of an axis' quantities in logs and keys.
#pragma once

#include <string>

namespace breakwater {

/// Suffixes and units of a position, its rate, the force along it and what resists that.
struct AxisUnits {
  std::string position;         ///< "rad", which is its suffix too
  std::string velocity_suffix;  ///< "rad_s"
  std::string velocity;         ///< "rad/s"
  std::string force_suffix;     ///< "Nm"
  std::string force;            ///< "N m"
  std::string inertia;          ///< "inertia", "mass"
  std::string inertia_suffix;   ///< "kgm2"
  std::string friction_suffix;  ///< suffix of a viscous friction: "Nms_rad"

  bool turns() const { return position == "rad"; }
  std::string stiffness_suffix() const { return force_suffix + "_" + position; }
};

inline AxisUnits rotation_units() {
  return {"rad", "rad_s", "rad/s", "Nm", "N m", "inertia", "kgm2", "Nms_rad"};
}
inline AxisUnits translation_units() {
  return {"m", "m_s", "m/s", "N", "N", "mass", "kg", "Ns_m"};
}

}  // namespace breakwater
