#include <breakwater/control/predictive_control.h>

#include <algorithm>
#include <stdexcept>
#include <utility>

#include <breakwater/control/estimate_signals.h>

namespace breakwater {

PredictiveControl::PredictiveControl(std::shared_ptr<DisturbanceEstimator> estimator,
                                     const PredictiveControlDesign& design)
    : estimator_(std::move(estimator)),
      design_(design),
      lmpc_(design.lmpc),
      plant_states_(estimator_->state().size()),
      predicted_state_(Eigen::VectorXd::Zero(lmpc_.states())),
      trajectory_(Eigen::VectorXd::Zero(lmpc_.states() * lmpc_.prediction_steps())),
      reserved_(Eigen::VectorXd::Zero(1)),
      planned_input_(Eigen::VectorXd::Zero(1)),
      cancelled_(Eigen::VectorXd::Zero(1)),
      held_input_(Eigen::VectorXd::Zero(1)) {
  const Eigen::Index disturbances =
      design.disturbance_use == DisturbanceUse::predict ? estimator_->disturbance().size() : 0;
  if (lmpc_.inputs() != 1 || estimator_->disturbance().size() != 1 ||
      lmpc_.states() != plant_states_ + disturbances ||
      design.start_state.size() != plant_states_ || design.controlled < 0 ||
      design.controlled >= plant_states_) {
    throw std::invalid_argument(
        "predictive control: estimator and model must be for the same plant");
  }
  if (design.samples_per_move < 1) {
    throw std::invalid_argument("predictive control: needs at least one sample per move");
  }
  if (!(design.force_limit > 0.0)) {
    throw std::invalid_argument("predictive control: the force limit must be positive");
  }
  const AxisUnits& units = design.units;
  signals_ = {{"reference_" + units.position_suffix, units.position, "r", view(reference_)}};
  for (const Signal& signal : estimate_signals(*estimator_, units)) signals_.push_back(signal);
  const std::vector<Signal> own = {
      {"u_mpc_" + units.force_suffix, units.force, "input of the optimisation (Eq. 2.42)",
       view(planned_input_)},
      {"qp_iterations", "1", "iterations of the last optimisation", view(iterations_)},
      {"qp_softened", "1", "number of softened bounds in it: on states, then on du",
       view(softened_)},
      {"qp_status", "1", "status of its last solve: 0 solved, 1 iteration cap, 4 inaccurate",
       view(status_)},
      {"qp_kkt_residual", "1", "residual of its last solve", view(kkt_residual_)}};
  signals_.insert(signals_.end(), own.begin(), own.end());
  for (const Signal& signal : signals_of(*estimator_, units.position)) signals_.push_back(signal);
}

void PredictiveControl::reset(const Sample&) {
  estimator_->reset(design_.start_state);
  lmpc_.reset();
  planned_input_.setZero();
  cancelled_.setZero();
  held_input_.setZero();
  samples_to_move_ = 0;
}

void PredictiveControl::update(const Sample& y, Eigen::Ref<Eigen::VectorXd> u) {
  estimator_->update(held_input_, y.y.head<1>());
  reference_ = design_.reference.at(y.time_s);
  const bool cancels = design_.disturbance_use == DisturbanceUse::cancel ||
                       design_.disturbance_use == DisturbanceUse::cancel_within_bounds;
  const bool decides = samples_to_move_ == 0;
  if (decides) {
    samples_to_move_ = design_.samples_per_move;
    predicted_state_.head(plant_states_) = estimator_->state();
    if (design_.disturbance_use == DisturbanceUse::predict) {
      predicted_state_.tail(1) = estimator_->disturbance();
    }
    if (design_.disturbance_use == DisturbanceUse::cancel_within_bounds) {
      reserved_ = estimator_->disturbance();
    }
    for (int i = 0; i < lmpc_.prediction_steps(); ++i) {
      trajectory_(i * lmpc_.states() + design_.controlled) = reference_;
    }
    planned_input_ += lmpc_.optimise(predicted_state_, planned_input_, trajectory_, reserved_);
    iterations_ = lmpc_.iterations();
    softened_ = lmpc_.softened_bounds();
    status_ = static_cast<double>(lmpc_.solution().status);
    kkt_residual_ = lmpc_.solution().kkt_residual;
  }
  --samples_to_move_;
  held_input_ = planned_input_;
  if (cancels) {
    if (decides || design_.cancel_at == CancelAt::sample) cancelled_ = estimator_->disturbance();
    held_input_ += cancelled_;
  }
  if (design_.disturbance_use == DisturbanceUse::cancel_within_bounds) {
    held_input_(0) =
        std::clamp(held_input_(0), lmpc_.first_input_lower(0), lmpc_.first_input_upper(0));
  }
  u = held_input_;
  held_input_(0) = std::clamp(held_input_(0), -design_.force_limit, design_.force_limit);
}

}  // namespace breakwater
