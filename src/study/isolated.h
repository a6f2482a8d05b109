// Points in processes of their own.
#pragma once

#include <cstddef>
#include <vector>

#include <breakwater/study/executor.h>
#include <breakwater/study/study_folder.h>

namespace breakwater {

/// As run_points(), but in child processes. Each is a task (`COMMAND DIR --points …`, and
/// PointSource::task_words()) of some of `points`, which ascend, and
/// keeps their results in a shard of its own, from which it is known how far it is. One that
/// crashes costs the point that it was at, which goes into `shard`; one that is killed from outside
/// (where memory is short, say) leaves its point undone, and says so. Another child goes on behind
/// that point. A child may leave out points that another process has done meanwhile. An error that
/// a child tells ends the study, and so does a child that ends before it begins a point:
/// std::invalid_argument.
void run_isolated(const std::vector<std::size_t>& points, const PointSource& source,
                  const StudyFolder& folder, Shard& shard, const ExecutorOptions& options);

}  // namespace breakwater
