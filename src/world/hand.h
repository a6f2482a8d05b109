// A stiff hand that turns a link and lets go.
#pragma once

namespace breakwater {

/// Grips a link at `start_s`, turns its absolute angle by `angle_rad` along a smoothstep of
/// `rise_s`, holds it for `hold_s` and lets go: the forced displacement of thesis 2.4.3.3. While it
/// grips, it pulls the link towards where it wants it, as a spring and a damper would.
struct Hand {
  double start_s = 0.0;
  double rise_s = 1.0;
  double hold_s = 0.0;
  double angle_rad = 0.0;
  double stiffness_Nm_rad = 0.0;
  double damping_Nms_rad = 0.0;

  double release_s() const { return start_s + rise_s + hold_s; }
  bool grips(double time_s) const { return time_s >= start_s && time_s < release_s(); }

  /// How far the hand wants the link turned from where it gripped it [rad].
  double target_rad(double time_s) const;

  /// Its moment about the link's joint [N m], given how far the link is turned from where it was
  /// gripped [rad] and how fast it turns [rad/s]. 0 while it does not grip.
  double moment_Nm(double time_s, double turned_rad, double rate_rad_s) const;

 private:
  double target_rate_rad_s(double time_s) const;
};

}  // namespace breakwater
