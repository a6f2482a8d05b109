#include <breakwater/observers/state_observer.h>

namespace breakwater {

StateObserver::StateObserver(const StateSpace& continuous_plant,
                             const std::vector<PoleGroup>& poles, double period_s)
    : predictor_(continuous_plant, poles, period_s),
      disturbance_(Eigen::VectorXd::Zero(continuous_plant.inputs())),
      signals_(
          {{"innovation", "", "e = y - C x(k|k-1) (Eq. 4.15)", view(predictor_.innovation())}}) {}

}  // namespace breakwater
