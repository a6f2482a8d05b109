// The common parts of the published observers, which must survive any input, and of those that
// are Kalman filters.
#pragma once

#include <Eigen/Core>
#include <cmath>
#include <cstddef>
#include <memory>
#include <stdexcept>
#include <utility>

#include <breakwater/math/refuse_unless.h>
#include <breakwater/observers/disturbance_estimator.h>
#include <breakwater/observers/kalman_estimator.h>
#include <breakwater/observers/sensor_error.h>

namespace breakwater {

/// An estimator with one input and one output. A measurement that is not finite is not used: the
/// estimator only predicts. An input that is not finite counts as the last one. If the estimate is
/// not finite after a sample, the estimator starts again at the measurement.
template <typename Base = DisturbanceEstimator>
class Guarded : public Base {
 public:
  using Vector = DisturbanceEstimator::Vector;

  void update(const Vector& held_input, const Vector& y) final {
    if (std::isfinite(held_input(0))) last_input_ = held_input;
    is_measured_ = std::isfinite(y(0));
    step(last_input_, y);
    if (is_sound()) return;
    start_.setZero(this->state().size());
    if (is_measured_) start_(0) = y(0);
    this->reset(start_);
  }

 protected:
  template <typename... Arguments>
  explicit Guarded(Arguments&&... arguments) : Base(std::forward<Arguments>(arguments)...) {}

  /// One sample with a finite input. It must not use y unless is_measured_.
  virtual void step(const Vector& held_input, const Vector& y) = 0;
  /// Whether every published number is finite.
  virtual bool is_sound() const {
    for (const Signal& signal : this->signals()) {
      for (const double value : signal.values) {
        if (!std::isfinite(value)) return false;
      }
    }
    return this->state().allFinite() && this->disturbance().allFinite();
  }

  bool is_measured_ = false;

 private:
  Eigen::VectorXd last_input_ = Eigen::VectorXd::Zero(1);
  Eigen::Matrix<double, Eigen::Dynamic, 1, 0, 8, 1> start_;  // without a heap
};

/// Q = `q` on the disturbance's highest derivative, R from the sensor's error, P0 diagonal. The
/// published filters depend on these numbers themselves, unlike those of the thesis.
inline KalmanDesign known_sensor_design(const ExtendedPlant& plant, const SensorError& sensor,
                                        double q, const Eigen::VectorXd& P0) {
  check(sensor, plant.outputs());
  return {plant, disturbance_noise(plant, q),
          sensor.variance().cwiseMax(kSmallestVariance).asDiagonal(), P0.asDiagonal()};
}

/// The likelihood of a measurement: a Gaussian density with the variance R, or the probability of
/// the encoder's code (CodeSensor).
enum class Likelihood { gauss, code };

/// A guarded Kalman filter with N extended states, one input, and the first state as output.
template <int N>
class GuardedKalman : public Guarded<KalmanEstimator> {
 protected:
  using State = Eigen::Matrix<double, N, 1>;
  using Covariance = Eigen::Matrix<double, N, N>;

  explicit GuardedKalman(const KalmanDesign& design) : Guarded<KalmanEstimator>(design) {
    refuse_unless(kernel_ && measures_first_ && extended_state().size() == N,
                  "Kalman filter: the output must be the first state");
    signals_.pop_back();  // lambda: there is no forgetting factor
  }

  /// A variance below 0 is the rounding error of a huge innovation.
  bool is_sound() const override {
    return extended_state_.allFinite() && covariance_.allFinite() &&
           covariance_.diagonal().minCoeff() >= 0.0 && Guarded<KalmanEstimator>::is_sound();
  }

  /// Computes x̄(k|k−1), P(k|k−1) and ê(k), which is 0 without a measurement.
  void predict_sample(const Vector& held_input, const Vector& y) {
    predict(held_input, y);
    if (!is_measured_) innovation_.setZero();
  }

  /// The base's x̄, P and K with their sizes.
  Eigen::Map<State> extended_state_{KalmanEstimator::extended_state_.data()};
  Eigen::Map<Covariance> covariance_{KalmanEstimator::covariance_.data()};
  Eigen::Map<State> gain_{KalmanEstimator::gain_.data()};
};

/// The largest number of extended states of an axis in a GuardedKalman.
inline constexpr int kMostAxisStates = 5;

/// Filter<N> for the number of extended states of an axis: 3 to 5. Throws as its class does.
template <template <int> class Filter, typename... Arguments>
std::unique_ptr<KalmanEstimator> of_axis_size(const KalmanDesign& design,
                                              const Arguments&... arguments) {
  switch (design.plant.states()) {
    case 3:
      return std::make_unique<Filter<3>>(design, arguments...);
    case 4:
      return std::make_unique<Filter<4>>(design, arguments...);
    case kMostAxisStates:
      return std::make_unique<Filter<kMostAxisStates>>(design, arguments...);
    default:
      throw std::invalid_argument("Kalman filter: the axis must have 3 to 5 extended states");
  }
}

/// The `parts` have a mean x and a covariance P. Their weights(i) add up to 1. Writes
///     x = Σ w_i x_i,   P = Σ w_i (P_i + (x_i − x)(x_i − x)ᵀ).
template <typename Parts, typename Weights, typename State, typename Covariance>
void mix(const Parts& parts, const Weights& weights, State& x, Covariance& P) {
  x.setZero();
  for (std::size_t i = 0; i < parts.size(); ++i) x += weights(static_cast<long>(i)) * parts[i].x;
  P.setZero();
  for (std::size_t i = 0; i < parts.size(); ++i) {
    const auto offset = (parts[i].x - x).eval();
    P += weights(static_cast<long>(i)) * (parts[i].P + offset * offset.transpose());
  }
}

}  // namespace breakwater
