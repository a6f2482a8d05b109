// Comparison of candidates in the same test conditions.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <functional>
#include <limits>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <breakwater/statistics/distribution.h>

namespace breakwater {

/// The direction in which a metric is better.
enum class Goal { none, min, max };

/// Names in files; `none` has no name.
inline const std::vector<std::pair<std::string, Goal>>& goal_names() {
  static const std::vector<std::pair<std::string, Goal>> names = {{"min", Goal::min},
                                                                  {"max", Goal::max}};
  return names;
}

/// Holm's adjusted p: with p₍₁₎ ≤ … ≤ p₍ₘ₎,  p'₍ᵢ₎ = max_{j ≤ i} min(1, (m − j + 1) p₍ⱼ₎). A
/// rejection where p' ≤ α gives any false rejection with probability α at most, for any dependence.
///
/// Source: S. Holm, Scand. J. Statist. 6 (1979) 65–70.
std::vector<double> holm(const std::vector<double>& p);

/// The levels at which Holm's procedure decides the tests. After r rejections a rejected p₍ᵢ₎ has
/// α/(m − i + 1), and each other one α/(m − r). Equal p have the level of the first of them. p ≤
/// its level exactly where p' ≤ α. So an interval that belongs to the test has this level, and
/// covers with probability 1 − α or more.
std::vector<double> holm_levels(const std::vector<double>& p, double alpha);

/// Results of each candidate (columns) in each test condition (rows).
struct PairedResults {
  std::vector<std::string> candidates;
  std::optional<std::size_t> baseline;  ///< compared with all others; else all pairs are compared
  std::vector<std::string> metrics;
  std::map<std::string, Goal> goals;    ///< by metric; others have none
  std::vector<Eigen::MatrixXd> values;  ///< for each metric; NaN: the run lacks it
  Eigen::MatrixXd failed;               ///< 1 if the run did not end, else 0
  /// Adjacent rows with equal numbers repeat one sample (with other seeds). Empty: each row is a
  /// sample.
  Eigen::VectorXi samples = {};
  /// Equal numbers in a column are identical runs: the test conditions differ without effect on the
  /// candidate. Empty: all runs differ.
  Eigen::MatrixXi runs = {};
};

/// The coordinates of a test condition: the values of the varied keys and the index of its seed.
using Coordinates = std::vector<double>;

/// Numbers the failed runs in `results.runs` anew, which has the number of each run's outcome. All
/// runs that fail in the first step have one outcome. Two failed runs of a candidate are equal if
/// they ended alike and differ only in coordinates without effect on its other runs.
void number_failed_runs(const std::vector<Coordinates>& places, PairedResults& results);

enum class ComparisonVerdict {
  better,
  worse,
  smaller,
  larger,
  no_difference_shown,
  too_few_blocks
};
const std::string& name_of(ComparisonVerdict verdict);

/// Verdicts have this level of significance, and intervals 1 − kAlpha or more.
inline constexpr double kAlpha = 0.05;

/// The median of a sample that is not empty, with quantile_interval().
EstimatedValue estimated_median(std::vector<double> values);

/// The test conditions of each block.
using Blocks = std::vector<std::vector<Eigen::Index>>;

/// The rows of `results` by block. Samples in which all of these candidates have the runs of an
/// earlier sample are left out.
Blocks different_blocks(const PairedResults& results, const std::vector<std::size_t>& candidates);

/// The median over each block of a function of the test condition. A value of NaN is left out, and
/// so is a block without others.
std::vector<double> block_medians(const Blocks& blocks,
                                  const std::function<double(Eigen::Index)>& value);

/// In place of a metric in the rows of failures.
inline constexpr const char* kFailure = "failure";

/// One metric of a candidate x compared with the reference y, over the pairs in which both have it.
/// The unit is the block: a sample, repeated by its test conditions. Its value is the median of x −
/// y (of x, of y) over these. Samples with identical runs of x and y are one block.
///
/// For kFailure, the value of a block is its number of failures, and p is mcnemar_exact(). It has
/// no median, difference or probability.
struct PairComparison {
  std::string metric;
  Goal goal = Goal::none;
  std::size_t candidate = 0, reference = 0;
  std::size_t pairs = 0, blocks = 0;
  std::size_t failures = 0, reference_failures = 0;  ///< for kFailure
  bool is_test = false;  ///< whether x and y differ, so that it counts in Holm's correction
  EstimatedValue median{}, reference_median{};
  EstimatedValue difference{};  ///< pseudo-median of x − y, with its interval at Holm's level
  std::size_t smaller = 0, larger = 0;     ///< blocks with x < y and with x > y
  std::optional<std::size_t> needed = {};  ///< differences_needed(), at Holm's level
  double p = 1.0;                          ///< SignedRank of x − y
  double p_holm = 1.0;        ///< over all metrics (or failures) and pairs of candidates
  double least_p_holm = 1.0;  ///< the smallest that these numbers of blocks can give
  /// The share of blocks with x < y; equal ones count half.
  double probability_smaller = std::numeric_limits<double>::quiet_NaN();
  double probability_better = std::numeric_limits<double>::quiet_NaN();  ///< if there is a goal
  ComparisonVerdict verdict = ComparisonVerdict::no_difference_shown;
};

struct CandidateComparison {
  std::vector<std::string> candidates;
  std::size_t blocks = 0;            ///< blocks in which any candidate's runs differ
  std::vector<std::size_t> reached;  ///< blocks of each candidate alone
  /// By candidate: metrics with a goal that another candidate has, but none of its own runs. At
  /// least one of its runs must have ended.
  std::vector<std::vector<std::string>> never;
  std::size_t tests = 0;                ///< metrics and pairs in Holm's correction
  std::vector<PairComparison> metrics;  ///< by metric, then by candidate
  std::vector<PairComparison> failures;
};

/// The smallest p that the tests of n blocks can give: m·2·2⁻ⁿ for the first of m tests in Holm's
/// correction, at most 1.
double least_p(std::size_t blocks, std::size_t tests = 1);

/// Compares the candidates. Medians have quantile_interval(). The difference has the interval of
/// its signed-rank test at the level of holm_levels(), so it excludes zero exactly where p_holm ≤
/// kAlpha.
///
/// The verdict: x is `better` or `worse` than y if p_holm ≤ kAlpha. Without a goal it is `smaller`
/// or `larger`. Otherwise it is `no difference shown`, which does not mean equal, or `too few
/// blocks` (no result of so many blocks and tests could be significant). A candidate is better in
/// failures if it has fewer in more blocks and p_holm ≤ kAlpha.
///
/// A metric that no pair has in common has no row. A metric in which no pair differs is not a test
/// and does not count in Holm's correction.
CandidateComparison compare_candidates(const PairedResults& results);

}  // namespace breakwater
