#include <breakwater/observers/eso.h>

#include <Eigen/LU>

#include <breakwater/linear/pole_placement.h>
#include <breakwater/math/functions.h>
#include <breakwater/math/refuse_unless.h>

namespace breakwater {

double scaled_fal(double e, double exponent, double zone) {
  const double size = std::abs(e);
  return size <= zone ? e : e * math::pow(size / zone, exponent - 1.0);
}

Eso::Eso(const StateSpace& plant, const EsoDesign& design, double period_s)
    : linear_zone_(design.linear_zone) {
  refuse_unless(plant.states() == 2 && plant.inputs() == 1 && plant.outputs() == 1,
                "ESO: needs an axis with position and velocity");
  refuse_unless(design.bandwidth_rad_s > 0.0 && linear_zone_ > 0.0,
                "ESO: the bandwidth and the linear zone must be positive");
  const StateSpace sampled = zero_order_hold(extend_by_input_disturbance(plant), period_s);
  transition_ = sampled.A;
  input_ = sampled.B;
  const PoleGroup poles(3, {-design.bandwidth_rad_s, 0.0});
  // Φ − H C̅ = Φ (I − l C̅) with l = Φ⁻¹ H has the poles of (I − l C̅) Φ.
  const Eigen::MatrixXd H =
      place_observer_poles(sampled.A, sampled.C, sample_poles({poles}, period_s));
  gain_ = transition_.partialPivLu().solve(H);
  error_dynamics_ = (Eigen::Matrix3d::Identity() - gain_ * sampled.C) * transition_;
  signals_ = {{"innovation", "", "e = y - q(k|k-1)", view(innovation_)}};
}

void Eso::reset(const Vector& x) {
  estimate_ << x(0), x(1), 0.0;
  innovation_ = 0.0;
  has_begun_ = false;
}

void Eso::step(const Vector& held_input, const Vector& y) {
  if (has_begun_) estimate_ = (transition_ * estimate_ + input_ * held_input(0)).eval();
  has_begun_ = true;
  innovation_ = is_measured_ ? y(0) - estimate_(0) : 0.0;
  estimate_(0) += gain_(0) * innovation_;
  estimate_(1) += gain_(1) * scaled_fal(innovation_, 0.5, linear_zone_);
  estimate_(2) += gain_(2) * scaled_fal(innovation_, 0.25, linear_zone_);
}

}  // namespace breakwater
