// Stability margins of a loop.
#pragma once

#include <complex>
#include <vector>

namespace breakwater {

/// Margins of a loop gain L(jω) with negative feedback. NaN: there is no such crossing.
struct LoopMargins {
  double crossover_rad_s;        ///< the last frequency at which |L| = 1
  double phase_margin_rad;       ///< the smallest distance of arg L from −π at |L| = 1
  double gain_margin;            ///< the smallest factor above 1 that makes it unstable
  double gain_margin_rad_s;      ///< where that is
  double gain_reduction_margin;  ///< the largest factor below 1 that makes it unstable
  double delay_margin_s;         ///< the smallest additional delay that makes it unstable
  double sensitivity_peak;  ///< M_s = max |1/(1 + L)|; 1/M_s is the smallest distance of L from −1
  double complementary_peak;  ///< M_t = max |L/(1 + L)|
};

/// `omega_rad_s` (increasing) and `loop_gain` have equal length. Crossings are interpolated, so log
/// |L| and arg L must be nearly straight over log ω between two points. Throws
/// std::invalid_argument if there are fewer than two.
///
/// Source: K. J. Åström, R. M. Murray, Feedback Systems, Princeton 2008, section 9.3.
LoopMargins loop_margins(const std::vector<double>& omega_rad_s,
                         const std::vector<std::complex<double>>& loop_gain);

}  // namespace breakwater
