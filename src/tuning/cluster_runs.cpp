#include <breakwater/tuning/cluster_runs.h>

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <set>
#include <sstream>
#include <utility>

#include <breakwater/scenario/process.h>
#include <breakwater/scenario/table.h>
#include <breakwater/study/shards.h>
#include <breakwater/study/slurm_queue.h>
#include <breakwater/tuning/tune_command.h>

namespace breakwater {
namespace {

namespace fs = std::filesystem;

constexpr int kMostInVain = 3;  // jobs

// A line for each candidate of the runs: the number of its case, its own, and its keys' values as
// TOML, which has no bare tab or end of a line in them.
std::string candidates_text(const TuningPlan& plan, const std::vector<std::size_t>& runs) {
  std::set<std::pair<std::size_t, std::size_t>> candidates;
  for (const std::size_t number : runs) {
    const TuningRun run = plan.run(number);
    candidates.emplace(run.tuned, run.evaluation);
  }
  std::string text;
  for (const auto& [tuned, evaluation] : candidates) {
    text += fmt::format("{}\t{}\t{}\n", tuned, evaluation,
                        fmt::join(plan.values_of(tuned, evaluation), "\t"));
  }
  return text;
}

void read_candidates(TuningPlan& plan, const fs::path& file) {
  std::ifstream stream(file);
  if (!stream) throw std::invalid_argument(file.string() + ": cannot be read");
  for (std::string line; std::getline(stream, line);) {
    std::istringstream parts(line);
    std::size_t tuned = 0;
    std::size_t evaluation = 0;
    parts >> tuned >> evaluation;
    parts.ignore();
    std::vector<std::string> values;
    for (std::string value; std::getline(parts, value, '\t');) values.push_back(value);
    const Tuning& tuning = plan.tuning();
    if (tuned >= tuning.cases.size() || evaluation >= tuning.budget ||
        values.size() != tuning.cases[tuned].search.size()) {
      throw std::invalid_argument(fmt::format("{}: has no candidate in: {}", file.string(), line));
    }
    plan.begin(tuned, evaluation, std::move(values));
  }
}

// Of `runs`, those that no shard has.
std::vector<std::size_t> missing(const ShardIndex& index, std::vector<std::size_t> runs) {
  std::erase_if(runs, [&](std::size_t run) { return index.has(run); });
  return runs;
}

// Processor time of runs of one case: as long as those that are there, else as the first of them,
// which is run for it.
double estimated_s(const TuningPlan& plan, const StudyFolder& folder, const ShardIndex& index,
                   const std::vector<std::size_t>& runs) {
  const std::size_t tuned = plan.run(runs.front()).tuned;
  double cost_s = 0.0;
  std::size_t count = 0;
  for (std::size_t number = 0; number < index.points(); ++number) {
    if (!index.has(number) || plan.run(number).tuned != tuned) continue;
    cost_s += index.cost_s(number);
    ++count;
  }
  if (count == 0) {
    Shard shard(folder.shards());
    ExecutorOptions options;
    options.stop = &interrupted();
    options.on_result = [&](const PointResult& result) { cost_s = result.cost_s; };
    count = run_points({runs.front()}, plan, shard, options);
    shard.finish();
    if (count == 0) throw Interrupted();
  }
  return cost_s / static_cast<double>(count) * static_cast<double>(runs.size());
}

// "ours, evaluations 17 to 32: 64 runs"
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
  for (int in_vain = 0;;) {
    wait_for_queue(folder, plan.size());
    if (interrupted()) throw Interrupted();
    const ShardIndex index(folder.shards(), plan.size());
    const std::size_t before = left.size();
    left = missing(index, runs);
    if (left.empty()) return;
    if (left.size() < before) in_vain = 0;
    if (in_vain++ == kMostInVain) {
      throw RunsMissing(fmt::format("{} jobs in a row have brought nothing of {}", kMostInVain,
                                    text_of(plan, left)));
    }
    const SlurmStudy study = {kTune, folder, plan.tuning().slurm, candidates_text(plan, left)};
    const SubmittedJob job = submit(study, left, cluster.request,
                                    [&] { return estimated_s(plan, folder, index, left); });
    if (cluster.quiet) continue;
    fmt::print("{} in {}: job {}\n", text_of(plan, left), number_of(job.tasks, "task"), job.number);
    std::fflush(stdout);  // it may be a file that somebody watches
  }
}

bool run_task(TuningPlan& plan, const StudyFolder& folder, const std::string& points,
              std::size_t jobs) {
  read_candidates(plan, submission_of_task(points) / "candidates");
  const ShardIndex index(folder.shards(), plan.size());
  const std::vector<std::size_t> runs = missing(index, points_of_task(points, plan.size()));
  for (const std::size_t number : runs) {
    const TuningRun run = plan.run(number);
    if (plan.has(run.tuned, run.evaluation)) continue;
    throw std::invalid_argument(
        fmt::format("--points: {}: the candidate of run {} is not beside it", points, number));
  }
  Shard shard(folder.shards());
  ExecutorOptions options;
  options.threads = jobs > 0 ? jobs : task_threads();
  options.finishes_runs = true;
  options.stop = &interrupted();
  const std::size_t ran = run_points(runs, plan, shard, options);
  shard.finish();
  return ran == runs.size();
}

}  // namespace breakwater
