#include <breakwater/observers/mdob.h>

#include <cmath>
#include <stdexcept>

#include <breakwater/math/functions.h>

namespace breakwater {

Mdob::Mdob(const MdobDesign& design, double period_s) : design_(design), period_s_(period_s) {
  const double g_d = design.derivative_cutoff_rad_s;
  const double g_w = design.observer_cutoff_rad_s;
  if (!(design.nominal_inertia > 0.0 && g_d > 0.0 && g_w > 0.0 && period_s > 0.0)) {
    throw std::invalid_argument("MDOB: inertia, cut-offs and sampling period must be positive");
  }
  if (std::isinf(g_w)) throw std::invalid_argument("MDOB: the low-pass needs a finite cut-off");
  momentum_gain_ = g_w * design.nominal_inertia;
  follow({});
}

bool Mdob::follow(const SampleInterval& interval) {
  const double h = interval.length_s > 0.0 ? interval.length_s : period_s_;
  if (h == interval_s_) return true;
  interval_s_ = h;
  const double g_d = design_.derivative_cutoff_rad_s;
  const double g_w = design_.observer_cutoff_rad_s;
  if (std::isinf(g_d)) {
    derivative_memory_ = 0.0;
    derivative_gain_ = 1.0 / h;
  } else {
    derivative_memory_ = 1.0 / (1.0 + g_d * h);
    derivative_gain_ = g_d * derivative_memory_;
  }
  torque_gain_ = -math::expm1(-g_w * h);
  momentum_weight_ = g_w * h / (1.0 + g_w * h);
  return true;
}

void Mdob::start(double angle) {
  estimate_ << angle, 0.0, 0.0;
  filtered_torque_ = filtered_momentum_ = 0.0;
}

void Mdob::reset(const Vector& x) {
  has_begun_ = false;
  follow({});
  start(x(0));
}

void Mdob::update(const Vector& held_input, const Vector& y) {
  const double angle = y(0);
  if (!has_begun_) {  // a difference needs two samples
    has_begun_ = true;
    return start(angle);
  }
  const double velocity =
      derivative_memory_ * estimate_(1) + derivative_gain_ * (angle - estimate_(0));
  filtered_torque_ += torque_gain_ * (held_input(0) - filtered_torque_);
  filtered_momentum_ += momentum_weight_ * (momentum_gain_ * velocity - filtered_momentum_);
  estimate_ << angle, velocity, filtered_torque_ + filtered_momentum_ - momentum_gain_ * velocity;
}

void Mdob::pole_matrix(Eigen::Ref<Eigen::MatrixXd> F) const {
  F.setZero();
  F(0, 0) = 1.0 - momentum_weight_;
  if (poles() == 2) F(1, 1) = derivative_memory_;
}

}  // namespace breakwater
