// A hand that pushes a link and then releases it.
#pragma once

#include <algorithm>

namespace breakwater {

/// Grips a link at `start_s`, turns its absolute angle by `angle_rad` along a smoothstep of
/// `rise_s`, holds it for `hold_s` and releases it. This is the forced displacement of thesis
/// 2.4.3.3. The grip acts as a spring and a damper between the link and the target angle. A hand of
/// given moment pushes with it instead, along the same smoothstep, wherever the link goes.
struct Hand {
  double start_s = 0.0;
  double rise_s = 1.0;
  double hold_s = 0.0;
  double angle_rad = 0.0;
  double stiffness_Nm_rad = 0.0;
  double damping_Nms_rad = 0.0;
  double given_moment_Nm = 0.0;  ///< about the link's joint; 0: the hand turns the link

  double release_s() const { return start_s + rise_s + hold_s; }
  bool grips(double time_s) const { return time_s >= start_s && time_s < release_s(); }

  /// Target rotation of the link since the grip [rad].
  double target_rad(double time_s) const { return risen(angle_rad, time_s); }

  /// The hand's moment about the link's joint [N m], from the link's rotation since the grip [rad]
  /// and its rate [rad/s]. 0 without a grip.
  double moment_Nm(double time_s, double turned_rad, double rate_rad_s) const {
    if (!grips(time_s)) return 0.0;
    if (given_moment_Nm != 0.0) return risen(given_moment_Nm, time_s);
    return stiffness_Nm_rad * (target_rad(time_s) - turned_rad) +
           damping_Nms_rad * (target_rate_rad_s(time_s) - rate_rad_s);
  }

 private:
  // The share of the rise's time that is over.
  double share(double time_s) const { return std::clamp((time_s - start_s) / rise_s, 0.0, 1.0); }
  // From 0 to `end`.
  double risen(double end, double time_s) const {
    const double s = share(time_s);
    return end * s * s * (3.0 - 2.0 * s);
  }
  double target_rate_rad_s(double time_s) const {
    const double s = share(time_s);
    return angle_rad * 6.0 * s * (1.0 - s) / rise_s;
  }
};

}  // namespace breakwater
