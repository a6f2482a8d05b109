#include <breakwater/linear/high_pass.h>

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace breakwater {
namespace {

double gain_at(double frequency_Hz, double cutoff_Hz, double period_s) {
  HighPass filter(cutoff_Hz, period_s);
  double largest = 0.0;
  for (int k = 0; k < 20000; ++k) {
    const double y = filter.update(std::sin(2 * M_PI * frequency_Hz * k * period_s));
    if (k > 10000) largest = std::max(largest, std::abs(y));
  }
  return largest;
}

TEST(HighPass, HasButterworthsGain) {
  // |H| = 1/√(1 + (w_c/w)⁴), in the bilinear transform's warped frequencies w = tan(π f T).
  const double T = 1e-3, cutoff = 150.0;
  for (const double f : {10.1, 40.3, 150.0, 301.7}) {
    const double ratio = std::tan(M_PI * cutoff * T) / std::tan(M_PI * f * T);
    EXPECT_NEAR(gain_at(f, cutoff, T), 1.0 / std::sqrt(1.0 + std::pow(ratio, 4)), 2e-3) << f;
  }
}

TEST(HighPass, RemovesAConstant) {
  HighPass filter(150.0, 1e-3);
  double y = 0.0;
  for (int k = 0; k < 1000; ++k) y = filter.update(7.0);
  EXPECT_NEAR(y, 0.0, 1e-12);
}

TEST(HighPass, RefusesNonsense) {
  EXPECT_THROW(HighPass(500.0, 1e-3), std::invalid_argument);
  EXPECT_THROW(HighPass(0.0, 1e-3), std::invalid_argument);
  EXPECT_THROW(HighPass(10.0, 0.0), std::invalid_argument);
  EXPECT_THROW(HighPass(std::nan(""), 1e-3), std::invalid_argument);
}

}  // namespace
}  // namespace breakwater
