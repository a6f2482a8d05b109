// Estimators of single axes, combined into an estimator of all axes.
#pragma once

#include <Eigen/Core>
#include <memory>
#include <vector>

#include <breakwater/observers/disturbance_estimator.h>

namespace breakwater {

/// n decoupled axes, each with its own estimator: x̂ = [q (n); q̇ (n)], d̂ (n), y = q (n).
/// The scalar signals of the axes with one name form a signal of n values. Signals of several
/// values stay separate: NAME_q1, NAME_q2, …
class StackedEstimator final : public DisturbanceEstimator {
 public:
  /// Throws std::invalid_argument if there is no estimator, or one is not for a single axis.
  explicit StackedEstimator(std::vector<std::unique_ptr<DisturbanceEstimator>> axes);

  void reset(const Vector& x) override;
  void update(const Vector& held_input, const Vector& y) override;

  View state() const override { return {estimate_.data(), 2 * size()}; }
  View disturbance() const override { return {estimate_.data() + 2 * size(), size()}; }

 private:
  // Source and destination of a scalar of an axis.
  struct Copy {
    const double* from;
    double* to;
  };

  Eigen::Index size() const { return static_cast<Eigen::Index>(axes_.size()); }
  void gather();

  std::vector<std::unique_ptr<DisturbanceEstimator>> axes_;
  Eigen::VectorXd estimate_;   // [q; q̇; d]
  Eigen::MatrixXd published_;  // one column per signal
  std::vector<Copy> copies_;
};

}  // namespace breakwater
