// Minimal-order disturbance observer (MDOB): thesis 2.2.2.
#pragma once

namespace breakwater {

/// What an MDOB is designed with.
struct MdobDesign {
  double nominal_inertia = 1.0;  ///< J_n [kg m²], or a mass [kg] for a slide
  double derivative_cutoff_rad_s =
      0;                             ///< g_d of the pseudo-derivative; infinity: the raw difference
  double observer_cutoff_rad_s = 0;  ///< g_w of the observer's low-pass, finite
};

/// Estimates the disturbance of one joint from its angle and torque (Eq. 2.6):
///     d̂ = g_w/(s + g_w)·{τ + g_w J_n G_d(s) q} − g_w J_n G_d(s) q,   G_d(s) = g_d s/(s + g_d),
/// which is g_w/(s + g_w)·{τ − J_n s G_d(s) q}: the torque less what the nominal inertia's
/// acceleration takes. As everywhere in this project d̂ opposes the input, J_n q̈ = τ − d̂; the
/// first line of Eq. 2.6 prints the other sign.
///
/// Sampled: the torque is held, so its low-pass is exact; the angle's filters are the backward
/// differences of theirs.
///
/// Used once a sample: update(τ, q) with the torque that acted since the last sample and the angle
/// measured at this one; then d̂ is that of this sample.
class Mdob {
 public:
  /// Throws std::invalid_argument unless inertia, cut-offs and period are positive, and g_w finite.
  Mdob(const MdobDesign& design, double period_s);

  void reset(double angle);
  /// The intervals that follow are so long; 0: T_s. The filters are those of this length.
  void over(double interval_s);
  void update(double held_torque, double angle);

  double angle() const { return angle_; }        ///< as measured
  double velocity() const { return velocity_; }  ///< G_d(s) q
  double disturbance() const {
    return filtered_torque_ + filtered_momentum_ - momentum_gain_ * velocity_;
  }

  /// The sampled poles of its two filters.
  double derivative_pole() const { return derivative_memory_; }
  double low_pass_pole() const { return 1.0 - momentum_weight_; }

 private:
  MdobDesign design_;
  double period_s_;
  double interval_s_ = 0.0;
  double derivative_gain_;    // g_d/(1 + g_d T_s)
  double derivative_memory_;  // 1/(1 + g_d T_s)
  double torque_gain_;        // 1 − e^{−g_w T_s}
  double momentum_weight_;    // g_w T_s/(1 + g_w T_s)
  double momentum_gain_;      // g_w J_n
  double angle_ = 0.0;
  double velocity_ = 0.0;
  double filtered_torque_ = 0.0;
  double filtered_momentum_ = 0.0;
};

}  // namespace breakwater
