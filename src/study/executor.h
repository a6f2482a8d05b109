// The engine of studies: runs points on many threads and saves each result at once.
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
#include <breakwater/study/study_folder.h>

namespace breakwater {

/// A source of points. Several threads call it at the same time.
class PointSource {
 public:
  virtual ~PointSource() = default;

  /// The run of a point. Throws std::invalid_argument if the point has to be refused.
  virtual PreparedRun prepare(std::size_t point) const = 0;
  /// A hash of what the study asks for at this point; empty: not known yet. It is cheaper than the
  /// key, which needs the configuration, and is the key of a point that cannot be prepared.
  virtual std::string asked(std::size_t point) const = 0;
  /// The folder for the run and its log; empty: none. `failed` is known after the run. If only
  /// failed points are kept, such a point runs again with its log.
  virtual std::filesystem::path folder(std::size_t point, const std::string& key,
                                       bool failed) const = 0;
};

struct ExecutorOptions {
  std::size_t threads = 0;                  ///< 0: the number of cores
  const std::atomic<bool>* stop = nullptr;  ///< true: begin no further point
  /// A task of a scheduler or of run_isolated(): running points go on to their end, and the shard
  /// records which point has begun.
  bool is_task = false;
  std::function<bool()> is_over = {};  ///< true: begin no further point
  std::function<void(std::size_t done_index, double fraction)> progress =
      {};                                                  ///< index in `points`
  std::function<void(const PointResult&)> on_result = {};  ///< an exception ends the study
  KnownModels* models = nullptr;  ///< the models of the points' keys; null: own ones

  /// Whether no further point is to begin.
  bool has_to_stop() const { return (stop != nullptr && *stop) || (is_over && is_over()); }
};

/// Runs `points` of a source in this order. Each result goes into the shard at once. Each model
/// file is compiled once. Only one of the points with the same key writes its folder. The process
/// may open as many files as the system allows. A failed point is a result. A model file that
/// changed during the study ends it (std::invalid_argument). So does a lack of memory or open files
/// (OutOfMemory or OutputError). Returns the number of runs, which is smaller if the study was
/// stopped. Throws std::invalid_argument or OutputError.
std::size_t run_points(const std::vector<std::size_t>& points, const PointSource& source,
                       Shard& shard, const ExecutorOptions& options);

/// Runs one point and writes its folder if the source wants one.
PointResult run_point(std::size_t point, const PointSource& source, const RunControl& control);

/// Like run_points(), but in child processes. `points` ascend. Each child is a task for some of
/// them (`COMMAND DIR --points …`). It writes results to its own shard, which shows its progress. A
/// child may leave out points that another process has done. If a child crashes, its current point
/// gets the status crashed in `shard`. If something else kills a child (for example a lack of
/// memory), a message names the undone point. In both cases another child continues behind this
/// point. Throws std::invalid_argument if a child reports an error or ends before its first point.
void run_isolated(const std::vector<std::size_t>& points, const PointSource& source,
                  const StudyFolder& folder, Shard& shard, const ExecutorOptions& options);

}  // namespace breakwater
