// Estimators of one axis each, as one of all axes.
#pragma once

#include <Eigen/Core>
#include <memory>
#include <vector>

#include <breakwater/observers/disturbance_estimator.h>

namespace breakwater {

/// n decoupled axes, each with an estimator of its own: x̂ = [q (n); q̇ (n)], d̂ (n), y = q (n).
class StackedEstimator final : public DisturbanceEstimator {
 public:
  /// Throws std::invalid_argument if there is none, or one is not of a single axis.
  explicit StackedEstimator(std::vector<std::unique_ptr<DisturbanceEstimator>> axes);

  void reset(const Vector& x) override;
  void update(const Vector& held_input, const Vector& y) override;

  View state() const override { return {estimate_.data(), 2 * size()}; }
  View disturbance() const override { return {estimate_.data() + 2 * size(), size()}; }
  /// A number that every axis publishes is one signal of n values. A signal of several values stays
  /// each axis' own: NAME_q1, NAME_q2, …
  std::span<const Signal> signals() const override { return signals_; }

 private:
  // A number of an axis, and where it stands among those of all.
  struct Copy {
    const double* from;
    double* to;
  };

  Eigen::Index size() const { return static_cast<Eigen::Index>(axes_.size()); }
  void gather();

  std::vector<std::unique_ptr<DisturbanceEstimator>> axes_;
  Eigen::VectorXd estimate_;   // [q; q̇; d]
  Eigen::MatrixXd published_;  // a column a signal
  std::vector<Copy> copies_;
  std::vector<Signal> signals_;
};

}  // namespace breakwater
