#include <breakwater/pages/paired_runs.h>

#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <set>
#include <stdexcept>

#include <breakwater/config/config.h>
#include <breakwater/experiment/differing_keys.h>
#include <breakwater/shell/did_you_mean.h>

namespace breakwater {
namespace {

std::vector<std::string> metrics_of_runs(const std::vector<SavedRun>& runs) {
  std::vector<std::string> names;
  for (const SavedRun& run : runs) {
    for (const Metric& metric : run.metrics()) {
      if (std::find(names.begin(), names.end(), metric.name) == names.end()) {
        names.push_back(metric.name);
      }
    }
  }
  return names;
}

void check_known(const char* option, const std::string& name,
                 const std::vector<std::string>& names) {
  if (std::find(names.begin(), names.end(), name) != names.end()) return;
  throw std::invalid_argument(
      fmt::format("{}: {}: no run has it{}", option, name, did_you_mean(name, names)));
}

}  // namespace

PairedResults paired_runs(const std::vector<SavedRun>& runs,
                          const std::vector<std::string>& metrics, const std::string& baseline,
                          const std::map<std::string, Goal>& goals) {
  PairedResults results;
  std::vector<std::string> seeds;
  std::map<std::pair<std::string, std::string>, const SavedRun*> found;  // by case and seed
  for (const SavedRun& run : runs) {
    if (run.scenario() != runs.front().scenario()) {
      throw std::invalid_argument(
          fmt::format("{}: is of {}, {} of {}: compare runs of one scenario", run.folder().string(),
                      run.scenario(), runs.front().folder().string(), runs.front().scenario()));
    }
    if (run.failure() && run.failure()->is_cut) {
      throw std::invalid_argument(run.folder().string() +
                                  ": was cut and has no metrics: leave it out");
    }
    if (!found.emplace(std::pair(run.case_name(), run.seed()), &run).second) {
      throw std::invalid_argument(fmt::format("{}: {} with seed {} is there twice",
                                              run.folder().string(), run.case_name(), run.seed()));
    }
    const auto add = [](std::vector<std::string>& to, const std::string& name) {
      if (std::find(to.begin(), to.end(), name) == to.end()) to.push_back(name);
    };
    add(results.candidates, run.case_name());
    add(seeds, run.seed());
  }
  if (results.candidates.size() < 2) {
    throw std::invalid_argument("--paired: all runs are of one case: there is nothing to compare");
  }
  std::erase_if(seeds, [&](const std::string& seed) {
    return !std::all_of(results.candidates.begin(), results.candidates.end(),
                        [&](const std::string& name) {
                          return found.contains({name, seed});
                        });
  });
  if (seeds.empty()) throw std::invalid_argument("--paired: no seed is common to all cases");
  const std::vector<std::string> all = metrics_of_runs(runs);
  for (const std::string& metric : metrics) check_known("--metric", metric, all);
  for (const auto& [metric, goal] : goals) check_known("--goal", metric, all);
  if (!baseline.empty()) {
    check_known("--baseline", baseline, results.candidates);
    results.baseline = static_cast<std::size_t>(
        std::find(results.candidates.begin(), results.candidates.end(), baseline) -
        results.candidates.begin());
  }
  results.metrics = metrics.empty() ? all : metrics;
  results.goals = goals;
  const auto rows = static_cast<Eigen::Index>(seeds.size());
  const auto columns = static_cast<Eigen::Index>(results.candidates.size());
  results.failed = Eigen::MatrixXd::Zero(rows, columns);
  results.values.assign(
      results.metrics.size(),
      Eigen::MatrixXd::Constant(rows, columns, std::numeric_limits<double>::quiet_NaN()));
  for (Eigen::Index i = 0; i < rows; ++i) {
    for (Eigen::Index k = 0; k < columns; ++k) {
      const SavedRun& run = *found.at(
          {results.candidates[static_cast<std::size_t>(k)], seeds[static_cast<std::size_t>(i)]});
      if (run.failure()) results.failed(i, k) = 1.0;
      for (std::size_t m = 0; m < results.metrics.size(); ++m) {
        if (const auto value = run.metric(results.metrics[m])) results.values[m](i, k) = *value;
      }
    }
  }
  return results;
}

std::vector<std::string> other_differences(const Catalogue& catalogue,
                                           const std::vector<SavedRun>& runs) {
  std::map<std::string, std::set<std::string>> differing;  // the values of a key
  const auto note = [&](const std::vector<SavedRun>& some, const std::set<std::string>* only) {
    for (const DifferingKey& key : differing_keys(some)) {
      if (key.key == "run.seed" || key.key.starts_with("record.")) continue;
      if (only != nullptr && !only->contains(key.key)) continue;
      differing[key.key].insert(key.values.begin(), key.values.end());
    }
  };
  std::map<std::string, std::vector<SavedRun>> of_case;
  for (const SavedRun& run : runs) of_case[run.case_name()].push_back(run);
  std::vector<SavedRun> one_of_each;
  std::set<std::string> changed;  // cases differ, but not in what a user changed
  for (const auto& [name, same] : of_case) {
    note(same, nullptr);
    one_of_each.push_back(same.front());
    for (const ChangedKey& key : changed_keys(catalogue, same.front())) changed.insert(key.key);
  }
  note(one_of_each, &changed);
  if (differing.empty()) return {};
  std::vector<std::string> texts;
  for (const auto& [key, values] : differing) {
    texts.push_back(fmt::format("{} ({})", key, fmt::join(values, "; ")));
  }
  return {fmt::format("--paired: the runs differ in more than case and seed: {}",
                      fmt::join(texts, ", "))};
}

}  // namespace breakwater
