#include <breakwater/observers/resonator.h>

#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>

#include <breakwater/math/functions.h>
#include <breakwater/math/refuse_unless.h>

namespace breakwater {
namespace {

constexpr int kParameters = 6;  // ln ω, ln ζ, ln σ of both resonators
constexpr int kFitSteps = 200;
constexpr double kLongestFitStep = 0.5;     // bound on the change of each logarithm
constexpr double kFitTolerance = 1e-10;     // relative change of the distance that ends the fit
constexpr double kLargestFitDamping = 1e8;  // bound on the damping of Fisher's scoring
constexpr double kLargestDampingRatio = 0.9;

using Parameters = Eigen::Matrix<double, kParameters, 1>;

Resonator resonator(const Parameters& p, int which) {
  const auto at = [&](int i) { return math::exp(p(3 * which + i)); };
  return {at(0), std::min(at(1), kLargestDampingRatio), at(2)};
}

// ∂G/∂ ln ω, ∂G/∂ ln ζ, ∂G/∂ ln σ.
Eigen::Vector3d slopes(const Resonator& r, double omega, double density) {
  const double apart = r.omega_rad_s * r.omega_rad_s - omega * omega;
  const double damped = 2.0 * r.damping * r.omega_rad_s * omega;
  const double all = apart * apart + damped * damped;
  const double by_place =
      (4.0 * r.omega_rad_s * r.omega_rad_s * apart + 2.0 * damped * damped) / all;
  return density * Eigen::Vector3d(3.0 - by_place, 1.0 - 2.0 * damped * damped / all, 2.0);
}

struct Scoring {
  double distance = 0.0;  // that of Itakura and Saito
  Parameters gradient = Parameters::Zero();
  Eigen::Matrix<double, kParameters, kParameters> information =
      Eigen::Matrix<double, kParameters, kParameters>::Zero();
};

Scoring score(const ForceSpectrum& s, const Parameters& p) {
  const Resonator pair[] = {resonator(p, 0), resonator(p, 1)};
  Scoring result;
  for (std::size_t i = 0; i < s.density.size(); ++i) {
    const double w = s.omega_rad_s[i];
    const double densities[] = {spectral_density(pair[0], w), spectral_density(pair[1], w)};
    const double model = densities[0] + densities[1] + s.noise[i];
    Parameters slope;
    slope << slopes(pair[0], w, densities[0]), slopes(pair[1], w, densities[1]);
    slope /= model;
    const double ratio = (s.density[i] + s.noise[i]) / model;
    result.distance += ratio - math::log(ratio) - 1.0;
    result.gradient += (ratio - 1.0) * slope;
    result.information += slope * slope.transpose();
  }
  return result;
}

// One resonator in each half of the band, with half of the width and half of the variance.
Parameters first_guess(const ForceSpectrum& s, double step) {
  double area = 0.0, moment = 0.0, second = 0.0;
  for (std::size_t i = 0; i < s.density.size(); ++i) {
    area += s.density[i];
    moment += s.density[i] * s.omega_rad_s[i];
  }
  const double mean = moment / area;
  for (std::size_t i = 0; i < s.density.size(); ++i) {
    second += s.density[i] * (s.omega_rad_s[i] - mean) * (s.omega_rad_s[i] - mean);
  }
  const double width = std::max(std::sqrt(second / area), 1e-3 * mean);
  const double std = std::sqrt(0.5 * area * step);
  Parameters p;
  int next = 0;
  for (const double side : {-0.5, 0.5}) {
    p(next++) = math::log(mean + side * width);
    p(next++) = math::log(std::min(0.5 * width / mean, 0.5));
    p(next++) = math::log(std);
  }
  return p;
}

void check(const ForceSpectrum& s) {
  const std::size_t n = s.omega_rad_s.size();
  bool fits = n >= kParameters && s.density.size() == n && s.noise.size() == n;
  double area = 0.0;
  for (std::size_t i = 0; fits && i < n; ++i) {
    fits = s.omega_rad_s[i] > (i > 0 ? s.omega_rad_s[i - 1] : 0.0) && s.density[i] >= 0.0 &&
           s.noise[i] > 0.0;
    area += s.density[i];
  }
  refuse_unless(
      fits && area > 0.0 && std::isfinite(area),
      "resonator fit: needs six or more increasing frequencies, a spectrum, and positive noise");
}

}  // namespace

double force_noise_density(const AxisNoise& axis, double omega_rad_s) {
  const auto square = [](double value) { return value * value; };
  const double omega2 = square(omega_rad_s);
  const double dt = axis.period_s;
  return (square(axis.mass_kg * omega2 * axis.position_std_m) * dt +
          square(axis.mass_kg * axis.velocity_std_m_s) / dt +
          square(axis.bias_std_N) / (dt * omega2)) /
         std::numbers::pi;
}

ResonatorPair fit_resonators(const ForceSpectrum& spectrum) {
  check(spectrum);
  const double step = spectrum.omega_rad_s[1] - spectrum.omega_rad_s[0];
  Parameters p = first_guess(spectrum, step);
  Scoring best = score(spectrum, p);
  double damping = 1e-3;
  for (int i = 0; i < kFitSteps && damping < kLargestFitDamping; ++i) {
    auto damped = best.information;
    damped.diagonal() += damping * best.information.diagonal();
    Parameters change = damped.ldlt().solve(best.gradient);
    const double longest = change.cwiseAbs().maxCoeff();
    if (longest > kLongestFitStep) change *= kLongestFitStep / longest;
    const Scoring there = score(spectrum, p + change);
    if (there.distance < best.distance) {
      const bool ends = best.distance - there.distance < kFitTolerance * best.distance;
      p += change;
      best = there;
      if (ends) break;
      damping *= 0.2;
    } else {
      damping *= 5.0;
    }
  }
  ResonatorPair pair = {resonator(p, 0), resonator(p, 1)};
  if (pair[1].omega_rad_s < pair[0].omega_rad_s) std::swap(pair[0], pair[1]);
  double variance = 0.0;
  for (const double density : spectrum.density) variance += density * step;
  const double scale =
      std::sqrt(variance / (pair[0].std * pair[0].std + pair[1].std * pair[1].std));
  for (Resonator& r : pair) r.std *= scale;
  return pair;
}

double fit_walk(const ForceSpectrum& spectrum, double period_s) {
  check(spectrum);
  if (!(period_s > 0.0)) throw std::invalid_argument("walk fit: the period must be positive");
  double area = 0.0, moment = 0.0;
  for (std::size_t i = 0; i < spectrum.density.size(); ++i) {
    area += spectrum.density[i];
    moment += spectrum.density[i] * spectrum.omega_rad_s[i] * spectrum.omega_rad_s[i];
  }
  // Starts from the random walk with the density variance/ω at the mean frequency ω of S.
  const double step = spectrum.omega_rad_s[1] - spectrum.omega_rad_s[0];
  double log_std =
      0.5 * math::log(moment * step * std::numbers::pi * period_s / std::sqrt(moment / area));
  for (int i = 0; i < kFitSteps; ++i) {
    const double intensity = math::exp(2.0 * log_std) / (std::numbers::pi * period_s);
    double gradient = 0.0, information = 0.0;
    for (std::size_t k = 0; k < spectrum.density.size(); ++k) {
      const double w = spectrum.omega_rad_s[k];
      const double walk = intensity / (w * w);
      const double model = walk + spectrum.noise[k];
      const double slope = 2.0 * walk / model;
      gradient += ((spectrum.density[k] + spectrum.noise[k]) / model - 1.0) * slope;
      information += slope * slope;
    }
    const double change = std::clamp(gradient / information, -kLongestFitStep, kLongestFitStep);
    log_std += change;
    if (std::abs(change) < kFitTolerance) break;
  }
  return math::exp(log_std);
}

}  // namespace breakwater
