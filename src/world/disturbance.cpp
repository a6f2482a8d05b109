#include <breakwater/world/disturbance.h>

#include <algorithm>
#include <cstdint>

#include <breakwater/math/functions.h>

namespace breakwater {
namespace {

using Value = math::TableFunction::Value;

Value sine(double amplitude, double frequency_rad_s, double elapsed_s) {
  const auto [sine, cosine] = math::sincos(frequency_rad_s * elapsed_s);
  return {amplitude * sine, amplitude * frequency_rad_s * cosine};
}

Value chirp(const Disturbance& of, double elapsed_s) {
  const double swept_s = std::min(elapsed_s, of.sweep_s);
  const double change = (of.end_frequency_rad_s - of.frequency_rad_s) * swept_s;
  const double rate = of.frequency_rad_s + change / of.sweep_s;
  const double swept = of.frequency_rad_s * swept_s + 0.5 * change * swept_s / of.sweep_s;
  const auto [sine, cosine] = math::sincos(swept + rate * (elapsed_s - swept_s));
  return {of.amplitude * sine, of.amplitude * rate * cosine};
}

}  // namespace

Value Disturbance::shape(double time_s) const {
  const double elapsed_s = time_s - start_s;
  if (elapsed_s < 0.0 || time_s >= end_s) return {};
  switch (kind) {
    case DisturbanceKind::none:
      break;
    case DisturbanceKind::step:
      return {amplitude, 0.0};
    case DisturbanceKind::ramp:
      return {amplitude * elapsed_s, amplitude};
    case DisturbanceKind::sine:
      return sine(amplitude, frequency_rad_s, elapsed_s);
    case DisturbanceKind::two_sines: {
      const Value first = sine(amplitude, frequency_rad_s, elapsed_s);
      const Value second = sine(second_amplitude, second_frequency_rad_s, elapsed_s);
      return {first.value + second.value, first.rate + second.rate};
    }
    case DisturbanceKind::chirp:
      return chirp(*this, elapsed_s);
    case DisturbanceKind::noise: {
      // The sample counts as begun a little before its time, which may be rounded.
      constexpr double kRounding = 1e-9;
      constexpr double kMostSamples = 1e18;
      const double sample = std::min(elapsed_s / hold_s + kRounding, kMostSamples);
      return {amplitude * (*noise)(static_cast<std::uint64_t>(sample)), 0.0};
    }
    case DisturbanceKind::csv: {
      const Value row = table.at(elapsed_s);
      return {amplitude * row.value, amplitude * row.rate};
    }
  }
  return {};
}

}  // namespace breakwater
