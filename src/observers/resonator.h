// A damped oscillator driven by white noise, sampled: the model of a wave force.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cmath>
#include <numbers>

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

}  // namespace breakwater
