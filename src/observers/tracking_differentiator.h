// Han's tracking differentiator, with the low-pass of a disturbance observer.
#pragma once

#include <Eigen/Core>
#include <cmath>

#include <breakwater/math/refuse_unless.h>
#include <breakwater/observers/guarded_kalman.h>
#include <breakwater/observers/mdob.h>

namespace breakwater {

/// The time-optimal acceleration to the origin, |·| ≤ r, of a double integrator:
/// x₁(k+1) = x₁ + h x₂, x₂(k+1) = x₂ + h fhan(x₁, x₂, r, h) (Han 2009).
inline double fhan(double x1, double x2, double r, double h) {
  const double d = r * h * h;
  const double a0 = h * x2;
  const double y = x1 + a0;
  const double a1 = std::sqrt(d * (d + 8.0 * std::abs(y)));
  const double a = std::abs(y) <= d ? a0 + y : a0 + std::copysign(0.5 * (a1 - d), y);
  return std::abs(a) <= d ? -r * a / d : -std::copysign(r, a);
}

struct TrackingDesign {
  double inertia = 1.0;         ///< J_n of the disturbance observer
  double acceleration = 0.0;    ///< r > 0: the largest acceleration of the estimate
  double filter_samples = 1.0;  ///< h₀/T_s ≥ 1: larger values filter more
  double cutoff_rad_s = 0.0;    ///< g_w of the disturbance observer's low-pass, finite
};

/// v₁ follows the position y and v₂ is its derivative:
///     v₁(k+1) = v₁ + T_s v₂,   v₂(k+1) = v₂ + T_s fhan(v₁ − y, v₂, r, h₀).
/// The update with y(k) gives the estimate of sample k. It needs no model. d̂ is that of an MDOB
/// with v₂ as the derivative. v₂ and d̂ stay as they are while there is no measurement.
///
/// Source: J. Han, IEEE Trans. Ind. Electron. 56 (2009) 900–906.
class TrackingDifferentiator final : public Guarded<> {
 public:
  /// Throws std::invalid_argument if a number is out of its range.
  TrackingDifferentiator(const TrackingDesign& design, double period_s)
      : design_(design), period_s_(period_s), disturbance_(design.inertia, design.cutoff_rad_s) {
    refuse_unless(design.acceleration > 0.0 && design.filter_samples >= 1.0 && period_s > 0.0,
                  "tracking differentiator: the acceleration and the sampling period must be "
                  "positive, and the samples of the filter at least 1");
    disturbance_.over(period_s);
  }

  void reset(const Vector& x) override {
    estimate_ << x(0), x(1), 0.0;
    disturbance_.start(x(1));
    has_begun_ = false;
  }
  View state() const override { return {estimate_.data(), 2}; }
  View disturbance() const override { return {estimate_.data() + 2, 1}; }

 private:
  void step(const Vector& held_input, const Vector& y) override {
    const double velocity = estimate_(1);
    if (is_measured_) {
      estimate_(1) += period_s_ * fhan(estimate_(0) - y(0), velocity, design_.acceleration,
                                       design_.filter_samples * period_s_);
    }
    estimate_(0) += period_s_ * velocity;
    if (has_begun_ && is_measured_) estimate_(2) = disturbance_.update(held_input(0), estimate_(1));
    has_begun_ = true;
  }

  TrackingDesign design_;
  double period_s_;
  MomentumObserver disturbance_;
  Eigen::Vector3d estimate_ = Eigen::Vector3d::Zero();  // [v₁; v₂; d̂]
  bool has_begun_ = false;
};

}  // namespace breakwater
