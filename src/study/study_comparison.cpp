#include <breakwater/study/study_comparison.h>

#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <stdexcept>
#include <unordered_map>

#include <breakwater/config/config.h>
#include <breakwater/record/file_hash.h>
#include <breakwater/study/plan.h>
#include <breakwater/study/results.h>

namespace breakwater {
namespace {

constexpr std::size_t kMostWithoutBaseline = 20, kMostRanked = 100;
constexpr double kMostCompared = 2e8;

// The outcome of a run. Complete runs with equal outcomes are equal.
std::string outcome(const PointResult& result) {
  std::string text = name_of(result.status) + " " + result.state_hash;
  if (result.state_hash.empty()) text += " " + result.reason;
  for (const auto& [name, value] : result.metrics) text += fmt::format(" {}={:.17g}", name, value);
  return text;
}

// Whether each seed of a sample is a block of its own.
bool counts_seeds(const Study& study) {
  return study.vary.empty() || study.are_seeds_worlds;
}

}  // namespace

PairedResults paired_results(const Plan& plan, const ShardIndex& index,
                             const std::vector<std::string>& metrics) {
  const Study& study = plan.study();
  PairedResults results;
  for (const Candidate& candidate : plan.candidates()) {
    if (candidate.label == study.baseline) results.baseline = results.candidates.size();
    results.candidates.push_back(candidate.label);
  }
  results.metrics = !metrics.empty()         ? metrics
                    : !study.metrics.empty() ? study.metrics
                                             : metrics_of(index);
  results.goals = {study.goals.begin(), study.goals.end()};
  const std::size_t k = plan.candidates().size();
  const std::size_t all = plan.size() / k;
  if (static_cast<double>(plan.size()) * static_cast<double>(results.metrics.size()) >
      kMostCompared) {
    throw std::invalid_argument(
        fmt::format("compare.metrics: {} metrics of {} runs are too many to compare: name some",
                    results.metrics.size(), plan.size()));
  }
  std::unordered_map<std::string, std::size_t> columns;
  for (std::size_t i = 0; i < results.metrics.size(); ++i) columns.emplace(results.metrics[i], i);

  // A sample waits until all its seeds have run. Earlier, repeats could not be recognised.
  const std::size_t together = counts_seeds(study) ? k : k * plan.seeds();
  std::vector<std::size_t> worlds;
  for (std::size_t world = 0; world < all; ++world) {
    const std::size_t first = world * k / together * together;
    std::size_t done = 0;
    while (done < together && index.has(first + done)) ++done;
    if (done == together) worlds.push_back(world);
  }
  const auto rows = static_cast<Eigen::Index>(worlds.size()), width = static_cast<Eigen::Index>(k);
  results.failed = Eigen::MatrixXd::Zero(rows, width);
  results.values.assign(
      results.metrics.size(),
      Eigen::MatrixXd::Constant(rows, width, std::numeric_limits<double>::quiet_NaN()));
  results.runs = Eigen::MatrixXi::Zero(rows, width);
  results.samples = Eigen::VectorXi::Zero(rows);
  const std::vector<StudyKey> keys = study_keys(study);
  std::unordered_map<std::string, int> numbers;  // outcome → number
  std::vector<Coordinates> places;
  for (Eigen::Index row = 0; row < rows; ++row) {
    const std::size_t world = worlds[static_cast<std::size_t>(row)];
    results.samples(row) = static_cast<int>(world * k / together);
    const StudyPoint point = plan.point(world * k);
    Coordinates& place = places.emplace_back();
    for (std::size_t i = 0; i < keys.size(); ++i) {
      place.push_back(key_number(keys[i], point.values[i]));
    }
    place.push_back(static_cast<double>(world % plan.seeds()));
    for (std::size_t c = 0; c < k; ++c) {
      const PointResult run = index.read(world * k + c);
      const auto column = static_cast<Eigen::Index>(c);
      results.runs(row, column) =
          numbers.emplace(fingerprint({outcome(run)}), static_cast<int>(numbers.size()))
              .first->second;
      if (run.status != PointStatus::complete) results.failed(row, column) = 1.0;
      for (const auto& [name, value] : run.metrics) {
        const auto found = columns.find(name);
        if (found != columns.end()) results.values[found->second](row, column) = value;
      }
    }
  }
  number_failed_runs(places, results);
  return results;
}

std::optional<CandidateComparison> compare_study(const Plan& plan, const ShardIndex& index) {
  if (most_blocks(plan) == 0) return std::nullopt;
  return compare_candidates(paired_results(plan, index));
}

std::optional<Ranking> rank_study(const Plan& plan, const ShardIndex& index) {
  const Study& study = plan.study();
  const std::size_t candidates = plan.candidates().size();
  if (study.goals.empty() || candidates < 2 || candidates > kMostRanked) return std::nullopt;
  const auto& [metric, goal] = study.goals.front();
  std::vector<std::string> metrics = {metric};
  for (const Bound& bound : study.require.bounds) {
    if (bound.metric != metric) metrics.push_back(bound.metric);
  }
  return rank_candidates(paired_results(plan, index, metrics), metric, goal, study.require);
}

std::size_t most_blocks(const Plan& plan) {
  const std::size_t candidates = plan.candidates().size();
  if (candidates < 2) return 0;
  if (plan.study().baseline.empty() && candidates > kMostWithoutBaseline) return 0;
  return plan.samples() * (counts_seeds(plan.study()) ? plan.seeds() : 1);
}

}  // namespace breakwater
