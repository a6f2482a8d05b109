// An autoregressive model of a signal, identified on line.
#pragma once

#include <Eigen/Core>

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

}  // namespace breakwater
