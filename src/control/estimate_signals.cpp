#include <breakwater/control/estimate_signals.h>

namespace breakwater {

std::vector<Signal> estimate_signals(const DisturbanceEstimator& estimator,
                                     const AxisUnits& units) {
  const auto part = [](const DisturbanceEstimator::View& values, Eigen::Index i) {
    return view(*(values.data() + i));
  };
  const DisturbanceEstimator::View x = estimator.state();
  const bool knows_spring = x.size() == 4;
  std::vector<Signal> signals = {
      {"position_hat_" + units.position_suffix, units.position, "position, estimated", part(x, 0)},
      {"velocity_hat_" + units.velocity_suffix, units.velocity, "velocity, estimated", part(x, 1)},
      {"d_hat_" + units.force_suffix, units.force,
       knows_spring ? "disturbance at the load, estimated" : "disturbance at the drive, estimated",
       part(estimator.disturbance(), 0)}};
  if (knows_spring) {
    signals.push_back({"other_position_hat_" + units.position_suffix, units.position,
                       "position of the side without the encoder, estimated", part(x, 2)});
    signals.push_back({"other_velocity_hat_" + units.velocity_suffix, units.velocity,
                       "velocity of the side without the encoder, estimated", part(x, 3)});
  }
  return signals;
}

}  // namespace breakwater
