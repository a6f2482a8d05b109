// First-order low-pass filter of a sensor.
#pragma once

#include <breakwater/math/functions.h>
#include <breakwater/math/refuse_unless.h>

namespace breakwater {

/// 1/(τ s + 1), discretised exactly for an input held over each step. τ = 0: output = input.
class LowPass {
 public:
  /// Both in seconds. Throws std::invalid_argument if τ is negative or the step is not positive.
  LowPass(double time_constant_s, double step_s)
      : gain_(time_constant_s == 0.0 ? 1.0 : -math::expm1(-step_s / time_constant_s)) {
    refuse_unless(time_constant_s >= 0.0 && step_s > 0.0,
                  "low-pass: needs a time constant >= 0 and a step > 0");
  }

  void reset(double value) { value_ = value; }
  double update(double input) { return value_ += gain_ * (input - value_); }
  double value() const { return value_; }

 private:
  double gain_;
  double value_ = 0.0;
};

}  // namespace breakwater
