#include <breakwater/observers/state_observer.h>

namespace breakwater {

StateObserver::StateObserver(const StateSpace& continuous_plant,
                             const std::vector<PoleGroup>& poles, double period_s)
    : predictor_(continuous_plant, poles, period_s),
      C_(continuous_plant.C),
      disturbance_(Eigen::VectorXd::Zero(continuous_plant.inputs())),
      last_output_(Eigen::VectorXd::Zero(continuous_plant.outputs())),
      innovation_(last_output_),
      signals_({{"innovation", "", "e = y - C x(k|k-1)", view(innovation_)}}) {}

void StateObserver::reset(const Vector& x) {
  predictor_.state() = x;
  has_begun_ = false;
  follow({});
}

bool StateObserver::follow(const SampleInterval& interval) {
  predictor_.over(interval.length_s);
  return true;
}

void StateObserver::update(const Vector& held_input, const Vector& y) {
  if (has_begun_) predictor_.update(held_input, last_output_);
  has_begun_ = true;
  last_output_ = y;
  innovation_ = y;
  innovation_.noalias() -= C_ * predictor_.state();
}

}  // namespace breakwater
