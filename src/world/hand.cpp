#include <breakwater/world/hand.h>

#include <algorithm>

namespace breakwater {

double Hand::risen(double end, double time_s) const {
  const double s = std::clamp((time_s - start_s) / rise_s, 0.0, 1.0);
  return end * s * s * (3.0 - 2.0 * s);
}

double Hand::target_rad(double time_s) const {
  return risen(angle_rad, time_s);
}

double Hand::target_rate_rad_s(double time_s) const {
  const double s = std::clamp((time_s - start_s) / rise_s, 0.0, 1.0);
  return angle_rad * 6.0 * s * (1.0 - s) / rise_s;
}

double Hand::moment_Nm(double time_s, double turned_rad, double rate_rad_s) const {
  if (!grips(time_s)) return 0.0;
  if (given_moment_Nm != 0.0) return risen(given_moment_Nm, time_s);
  return stiffness_Nm_rad * (target_rad(time_s) - turned_rad) +
         damping_Nms_rad * (target_rate_rad_s(time_s) - rate_rad_s);
}

}  // namespace breakwater
