#include <breakwater/observers/idob.h>

#include <stdexcept>
#include <string>

#include <breakwater/linear/observability.h>

namespace breakwater {

Idob::Idob(const StateSpace& continuous_plant, const std::vector<PoleGroup>& poles, double period_s)
    : states_(continuous_plant.states()) {
  const std::vector<PoleGroup> sampled = sample_poles(poles, period_s);
  const StateSpace extended =
      zero_order_hold(extend_by_input_disturbance(continuous_plant), period_s);
  const Eigen::Index rank = observability_rank(extended.A, extended.C);
  if (rank != extended.states()) {
    throw std::invalid_argument("IDOB: the extended plant is not observable (rank " +
                                std::to_string(rank) + " of " + std::to_string(extended.states()) +
                                ")");
  }
  observer_gain_ = place_observer_poles(extended.A, extended.C, sampled);
  error_dynamics_ = extended.A - observer_gain_ * extended.C;
  input_matrix_ = extended.B;
  extended_state_.setZero(extended.states());
  next_.setZero(extended.states());
}

void Idob::reset(const Eigen::Ref<const Eigen::VectorXd>& x) {
  extended_state_.setZero();
  extended_state_.head(states_) = x;
}

void Idob::update(const Eigen::Ref<const Eigen::VectorXd>& u,
                  const Eigen::Ref<const Eigen::VectorXd>& y) {
  next_.noalias() = error_dynamics_ * extended_state_;
  next_.noalias() += input_matrix_ * u;
  next_.noalias() += observer_gain_ * y;
  // Copied, not swapped: a log holds the address of the state.
  extended_state_ = next_;
}

}  // namespace breakwater
