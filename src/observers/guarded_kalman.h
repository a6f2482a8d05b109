// The common part of the published Kalman filters of an axis.
#pragma once

#include <memory>
#include <stdexcept>

#include <breakwater/observers/guarded.h>
#include <breakwater/observers/kalman_estimator.h>
#include <breakwater/observers/sensor_error.h>

namespace breakwater {

/// Q = `q` on the disturbance's highest derivative, R from the sensor's error, P0 diagonal. The
/// published filters depend on these numbers themselves, unlike those of the thesis.
KalmanDesign known_sensor_design(const ExtendedPlant& plant, const SensorError& sensor, double q,
                                 const Eigen::VectorXd& P0);

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
    if (!(kernel_ && measures_first_ && extended_state().size() == N)) {
      throw std::invalid_argument("Kalman filter: the output must be the first state");
    }
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
std::unique_ptr<DisturbanceEstimator> of_axis_size(const KalmanDesign& design,
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

}  // namespace breakwater
