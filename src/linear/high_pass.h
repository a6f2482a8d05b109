// Second-order Butterworth high-pass filter.
#pragma once

namespace breakwater {

/// s²/(s² + √2 ω_c s + ω_c²), sampled by the bilinear transform. The sampled filter keeps ω_c.
class HighPass {
 public:
  /// Throws std::invalid_argument unless the cut-off is between 0 and half the sampling frequency.
  HighPass(double cutoff_Hz, double period_s);

  double update(double input);

 private:
  double gain_;
  double feedback1_;
  double feedback2_;
  double memory1_ = 0.0;  // transposed direct form II
  double memory2_ = 0.0;
};

}  // namespace breakwater
