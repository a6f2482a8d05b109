// The guard of the published observers, which must survive any input.
#pragma once

#include <Eigen/Core>
#include <cmath>
#include <utility>

#include <breakwater/observers/disturbance_estimator.h>

namespace breakwater {

/// An estimator with one input and one output. A measurement that is not finite is not used: the
/// estimator only predicts. An input that is not finite counts as the last one. If the estimate is
/// not finite after a sample, the estimator starts again at the measurement.
template <typename Base = DisturbanceEstimator>
class Guarded : public Base {
 public:
  using Vector = DisturbanceEstimator::Vector;

  void update(const Vector& held_input, const Vector& y) final {
    if (std::isfinite(held_input(0))) last_input_ = held_input;
    is_measured_ = std::isfinite(y(0));
    step(last_input_, y);
    if (is_sound()) return;
    start_.setZero(this->state().size());
    if (is_measured_) start_(0) = y(0);
    this->reset(start_);
  }

 protected:
  template <typename... Arguments>
  explicit Guarded(Arguments&&... arguments) : Base(std::forward<Arguments>(arguments)...) {}

  /// One sample with a finite input. It must not use y unless is_measured_.
  virtual void step(const Vector& held_input, const Vector& y) = 0;
  /// Whether every published number is finite.
  virtual bool is_sound() const {
    for (const Signal& signal : this->signals()) {
      for (const double value : signal.values) {
        if (!std::isfinite(value)) return false;
      }
    }
    return this->state().allFinite() && this->disturbance().allFinite();
  }

  bool is_measured_ = false;

 private:
  Eigen::VectorXd last_input_ = Eigen::VectorXd::Zero(1);
  Eigen::Matrix<double, Eigen::Dynamic, 1, 0, 8, 1> start_;  // without a heap
};

}  // namespace breakwater
