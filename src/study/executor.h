// The engine of studies: runs points on many threads and keeps each result at once.
#pragma once

#include <atomic>
#include <cstddef>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include <breakwater/experiment/known_models.h>
#include <breakwater/experiment/runner.h>
#include <breakwater/study/shards.h>

namespace breakwater {

/// Where points come from. Called from several threads at once.
class PointSource {
 public:
  virtual ~PointSource() = default;

  /// The run of a point. Throws std::invalid_argument if there can be none: the point is refused.
  virtual PreparedRun prepare(std::size_t point) const = 0;
  /// What it is known by.
  virtual std::string key(std::size_t /*point*/, const PreparedRun& run,
                          const ModelHashes& models) const {
    return point_key(run.config_text, models);
  }
  /// The same where it cannot be prepared.
  virtual std::string unprepared_key(std::size_t point) const = 0;
  /// Where the run's folder, with its log, is to go; empty: nowhere. `failed` is known once it ran:
  /// a point that is to be kept only then is run again with its log.
  virtual std::filesystem::path folder(std::size_t point, const std::string& key,
                                       bool failed) const = 0;
  /// Whether the log is needed before the run, for its folder or for what is made of its signals.
  virtual bool logs(std::size_t point) const = 0;
  /// Words that tell a process of the points that it is to make, beside their numbers.
  virtual std::vector<std::string> task_words(const std::vector<std::size_t>& /*points*/) const {
    return {};
  }
  /// Adds numbers made of the signals to the result of a run, which may have failed.
  virtual void derive(std::size_t /*point*/, const Recording&, PointResult&) const {}
};

struct ExecutorOptions {
  std::size_t threads = 0;                  ///< 0: as many as there are cores
  const std::atomic<bool>* stop = nullptr;  ///< when it becomes true: no further point …
  /// A task of a scheduler, or of run_isolated(): runs under way go on to their end, and the shard
  /// says which point is begun.
  bool is_task = false;
  std::function<bool()> is_over = {};  ///< if true, no further point either
  std::function<void(std::size_t done_index, double fraction)> progress = {};  ///< of `points`
  std::function<void(const PointResult&)> on_result = {};  ///< what it throws ends the study
  KnownModels* models = nullptr;  ///< those that the points' keys were made of; null: own ones
};

/// Runs `points` of a source in that order, each result into the shard as soon as it is there. Each
/// model file is compiled once. A point that fails is a result. One of which a model file was
/// changed since it was first read gives none, and ends the study: std::invalid_argument, as
/// KnownModels says it. What the machine lacks (memory, open files) is no result and ends the study
/// too: OutOfMemory or OutputError; the process may open as many files as the system allows. Of
/// points with the same key one writes its folder. Returns how many were run: fewer than there are
/// if it was stopped. Throws std::invalid_argument or OutputError for what else ends a study.
std::size_t run_points(const std::vector<std::size_t>& points, const PointSource& source,
                       Shard& shard, const ExecutorOptions& options);

/// Lets this process open as many files as the system allows: each thread and each child process
/// needs some.
void allow_many_files();

/// One point, its folder (if the source wants one) included.
PointResult run_point(std::size_t point, const PointSource& source, const RunControl& control);

}  // namespace breakwater
