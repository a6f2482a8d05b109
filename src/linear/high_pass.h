// Second-order Butterworth high-pass filter.
#pragma once

#include <numbers>

#include <breakwater/math/functions.h>
#include <breakwater/math/refuse_unless.h>

namespace breakwater {

/// s²/(s² + √2 ω_c s + ω_c²), sampled by the bilinear transform. The sampled filter keeps ω_c.
class HighPass {
 public:
  /// Throws std::invalid_argument unless the cut-off is between 0 and half the sampling frequency.
  HighPass(double cutoff_Hz, double period_s) {
    refuse_unless(period_s > 0.0 && cutoff_Hz > 0.0 && cutoff_Hz < 0.5 / period_s,
                  "high-pass: the cut-off must lie between 0 and half the sampling frequency");
    const double w = math::tan(std::numbers::pi * cutoff_Hz * period_s);
    const double norm = 1.0 + std::numbers::sqrt2 * w + w * w;
    gain_ = 1.0 / norm;
    feedback1_ = 2.0 * (w * w - 1.0) / norm;
    feedback2_ = (1.0 - std::numbers::sqrt2 * w + w * w) / norm;
  }

  double update(double input) {
    const double output = gain_ * input + memory1_;
    memory1_ = -2.0 * gain_ * input - feedback1_ * output + memory2_;
    memory2_ = gain_ * input - feedback2_ * output;
    return output;
  }

 private:
  double gain_;
  double feedback1_;
  double feedback2_;
  double memory1_ = 0.0;  // transposed direct form II
  double memory2_ = 0.0;
};

}  // namespace breakwater
