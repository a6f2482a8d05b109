#include <breakwater/program/commands.h>

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <complex>
#include <iterator>
#include <numbers>
#include <vector>

#include <breakwater/math/functions.h>
#include <breakwater/shell/child_program.h>
#include <breakwater/shell/process.h>
#include <breakwater/world/waves.h>

namespace breakwater {
namespace {

constexpr int kSamples = 7200;
constexpr double kStep_s = 0.5;  // the samples last an hour

// The energy of the samples in a band of frequencies, by the discrete Fourier transform.
double energy(const std::vector<double>& samples, double from_rad_s, double to_rad_s) {
  const double resolution = 2.0 * std::numbers::pi / (kSamples * kStep_s);
  const auto last = static_cast<int>(std::ceil(to_rad_s / resolution));
  double sum = 0.0;
  for (auto k = static_cast<int>(std::ceil(from_rad_s / resolution)); k < last; ++k) {
    const auto [sine, cosine] = math::sincos(-2.0 * std::numbers::pi * k / kSamples);
    const std::complex<double> turn(cosine, sine);
    std::complex<double> amplitude = 0.0;
    std::complex<double> phase = 1.0;
    for (const double sample : samples) {
      amplitude += sample * phase;
      phase *= turn;
    }
    sum += 2.0 * std::norm(amplitude / static_cast<double>(kSamples));
  }
  return sum;
}

// The largest divergence at points from the surface to the bottom, at most 20 m deep.
double largest_divergence(const Waves& waves, double depth_m) {
  constexpr double kShift_m = 1e-3;
  constexpr int kPoints = 50;
  const double reach_m = depth_m > 0.0 ? std::min(depth_m, 20.0) : 20.0;
  double largest = 0.0;
  for (int i = 0; i < kPoints; ++i) {
    const Eigen::Vector3d p(3.1 * i - 70.0, 40.0 - 1.7 * i, -reach_m * (0.05 + 0.9 * i / kPoints));
    double divergence = 0.0;
    for (int axis = 0; axis < 3; ++axis) {
      const Eigen::Vector3d e = kShift_m * Eigen::Vector3d::Unit(axis);
      divergence += (waves.at(2.3 * i, p + e).velocity - waves.at(2.3 * i, p - e).velocity)(axis);
    }
    largest = std::max(largest, std::abs(divergence / (2.0 * kShift_m)));
  }
  return largest;
}

// Root mean square of the vertical speed of the water in an hour [m/s].
double speed_of(const Waves& waves, double z_m) {
  double sum = 0.0;
  for (int i = 0; i < kSamples; ++i) {
    const double speed = waves.at(kStep_s * i, Eigen::Vector3d(0, 0, z_m)).velocity.z();
    sum += speed * speed;
  }
  return std::sqrt(sum / kSamples);
}

// The same of the spectrum, except for a factor that does not depend on z.
double speed_of(const SeaState& sea, double z_m) {
  constexpr int kIntervals = 2000;
  const SampledSpectrum acceleration = acceleration_spectrum(sea, -z_m, 0.5, 3.0, kIntervals);
  double sum = 0.0;
  for (std::size_t i = 0; i < acceleration.density.size(); ++i) {
    sum += acceleration.density[i] / (acceleration.omega_rad_s[i] * acceleration.omega_rad_s[i]);
  }
  return std::sqrt(sum);
}

// The vertical speed at some depths, as a part of that at z = 0.
std::string decay_text(const SeaState& sea, const Waves& waves) {
  const double peak = JonswapSpectrum(sea).peak_rad_s();
  const double k = wave_number(peak, sea.water_depth_m, sea.gravity_m_s2);
  const Waves peak_wave({{1.0, peak, k, 0.0}}, 0.0, sea.water_depth_m);
  std::string text =
      "\nvertical speed over that at z = 0\nz [m]    a wave of T_p    the spectrum    an hour\n";
  for (const double z : {-1.0, -5.0, -10.0, -20.0}) {
    if (sea.water_depth_m > 0.0 && -z >= sea.water_depth_m) break;
    text += fmt::format("{:5.1f}    {:13.4f}    {:12.4f}    {:7.4f}\n", z,
                        speed_of(peak_wave, z) / speed_of(peak_wave, 0.0),
                        speed_of(sea, z) / speed_of(sea, 0.0),
                        speed_of(waves, z) / speed_of(waves, 0.0));
  }
  return text;
}

// A report on one realisation of a sea. It compares H_s = 4 √m0 of the spectrum and of an hour, and
// the spectrum with the Fourier transform of that hour. It compares the decay with depth of a wave
// of the peak period, of the spectrum and of that hour. It prints the largest divergence of the
// velocity [1/s].
std::string waves_report(const SeaState& sea) {
  const JonswapSpectrum spectrum(sea);
  const Waves waves(sea, 0.0);
  const double peak = spectrum.peak_rad_s();
  std::vector<double> samples(kSamples);
  double variance = 0.0;
  for (int i = 0; i < kSamples; ++i) {
    samples[static_cast<std::size_t>(i)] = waves.elevation(kStep_s * i, 0.0, 0.0);
    variance += samples[static_cast<std::size_t>(i)] * samples[static_cast<std::size_t>(i)];
  }
  variance /= kSamples;

  std::string text = fmt::format(
      "H_s   asked for {:.4f} m, 4 sqrt(m0) of the spectrum {:.4f} m, "
      "of an hour {:.4f} m\n\n",
      sea.significant_height_m, 4.0 * std::sqrt(spectrum.variance(0.1 * peak, 50.0 * peak)),
      4.0 * std::sqrt(variance));
  text += "omega/omega_p    spectrum [m^2]   an hour [m^2]\n";
  constexpr double kBounds[] = {0.5, 0.8125, 0.9375, 1.0625, 1.1875, 1.5, 2.0, 3.0};
  for (std::size_t b = 0; b + 1 < std::size(kBounds); ++b) {
    const double from = kBounds[b] * peak;
    const double to = kBounds[b + 1] * peak;
    text += fmt::format("{:.4f}-{:.4f}    {:14.5f}  {:14.5f}\n", kBounds[b], kBounds[b + 1],
                        spectrum.variance(from, to), energy(samples, from, to));
  }

  if (sea.significant_height_m > 0.0) text += decay_text(sea, waves);
  return text + fmt::format("\ndivergence of the velocity: at most {:.1e} 1/s\n",
                            largest_divergence(waves, sea.water_depth_m));
}

}  // namespace

int waves_main(const Catalogue&, int argc, const char* const* argv) {
  const std::string program = own_program_name() + " waves";
  return guarded(program, [&] {
    CLI::App app("check a sea's spectrum and its water", program);
    SeaState sea;
    sea.significant_height_m = 2.0;
    app.add_option("--height", sea.significant_height_m, "H_s [m]")->capture_default_str();
    app.add_option("--period", sea.peak_period_s, "T_p [s]")->capture_default_str();
    app.add_option("--gamma", sea.gamma, "peak enhancement")->capture_default_str();
    app.add_option("--depth", sea.water_depth_m, "of the bottom; 0: deep water [m]")
        ->capture_default_str();
    app.add_option("--components", sea.components, "of the realisation")->capture_default_str();
    app.add_option("--seed", sea.seed, "of the realisation")->capture_default_str();
    if (const auto status = parse(app, argc, argv)) return *status;
    fmt::print("{}", waves_report(sea));
    return static_cast<int>(kSuccess);
  });
}

}  // namespace breakwater
