// The measurement itself as an estimate.
#pragma once

#include <breakwater/linear/state_space.h>
#include <breakwater/math/refuse_unless.h>
#include <breakwater/observers/disturbance_estimator.h>

namespace breakwater {

/// x̂ = [measured positions; their differences over a sample], and no disturbance. The difference of
/// the first sample after a reset is 0.
class RawDifference final : public DisturbanceEstimator {
 public:
  /// The states of `plant` must be positions and their rates, and its outputs must be all
  /// positions. Throws std::invalid_argument otherwise.
  RawDifference(const StateSpace& plant, double period_s)
      : to_positions_(plant.C.leftCols(plant.states() / 2).transpose()),
        period_s_(period_s),
        last_(Eigen::VectorXd::Zero(plant.states() / 2)),
        x_(Eigen::VectorXd::Zero(plant.states())),
        d_(Eigen::VectorXd::Zero(plant.inputs())) {
    refuse_unless(
        plant.outputs() == last_.size() && (to_positions_.transpose() * to_positions_).isIdentity(),
        "needs a measurement of every position");
  }

  void reset(const Vector& x) override {
    x_ = x;
    is_first_ = true;
  }
  void update(const Vector& /*held_input*/, const Vector& y) override {
    const Eigen::Index n = last_.size();
    x_.head(n).noalias() = to_positions_ * y;
    if (is_first_) {
      x_.tail(n).setZero();
    } else {
      x_.tail(n) = (x_.head(n) - last_) / period_s_;
    }
    is_first_ = false;
    last_ = x_.head(n);
  }
  View state() const override { return {x_.data(), x_.size()}; }
  View disturbance() const override { return {d_.data(), d_.size()}; }

 private:
  Eigen::MatrixXd to_positions_;  // from outputs
  double period_s_;
  bool is_first_ = true;
  Eigen::VectorXd last_;
  Eigen::VectorXd x_;
  Eigen::VectorXd d_;
};

}  // namespace breakwater
