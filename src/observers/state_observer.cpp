#include <breakwater/observers/state_observer.h>

#include <cmath>
#include <complex>

#include <breakwater/math/functions.h>

namespace breakwater {

namespace {

// If the sum of the poles has a larger error, the gain for T_s is used.
constexpr double kPlacementError = 1e-6;

}  // namespace

StateObserver::StateObserver(const StateSpace& continuous_plant,
                             const std::vector<PoleGroup>& poles, double period_s)
    : poles_(poles),
      sampled_poles_(sample_poles(poles, period_s)),
      placement_(continuous_plant.states(), continuous_plant.outputs()),
      period_s_(period_s),
      interval_s_(period_s),
      hold_(continuous_plant),
      C_(continuous_plant.C) {
  const StateSpace sampled = zero_order_hold(continuous_plant, period_s);
  regular_.gain = place_observer_poles(sampled.A, sampled.C, sampled_poles_);
  regular_.error_dynamics = sampled.A - regular_.gain * sampled.C;
  regular_.B = sampled.B;
  step_ = regular_;
  const Eigen::Index n = sampled.states();
  state_.setZero(n);
  disturbance_.setZero(sampled.inputs());
  next_.setZero(n);
  last_output_.setZero(C_.rows());
  innovation_ = last_output_;
  change_ = observability_ = polynomial_ = factor_ = work_ = Eigen::MatrixXd::Identity(n, n);
  last_ = Eigen::VectorXd::Unit(n, n - 1);
  solver_ = Eigen::PartialPivLU<Eigen::MatrixXd>(n);
  signals_ = {{"innovation", "", "e = y - C x(k|k-1) (Eq. 4.15)", view(innovation_)}};
}

bool StateObserver::follow(const SampleInterval& interval) {
  const double length_s = interval.length_s > 0.0 ? interval.length_s : period_s_;
  if (length_s == interval_s_) return true;
  interval_s_ = length_s;
  if (length_s == period_s_) {
    step_ = regular_;
  } else {
    place(length_s);
  }
  return true;
}

// H = φ(A) O⁻¹ e_n with the polynomial φ of the poles. The rows of O are C (A − I)ⁱ, not C Aⁱ: they
// do not cancel for a short interval.
void StateObserver::place(double interval_s) {
  hold_.over(interval_s);
  step_.B = hold_.B();
  step_.error_dynamics = hold_.A();
  if (C_.rows() > 1) {
    sample_poles(poles_, interval_s, sampled_poles_);
    placement_.place(step_.error_dynamics, C_, sampled_poles_, step_.gain);
    step_.error_dynamics.noalias() -= step_.gain * C_;
    // For a very short interval the poles are close to 1, and rounding may move them.
    double sum = 0.0;
    for (const PoleGroup& group : sampled_poles_) {
      for (const std::complex<double>& pole : group) sum += pole.real();
    }
    if (!(std::abs(step_.error_dynamics.trace() - sum) < kPlacementError)) {
      step_.gain = regular_.gain;
      step_.error_dynamics = hold_.A();
      step_.error_dynamics.noalias() -= step_.gain * C_;
    }
    return;
  }
  change_ = step_.error_dynamics;
  change_.diagonal().array() -= 1.0;
  observability_.row(0) = C_.row(0);
  for (Eigen::Index i = 1; i < C_.cols(); ++i) {
    observability_.row(i).noalias() = observability_.row(i - 1) * change_;
  }
  polynomial_.setIdentity();
  for (const std::complex<double>& pole : poles_.front()) {
    if (pole.imag() < 0.0) continue;  // done with its conjugate
    const double decay = math::expm1(pole.real() * interval_s);
    const double angle = pole.imag() * interval_s;
    factor_ = change_;
    factor_.diagonal().array() -= decay + (1.0 + decay) * (math::cos(angle) - 1.0);
    work_.noalias() = polynomial_ * factor_;
    if (pole.imag() == 0.0) {
      polynomial_ = work_;
      continue;
    }
    // (A − z)(A − z̄) = (A − Re z)² + (Im z)².
    const double imaginary = (1.0 + decay) * math::sin(angle);
    polynomial_ *= imaginary * imaginary;
    polynomial_.noalias() += work_ * factor_;
  }
  solver_.compute(observability_);
  next_ = solver_.solve(last_);
  step_.gain.noalias() = polynomial_ * next_;
  step_.error_dynamics.noalias() -= step_.gain * C_;
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
  innovation_.noalias() -= C_ * state_;
}

}  // namespace breakwater
