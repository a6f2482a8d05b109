#include <breakwater/study/executor.h>

#include <fmt/format.h>

#include <chrono>
#include <stdexcept>

#include <breakwater/scenario/all_cores.h>
#include <breakwater/signals/thread_time.h>
#include <breakwater/sim/model.h>

namespace breakwater {
namespace {

void write_folder(const PreparedRun& run, const ModelHashes& models, const Recording& recording,
                  double wall_s, const std::filesystem::path& target) {
  RunFolder folder(target);
  write_run(run, models, recording, wall_s, folder, false);
}

PointResult execute(std::size_t number, const PointSource& source, RunControl control,
                    KnownModels& known, Shard* shard) {
  const double begin_s = thread_time_s();
  const auto start = std::chrono::steady_clock::now();
  PointResult result;
  result.number = number;
  PreparedRun run;
  Recording recording;
  ModelHashes models;
  try {
    run = source.prepare(number);
    models = known.of(run.model_files);
    result.key = source.key(number, run, models);
    if (shard != nullptr) shard->add(models);
    control.logs = source.logs(number);
    recording = run.scenario->run(control);
  } catch (const std::invalid_argument& error) {
    result.status = PointStatus::refused;
    if (result.key.empty()) result.key = source.unprepared_key(number);
    result.reason = error.what();
    known.check_unchanged();  // it may be due to a file that somebody is writing
    return result;
  }
  known.check_unchanged(run.model_files);
  result.state_hash = fmt::format("{:016x}", recording.state_hash);
  if (recording.failure) {
    result.status = PointStatus::failed;
    result.reason =
        fmt::format("at {:.6g} s: {}", recording.failure->time_s, recording.failure->reason);
  }
  for (const Metric& metric : recording.metrics)
    result.metrics.emplace_back(metric.name, metric.value);
  source.derive(number, recording, result);
  const std::filesystem::path folder =
      source.folder(number, result.key, recording.failure.has_value());
  if (!folder.empty()) {
    if (!control.logs) {
      control.logs = true;
      recording = run.scenario->run(control);
      known.check_unchanged(run.model_files);
    }
    const double wall_s =
        std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    write_folder(run, models, recording, wall_s, folder);
  }
  result.cost_s = thread_time_s() - begin_s;
  return result;
}

}  // namespace

PointResult run_point(std::size_t point, const PointSource& source, const RunControl& control) {
  KnownModels known;
  return execute(point, source, control, known, nullptr);
}

std::size_t run_points(const std::vector<std::size_t>& points, const PointSource& source,
                       Shard& shard, const ExecutorOptions& options) {
  const SharedModels shared;
  KnownModels own;
  KnownModels& known = options.models != nullptr ? *options.models : own;
  std::atomic<std::size_t> finished = 0;
  const auto is_stopped = [&] {
    return (options.stop != nullptr && *options.stop) || (options.is_over && options.is_over());
  };
  try {
    on_all_cores(
        points.size(),
        [&](std::size_t i) {
          if (is_stopped()) throw Interrupted();
          RunControl control;
          if (options.progress) {
            control.progress = [&, i](double fraction) { options.progress(i, fraction); };
          }
          if (!options.finishes_runs) control.stop = options.stop;
          if (options.on_begin) options.on_begin(points[i]);
          const PointResult result = execute(points[i], source, control, known, &shard);
          shard.add(result);
          ++finished;
          if (options.progress) options.progress(i, 1.0);
          if (options.on_result) options.on_result(result);
        },
        options.threads);
  } catch (const Interrupted&) {
  }
  return finished;
}

}  // namespace breakwater
