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
  over(period_s);
}

void Mdob::over(double interval_s) {
  const double h = interval_s > 0.0 ? interval_s : period_s_;
  if (h == interval_s_) return;
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
}

void Mdob::reset(double angle) {
  angle_ = angle;
  velocity_ = filtered_torque_ = filtered_momentum_ = 0.0;
}

void Mdob::update(double held_torque, double angle) {
  velocity_ = derivative_memory_ * velocity_ + derivative_gain_ * (angle - angle_);
  angle_ = angle;
  filtered_torque_ += torque_gain_ * (held_torque - filtered_torque_);
  filtered_momentum_ += momentum_weight_ * (momentum_gain_ * velocity_ - filtered_momentum_);
}

}  // namespace breakwater
