// First values of the fit of two inertias, by linear least squares.
#pragma once

#include <vector>

#include <breakwater/identification/axis_model.h>
#include <breakwater/plants/motor_and_load.h>

namespace breakwater {

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
