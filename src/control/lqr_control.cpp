#include <breakwater/control/lqr_control.h>

#include <algorithm>
#include <stdexcept>
#include <utility>

#include <breakwater/control/estimate_signals.h>

namespace breakwater {

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
