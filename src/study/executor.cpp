#include <breakwater/study/executor.h>

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include <cerrno>
#include <chrono>
#include <cstring>
#include <map>
#include <mutex>
#include <set>
#include <stdexcept>

#include <breakwater/scenario/all_cores.h>
#include <breakwater/signals/thread_time.h>
#include <breakwater/sim/engine_guard.h>
#include <breakwater/sim/model.h>

namespace breakwater {
namespace {

// What the points of a call share.
struct Common {
  const PointSource& source;
  KnownModels& models;
  Shard* shard = nullptr;
  std::function<void(std::size_t, const std::string&)> on_key = {};
  std::mutex mutex = {};
  std::set<std::filesystem::path> folders = {};           // that were begun
  std::map<std::filesystem::path, LeftBeside> left = {};  // in the folders that these are in

  // Points with the same key are the same run: one of them writes its folder.
  bool begin(const std::filesystem::path& folder) {
    const std::lock_guard lock(mutex);
    return folders.insert(folder).second;
  }
  const LeftBeside& left_beside(const std::filesystem::path& folder) {
    const std::lock_guard lock(mutex);
    const std::filesystem::path parent = folder.parent_path();
    return left.try_emplace(parent, parent).first->second;
  }
};

// What may be the machine's fault is no result. That no file can be opened any more shows.
void check_machine(std::size_t number, const std::string& reason) {
  const int descriptor = open("/dev/null", O_RDONLY | O_CLOEXEC);
  if (descriptor < 0) {
    throw OutputError(fmt::format("point {} is left undone: {}; no file can be opened ({})", number,
                                  reason, std::strerror(errno)));
  }
  close(descriptor);
}

PointResult execute(std::size_t number, RunControl control, Common& common) {
  const PointSource& source = common.source;
  KnownModels& known = common.models;
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
    if (common.on_key) common.on_key(number, result.key);
    if (common.shard != nullptr) common.shard->add(models);
    control.logs = source.logs(number);
    recording = run.scenario->run(control);
  } catch (const OutOfMemory&) {
    throw;
  } catch (const std::invalid_argument& error) {
    check_machine(number, error.what());
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
  if (!folder.empty() && common.begin(folder)) {
    if (!control.logs) {
      control.logs = true;
      recording = run.scenario->run(control);
      known.check_unchanged(run.model_files);
    }
    const double wall_s =
        std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    RunFolder target(folder, &common.left_beside(folder));
    write_run(run, models, recording, wall_s, target, false);
  }
  result.cost_s = thread_time_s() - begin_s;
  return result;
}

}  // namespace

PointResult run_point(std::size_t point, const PointSource& source, const RunControl& control) {
  KnownModels known;
  const SharedModels shared([&](const std::string& file) { known.note(file); });
  Common common{source, known};
  return execute(point, control, common);
}

std::size_t run_points(const std::vector<std::size_t>& points, const PointSource& source,
                       Shard& shard, const ExecutorOptions& options) {
  KnownModels own;
  KnownModels& known = options.models != nullptr ? *options.models : own;
  const SharedModels shared([&](const std::string& file) { known.note(file); });
  Common common{source, known, &shard, options.on_key};
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
          const PointResult result = execute(points[i], control, common);
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
