#include <breakwater/observers/state_observer.h>

#include <cmath>
#include <complex>
#include <stdexcept>
#include <utility>

namespace breakwater {

namespace {

// If the sum of the poles has a larger error, the gain for T_s is used.
constexpr double kPlacementError = 1e-6;

}  // namespace

StateObserver::StateObserver(const StateSpace& continuous_plant,
                             const std::vector<PoleGroup>& poles, double period_s)
    : plant_(continuous_plant), poles_(poles), period_s_(period_s), interval_s_(period_s) {
  const StateSpace sampled = zero_order_hold(plant_, period_s);
  const std::vector<PoleGroup> sampled_poles = sample_poles(poles, period_s);
  regular_ = step_of(sampled, place_observer_poles(sampled.A, sampled.C, sampled_poles));
  step_ = regular_;
  state_.setZero(plant_.states());
  disturbance_.setZero(plant_.inputs());
  next_.setZero(plant_.states());
  last_output_.setZero(plant_.outputs());
  innovation_ = last_output_;
  signals_ = {{"innovation", "", "e = y - C x(k|k-1) (Eq. 4.15)", view(innovation_)}};
}

StateObserver::Step StateObserver::step_of(const StateSpace& sampled, Eigen::MatrixXd H) {
  const Eigen::MatrixXd error_dynamics = sampled.A - H * sampled.C;
  return {std::move(H), error_dynamics, sampled.B};
}

bool StateObserver::follow(const SampleInterval& interval) {
  const double length_s = interval.length_s > 0.0 ? interval.length_s : period_s_;
  if (length_s == interval_s_) return true;
  interval_s_ = length_s;
  if (length_s == period_s_) {
    step_ = regular_;
    return true;
  }
  const StateSpace sampled = zero_order_hold(plant_, length_s);
  const std::vector<PoleGroup> poles = sample_poles(poles_, length_s);
  step_ = step_of(sampled, regular_.gain);
  try {
    const Step placed = step_of(sampled, place_observer_poles(sampled.A, sampled.C, poles));
    // For a very short interval the poles are close to 1, and rounding may move them.
    double sum = 0.0;
    for (const PoleGroup& group : poles) {
      for (const std::complex<double>& pole : group) sum += pole.real();
    }
    if (std::abs(placed.error_dynamics.trace() - sum) < kPlacementError) step_ = placed;
  } catch (const std::invalid_argument&) {
    return true;  // a mode has decayed within a long interval, so its poles cannot be placed
  }
  return true;
}

void StateObserver::reset(const Vector& x) {
  state_.setZero();
  state_.head(x.size()) = x;
  has_begun_ = false;
  follow({});
}

void StateObserver::update(const Vector& held_input, const Vector& y) {
  if (has_begun_) {
    next_.noalias() = step_.error_dynamics * state_;
    next_.noalias() += step_.B * held_input;
    next_.noalias() += step_.gain * last_output_;
    // Copies, does not swap: a log holds the address of the state.
    state_ = next_;
  }
  has_begun_ = true;
  last_output_ = y;
  innovation_ = y;
  innovation_.noalias() -= plant_.C * state_;
}

}  // namespace breakwater
