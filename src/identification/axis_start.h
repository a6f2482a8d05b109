// First values of the fit of an axis, by linear least squares.
#pragma once

#include <vector>

#include <breakwater/identification/axis_fit.h>

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

}  // namespace breakwater
