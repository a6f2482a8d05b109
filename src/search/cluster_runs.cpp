#include <breakwater/search/cluster_runs.h>

#include <fmt/format.h>

#include <algorithm>
#include <optional>

#include <breakwater/cluster/slurm_queue.h>
#include <breakwater/shell/process.h>
#include <breakwater/shell/table.h>
#include <breakwater/study/shards.h>

namespace breakwater {
namespace {

constexpr int kMostWithoutResult = 3;  // jobs in a row without a result

// The runs that are in no shard.
std::vector<std::size_t> missing(const ShardIndex& index, std::vector<std::size_t> runs) {
  std::erase_if(runs, [&](std::size_t run) { return index.has(run); });
  return runs;
}

// Mean processor time of the finished runs of the same case; nothing if there are none. Crashed
// runs do not count.
std::optional<double> mean_s(const TuningPlan& plan, const ShardIndex& index,
                             const std::vector<std::size_t>& runs) {
  const std::size_t tuned = plan.run(runs.front()).tuned;
  double cost_s = 0.0;
  std::size_t count = 0;
  for (std::size_t number = 0; number < index.points(); ++number) {
    if (!index.has(number) || plan.run(number).tuned != tuned) continue;
    if (!(index.cost_s(number) > 0.0)) continue;
    cost_s += index.cost_s(number);
    ++count;
  }
  if (count == 0) return std::nullopt;
  return cost_s / static_cast<double>(count);
}

// A text such as "ours, evaluations 17 to 32: 64 runs".
std::string text_of(const TuningPlan& plan, const std::vector<std::size_t>& runs) {
  const TuningRun first = plan.run(runs.front());
  const std::size_t last = plan.run(runs.back()).evaluation;
  const std::string what = first.is_validation        ? "validation"
                           : first.evaluation == last ? fmt::format("evaluation {}", last + 1)
                                                      : fmt::format("evaluations {} to {}",
                                                                    first.evaluation + 1, last + 1);
  return fmt::format("{}, {}: {}", plan.tuning().cases[first.tuned].name, what,
                     number_of(runs.size(), "run"));
}

}  // namespace

void run_on_slurm(const TuningPlan& plan, const ClusterTuning& cluster,
                  const std::vector<std::size_t>& runs) {
  const StudyFolder& folder = cluster.folder;
  std::vector<std::size_t> left = runs;
  for (int without_result = 0;;) {
    wait_for_queue(folder, plan.size());
    if (interrupted()) throw Interrupted();
    const ShardIndex index =
        folder.index(plan.size(), [&](std::size_t run) { return plan.asked(run); });
    const std::optional<double> each_s = mean_s(plan, index, runs);
    const std::size_t before = left.size();
    left = missing(index, runs);
    if (left.empty()) return;
    if (cluster.request.tasks == 0 && !each_s) {
      cluster.make_here({left.front()});  // shows how long the others take
      continue;
    }
    if (left.size() < before) without_result = 0;
    if (without_result++ == kMostWithoutResult) {
      throw RunsMissing(fmt::format("{} jobs in a row have brought nothing of {}",
                                    kMostWithoutResult, text_of(plan, left)));
    }
    const SlurmStudy study = {folder, plan.tuning().slurm,
                              fmt::format("{}\n", fmt::join(plan.candidate_lines(left), "\n"))};
    const SubmittedJob job = submit(study, left, cluster.request, [&] {
      return each_s.value_or(0.0) * static_cast<double>(left.size());
    });
    if (cluster.quiet) continue;
    fmt::print("{} in {}: job {}\n", text_of(plan, left), number_of(job.tasks, "task"), job.number);
    std::fflush(stdout);  // standard output may be a file that somebody watches
  }
}

}  // namespace breakwater
