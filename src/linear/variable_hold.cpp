#include <breakwater/linear/variable_hold.h>

namespace breakwater {

VariableHold::VariableHold(const StateSpace& continuous) : states_(continuous.states()) {
  check(continuous);
  const Eigen::Index size = states_ + continuous.inputs();
  generator_ = Eigen::MatrixXd::Zero(size, size);
  generator_.topLeftCorner(states_, states_) = continuous.A;
  generator_.topRightCorner(states_, continuous.inputs()) = continuous.B;
  norm_ = generator_.cwiseAbs().colwise().sum().maxCoeff();
  scaled_ = transition_ = term_ = work_ = Eigen::MatrixXd::Identity(size, size);
}

void VariableHold::over(double interval_s) {
  constexpr double kSmall = 0.5;
  constexpr int kMostTerms = 20;  // 0.5²⁰/20! is 4e-25
  int squarings = 0;
  double part_s = interval_s;
  for (; norm_ * part_s > kSmall; part_s *= 0.5) ++squarings;
  scaled_ = generator_ * part_s;
  term_.setIdentity();
  transition_.setIdentity();
  for (int k = 1; k <= kMostTerms; ++k) {
    work_.noalias() = term_ * scaled_;
    term_ = work_ / k;
    work_ = transition_ + term_;
    if (work_ == transition_) break;
    transition_ = work_;
  }
  for (; squarings > 0; --squarings) {
    work_.noalias() = transition_ * transition_;
    transition_ = work_;
  }
}

}  // namespace breakwater
