// Points in separate processes.
#pragma once

#include <cstddef>
#include <vector>

#include <breakwater/study/executor.h>
#include <breakwater/study/study_folder.h>

namespace breakwater {

/// Like run_points(), but in child processes. `points` ascend. Each child is a task for some of
/// them (`COMMAND DIR --points …` and PointSource::task_words()). It writes results to its own
/// shard, which shows its progress. A child may leave out points that another process has done. If
/// a child crashes, its current point gets the status crashed in `shard`. If something else kills a
/// child (for example a lack of memory), a message names the undone point. In both cases another
/// child continues behind this point. Throws std::invalid_argument if a child reports an error or
/// ends before its first point.
void run_isolated(const std::vector<std::size_t>& points, const PointSource& source,
                  const StudyFolder& folder, Shard& shard, const ExecutorOptions& options);

}  // namespace breakwater
