// Forecasts of the disturbing force on the quadrotor.
#pragma once

#include <Eigen/Core>
#include <vector>

#include <breakwater/control/quadrotor_estimator.h>
#include <breakwater/observers/autoregressive.h>

namespace breakwater {

/// A force in the world at several times, one in each column [N].
using ForceTable = Eigen::Matrix<double, 3, Eigen::Dynamic, Eigen::RowMajor>;

/// A forecast of the force over a horizon of N steps of the period T.
class ForceForecast {
 public:
  ForceForecast() = default;
  ForceForecast(const ForceForecast&) = delete;
  ForceForecast& operator=(const ForceForecast&) = delete;
  virtual ~ForceForecast() = default;

  virtual void reset(double time_s) = 0;
  /// Called once in each T, after the estimator's update. Column i of `forces` (3 × N + 1) becomes
  /// the force in the world at the time t + i T [N]. Allocates nothing.
  virtual void update(double time_s, const QuadrotorEstimator& estimator, ForceTable& forces) = 0;
};

/// The estimator's own forecast: the free response of its model of the force. Without `foresees`
/// the present estimate holds.
class EstimatorForecast final : public ForceForecast {
 public:
  EstimatorForecast(double period_s, bool foresees) : period_s_(period_s), foresees_(foresees) {}

  void reset(double) override {}
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
