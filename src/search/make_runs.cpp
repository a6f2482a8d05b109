#include <breakwater/search/make_runs.h>

#include <fmt/format.h>

#include <algorithm>
#include <string>
#include <utility>

#include <breakwater/record/output_error.h>
#include <breakwater/search/candidates.h>
#include <breakwater/shell/process.h>
#include <breakwater/study/isolated.h>

namespace breakwater {
namespace {

std::size_t made(const TuningPlan& plan, const StudyFolder& folder, std::vector<std::size_t> runs,
                 bool isolate, Shard& shard, const ExecutorOptions& options) {
  if (!isolate) return run_points(runs, plan, shard, options);
  std::sort(runs.begin(), runs.end());
  const auto candidates = [&](const std::vector<std::size_t>& some) {
    std::vector<std::string> words;
    for (std::string& line : candidate_lines(plan, some)) {
      words.insert(words.end(), {"--candidate", std::move(line)});
    }
    return words;
  };
  return run_isolated(runs, plan, {kTune, candidates}, folder, shard, options);
}

}  // namespace

bool make_runs(const TuningPlan& plan, const StudyFolder& folder, std::vector<std::size_t> runs,
               bool isolate, ExecutorOptions options) {
  const std::size_t all = runs.size();
  options.stop = &interrupted();
  Shard shard(folder.shards());
  const std::size_t left = all - made(plan, folder, std::move(runs), isolate, shard, options);
  shard.finish();
  if (left > 0 && !interrupted()) {
    throw OutputError(fmt::format("{}: {} left undone: the same command goes on",
                                  folder.path().string(),
                                  left == 1 ? "one run was" : fmt::format("{} runs were", left)));
  }
  return left == 0;
}

}  // namespace breakwater
