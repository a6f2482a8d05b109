#include <breakwater/study/study_comparison.h>

#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <stdexcept>
#include <unordered_map>

namespace breakwater {
namespace {

constexpr std::size_t kMostWithoutBaseline = 20, kMostRanked = 100;
constexpr double kMostCompared = 2e8;

// Whether each seed of a sample is a block of its own.
bool counts_seeds(const Study& study) {
  return study.vary.empty() || study.are_seeds_worlds;
}

}  // namespace

PairedResults paired_results(const Plan& plan, const StudyNumbers& numbers,
                             const std::vector<std::string>& metrics) {
  const Study& study = plan.study();
  PairedResults results;
  for (const Candidate& candidate : plan.candidates()) {
    if (candidate.label == study.baseline) results.baseline = results.candidates.size();
    results.candidates.push_back(candidate.label);
  }
  results.metrics = !metrics.empty()         ? metrics
                    : !study.metrics.empty() ? study.metrics
                                             : numbers.metrics;
  results.goals = {study.goals.begin(), study.goals.end()};
  const std::size_t k = plan.candidates().size();
  if (static_cast<double>(plan.size()) * static_cast<double>(results.metrics.size()) >
      kMostCompared) {
    throw std::invalid_argument(
        fmt::format("compare.metrics: {} metrics of {} runs are too many to compare: name some",
                    results.metrics.size(), plan.size()));
  }
  // A sample waits until all its seeds have run. Earlier, repeats could not be recognised.
  const std::size_t together = counts_seeds(study) ? k : k * plan.seeds();
  const std::vector<StudyRun>& runs = numbers.runs;
  std::vector<std::size_t> worlds;  // the first run of each test condition
  for (std::size_t begin = 0, end = 0; begin < runs.size(); begin = end) {
    const std::size_t sample = runs[begin].number / together;
    while (end < runs.size() && runs[end].number / together == sample) ++end;
    if (end - begin < together) continue;
    for (std::size_t world = begin; world < end; world += k) worlds.push_back(world);
  }
  const auto rows = static_cast<Eigen::Index>(worlds.size()), width = static_cast<Eigen::Index>(k);
  results.failed.resize(rows, width);
  results.runs.resize(rows, width);
  results.samples.resize(rows);
  std::unordered_map<std::size_t, int> outcomes;  // their numbers
  std::vector<Coordinates> places;
  for (Eigen::Index row = 0; row < rows; ++row) {
    const StudyRun* const first = &runs[worlds[static_cast<std::size_t>(row)]];
    results.samples(row) = static_cast<int>(first->number / together);
    Coordinates& place = places.emplace_back();
    for (const StudyKey& key : numbers.keys) place.push_back(key.values[first->sample]);
    place.push_back(static_cast<double>(first->number / k % plan.seeds()));
    for (Eigen::Index c = 0; c < width; ++c) {
      results.failed(row, c) = first[c].failed ? 1.0 : 0.0;
      results.runs(row, c) =
          outcomes.emplace(first[c].outcome, static_cast<int>(outcomes.size())).first->second;
    }
  }
  for (const std::string& metric : results.metrics) {
    Eigen::MatrixXd& values = results.values.emplace_back(
        Eigen::MatrixXd::Constant(rows, width, std::numeric_limits<double>::quiet_NaN()));
    const auto found = std::ranges::find(numbers.metrics, metric);
    if (found == numbers.metrics.end()) continue;
    const double* const column =
        numbers.columns[static_cast<std::size_t>(found - numbers.metrics.begin())].data();
    for (Eigen::Index row = 0; row < rows; ++row) {
      values.row(row) = Eigen::Map<const Eigen::RowVectorXd>(
          column + worlds[static_cast<std::size_t>(row)], width);
    }
  }
  number_failed_runs(places, results);
  return results;
}

std::optional<CandidateComparison> compare_study(const Plan& plan, const StudyNumbers& numbers) {
  if (most_blocks(plan) == 0) return std::nullopt;
  return compare_candidates(paired_results(plan, numbers));
}

std::optional<Ranking> rank_study(const Plan& plan, const StudyNumbers& numbers) {
  const Study& study = plan.study();
  const std::size_t candidates = plan.candidates().size();
  if (study.goals.empty() || candidates < 2 || candidates > kMostRanked) return std::nullopt;
  const auto& [metric, goal] = study.goals.front();
  std::vector<std::string> metrics = {metric};
  for (const Bound& bound : study.require.bounds) {
    if (bound.metric != metric) metrics.push_back(bound.metric);
  }
  return rank_candidates(paired_results(plan, numbers, metrics), metric, goal, study.require);
}

std::size_t most_blocks(const Plan& plan) {
  const std::size_t candidates = plan.candidates().size();
  if (candidates < 2) return 0;
  if (plan.study().baseline.empty() && candidates > kMostWithoutBaseline) return 0;
  return plan.samples() * (counts_seeds(plan.study()) ? plan.seeds() : 1);
}

}  // namespace breakwater
