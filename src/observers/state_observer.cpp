#include <breakwater/observers/state_observer.h>

namespace breakwater {

StateObserver::StateObserver(const StateSpace& continuous_plant,
                             const std::vector<PoleGroup>& poles, double period_s)
    : plant_(zero_order_hold(continuous_plant, period_s)),
      gain_(place_observer_poles(plant_.A, plant_.C, sample_poles(poles, period_s))),
      error_dynamics_(plant_.A - gain_ * plant_.C),
      state_(Eigen::VectorXd::Zero(plant_.states())),
      next_(state_),
      disturbance_(Eigen::VectorXd::Zero(plant_.inputs())),
      last_output_(Eigen::VectorXd::Zero(plant_.outputs())),
      innovation_(last_output_),
      signals_({{"innovation", "", "e = y - C x(k|k-1)", view(innovation_)}}) {}

void StateObserver::reset(const Vector& x) {
  state_ = x;
  has_begun_ = false;
}

void StateObserver::update(const Vector& held_input, const Vector& y) {
  if (has_begun_) {
    next_.noalias() = error_dynamics_ * state_;
    next_.noalias() += plant_.B * held_input;
    next_.noalias() += gain_ * last_output_;
    state_ = next_;
  }
  has_begun_ = true;
  last_output_ = y;
  innovation_ = y;
  innovation_.noalias() -= plant_.C * state_;
}

}  // namespace breakwater
