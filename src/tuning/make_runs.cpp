#include <breakwater/tuning/make_runs.h>

#include <algorithm>
#include <string>
#include <utility>

#include <breakwater/study/isolated.h>
#include <breakwater/tuning/candidates.h>
#include <breakwater/tuning/tune_command.h>

namespace breakwater {

std::size_t make_runs(const TuningPlan& plan, const StudyFolder& folder,
                      std::vector<std::size_t> runs, bool isolate, Shard& shard,
                      const ExecutorOptions& options) {
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

}  // namespace breakwater
