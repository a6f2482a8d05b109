#include <breakwater/control/state_feedback.h>

#include <Eigen/LU>
#include <algorithm>
#include <stdexcept>
#include <utility>

#include <breakwater/control/estimate_signals.h>

namespace breakwater {

Eigen::RowVectorXd place_feedback_poles(const StateSpace& continuous_plant, const PoleGroup& poles,
                                        double period_s) {
  const StateSpace sampled = zero_order_hold(continuous_plant, period_s);
  return place_observer_poles(sampled.A.transpose(), sampled.B.transpose(),
                              sample_poles({poles}, period_s))
      .transpose();
}

StateFeedback::StateFeedback(std::shared_ptr<DisturbanceEstimator> estimator,
                             const StateFeedbackDesign& design)
    : estimator_(std::move(estimator)),
      design_(design),
      poles_(*estimator_, design.period_s),
      held_input_(Eigen::VectorXd::Zero(1)) {
  const StateSpace& plant = design_.plant;
  check(plant);
  const Eigen::Index n = plant.states();
  if (plant.inputs() != 1 || design.E.size() != n || design.K.size() != n ||
      design.start_state.size() != n || estimator_->state().size() != n ||
      estimator_->disturbance().size() != 1 || design.controlled < 0 || design.controlled >= n) {
    throw std::invalid_argument("state feedback: estimator, gain and plant do not fit");
  }
  if (!(design.force_limit > 0.0)) {
    throw std::invalid_argument("state feedback: the force limit must be positive");
  }
  // [A B; c 0] [x*; u*] = [E d; r], for d = 1 and for r = 1.
  Eigen::MatrixXd rest = Eigen::MatrixXd::Zero(n + 1, n + 1), wanted = rest.leftCols(2);
  rest.topLeftCorner(n, n) = plant.A;
  rest.topRightCorner(n, 1) = plant.B;
  rest(n, design.controlled) = 1.0;
  wanted.col(0).head(n) = design.E;
  wanted(n, 1) = 1.0;
  const Eigen::FullPivLU<Eigen::MatrixXd> factor(rest);
  if (!factor.isInvertible()) {
    throw std::invalid_argument("state feedback: the plant cannot rest at every reference");
  }
  const Eigen::MatrixXd found = factor.solve(wanted);
  const Eigen::RowVectorXd gains = found.row(n) + design.K * found.topRows(n);
  disturbance_gain_ = gains(0);
  reference_gain_ = gains(1);

  signals_ = {
      {"reference_" + design.units.position_suffix, design.units.position, "r", view(reference_)}};
  for (const Signal& signal : estimate_signals(*estimator_, design.units)) {
    signals_.push_back(signal);
  }
  for (const Signal& signal : signals_of(*estimator_, design.units.position)) {
    signals_.push_back(signal);
  }
  for (const Signal& signal : poles_.signals()) signals_.push_back(signal);
}

void StateFeedback::reset(const Sample&) {
  estimator_->reset(design_.start_state);
  held_input_.setZero();
}

void StateFeedback::update(const Sample& y, Eigen::Ref<Eigen::VectorXd> u) {
  estimator_->update(held_input_, y.y.head<1>());
  if (is_watched_) poles_.update();
  reference_ = design_.reference.at(y.time_s);
  u(0) = reference_gain_ * reference_ + disturbance_gain_ * estimator_->disturbance()(0) -
         design_.K.dot(estimator_->state());
  held_input_(0) = std::clamp(u(0), -design_.force_limit, design_.force_limit);
}

LqrControl::LqrControl(std::shared_ptr<DisturbanceEstimator> estimator, Eigen::RowVectorXd K,
                       Eigen::VectorXd start_state, bool uses_true_state, double force_limit)
    : estimator_(std::move(estimator)),
      K_(std::move(K)),
      start_state_(std::move(start_state)),
      uses_true_state_(uses_true_state),
      force_limit_(force_limit),
      held_input_(Eigen::VectorXd::Zero(1)) {
  if (K_.size() != estimator_->state().size() || start_state_.size() != K_.size() ||
      estimator_->disturbance().size() != 1) {
    throw std::invalid_argument("LQR: estimator and gain must be for the same plant");
  }
  if (!(force_limit > 0.0)) throw std::invalid_argument("LQR: the force limit must be positive");
  signals_ = estimate_signals(*estimator_, translation_units());
  for (const Signal& signal : signals_of(*estimator_, "m")) signals_.push_back(signal);
}

void LqrControl::reset(const Sample&) {
  estimator_->reset(start_state_);
  held_input_.setZero();
}

void LqrControl::update(const Sample& y, Eigen::Ref<Eigen::VectorXd> u) {
  estimator_->update(held_input_, y.y.head<1>());
  if (uses_true_state_) {
    u.noalias() = -K_ * y.y.segment(1, K_.size());
  } else {
    u.noalias() = -K_ * estimator_->state();
    u += estimator_->disturbance();
  }
  held_input_(0) = std::clamp(u(0), -force_limit_, force_limit_);
}

}  // namespace breakwater
