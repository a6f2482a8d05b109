// What every disturbance estimator is.
#pragma once

#include <Eigen/Core>
#include <span>
#include <string>
#include <vector>

#include <breakwater/signals/signal.h>

namespace breakwater {

/// How a sample follows the last one, where that is not after one period, exactly.
struct SampleInterval {
  double length_s = 0.0;       ///< since the last sample; 0: T_s
  double instant_std_s = 0.0;  ///< how well it is known when y was measured
  /// How well the held input's mean over the interval is known: where samples are missing. What it
  /// is weighed against is the output's error; 0: that is what the estimator's R says.
  double input_std = 0.0;
  double output_std = 0.0;
};

/// Estimates the state x (n) of a plant and the disturbance d (m) that opposes its inputs,
///     x(k+1) = A x(k) + B (u(k) − d(k)),   y(k) = C x(k) + noise   (Eqs. 3.1, 3.2),
/// from what it was given and what was measured. Used once a sample: update(), then read.
class DisturbanceEstimator {
 public:
  using Vector = Eigen::Ref<const Eigen::VectorXd>;
  using View = Eigen::Map<const Eigen::VectorXd>;

  DisturbanceEstimator() = default;
  DisturbanceEstimator(const DisturbanceEstimator&) = delete;
  DisturbanceEstimator& operator=(const DisturbanceEstimator&) = delete;
  virtual ~DisturbanceEstimator() = default;

  /// Starts from state `x` (n) and no disturbance.
  virtual void reset(const Vector& x) = 0;

  /// One sample: `held_input` (m) is what acted since the last sample, `y` (p) what is measured
  /// now. Nothing acted before the first sample after a reset: its input is ignored. Allocates
  /// nothing.
  virtual void update(const Vector& held_input, const Vector& y) = 0;

  /// x̂ and d̂ of this sample, at addresses that do not change.
  virtual View state() const = 0;
  virtual View disturbance() const = 0;

  /// What it lets others see: the innovation, the forgetting factor λ(k), … The views stay valid
  /// as long as the estimator lives. An empty unit is the output's, which it does not know.
  virtual std::span<const Signal> signals() const = 0;

  /// How many poles it has, and writes the matrix whose eigenvalues they are: A̅ − K(k) C̅ of this
  /// sample (thesis 4.3.4). Allocates nothing. One that does not tell them needs neither.
  virtual Eigen::Index poles() const { return 0; }
  virtual void pole_matrix(Eigen::Ref<Eigen::MatrixXd> /*F*/) const {}

  /// Says how the next sample, and those after it, follow the one before each, until a reset.
  /// Returns false if it takes every interval for T_s and every instant for known, as one may.
  /// Allocates nothing.
  virtual bool follow(const SampleInterval& /*interval*/) { return false; }
};

/// The values that an estimator publishes under a name; empty if it has no such signal.
inline std::span<const double> published(const DisturbanceEstimator& estimator,
                                         const std::string& name) {
  for (const Signal& signal : estimator.signals()) {
    if (signal.name == name) return signal.values;
  }
  return {};
}

/// An estimator's signals for a log, where its output is measured in `output_unit`.
inline std::vector<Signal> signals_of(const DisturbanceEstimator& estimator,
                                      const std::string& output_unit) {
  std::vector<Signal> signals(estimator.signals().begin(), estimator.signals().end());
  for (Signal& signal : signals) {
    if (signal.unit.empty()) signal.unit = output_unit;
  }
  return signals;
}

}  // namespace breakwater
