#include <breakwater/control/force_forecast.h>

namespace breakwater {

void EstimatorForecast::update(double, const QuadrotorEstimator& estimator, ForceTable& forces) {
  for (Eigen::Index i = 0; i < forces.cols(); ++i) {
    forces.col(i) =
        foresees_ ? estimator.force_ahead(period_s_ * static_cast<double>(i)) : estimator.force();
  }
}

void AutoregressiveForecast::reset(double) {
  for (AutoregressiveModel& axis : axes_) axis.reset();
}

void AutoregressiveForecast::update(double, const QuadrotorEstimator& estimator,
                                    ForceTable& forces) {
  forces.col(0) = estimator.force();
  for (Eigen::Index i = 0; i < 3; ++i) {
    AutoregressiveModel& axis = axes_[static_cast<std::size_t>(i)];
    axis.update(forces(i, 0));
    axis.forecast(forces.row(i).tail(forces.cols() - 1));
  }
}

}  // namespace breakwater
