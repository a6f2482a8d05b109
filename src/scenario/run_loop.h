// The loop of a run: step, record, report.
#pragma once

#include <cstdint>

#include <breakwater/scenario/scenario.h>
#include <breakwater/sim/engine_guard.h>
#include <breakwater/sim/simulation.h>

namespace breakwater {

/// Calls `step(k)` for k = 0 … steps − 1; reports progress and obeys a request to stop at the
/// start, after the first step (from which on nothing allocates), and now and then. Returns the
/// failure if a step throws RunFailure.
template <typename Step>
std::optional<Failure> run_loop(std::int64_t steps, const RunControl& control, Step&& step) {
  constexpr std::int64_t kStepsBetweenReports = 10000;
  try {
    for (std::int64_t k = 0; k < steps; ++k) {
      if (k % kStepsBetweenReports == 0 || k == 1) {
        if (control.stop != nullptr && *control.stop) throw Interrupted();
        if (control.progress) {
          control.progress(static_cast<double>(k) / static_cast<double>(steps));
        }
      }
      step(k);
    }
  } catch (const RunFailure& failure) {
    return Failure{failure.time_s(), failure.what()};
  }
  return std::nullopt;
}

/// Fills in what every recording tells of its simulation.
inline void conclude(Recording& recording, const Simulation& simulation) {
  recording.simulated_s = simulation.time_of(simulation.steps());
  recording.state_hash = simulation.state_hash();
  recording.dropped_samples = simulation.sensing().dropped();
}

}  // namespace breakwater
