// Quantisation-aware variable forgetting factor (QVFF): the VFAKFD with a dead zone for the
// sensor's error.
#pragma once

#include <breakwater/observers/sensor_error.h>
#include <breakwater/observers/vfakfd.h>

namespace breakwater {

/// The λ(k) of the VFAKFD reacts to ê², from a disturbance or from the encoder. With α = 1/(b_reso
/// T_s) it reacts from ê² ≈ 0.2 α on: 3 to 144 counts, depending on resolution and period. QVFF
/// first subtracts from ê the sensor's own error, and then reacts to small errors:
///     |ê| → max(0, |ê| − Δ − 4.5 σ),   α = max((Δ/2)², (1.5 σ)², α_floor),   P0 = 1e-6·I.
/// Δ covers the rounding ±Δ/2 of the measurement and that of the prediction. Seven samples in a
/// million exceed 4.5 σ. Truncation has an error of up to Δ, always towards 0. The errors of two
/// measurements on one side of 0 then also differ by less than Δ.
/// P0 is a number without a unit, against R = 1: the estimate depends on the unit of the position.
/// Derivation and limits: docs/explanation/methods/disturbance-kalman-filters.md.
///
/// Throws as check(SensorError) does.
VfakfdDesign qvff_design(const SensorError& error);

/// The Kalman design of a VFAKFD: Q = 0 and P0 = p0·I; R is not used.
KalmanDesign variable_forgetting_design(const ExtendedPlant& plant, double p0);

constexpr double kQvffInitialCovariance = 1e-6;

}  // namespace breakwater
