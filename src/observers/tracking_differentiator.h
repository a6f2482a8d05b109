// Han's tracking differentiator, with the low-pass of a disturbance observer.
#pragma once

#include <Eigen/Core>

#include <breakwater/observers/guarded_kalman.h>
#include <breakwater/observers/mdob.h>

namespace breakwater {

/// The time-optimal acceleration to the origin, |·| ≤ r, of a double integrator:
/// x₁(k+1) = x₁ + h x₂, x₂(k+1) = x₂ + h fhan(x₁, x₂, r, h) (Han 2009).
double fhan(double x1, double x2, double r, double h);

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
  TrackingDifferentiator(const TrackingDesign& design, double period_s);

  void reset(const Vector& x) override;
  View state() const override { return {estimate_.data(), 2}; }
  View disturbance() const override { return {estimate_.data() + 2, 1}; }

 private:
  void step(const Vector& held_input, const Vector& y) override;

  TrackingDesign design_;
  double period_s_;
  MomentumObserver disturbance_;
  Eigen::Vector3d estimate_ = Eigen::Vector3d::Zero();  // [v₁; v₂; d̂]
  bool has_begun_ = false;
};

}  // namespace breakwater
