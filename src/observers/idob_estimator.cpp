#include <breakwater/observers/idob_estimator.h>

namespace breakwater {

IdobEstimator::IdobEstimator(const StateSpace& continuous_plant,
                             const std::vector<PoleGroup>& poles, double period_s)
    : idob_(continuous_plant, poles, period_s),
      plant_states_(continuous_plant.states()),
      C_(continuous_plant.C),
      last_output_(Eigen::VectorXd::Zero(C_.rows())),
      innovation_(last_output_),
      signals_({{"innovation", "", "e = y - C x(k|k-1) (Eq. 4.15)", view(innovation_)}}) {}

void IdobEstimator::reset(const Vector& x) {
  idob_.reset(x);
  has_begun_ = false;
  follow({});
}

bool IdobEstimator::follow(const SampleInterval& interval) {
  idob_.over(interval.length_s);
  return true;
}

void IdobEstimator::update(const Vector& held_input, const Vector& y) {
  if (has_begun_) idob_.update(held_input, last_output_);
  has_begun_ = true;
  last_output_ = y;
  innovation_ = y;
  innovation_.noalias() -= C_ * state();
}

}  // namespace breakwater
