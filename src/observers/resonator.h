// A damped oscillator driven by white noise, sampled: the model of a wave force. Fit of two of
// them, or a random walk, to a given spectrum.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cmath>
#include <numbers>
#include <vector>

#include <breakwater/math/functions.h>

namespace breakwater {

/// The matrix exp([0 ω; −ω −2 ζ ω] δ) that predicts [f; h], h = ḟ/ω, by one sample.
/// The oscillator is f̈ + 2 ζ ω ḟ + ω² f = noise with ζ = `damping` in (0, 1), δ = `period_s`.
inline Eigen::Matrix2d resonator_step(double omega_rad_s, double damping, double period_s) {
  const double damped = omega_rad_s * std::sqrt(1.0 - damping * damping);
  const double decay = math::exp(-damping * omega_rad_s * period_s);
  const auto [sine, cosine] = math::sincos(damped * period_s);
  const double c = decay * cosine;
  const double s = decay * sine * omega_rad_s / damped;
  return (Eigen::Matrix2d() << c + damping * s, s, -s, c - damping * s).finished();
}

/// f̈ + 2 ζ ω ḟ + ω² f = white noise. f has a stationary standard deviation σ.
struct Resonator {
  double omega_rad_s = 1.0;
  double damping = 0.1;  ///< ζ, in (0, 1)
  double std = 1.0;      ///< σ, of f

  bool is_sound() const { return omega_rad_s > 0.0 && damping > 0.0 && damping < 1.0 && std > 0.0; }
};
/// Two resonators with independent noises; the slower one first. Their sum is the force.
using ResonatorPair = std::array<Resonator, 2>;

/// One-sided spectral density of f [f²s/rad], ∫₀^∞ G dω = σ²:
///     G(ω) = (4/π) ζ ω₀³ σ²/((ω₀² − ω²)² + (2 ζ ω₀ ω)²).
inline double spectral_density(const Resonator& resonator, double omega_rad_s) {
  const double place = resonator.omega_rad_s;
  const double apart = place * place - omega_rad_s * omega_rad_s;
  const double damped = 2.0 * resonator.damping * place * omega_rad_s;
  return 4.0 / std::numbers::pi * resonator.damping * place * place * place * resonator.std *
         resonator.std / (apart * apart + damped * damped);
}

/// Process noise of h in one sample. The noise on ḣ has the rate 4 ζ ω σ², which gives f the
/// stationary standard deviation σ.
inline double resonator_noise(double omega_rad_s, double damping, double std, double period_s) {
  return 4.0 * damping * omega_rad_s * std * std * period_s;
}

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
