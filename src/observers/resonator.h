// A damped oscillation driven by white noise, sampled: the model of a wave's force.
#pragma once

#include <Eigen/Core>
#include <cmath>

#include <breakwater/math/functions.h>

namespace breakwater {

/// [f; h]⁺ = exp([0 ω; −ω −2 ζ ω] δ) [f; h]: f̈ + 2 ζ ω ḟ + ω² f = noise, h = ḟ/ω. `omega_rad_s` ω,
/// `damping` ζ in (0, 1), `period_s` δ.
inline Eigen::Matrix2d resonator_step(double omega_rad_s, double damping, double period_s) {
  const double damped = omega_rad_s * std::sqrt(1.0 - damping * damping);
  const double decay = math::exp(-damping * omega_rad_s * period_s);
  const auto [sine, cosine] = math::sincos(damped * period_s);
  const double c = decay * cosine;
  const double s = decay * sine * omega_rad_s / damped;
  return (Eigen::Matrix2d() << c + damping * s, s, -s, c - damping * s).finished();
}

/// What white noise on ḣ adds to h's variance at each sample so that f's stationary standard
/// deviation is σ: its rate is 4 ζ ω σ².
inline double resonator_noise(double omega_rad_s, double damping, double std, double period_s) {
  return 4.0 * damping * omega_rad_s * std * std * period_s;
}

}  // namespace breakwater
