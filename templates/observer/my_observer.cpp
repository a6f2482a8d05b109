#include "my_observer.h"

#include <Eigen/LU>
#include <memory>
#include <stdexcept>

#include <breakwater/linear/pole_placement.h>

namespace my_observer_lab {

using breakwater::Fields;
using breakwater::NominalAxis;
using breakwater::StateSpace;

MyObserver::MyObserver(const StateSpace& plant, double bandwidth_rad_s, double period_s) {
  if (plant.states() != 2 || plant.inputs() != 1 || plant.outputs() != 1) {
    throw std::invalid_argument("the plant must be an axis of second order");
  }
  const StateSpace sampled =
      breakwater::zero_order_hold(breakwater::extend_by_input_disturbance(plant), period_s);
  transition_ = sampled.A;
  input_ = sampled.B;
  const breakwater::PoleGroup poles(3, {-bandwidth_rad_s, 0.0});
  // The gain H of the predictor Φ − H C with these poles. With L = Φ⁻¹ H, (I − L C) Φ has the same
  // poles, since Φ − H C = Φ (I − L C).
  const Eigen::MatrixXd H = breakwater::place_observer_poles(
      sampled.A, sampled.C, breakwater::sample_poles({poles}, period_s));
  gain_ = transition_.partialPivLu().solve(H);
  error_dynamics_ = (Eigen::Matrix3d::Identity() - gain_ * sampled.C) * transition_;
  signals_ = {{"innovation", "", "y minus its prediction", breakwater::view(innovation_)}};
}

void MyObserver::reset(const Vector& x) {
  estimate_ << x(0), x(1), 0.0;
  innovation_ = 0.0;
  has_begun_ = false;
}

void MyObserver::update(const Vector& held_input, const Vector& y) {
  // No input acted before the first sample.
  if (has_begun_) estimate_ = transition_ * estimate_ + input_ * held_input(0);
  has_begun_ = true;
  innovation_ = y(0) - estimate_(0);
  estimate_ += gain_ * innovation_;
}

namespace {

struct Settings {
  double bandwidth_rad_s = 60.0;
};

void bind(Fields& fields, Settings& settings) {
  fields.optional_number("observer.bandwidth_rad_s", settings.bandwidth_rad_s,
                         breakwater::positive(),
                         "omega_o: bandwidth; all poles are at -omega_o [rad/s]");
}

std::unique_ptr<breakwater::DisturbanceEstimator> make(const Settings& settings,
                                                       const NominalAxis& axis) {
  return breakwater::blame("observer.bandwidth_rad_s", [&] {
    return std::make_unique<MyObserver>(axis.plant, settings.bandwidth_rad_s, axis.period_s);
  });
}

}  // namespace

breakwater::AxisEstimatorKind my_observer_kind() {
  return {"my_observer", "extended state observer with a given bandwidth", bind, make};
}

}  // namespace my_observer_lab
