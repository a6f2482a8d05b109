#include <breakwater/observers/raw_difference.h>

#include <breakwater/math/refuse_unless.h>

namespace breakwater {

RawDifference::RawDifference(const StateSpace& plant, double period_s)
    : to_positions_(plant.C.leftCols(plant.states() / 2).transpose()),
      period_s_(period_s),
      last_(Eigen::VectorXd::Zero(plant.states() / 2)),
      x_(Eigen::VectorXd::Zero(plant.states())),
      d_(Eigen::VectorXd::Zero(plant.inputs())) {
  const Eigen::Index n = plant.states() / 2;
  refuse_unless(plant.outputs() == n && (to_positions_.transpose() * to_positions_).isIdentity(),
                "needs a measurement of every position");
}

void RawDifference::reset(const Vector& x) {
  x_ = x;
  is_first_ = true;
}

void RawDifference::update(const Vector& /*held_input*/, const Vector& y) {
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

}  // namespace breakwater
