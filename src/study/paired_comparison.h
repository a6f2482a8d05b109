// Candidates that met the same worlds, compared.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include <breakwater/study/confidence_interval.h>
#include <breakwater/study/goal.h>

namespace breakwater {

/// What the same worlds (rows) made of each candidate (columns).
struct PairedResults {
  std::vector<std::string> candidates;
  std::optional<std::size_t> baseline;  ///< that the others are compared with; else all pairs are
  std::vector<std::string> metrics;
  std::map<std::string, Goal> goals;    ///< of metrics; none of those that are not there
  std::vector<Eigen::MatrixXd> values;  ///< of each metric; NaN: the run does not have it
  Eigen::MatrixXd failed;               ///< 1 where the run did not end, else 0
  /// Equal numbers in a column are the same run again: what makes two worlds different does not
  /// reach that candidate. Empty: all runs differ.
  Eigen::MatrixXi runs = {};
};

enum class ComparisonVerdict { better, worse, smaller, larger, no_difference_shown };
const std::string& name_of(ComparisonVerdict verdict);

struct EstimatedMedian {
  double value;
  std::optional<ConfidenceInterval> interval;
};

/// One metric of one candidate x beside another, the reference y, over the pairs that have both. A
/// pair of the same two runs counts once, as does a run in its median.
struct MetricComparison {
  std::string metric;
  Goal goal = Goal::none;
  std::size_t candidate = 0, reference = 0;
  std::size_t pairs = 0;
  EstimatedMedian median{}, reference_median{};
  EstimatedMedian difference{};                   ///< the median of x − y
  double p = 1.0;                                 ///< signed_rank_test() of x − y
  double p_holm = 1.0;                            ///< over all metrics and pairs of candidates
  double probability_smaller = 0.5;               ///< share of pairs with x < y, equal ones by half
  std::optional<double> probability_better = {};  ///< where there is a goal
  ComparisonVerdict verdict = ComparisonVerdict::no_difference_shown;
};

/// Failures of one candidate beside another's.
struct FailureComparison {
  std::size_t candidate = 0, reference = 0;
  std::size_t pairs = 0;
  std::size_t failures = 0, reference_failures = 0;
  std::size_t alone = 0, reference_alone = 0;  ///< where the other did not fail
  double p = 1.0;                              ///< mcnemar_exact()
  double p_holm = 1.0;                         ///< over all pairs of candidates
  ComparisonVerdict verdict = ComparisonVerdict::no_difference_shown;
};

/// Ranks of three candidates or more in one metric, over the worlds in which all have it: 1 is the
/// smallest value; with the goal max, the largest. None where a pair of runs repeats: its worlds
/// are not independent.
struct RankComparison {
  std::string metric;
  Goal goal = Goal::none;
  std::size_t worlds = 0;
  std::vector<double> average_ranks;  ///< of each candidate
  double critical_difference = 0.0;   ///< Nemenyi's, at 5 %
};

struct CandidateComparison {
  std::vector<std::string> candidates;
  std::size_t worlds = 0;         ///< that they met
  std::vector<std::size_t> runs;  ///< of each candidate, that differ
  /// Of each candidate that ends at least once, the metrics with a goal that another candidate has
  /// and none of its runs.
  std::vector<std::vector<std::string>> never;
  std::vector<MetricComparison> metrics;  ///< metrics in their order, in them the candidates
  std::vector<FailureComparison> failures;
  std::vector<RankComparison> ranks;  ///< empty of fewer than three candidates
};

struct ComparisonSettings {
  double alpha = 0.05;
  BootstrapSettings bootstrap = {.replicates = 2000, .level = 0.95, .seed = 1};
};

/// Compares them. Medians have quantile_interval(), the median difference bca_interval() of its
/// bootstrap (of more than 2000 pairs quantile_interval(), which is near to it then).
///
/// The verdict: x is `better` (`worse`) than y if p_holm ≤ alpha and the interval of the median
/// difference lies on the better (worse) side of zero, zero not in it; `smaller` and `larger` take
/// their place where the metric has no goal; else `no difference shown`, which is not "equal".
/// Failures: fewer are better if p_holm ≤ alpha.
///
/// A metric that no pair has in common has no row; one in which no pair differs is no test, and
/// does not count for Holm's correction.
CandidateComparison compare_candidates(const PairedResults& results,
                                       const ComparisonSettings& settings = {});

}  // namespace breakwater
