#include <breakwater/control/disturbance_cancelling_pd.h>

#include <algorithm>
#include <stdexcept>
#include <utility>

#include <breakwater/control/estimate_signals.h>

namespace breakwater {

DisturbanceCancellingPd::DisturbanceCancellingPd(std::shared_ptr<DisturbanceEstimator> estimator,
                                                 const DisturbanceCancellingPdDesign& design)
    : estimator_(std::move(estimator)),
      design_(design),
      poles_(*estimator_, design.period_s),
      held_input_(Eigen::VectorXd::Zero(1)) {
  const Eigen::Index states = estimator_->state().size();
  if ((states != 2 && states != 4) || estimator_->disturbance().size() != 1) {
    throw std::invalid_argument("PD control: needs an estimator of one axis");
  }
  if (!(design.force_limit > 0.0)) {
    throw std::invalid_argument("PD control: the force limit must be positive");
  }
  const AxisUnits& units = design_.units;
  signals_ = {{"reference_" + units.position_suffix, units.position, "y_ref", view(reference_)}};
  for (const Signal& signal : estimate_signals(*estimator_, units)) signals_.push_back(signal);
  for (const Signal& signal : signals_of(*estimator_, units.position)) signals_.push_back(signal);
  for (const Signal& signal : poles_.signals()) signals_.push_back(signal);
}

void DisturbanceCancellingPd::reset(const Sample&) {
  estimator_->reset(design_.start_state);
  held_input_.setZero();
}

void DisturbanceCancellingPd::update(const Sample& y, Eigen::Ref<Eigen::VectorXd> u) {
  estimator_->update(held_input_, y.y.head<1>());
  if (is_watched_) poles_.update();
  reference_ = design_.reference.at(y.time_s);
  u(0) = design_.k_p * (reference_ - position()) - design_.k_d * velocity() +
         design_.cancelled_share * disturbance();
  held_input_(0) = std::clamp(u(0), -design_.force_limit, design_.force_limit);
}

ResonanceRatioGains resonance_ratio(const TwoInertia& plant, double damping_ratio) {
  check(plant);
  if (!(damping_ratio > 0.0)) {
    throw std::invalid_argument("resonance ratio control: the damping ratio must be positive");
  }
  const double omega = antiresonance_rad_s(plant);
  const double load_at_motor = plant.load_inertia / (plant.ratio * plant.ratio);
  return {.k_p = plant.motor_inertia * omega * omega,
          .k_d = 4.0 * damping_ratio * plant.motor_inertia * omega,
          .reaction = 4.0 * damping_ratio * damping_ratio * plant.motor_inertia / load_at_motor};
}

}  // namespace breakwater
