// First values of the fit of an axis, by linear least squares.
#pragma once

#include <algorithm>
#include <cstddef>
#include <vector>

#include <breakwater/identification/axis_fit.h>
#include <breakwater/identification/axis_model.h>
#include <breakwater/plants/motor_and_load.h>

namespace breakwater {

/// Candidates for the fit, from the equation of motion weighted with a window φ. The window and its
/// slope vanish at its ends, so the equation needs no derivative of the position:
///     J ∫φ̈ q − c ∫φ̇ q + F_C ∫φ sgn v + d₀ ∫φ = k ∫φ u(t − τ)
///
/// Each length of the window gives one candidate, with the delay of least residual, from
/// `least_delay_s` to `largest_delay_s`. No candidate has a Stribeck friction.
///
/// Source: M. Shinbrot, Trans. ASME 79 (1957) 547–552 (modulating functions).
std::vector<AxisValues> start_candidates(const AxisData& data, double least_delay_s,
                                         double largest_delay_s);

inline constexpr int kShortestWindow = 8;  ///< rows
inline constexpr int kWindowLengths = 7;   ///< each twice the one before
inline constexpr double kMostStuck = 0.2;  ///< share of a window without motion

/// Rows from one window to the next.
std::size_t hop_of(const AxisData& data, std::size_t rows);

/// Calls use(k, s, length_s, dt) for each row of a window, with s from 0 to 1 and the trapezoids'
/// widths dt.
template <typename Use>
void for_rows(const AxisStretch& stretch, std::size_t first, std::size_t rows, const Use& use) {
  const std::vector<double>& t = stretch.times_s;
  const std::size_t last = first + rows - 1;
  const double length = t[last] - t[first];
  for (std::size_t k = first; k <= last; ++k) {
    const double dt = 0.5 * (t[std::min(k + 1, last)] - t[std::max(k, first + 1) - 1]);
    use(k, (t[k] - t[first]) / length, length, dt);
  }
}

/// The sign of the velocity from `reach` rows on both sides; 0 if it moves by less than two counts.
double direction(const AxisStretch& stretch, std::size_t k, std::size_t reach, double quantum);

/// The input at each row of a stretch: the mean of those that act just before and just after.
std::vector<double> inputs_at_rows(const AxisStretch& stretch, double delay_s);

/// Candidates for the fit, from the transfer function of the measured position without backlash,
///     q⁗ + α₃ q‴ + α₂ q″ + α₁ q′ + f sgn v + d = β₂ u″ + β₁ u′ + β₀ u   (β₂ = 0 at the load),
/// weighted with windows as in start_candidates(). Then J_m + J_l = α₂/β₀, the resonance is at √α₂,
/// and at the motor J_m = 1/β₂. Other candidates share the whole inertia between both in fixed
/// ratios, or come from the fit of one inertia. None has a backlash.
///
/// Source: M. Shinbrot, Trans. ASME 79 (1957) 547–552 (modulating functions).
template <Side measured>
std::vector<AxisValues> two_inertia_candidates(const AxisData& data, double least_delay_s,
                                               double largest_delay_s);

}  // namespace breakwater
