#include <breakwater/world/disturbance.h>

#include <algorithm>
#include <cstdint>

#include <breakwater/math/functions.h>

namespace breakwater {
namespace {

// A sine and its derivative.
double sine(double amplitude, double frequency_rad_s, double elapsed_s) {
  return amplitude * math::sin(frequency_rad_s * elapsed_s);
}
double sine_rate(double amplitude, double frequency_rad_s, double elapsed_s) {
  return amplitude * frequency_rad_s * math::cos(frequency_rad_s * elapsed_s);
}

// A chirp's phase and its rate.
struct Phase {
  double value;
  double rate;
};
Phase chirp_phase(const Disturbance& chirp, double elapsed_s) {
  const double swept_s = std::min(elapsed_s, chirp.sweep_s);
  const double change = (chirp.end_frequency_rad_s - chirp.frequency_rad_s) * swept_s;
  const double rate = chirp.frequency_rad_s + change / chirp.sweep_s;
  const double swept = chirp.frequency_rad_s * swept_s + 0.5 * change * swept_s / chirp.sweep_s;
  return {swept + rate * (elapsed_s - swept_s), rate};
}

}  // namespace

double Disturbance::value(double time_s) const {
  return offset + shape(time_s);
}

double Disturbance::shape(double time_s) const {
  const double elapsed_s = time_s - start_s;
  if (elapsed_s < 0.0 || time_s >= end_s) return 0.0;
  switch (kind) {
    case DisturbanceKind::none:
      return 0.0;
    case DisturbanceKind::step:
      return amplitude;
    case DisturbanceKind::ramp:
      return amplitude * elapsed_s;
    case DisturbanceKind::sine:
      return sine(amplitude, frequency_rad_s, elapsed_s);
    case DisturbanceKind::two_sines:
      return sine(amplitude, frequency_rad_s, elapsed_s) +
             sine(second_amplitude, second_frequency_rad_s, elapsed_s);
    case DisturbanceKind::chirp:
      return amplitude * math::sin(chirp_phase(*this, elapsed_s).value);
    case DisturbanceKind::noise: {
      // The sample counts as begun a little before its time, which may be rounded.
      constexpr double kRounding = 1e-9;
      constexpr double kMostSamples = 1e18;
      const double sample = std::min(elapsed_s / hold_s + kRounding, kMostSamples);
      return amplitude * (*noise)(static_cast<std::uint64_t>(sample));
    }
    case DisturbanceKind::csv:
      return amplitude * table.at(elapsed_s).value;
  }
  return 0.0;
}

double Disturbance::rate(double time_s) const {
  const double elapsed_s = time_s - start_s;
  if (elapsed_s < 0.0 || time_s >= end_s) return 0.0;
  switch (kind) {
    case DisturbanceKind::none:
    case DisturbanceKind::step:
    case DisturbanceKind::noise:
      return 0.0;
    case DisturbanceKind::csv:
      return amplitude * table.at(elapsed_s).rate;
    case DisturbanceKind::ramp:
      return amplitude;
    case DisturbanceKind::sine:
      return sine_rate(amplitude, frequency_rad_s, elapsed_s);
    case DisturbanceKind::two_sines:
      return sine_rate(amplitude, frequency_rad_s, elapsed_s) +
             sine_rate(second_amplitude, second_frequency_rad_s, elapsed_s);
    case DisturbanceKind::chirp: {
      const Phase phase = chirp_phase(*this, elapsed_s);
      return amplitude * phase.rate * math::cos(phase.value);
    }
  }
  return 0.0;
}

}  // namespace breakwater
