// Minimal-order disturbance observer (MDOB): thesis 2.2.2.
#pragma once

#include <Eigen/Core>
#include <cmath>

#include <breakwater/math/functions.h>
#include <breakwater/math/refuse_unless.h>
#include <breakwater/observers/disturbance_estimator.h>

namespace breakwater {

/// Design parameters of an MDOB.
struct MdobDesign {
  double nominal_inertia = 1.0;          ///< J_n [kg m²], or a mass [kg] for a slide
  double derivative_cutoff_rad_s = 0.0;  ///< g_d; infinity: the raw difference
  double observer_cutoff_rad_s = 0.0;    ///< g_w of the observer's low-pass, finite
};

/// The low-pass of Eq. 2.6: d̂ = g_w/(s + g_w)·{τ + g_w J_n v} − g_w J_n v from the held torque τ
/// and the velocity v.
class MomentumObserver {
 public:
  /// Throws std::invalid_argument unless J_n and g_w are positive and finite.
  MomentumObserver(double inertia, double cutoff_rad_s)
      : cutoff_rad_s_(cutoff_rad_s), momentum_gain_(cutoff_rad_s * inertia) {
    refuse_unless(inertia > 0.0 && cutoff_rad_s > 0.0,
                  "MDOB: inertia, cut-offs and sampling period must be positive");
    refuse_unless(!std::isinf(cutoff_rad_s), "MDOB: the low-pass needs a finite cut-off");
  }

  /// Sets the interval of the next samples.
  void over(double interval_s) {
    torque_gain_ = -math::expm1(-cutoff_rad_s_ * interval_s);
    momentum_weight_ = cutoff_rad_s_ * interval_s / (1.0 + cutoff_rad_s_ * interval_s);
  }
  /// Starts without a disturbance.
  void start(double velocity) {
    filtered_torque_ = 0.0;
    filtered_momentum_ = momentum_gain_ * velocity;
  }
  double update(double torque, double velocity) {
    filtered_torque_ += torque_gain_ * (torque - filtered_torque_);
    filtered_momentum_ += momentum_weight_ * (momentum_gain_ * velocity - filtered_momentum_);
    return filtered_torque_ + filtered_momentum_ - momentum_gain_ * velocity;
  }
  /// The low-pass' pole.
  double pole() const { return 1.0 - momentum_weight_; }

 private:
  double cutoff_rad_s_;
  double momentum_gain_;          // g_w J_n
  double torque_gain_ = 0.0;      // 1 − e^{−g_w T_s}
  double momentum_weight_ = 0.0;  // g_w T_s/(1 + g_w T_s)
  double filtered_torque_ = 0.0;
  double filtered_momentum_ = 0.0;
};

/// Estimates the disturbance of one joint from its angle and torque (Eq. 2.6):
///     d̂ = g_w/(s + g_w)·{τ + g_w J_n G_d(s) q} − g_w J_n G_d(s) q,   G_d(s) = g_d s/(s + g_d),
/// which equals g_w/(s + g_w)·{τ − J_n s G_d(s) q}: the torque minus the nominal inertia's torque.
/// d̂ opposes the input: J_n q̈ = τ − d̂. The first line of Eq. 2.6 prints the other sign.
///
/// The low-pass of the held torque is exact. The filters of the angle use backward differences.
///
/// It does not filter the angle: x̂ = [q; G_d(s) q] with the measured q (below Eq. 4.22).
class Mdob final : public DisturbanceEstimator {
 public:
  /// Throws std::invalid_argument unless inertia, cut-offs and period are positive, and g_w finite.
  Mdob(const MdobDesign& design, double period_s)
      : design_(design),
        period_s_(period_s),
        disturbance_(design.nominal_inertia, design.observer_cutoff_rad_s) {
    refuse_unless(design.derivative_cutoff_rad_s > 0.0 && period_s > 0.0,
                  "MDOB: inertia, cut-offs and sampling period must be positive");
    follow({});
  }

  void reset(const Vector& x) override {
    has_begun_ = false;
    follow({});
    start(x(0));
  }
  void update(const Vector& held_input, const Vector& y) override {
    const double angle = y(0);
    if (!has_begun_) {  // a difference needs two samples
      has_begun_ = true;
      return start(angle);
    }
    const double velocity =
        derivative_memory_ * estimate_(1) + derivative_gain_ * (angle - estimate_(0));
    estimate_ << angle, velocity, disturbance_.update(held_input(0), velocity);
  }
  /// Computes the filters for this interval.
  bool follow(const SampleInterval& interval) override {
    const double h = interval.length_s > 0.0 ? interval.length_s : period_s_;
    const double g_d = design_.derivative_cutoff_rad_s;
    derivative_memory_ = std::isinf(g_d) ? 0.0 : 1.0 / (1.0 + g_d * h);
    derivative_gain_ = std::isinf(g_d) ? 1.0 / h : g_d * derivative_memory_;
    disturbance_.over(h);
    return true;
  }

  View state() const override { return {estimate_.data(), 2}; }
  View disturbance() const override { return {estimate_.data() + 2, 1}; }

  /// The poles of its two filters; a raw difference has no pole.
  Eigen::Index poles() const override { return derivative_memory_ > 0.0 ? 2 : 1; }
  void pole_matrix(Eigen::Ref<Eigen::MatrixXd> F) const override {
    F.setZero();
    F(0, 0) = disturbance_.pole();
    if (poles() == 2) F(1, 1) = derivative_memory_;
  }

 private:
  void start(double angle) {
    estimate_ << angle, 0.0, 0.0;
    disturbance_.start(0.0);
  }

  MdobDesign design_;
  double period_s_;
  double derivative_gain_;    // g_d/(1 + g_d T_s)
  double derivative_memory_;  // 1/(1 + g_d T_s)
  MomentumObserver disturbance_;
  bool has_begun_ = false;
  Eigen::Vector3d estimate_ = Eigen::Vector3d::Zero();  // [q; G_d(s) q; d̂]
};

}  // namespace breakwater
