// The loop of a run: step, record, report.
#pragma once

#include <cstdint>
#include <utility>
#include <vector>

#include <breakwater/experiment/scenario.h>
#include <breakwater/sim/engine_guard.h>
#include <breakwater/sim/simulation.h>

namespace breakwater {

/// Calls `step(k)` at each physics step k < `steps`, which steps the simulation. At each control
/// sample it calls `sample(time_s)` and, if `control.logs`, logs the signals as track "control".
/// Before that `values`, if it is not null, takes the values of the step and of the sample. Its
/// signals are logged too, and a complete run ends with its metrics. The caller adds any further
/// tracks. It reports progress and checks for a stop request at the start, after the first step and
/// at intervals. After the first step nothing allocates. A step that throws RunFailure ends the
/// run.
template <typename Step, typename Sample>
Recording record_run(const Simulation& simulation, const PhysicsSettings& physics,
                     std::int64_t steps, std::vector<Signal> signals, const RunControl& control,
                     Step&& step, Sample&& sample, MetricValues* values = nullptr) {
  constexpr std::int64_t kStepsBetweenReports = 10000;
  const std::int64_t per_sample = physics.steps_per_sample();
  const std::int64_t rows = control.logs ? (steps + per_sample - 1) / per_sample : 0;
  if (values != nullptr) {
    signals.insert(signals.end(), values->signals().begin(), values->signals().end());
  }
  Track log("control", std::move(signals), static_cast<std::size_t>(rows), control.stream);
  Recording recording;
  try {
    for (std::int64_t k = 0; k < steps; ++k) {
      if (k % kStepsBetweenReports == 0 || k == 1) {
        if (control.stop != nullptr && *control.stop) throw Interrupted();
        if (control.progress) {
          control.progress(static_cast<double>(k) / static_cast<double>(steps));
        }
      }
      step(k);
      if (values != nullptr) values->at_step(simulation.time_s());
      if (!simulation.sampled()) continue;
      sample(simulation.time_s());
      if (values != nullptr) values->at_sample(simulation.time_s());
      if (control.logs) log.append(simulation.time_s());
    }
  } catch (const RunFailure& failure) {
    recording.failure = Failure{failure.time_s(), failure.what()};
  }
  if (values != nullptr && !recording.failure) {
    recording.metrics = values->metrics();
    recording.absent = values->absent();
  }
  recording.simulated_s = simulation.time_of(simulation.steps());
  recording.state_hash = simulation.state_hash();
  recording.dropped_samples = simulation.sensing().dropped();
  recording.tracks.push_back(std::move(log));
  return recording;
}

}  // namespace breakwater
