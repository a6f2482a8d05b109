#include <breakwater/analysis/loop_margins.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <stdexcept>

namespace breakwater {
namespace {

constexpr double kPi = std::numbers::pi;

// Finds the zero of a straight line from a to b, as a share of its length, if there is one.
bool crosses(double a, double b, double& share) {
  if (!((a <= 0.0 && b > 0.0) || (a >= 0.0 && b < 0.0))) return false;
  share = a / (a - b);
  return true;
}

double between(double a, double b, double share) {
  return a + (b - a) * share;
}

void take_less(double& least, double value) {
  if (std::isnan(least) || value < least) least = value;
}

}  // namespace

LoopMargins loop_margins(const std::vector<double>& omega_rad_s,
                         const std::vector<std::complex<double>>& loop_gain) {
  if (omega_rad_s.size() < 2 || omega_rad_s.size() != loop_gain.size()) {
    throw std::invalid_argument("margins need a loop gain at two frequencies or more");
  }
  constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
  LoopMargins margins{kNone, kNone, kNone, kNone, kNone, kNone, 0.0, 0.0};
  double last_phase = 0.0;
  for (std::size_t i = 0; i < omega_rad_s.size(); ++i) {
    const std::complex<double> L = loop_gain[i];
    margins.sensitivity_peak = std::max(margins.sensitivity_peak, std::abs(1.0 / (1.0 + L)));
    margins.complementary_peak = std::max(margins.complementary_peak, std::abs(L / (1.0 + L)));
    // Unwraps the phase: nearest to the last one.
    double phase = std::arg(L);
    if (i > 0) phase += 2.0 * kPi * std::round((last_phase - phase) / (2.0 * kPi));
    if (i > 0) {
      const double gain_a = std::log(std::abs(loop_gain[i - 1])), gain_b = std::log(std::abs(L));
      const double omega_a = std::log(omega_rad_s[i - 1]), omega_b = std::log(omega_rad_s[i]);
      double share = 0.0;
      if (crosses(gain_a, gain_b, share)) {
        const double omega = std::exp(between(omega_a, omega_b, share));
        const double at = between(last_phase, phase, share);
        double above = std::fmod(at + kPi, 2.0 * kPi);  // from −π, in [0, 2π)
        if (above < 0.0) above += 2.0 * kPi;
        margins.crossover_rad_s = omega;
        take_less(margins.phase_margin_rad, std::min(above, 2.0 * kPi - above));
        take_less(margins.delay_margin_s, above / omega);
      }
      // All crossings of −π plus whole turns.
      const double turn =
          2.0 * kPi * std::round((between(last_phase, phase, 0.5) + kPi) / (2.0 * kPi));
      if (crosses(last_phase + kPi - turn, phase + kPi - turn, share)) {
        const double factor = std::exp(-between(gain_a, gain_b, share));
        if (factor > 1.0 && !(margins.gain_margin <= factor)) {
          margins.gain_margin = factor;
          margins.gain_margin_rad_s = std::exp(between(omega_a, omega_b, share));
        } else if (factor <= 1.0 && !(margins.gain_reduction_margin > factor)) {
          margins.gain_reduction_margin = factor;
        }
      }
    }
    last_phase = phase;
  }
  return margins;
}

}  // namespace breakwater
