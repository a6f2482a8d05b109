#include <breakwater/observers/mdob.h>

#include <cmath>

#include <breakwater/math/functions.h>
#include <breakwater/math/refuse_unless.h>

namespace breakwater {

MomentumObserver::MomentumObserver(double inertia, double cutoff_rad_s)
    : cutoff_rad_s_(cutoff_rad_s), momentum_gain_(cutoff_rad_s * inertia) {
  refuse_unless(inertia > 0.0 && cutoff_rad_s > 0.0,
                "MDOB: inertia, cut-offs and sampling period must be positive");
  refuse_unless(!std::isinf(cutoff_rad_s), "MDOB: the low-pass needs a finite cut-off");
}

void MomentumObserver::over(double interval_s) {
  torque_gain_ = -math::expm1(-cutoff_rad_s_ * interval_s);
  momentum_weight_ = cutoff_rad_s_ * interval_s / (1.0 + cutoff_rad_s_ * interval_s);
}

void MomentumObserver::start(double velocity) {
  filtered_torque_ = 0.0;
  filtered_momentum_ = momentum_gain_ * velocity;
}

double MomentumObserver::update(double torque, double velocity) {
  filtered_torque_ += torque_gain_ * (torque - filtered_torque_);
  filtered_momentum_ += momentum_weight_ * (momentum_gain_ * velocity - filtered_momentum_);
  return filtered_torque_ + filtered_momentum_ - momentum_gain_ * velocity;
}

Mdob::Mdob(const MdobDesign& design, double period_s)
    : design_(design),
      period_s_(period_s),
      disturbance_(design.nominal_inertia, design.observer_cutoff_rad_s) {
  refuse_unless(design.derivative_cutoff_rad_s > 0.0 && period_s > 0.0,
                "MDOB: inertia, cut-offs and sampling period must be positive");
  follow({});
}

bool Mdob::follow(const SampleInterval& interval) {
  const double h = interval.length_s > 0.0 ? interval.length_s : period_s_;
  if (h == interval_s_) return true;
  interval_s_ = h;
  const double g_d = design_.derivative_cutoff_rad_s;
  if (std::isinf(g_d)) {
    derivative_memory_ = 0.0;
    derivative_gain_ = 1.0 / h;
  } else {
    derivative_memory_ = 1.0 / (1.0 + g_d * h);
    derivative_gain_ = g_d * derivative_memory_;
  }
  disturbance_.over(h);
  return true;
}

void Mdob::start(double angle) {
  estimate_ << angle, 0.0, 0.0;
  disturbance_.start(0.0);
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
  estimate_ << angle, velocity, disturbance_.update(held_input(0), velocity);
}

void Mdob::pole_matrix(Eigen::Ref<Eigen::MatrixXd> F) const {
  F.setZero();
  F(0, 0) = disturbance_.pole();
  if (poles() == 2) F(1, 1) = derivative_memory_;
}

}  // namespace breakwater
