// Candidates that met the same worlds, compared.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include <breakwater/statistics/confidence_interval.h>
#include <breakwater/statistics/goal.h>
#include <breakwater/statistics/key_groups.h>

namespace breakwater {

/// The same worlds (rows) made this of each candidate (columns).
struct PairedResults {
  std::vector<std::string> candidates;
  std::optional<std::size_t> baseline;  ///< that the others are compared with; else all pairs are
  std::vector<std::string> metrics;
  std::map<std::string, Goal> goals;    ///< of metrics; none of those that are not there
  std::vector<Eigen::MatrixXd> values;  ///< of each metric; NaN: the run does not have it
  Eigen::MatrixXd failed;               ///< 1 where the run did not end, else 0
  /// Worlds of equal numbers, which stand together, repeat one sample (with other seeds). Empty:
  /// each world is a sample.
  Eigen::VectorXi samples = {};
  /// Equal numbers in a column are the same run again: what makes two worlds different does not
  /// reach that candidate. Empty: all runs differ.
  Eigen::MatrixXi runs = {};
  std::vector<StudyKey> keys = {};  ///< that samples differ in, with a value for each world
};

enum class ComparisonVerdict {
  better,
  worse,
  smaller,
  larger,
  no_difference_shown,
  too_few_blocks
};
const std::string& name_of(ComparisonVerdict verdict);

struct EstimatedMedian {
  double value;
  std::optional<ConfidenceInterval> interval;
};

/// One metric of one candidate x beside another, the reference y, over the pairs that have both.
///
/// The unit is the block: a sample, whose worlds are repeats of it. In a block stands the median of
/// x − y over its worlds (of x, of y); all that follows is over blocks. Samples in which x and y
/// have the same runs, world for world, are one block and not several.
struct MetricComparison {
  std::string metric;
  Goal goal = Goal::none;
  std::size_t candidate = 0, reference = 0;
  std::size_t pairs = 0, blocks = 0;
  std::optional<double> between = {};  ///< share_between() blocks of what x − y varies
  EstimatedMedian median{}, reference_median{};
  EstimatedMedian difference{};      ///< the median of x − y
  double p = 1.0;                    ///< signed_rank_test() of x − y
  double p_holm = 1.0;               ///< over all metrics and pairs of candidates
  double probability_smaller = 0.5;  ///< share of blocks with x < y, equal ones by half
  std::optional<double> probability_better = {};  ///< where there is a goal
  ComparisonVerdict verdict = ComparisonVerdict::no_difference_shown;
  std::vector<std::string> turns_with = {};  ///< keys with whose values the sign is shown to turn
};

/// A metric's difference x − y by the values of a varied key that reaches the pair. A value is one
/// group where it has two blocks or more, or where no other key is varied; else neighbours are
/// together. The blocks of a group repeat it; the worlds do, where a group is one block.
struct KeyInteraction {
  struct Value {
    std::string label;
    double x = 0.0;           ///< where it stands on an axis
    std::size_t repeats = 0;  ///< values of the difference
    double median = 0.0, q10 = 0.0, q90 = 0.0;
  };
  std::string metric;
  std::size_t candidate = 0, reference = 0;
  std::string key;
  bool is_log = false;  ///< the axis
  bool is_number = true;
  bool is_of_worlds = false;  ///< the repeats are worlds of one block
  std::vector<Value> values;  ///< those that any pair has
  double p = 1.0;             ///< sign_turn_p()
  double p_holm = 1.0;        ///< over all keys, metrics and pairs of candidates
  bool turns = false;         ///< p_holm ≤ alpha, and the medians have both signs
};

/// Failures of one candidate beside another's.
struct FailureComparison {
  std::size_t candidate = 0, reference = 0;
  std::size_t pairs = 0;
  std::size_t failures = 0, reference_failures = 0;
  std::size_t blocks = 0;
  /// Blocks in which more of its runs failed than of the other's.
  std::size_t alone = 0, reference_alone = 0;
  double p = 1.0;       ///< mcnemar_exact()
  double p_holm = 1.0;  ///< over all pairs of candidates
  ComparisonVerdict verdict = ComparisonVerdict::no_difference_shown;
};

/// Ranks of three candidates or more in one metric, of their medians over the blocks in which all
/// have it: 1 is the smallest value; with the goal max, the largest. None where two candidates have
/// fewer blocks than all have together (theirs are not independent), or where they are too few.
struct RankComparison {
  std::string metric;
  Goal goal = Goal::none;
  std::size_t blocks = 0;
  std::vector<double> average_ranks;  ///< of each candidate
  double critical_difference = 0.0;   ///< Nemenyi's, at 5 %
};

struct CandidateComparison {
  std::vector<std::string> candidates;
  std::size_t worlds = 0;            ///< that they met
  std::size_t blocks = 0;            ///< of these, in which any candidate's runs differ
  std::vector<std::size_t> reached;  ///< blocks of each candidate alone
  /// The metrics with a goal that another candidate has and none of this candidate's runs, if it
  /// ends at least once.
  std::vector<std::vector<std::string>> never;
  std::vector<MetricComparison> metrics;     ///< metrics in their order, in them the candidates
  std::vector<KeyInteraction> interactions;  ///< in the order of metrics, in them of keys
  std::vector<FailureComparison> failures;
  std::vector<RankComparison> ranks;  ///< empty of fewer than three candidates

  /// Whether any pair has more pairs of runs than blocks.
  bool has_repeats() const;
};

struct ComparisonSettings {
  double alpha = 0.05;
  BootstrapSettings bootstrap = {.replicates = 2000, .level = 0.95, .seed = 1};
};

/// Whether no test can show anything from n blocks: 2·2⁻ⁿ > alpha (five or fewer).
bool are_too_few(std::size_t blocks, double alpha = ComparisonSettings{}.alpha);

/// Compares them. Medians have quantile_interval(), the median difference bca_interval() of its
/// bootstrap (of more than 2000 blocks quantile_interval(), which is near to it then).
///
/// The verdict: x is `better` (`worse`) than y if p_holm ≤ alpha and the interval of the median
/// difference lies on the better (worse) side of zero, zero not in it; `smaller` and `larger` take
/// their place where the metric has no goal; else `no difference shown`, which is not "equal". No
/// test can show anything from blocks that are_too_few(): `too few blocks`.
/// Failures: of more blocks with fewer is better if p_holm ≤ alpha.
///
/// A metric that no pair has in common has no row; one in which no pair differs is no test, and
/// does not count for Holm's correction.
CandidateComparison compare_candidates(const PairedResults& results,
                                       const ComparisonSettings& settings = {});

}  // namespace breakwater
