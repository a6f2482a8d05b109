#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <numbers>

#include <breakwater/analysis/loop_analysis.h>

namespace breakwater {
namespace {

constexpr double kDegrees = 180.0 / std::numbers::pi;

LoopMargins margins_of(const std::function<std::complex<double>(std::complex<double>)>& L) {
  std::vector<double> omega;
  std::vector<std::complex<double>> gain;
  for (int i = 0; i <= 4000; ++i) {
    omega.push_back(std::pow(10.0, -3.0 + 6.0 * i / 4000.0));
    gain.push_back(L({0.0, omega.back()}));
  }
  return loop_margins(omega, gain);
}

TEST(LoopMargins, AreRightForAnIntegratorAndALag) {
  // L = K/(s(s + 1)): ω_c⁴ + ω_c² = K², phase margin 90° − atan ω_c, no gain margin.
  const double K = 3.0;
  const LoopMargins margins = margins_of([&](auto s) { return K / (s * (s + 1.0)); });
  const double crossover = std::sqrt(0.5 * (std::sqrt(1.0 + 4.0 * K * K) - 1.0));
  EXPECT_NEAR(margins.crossover_rad_s, crossover, 1e-4 * crossover);
  EXPECT_NEAR(margins.phase_margin_rad * kDegrees, 90.0 - std::atan(crossover) * kDegrees, 1e-3);
  EXPECT_NEAR(margins.delay_margin_s, margins.phase_margin_rad / crossover, 1e-5);
  EXPECT_TRUE(std::isnan(margins.gain_margin));
  EXPECT_TRUE(std::isnan(margins.gain_reduction_margin));
  // M_t = 1/(2ζ√(1 − ζ²)) of s² + s + K, ζ = 1/(2√K).
  const double damping = 0.5 / std::sqrt(K);
  EXPECT_NEAR(margins.complementary_peak, 0.5 / (damping * std::sqrt(1.0 - damping * damping)),
              1e-4);
}

TEST(LoopMargins, AreRightForThreeLags) {
  // K/(s + 1)³ crosses −180° at √3, where it is K/8.
  const LoopMargins margins = margins_of([](auto s) { return 2.0 / std::pow(s + 1.0, 3); });
  EXPECT_NEAR(margins.gain_margin, 4.0, 1e-3);
  EXPECT_TRUE(std::isnan(margins.gain_reduction_margin));
}

TEST(LoopMargins, AreRightForAConditionallyStableLoop) {
  // K (s + 1)²/s³, closed s³ + K s² + 2 K s + K: stable for K > 1/2 (Routh).
  const LoopMargins margins =
      margins_of([](auto s) { return 2.0 * std::pow(s + 1.0, 2) / std::pow(s, 3); });
  EXPECT_NEAR(margins.gain_reduction_margin, 0.25, 1e-4);
  EXPECT_TRUE(std::isnan(margins.gain_margin));
}

TEST(LoopMargins, AreRightForADelay) {
  // e^{−s}/s: the phase margin is 90° − 1 rad, the delay margin 0.571 s; −180° at π/2.
  const LoopMargins margins = margins_of([](auto s) { return std::exp(-s) / s; });
  EXPECT_NEAR(margins.delay_margin_s, 0.5 * std::numbers::pi - 1.0, 1e-4);
  EXPECT_NEAR(margins.gain_margin, 0.5 * std::numbers::pi, 1e-3);
}

TEST(LoopMargins, NeedTwoFrequencies) {
  EXPECT_THROW(loop_margins({1.0}, {{1.0, 0.0}}), std::invalid_argument);
  EXPECT_THROW(loop_margins({1.0, 2.0}, {{1.0, 0.0}}), std::invalid_argument);
}

}  // namespace
}  // namespace breakwater
