// Fit of two resonators, or a random walk, to a given spectrum.
#pragma once

#include <vector>

#include <breakwater/observers/resonator.h>

namespace breakwater {

/// A one-sided spectral density S of a force [N² s/rad] at equally spaced frequencies, and the
/// density N of the observer's noise, as a force.
struct ForceSpectrum {
  std::vector<double> omega_rad_s;
  std::vector<double> density;
  std::vector<double> noise;
};

/// Noise of a Kalman filter of an axis, as the density N of a force. m is the mass, δ the period.
/// The standard deviations in each sample are σ_p (measurement noise), σ_v (process noise of the
/// velocity) and σ_b (process noise of a constant force).
///     N(ω) = (m² ω⁴ σ_p² δ + m² σ_v²/δ + σ_b²/(δ ω²))/π.
struct AxisNoise {
  double mass_kg = 1.0;
  double position_std_m = 0.1;
  double velocity_std_m_s = 1e-3;
  double bias_std_N = 1e-3;
  double period_s = 0.01;
};
double force_noise_density(const AxisNoise& axis, double omega_rad_s);

/// The pair whose spectrum G minimises the Itakura–Saito distance
///     Σ (S + N)/(G + N) − ln((S + N)/(G + N)) − 1,
/// which is Whittle's likelihood: a long record of S makes this pair the most likely one. N
/// determines how much small values of S count. The method is damped Fisher scoring over the
/// logarithms of ω, ζ and σ. It starts from one resonator in each half of the band. At the end both
/// deviations are scaled so that the pair has the variance of S.
///
/// Source: P. Whittle, Arkiv för Matematik 2 (1953) 423–434.
///
/// Throws std::invalid_argument unless there are six or more increasing frequencies above 0, S is
/// non-negative and not 0 everywhere, and N is positive.
ResonatorPair fit_resonators(const ForceSpectrum& spectrum);

/// The standard deviation σ, in each sample, of the random walk nearest to a spectrum by the same
/// distance; G(ω) = σ²/(π δ ω²). Throws as fit_resonators() does, and if δ is not positive.
double fit_walk(const ForceSpectrum& spectrum, double period_s);

}  // namespace breakwater
