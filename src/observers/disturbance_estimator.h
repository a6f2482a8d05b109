// The interface of all disturbance estimators.
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <span>
#include <string>
#include <vector>

#include <breakwater/math/interface.h>
#include <breakwater/signals/axis_units.h>
#include <breakwater/signals/signal.h>

namespace breakwater {

/// The interval before a sample, if it is not exactly one period.
struct SampleInterval {
  double length_s = 0.0;       ///< time since the last sample; 0: T_s
  double instant_std_s = 0.0;  ///< standard deviation of the time of the measurement
  /// Standard deviation of the mean of the held input over the interval, if samples are missing.
  /// Its weight is relative to the output's error output_std; 0: the estimator's R.
  double input_std = 0.0;
  double output_std = 0.0;
};

/// The number of predictions in an interval: one per period, from 1 to 1000.
inline double pieces_of(double length_s, double period_s) {
  return std::clamp(std::round(length_s / period_s), 1.0, 1000.0);
}

/// Estimates the state x (n) of a plant and the disturbance d (m) that opposes its inputs,
///     x(k+1) = A x(k) + B (u(k) − d(k)),   y(k) = C x(k) + noise   (Eqs. 3.1, 3.2),
/// from the input and the measurement. Call update() once a sample, then read.
class DisturbanceEstimator : public Interface {
 public:
  using Vector = Eigen::Ref<const Eigen::VectorXd>;
  using View = Eigen::Map<const Eigen::VectorXd>;

  /// Starts from state `x` (n) and no disturbance.
  virtual void reset(const Vector& x) = 0;

  /// One sample: `held_input` (m) acted since the last sample, `y` (p) is the measurement now. The
  /// first sample after a reset ignores its input. Allocates nothing.
  virtual void update(const Vector& held_input, const Vector& y) = 0;

  /// x̂ and d̂ of this sample, at addresses that do not change.
  virtual View state() const = 0;
  virtual View disturbance() const = 0;

  /// Signals for a log: the innovation, the forgetting factor λ(k), … The views stay valid as long
  /// as the estimator lives. An empty unit means the unit of the output, unknown to the estimator.
  virtual std::span<const Signal> signals() const { return signals_; }

  /// The number of poles, and the matrix A̅ − K(k) C̅ of this sample, which has them as eigenvalues
  /// (thesis 4.3.4). Optional: 0 poles by default. Allocates nothing.
  virtual Eigen::Index poles() const { return 0; }
  virtual void pole_matrix(Eigen::Ref<Eigen::MatrixXd> /*F*/) const {}

  /// Sets the interval before the next samples, until a reset. Returns false if the estimator
  /// assumes that every interval is T_s and every time is exact.
  virtual bool follow(const SampleInterval& /*interval*/) { return false; }

 protected:
  std::vector<Signal> signals_;
};

/// The values of the signal `name`; empty if the estimator has no such signal.
inline std::span<const double> published(const DisturbanceEstimator& estimator,
                                         const std::string& name) {
  const auto all = estimator.signals();
  const auto found = std::ranges::find(all, name, &Signal::name);
  return found == all.end() ? std::span<const double>() : found->values;
}

/// An estimator's signals for a log. The output's unit is `output_unit`.
inline std::vector<Signal> signals_of(const DisturbanceEstimator& estimator,
                                      const std::string& output_unit) {
  std::vector<Signal> signals(estimator.signals().begin(), estimator.signals().end());
  for (Signal& signal : signals) {
    if (signal.unit.empty()) signal.unit = output_unit;
  }
  return signals;
}

/// The estimates of an axis as signals for a log. The states are [q, v] or, for two inertias,
/// [q, v, q₂, v₂].
inline std::vector<Signal> estimate_signals(const DisturbanceEstimator& estimator,
                                            const AxisUnits& units) {
  const double* x = estimator.state().data();
  const bool knows_spring = estimator.state().size() == 4;
  std::vector<Signal> signals = {
      {"position_hat_" + units.position, units.position, "position, estimated", view(x[0])},
      {"velocity_hat_" + units.velocity_suffix, units.velocity, "velocity, estimated", view(x[1])},
      {"d_hat_" + units.force_suffix, units.force,
       knows_spring ? "disturbance at the load, estimated" : "disturbance at the drive, estimated",
       view(*estimator.disturbance().data())}};
  if (knows_spring) {
    signals.push_back({"other_position_hat_" + units.position, units.position,
                       "position of the side without the encoder, estimated", view(x[2])});
    signals.push_back({"other_velocity_hat_" + units.velocity_suffix, units.velocity,
                       "velocity of the side without the encoder, estimated", view(x[3])});
  }
  return signals;
}

}  // namespace breakwater
