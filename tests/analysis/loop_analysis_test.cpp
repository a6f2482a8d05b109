// The loop of an axis: its frequency response and its margins.

#include <breakwater/analysis/analysis_outputs.h>
#include <breakwater/analysis/loop_analysis.h>
#include "support.h"

namespace breakwater::loop_analysis_test {

// A delay of 1 s lowers the phase by ω rad. The marks are more than half a turn apart.
TEST(BodeChart, MarksAreOnTheTurnOfTheLine) {
  LoopAnalysis loop;
  const auto add = [](LoopCurve& curve, double omega) {
    LoopPoint& point = curve.points.emplace_back();
    point.omega_rad_s = omega;
    point.sensitivity = point.complementary = std::polar(1.0, -omega);
  };
  for (double omega = 0.1; omega < 20.0; omega += 0.1) add(loop.designed, omega);
  for (const double omega : {0.5, 4.0, 15.0}) add(loop.measured, omega);
  const BodeResponse response{"it", &LoopPoint::sensitivity, false, "", "", ""};
  const PageData marks = bode_charts(response, {loop}, {0}).at(1).at("data").at("series").at(1);
  double phase_deg = marks.at("from");
  for (std::size_t k = 0; k < loop.measured.points.size(); ++k) {
    phase_deg += marks.at("v").at(k).get<double>() * marks.at("step").get<double>();
    const double omega = loop.measured.points[k].omega_rad_s;
    EXPECT_NEAR(phase_deg, -omega * 180.0 / std::numbers::pi, 0.1);
  }
}

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

TEST(LoopMargins, NeedTwoFrequencies) {
  EXPECT_THROW(loop_margins({1.0}, {{1.0, 0.0}}), std::invalid_argument);
  EXPECT_THROW(loop_margins({1.0, 2.0}, {{1.0, 0.0}}), std::invalid_argument);
}

}  // namespace breakwater::loop_analysis_test
