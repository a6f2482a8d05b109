// Forecasts of the disturbing force on the quadrotor, and the autoregressive model of one of
// them.
#pragma once

#include <Eigen/Core>
#include <vector>

#include <breakwater/control/quadrotor_estimator.h>
#include <breakwater/math/interface.h>

namespace breakwater {

struct AutoregressiveDesign {
  int order = 4;          ///< n: number of past values
  int spacing = 5;        ///< s: samples from one of these values to the next
  double memory = 600.0;  ///< time constant of the exponential forgetting, in samples
  double largest = 1.0;   ///< bound of the signal and of its forecast
};

/// The signal as a regression on its own past,
///     y(k) = c + Σ_{i=1}^{n} a_i y(k − s i) + e(k).
/// Recursive least squares with exponential forgetting identifies c and a_i. They start at
/// y(k) = y(k − s). The forecast repeats the equation with e = 0 and forecasts in the place of
/// values that are not known yet.
///
/// With s = 1 this is the usual model. A larger s keeps the values apart if the samples are much
/// closer together than the waves need.
///
/// Source: J. S. Riedel, A. J. Healey, "Model based predictive control of AUVs for station keeping
/// in a shallow water wave environment", Proc. Int. Advanced Robotics Program (1998) 27 ff.
class AutoregressiveModel {
 public:
  /// Throws std::invalid_argument unless every value is positive and the memory at least 1.
  explicit AutoregressiveModel(const AutoregressiveDesign& design);

  void reset();
  /// One sample. Any finite value is allowed: it counts up to `largest`. Allocates nothing.
  void update(double value);
  /// Writes the forecast of the following samples. Allocates nothing.
  void forecast(Eigen::Ref<Eigen::RowVectorXd> values) const;

  /// [c; a_1; …; a_n].
  const Eigen::VectorXd& coefficients() const { return coefficients_; }

 private:
  AutoregressiveDesign design_;
  Eigen::VectorXd past_;  // the newest value first
  Eigen::VectorXd coefficients_;
  Eigen::MatrixXd P_;
  Eigen::VectorXd regressor_;
  Eigen::VectorXd step_;  // P φ
  Eigen::VectorXd gain_;
  int samples_ = 0;  // up to all of past_
};

/// A force in the world at several times, one in each column [N].
using ForceTable = Eigen::Matrix<double, 3, Eigen::Dynamic, Eigen::RowMajor>;

/// A forecast of the force over a horizon of N steps of the period T.
class ForceForecast : public Interface {
 public:
  virtual void reset(double /*time_s*/) {}
  /// Called once in each T, after the estimator's update. Column i of `forces` (3 × N + 1) becomes
  /// the force in the world at the time t + i T [N]. Allocates nothing.
  virtual void update(double time_s, const QuadrotorEstimator& estimator, ForceTable& forces) = 0;
};

/// The estimator's own forecast: the free response of its model of the force. Without `foresees`
/// the present estimate holds.
class EstimatorForecast final : public ForceForecast {
 public:
  EstimatorForecast(double period_s, bool foresees) : period_s_(period_s), foresees_(foresees) {}

  void update(double time_s, const QuadrotorEstimator& estimator, ForceTable& forces) override;

 private:
  double period_s_;
  bool foresees_;
};

/// An autoregressive model of each component of the estimated force.
class AutoregressiveForecast final : public ForceForecast {
 public:
  /// Throws std::invalid_argument as the model does.
  explicit AutoregressiveForecast(const AutoregressiveDesign& design)
      : axes_(3, AutoregressiveModel(design)) {}

  void reset(double time_s) override;
  void update(double time_s, const QuadrotorEstimator& estimator, ForceTable& forces) override;

 private:
  std::vector<AutoregressiveModel> axes_;
};

}  // namespace breakwater
