#include <breakwater/study/paired_comparison.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <unordered_set>
#include <utility>

#include <breakwater/study/binomial.h>
#include <breakwater/study/bootstrap.h>
#include <breakwater/study/multiple_tests.h>
#include <breakwater/study/signed_rank.h>

namespace breakwater {
namespace {

constexpr std::size_t kMostBootstrapped = 2000;
constexpr std::size_t kFewestRanked = 3;

// Candidate and reference.
std::vector<std::pair<std::size_t, std::size_t>> pairs_of(const PairedResults& results) {
  std::vector<std::pair<std::size_t, std::size_t>> pairs;
  for (std::size_t x = 0; x < results.candidates.size(); ++x) {
    if (results.baseline) {
      if (x != *results.baseline) pairs.emplace_back(x, *results.baseline);
      continue;
    }
    for (std::size_t y = 0; y < x; ++y) pairs.emplace_back(x, y);
  }
  return pairs;
}

// What tells a run from others of its candidate.
int run_in(const PairedResults& results, Eigen::Index world, std::size_t candidate) {
  if (results.runs.size() == 0) return static_cast<int>(world);
  return results.runs(world, static_cast<Eigen::Index>(candidate));
}

// The worlds in which this pair of runs is new.
std::vector<Eigen::Index> different_worlds(const PairedResults& results, std::size_t x,
                                           std::size_t y) {
  std::unordered_set<std::uint64_t> met;
  met.reserve(static_cast<std::size_t>(results.failed.rows()));
  std::vector<Eigen::Index> worlds;
  for (Eigen::Index world = 0; world < results.failed.rows(); ++world) {
    const auto a = static_cast<std::uint32_t>(run_in(results, world, x));
    const auto b = static_cast<std::uint32_t>(run_in(results, world, y));
    if (met.insert(std::uint64_t{a} << 32 | b).second) worlds.push_back(world);
  }
  return worlds;
}

EstimatedMedian estimated_median(std::vector<double> values, double level) {
  std::sort(values.begin(), values.end());
  const auto interval = quantile_interval(values, 0.5, level);
  return {sample_median(values), interval};
}

EstimatedMedian median_difference(const std::vector<double>& differences,
                                  const BootstrapSettings& bootstrap) {
  if (differences.size() > kMostBootstrapped) {
    return estimated_median(differences, bootstrap.level);
  }
  std::vector<double> values = differences;
  return {
      sample_median(values),
      bca_interval(differences, sample_median,
                   bootstrap_replicates(differences, sample_median, bootstrap), bootstrap.level)};
}

Goal goal_in(const PairedResults& results, const std::string& metric) {
  const auto found = results.goals.find(metric);
  return found == results.goals.end() ? Goal::none : found->second;
}

MetricComparison compare_metric(const PairedResults& results, std::size_t metric, std::size_t x,
                                std::size_t y, const std::vector<Eigen::Index>& worlds,
                                const ComparisonSettings& settings) {
  MetricComparison comparison;
  comparison.metric = results.metrics[metric];
  comparison.goal = goal_in(results, comparison.metric);
  comparison.candidate = x;
  comparison.reference = y;
  const Eigen::MatrixXd& values = results.values[metric];
  std::vector<double> of_x, of_y, differences;
  std::unordered_set<int> runs_of_x(worlds.size()), runs_of_y(worlds.size());
  double smaller = 0.0;
  for (const Eigen::Index world : worlds) {
    const double a = values(world, static_cast<Eigen::Index>(x));
    const double b = values(world, static_cast<Eigen::Index>(y));
    if (std::isnan(a) || std::isnan(b)) continue;
    if (runs_of_x.insert(run_in(results, world, x)).second) of_x.push_back(a);
    if (runs_of_y.insert(run_in(results, world, y)).second) of_y.push_back(b);
    differences.push_back(a - b);
    smaller += a < b ? 1.0 : a == b ? 0.5 : 0.0;
  }
  comparison.pairs = differences.size();
  if (differences.empty()) return comparison;
  comparison.median = estimated_median(of_x, settings.bootstrap.level);
  comparison.reference_median = estimated_median(of_y, settings.bootstrap.level);
  comparison.difference = median_difference(differences, settings.bootstrap);
  comparison.p = signed_rank_test(differences).p;
  comparison.probability_smaller = smaller / static_cast<double>(comparison.pairs);
  if (comparison.goal != Goal::none) {
    comparison.probability_better = comparison.goal == Goal::min
                                        ? comparison.probability_smaller
                                        : 1.0 - comparison.probability_smaller;
  }
  return comparison;
}

bool differs(const MetricComparison& comparison, const PairedResults& results) {
  const auto metric = std::find(results.metrics.begin(), results.metrics.end(), comparison.metric) -
                      results.metrics.begin();
  const Eigen::MatrixXd& values = results.values[static_cast<std::size_t>(metric)];
  const auto x = values.col(static_cast<Eigen::Index>(comparison.candidate)).array();
  const auto y = values.col(static_cast<Eigen::Index>(comparison.reference)).array();
  return ((x - y).abs() > 0.0).any();  // never of NaN
}

ComparisonVerdict verdict_of(const MetricComparison& comparison, double alpha) {
  const auto& interval = comparison.difference.interval;
  if (comparison.p_holm > alpha || !interval) return ComparisonVerdict::no_difference_shown;
  const bool is_smaller = interval->upper<0.0, is_larger = interval->lower> 0.0;
  if (!is_smaller && !is_larger) return ComparisonVerdict::no_difference_shown;
  if (comparison.goal == Goal::none)
    return is_smaller ? ComparisonVerdict::smaller : ComparisonVerdict::larger;
  return is_smaller == (comparison.goal == Goal::min) ? ComparisonVerdict::better
                                                      : ComparisonVerdict::worse;
}

FailureComparison compare_failures(const PairedResults& results, std::size_t x, std::size_t y,
                                   const std::vector<Eigen::Index>& worlds) {
  const Eigen::ArrayXd of_x = results.failed(worlds, static_cast<Eigen::Index>(x));
  const Eigen::ArrayXd of_y = results.failed(worlds, static_cast<Eigen::Index>(y));
  const auto count = [](const auto& which) { return static_cast<std::size_t>(which.count()); };
  FailureComparison comparison;
  comparison.candidate = x;
  comparison.reference = y;
  comparison.pairs = worlds.size();
  comparison.failures = count(of_x > 0.0);
  comparison.reference_failures = count(of_y > 0.0);
  comparison.alone = count(of_x > of_y);
  comparison.reference_alone = count(of_y > of_x);
  comparison.p = mcnemar_exact(comparison.alone, comparison.reference_alone);
  return comparison;
}

// Where `counts` says so, Holm's; else p itself.
template <typename Comparison, typename Counts>
void adjust(std::vector<Comparison>& comparisons, const Counts& counts) {
  std::vector<double> p;
  for (const Comparison& one : comparisons) {
    if (counts(one)) p.push_back(one.p);
  }
  const std::vector<double> adjusted = holm(p);
  std::size_t next = 0;
  for (Comparison& one : comparisons) one.p_holm = counts(one) ? adjusted[next++] : one.p;
}

// Whether any two candidates have the same two runs in two worlds, given how many runs of each
// differ.
bool has_repeated_pair(const PairedResults& results, const std::vector<std::size_t>& runs) {
  const auto all = static_cast<std::size_t>(results.failed.rows());
  for (std::size_t x = 0; x < results.candidates.size(); ++x) {
    for (std::size_t y = 0; y < x; ++y) {
      if (std::max(runs[x], runs[y]) == all) continue;
      if (different_worlds(results, x, y).size() < all) return true;
    }
  }
  return false;
}

std::vector<std::size_t> different_runs(const PairedResults& results) {
  std::vector<std::size_t> runs;
  for (std::size_t x = 0; x < results.candidates.size(); ++x) {
    runs.push_back(different_worlds(results, x, x).size());
  }
  return runs;
}

std::vector<std::string> never_measured(const PairedResults& results, std::size_t candidate) {
  std::vector<std::string> metrics;
  const auto column = static_cast<Eigen::Index>(candidate);
  if ((results.failed.col(column).array() > 0.0).all()) return metrics;
  for (std::size_t metric = 0; metric < results.metrics.size(); ++metric) {
    const auto is_absent = results.values[metric].array().isNaN();
    const bool is_never = is_absent.col(column).all();
    if (goal_in(results, results.metrics[metric]) != Goal::none && is_never && !is_absent.all()) {
      metrics.push_back(results.metrics[metric]);
    }
  }
  return metrics;
}

std::optional<RankComparison> rank(const PairedResults& results, std::size_t metric, double alpha) {
  RankComparison comparison;
  comparison.metric = results.metrics[metric];
  comparison.goal = goal_in(results, comparison.metric);
  const Eigen::MatrixXd& values = results.values[metric];
  Eigen::MatrixXd whole(values.rows(), values.cols());
  Eigen::Index worlds = 0;
  for (Eigen::Index world = 0; world < values.rows(); ++world) {
    if (values.row(world).allFinite()) whole.row(worlds++) = values.row(world);
  }
  if (worlds == 0) return std::nullopt;
  if (comparison.goal == Goal::max) whole = -whole;
  const Eigen::VectorXd ranks = average_ranks(whole.topRows(worlds));
  comparison.worlds = static_cast<std::size_t>(worlds);
  comparison.average_ranks.assign(ranks.begin(), ranks.end());
  comparison.critical_difference =
      critical_difference(results.candidates.size(), comparison.worlds, alpha);
  return comparison;
}

}  // namespace

const std::string& name_of(ComparisonVerdict verdict) {
  static const std::array<std::string, 5> names = {"better", "worse", "smaller", "larger",
                                                   "no difference shown"};
  return names[static_cast<std::size_t>(verdict)];
}

CandidateComparison compare_candidates(const PairedResults& results,
                                       const ComparisonSettings& settings) {
  CandidateComparison comparison;
  comparison.candidates = results.candidates;
  comparison.worlds = static_cast<std::size_t>(results.failed.rows());
  comparison.runs = different_runs(results);
  for (std::size_t c = 0; c < results.candidates.size(); ++c) {
    comparison.never.push_back(never_measured(results, c));
  }
  const auto pairs = pairs_of(results);
  std::vector<std::vector<Eigen::Index>> worlds;
  for (const auto& [x, y] : pairs) worlds.push_back(different_worlds(results, x, y));
  for (std::size_t metric = 0; metric < results.metrics.size(); ++metric) {
    for (std::size_t i = 0; i < pairs.size(); ++i) {
      const auto& [x, y] = pairs[i];
      const MetricComparison one = compare_metric(results, metric, x, y, worlds[i], settings);
      if (one.pairs > 0) comparison.metrics.push_back(one);
    }
  }
  adjust(comparison.metrics, [&](const auto& one) { return differs(one, results); });
  for (MetricComparison& one : comparison.metrics) one.verdict = verdict_of(one, settings.alpha);

  for (std::size_t i = 0; i < pairs.size(); ++i) {
    comparison.failures.push_back(
        compare_failures(results, pairs[i].first, pairs[i].second, worlds[i]));
  }
  adjust(comparison.failures, [](const auto& one) { return one.alone + one.reference_alone > 0; });
  for (FailureComparison& one : comparison.failures) {
    if (one.p_holm > settings.alpha) continue;
    one.verdict =
        one.alone < one.reference_alone ? ComparisonVerdict::better : ComparisonVerdict::worse;
  }

  if (results.candidates.size() >= kFewestRanked && !has_repeated_pair(results, comparison.runs)) {
    for (std::size_t metric = 0; metric < results.metrics.size(); ++metric) {
      if (auto ranks = rank(results, metric, settings.alpha)) {
        comparison.ranks.push_back(std::move(*ranks));
      }
    }
  }
  return comparison;
}

}  // namespace breakwater
