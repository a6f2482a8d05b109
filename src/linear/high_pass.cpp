#include <breakwater/linear/high_pass.h>

#include <numbers>

#include <breakwater/math/functions.h>
#include <breakwater/math/refuse_unless.h>

namespace breakwater {

HighPass::HighPass(double cutoff_Hz, double period_s) {
  refuse_unless(period_s > 0.0 && cutoff_Hz > 0.0 && cutoff_Hz < 0.5 / period_s,
                "high-pass: the cut-off must lie between 0 and half the sampling frequency");
  const double w = math::tan(std::numbers::pi * cutoff_Hz * period_s);
  const double norm = 1.0 + std::numbers::sqrt2 * w + w * w;
  gain_ = 1.0 / norm;
  feedback1_ = 2.0 * (w * w - 1.0) / norm;
  feedback2_ = (1.0 - std::numbers::sqrt2 * w + w * w) / norm;
}

double HighPass::update(double input) {
  const double output = gain_ * input + memory1_;
  memory1_ = -2.0 * gain_ * input - feedback1_ * output + memory2_;
  memory2_ = gain_ * input - feedback2_ * output;
  return output;
}

}  // namespace breakwater
