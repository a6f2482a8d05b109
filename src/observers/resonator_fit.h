// Two resonators, or a walk, that have a given spectrum as nearly as they can.
#pragma once

#include <vector>

#include <breakwater/observers/resonator.h>

namespace breakwater {

/// A one-sided spectral density S of a force [N² s/rad] at equally spaced frequencies, and the
/// density N of whatever else an observer of it sees, as a force.
struct ForceSpectrum {
  std::vector<double> omega_rad_s;
  std::vector<double> density;
  std::vector<double> noise;
};

/// What a Kalman filter of an axis sees of a force besides it: the measurement's noise, the walk of
/// the velocity and that of a constant force, as densities of a force. With m the mass, σ_p, σ_v,
/// σ_b the deviations at each sample and δ its period,
///     N(ω) = (m² ω⁴ σ_p² δ + m² σ_v²/δ + σ_b²/(δ ω²))/π.
struct AxisNoise {
  double mass_kg = 1.0;
  double position_std_m = 0.1;
  double velocity_std_m_s = 1e-3;
  double bias_std_N = 1e-3;
  double period_s = 0.01;
};
double force_noise_density(const AxisNoise& axis, double omega_rad_s);

/// The pair whose spectrum G minimises Itakura and Saito's distance of what is seen,
///     Σ (S + N)/(G + N) − ln((S + N)/(G + N)) − 1,
/// which is Whittle's likelihood: of all pairs, a long record of S makes a filter with this one
/// likeliest. N decides how far down S counts. By Fisher's scoring, damped, over the logarithms of
/// ω, ζ and σ, from two halves of the band; the deviations are scaled together at the end so that
/// the pair has S's variance.
///
/// Source: P. Whittle, Arkiv för Matematik 2 (1953) 423–434.
///
/// Throws std::invalid_argument unless there are six or more frequencies, increasing from above 0,
/// S is not negative anywhere nor 0 everywhere, and N is positive.
ResonatorPair fit_resonators(const ForceSpectrum& spectrum);

/// The walk that comes nearest to a spectrum by the same distance: its standard deviation σ at each
/// sample, with G(ω) = σ²/(π δ ω²). Errors as fit_resonators(), and if δ is not positive.
double fit_walk(const ForceSpectrum& spectrum, double period_s);

}  // namespace breakwater
