// Quantisation-aware variable forgetting factor (QVFF): the VFAKFD, told what its sensor cannot
// see.
#pragma once

#include <breakwater/observers/sensor_error.h>
#include <breakwater/observers/vfakfd.h>

namespace breakwater {

/// The VFAKFD's λ(k) reacts to ê², whether it comes from a disturbance or from the encoder. Its α
/// = 1/(b_reso T_s) wakes it up at ê² ≈ 0.2 α, which is 3 to 144 counts, depending on resolution
/// and period. QVFF takes out of ê what the sensor's own error explains, and then reacts to little:
///     |ê| → max(0, |ê| − Δ − 4.5 σ),   α = max((Δ/2)², (1.5 σ)², α_floor),   P0 = 1e-6·I.
/// Δ is the ±Δ/2 by which a measurement is rounded and as much for the prediction, which knows no
/// better than a count where it is; 4.5 σ is passed by 7 samples in a million. An encoder that
/// truncates is off by up to Δ, but always towards 0: the errors of two measurements on one side of
/// 0 differ by less than Δ as well.
/// docs/explanation/methods/disturbance-kalman-filters.md has the derivation and where it loses.
///
/// Throws std::invalid_argument as check(SensorError) does.
VfakfdDesign qvff_design(const SensorError& error);

/// The VFAKFD's Kalman design: Q = 0 and P0 = p0·I; R is not used.
KalmanDesign variable_forgetting_design(const ExtendedPlant& plant, double p0);

constexpr double kQvffInitialCovariance = 1e-6;

}  // namespace breakwater
