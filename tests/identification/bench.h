// Records of simulated benches, and the results of their identification.
#pragma once

#include <breakwater/identification/identified_axis.h>
#include "support.h"

namespace breakwater::testing {

inline double normal(Random& random) {
  return std::sqrt(-2.0 * std::log(random.uniform(1e-300, 1.0))) *
         std::cos(random.uniform(0.0, 2.0 * std::numbers::pi));
}

/// A record's times, which jitter, and its inputs: a mean, and sines of one amplitude.
inline RecordedAxis sines(Random& random, double rate_Hz, double duration_s, double mean,
                          double amplitude, std::span<const double> frequencies_Hz) {
  RecordedAxis record;
  const auto rows = static_cast<std::size_t>(duration_s * rate_Hz);
  std::vector<double> phases;
  for (std::size_t i = 0; i < frequencies_Hz.size(); ++i) {
    phases.push_back(random.uniform(0.0, 2.0 * std::numbers::pi));
  }
  for (std::size_t k = 0; k < rows; ++k) {
    const double t = (static_cast<double>(k) + random.uniform(-0.05, 0.05)) * (1.0 / rate_Hz);
    record.times_s.push_back(t);
    double u = mean;
    for (std::size_t i = 0; i < phases.size(); ++i) {
      u += amplitude * std::sin(2.0 * std::numbers::pi * frequencies_Hz[i] * t + phases[i]);
    }
    record.inputs.push_back(u);
  }
  return record;
}

inline const ParameterEstimate& of(const Identification& identification, AxisParameter parameter) {
  for (const ParameterEstimate& estimate : identification.parameters) {
    if (estimate.parameter == parameter) return estimate;
  }
  throw std::logic_error("no such parameter");
}

}  // namespace breakwater::testing
