// The results of a study: their files, their columns, and the comparison of its candidates.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <unordered_map>
#include <vector>

#include <breakwater/statistics/key_groups.h>
#include <breakwater/statistics/paired_comparison.h>
#include <breakwater/statistics/ranking.h>
#include <breakwater/study/plan.h>
#include <breakwater/study/result_row.h>
#include <breakwater/study/shards.h>

namespace breakwater {

/// One finished run of a study.
struct StudyRun {
  std::size_t number = 0;    ///< number of the point
  std::uint32_t sample = 0;  ///< that of the plan, index into StudyKey::values
  std::uint32_t candidate = 0;
  bool failed = false;      ///< not complete, for any reason
  std::size_t outcome = 0;  ///< equal for runs with equal states and metrics, or equal failures
};

/// Runs that failed for the same reason, apart from the numbers in it.
struct FailureKind {
  PointStatus status = PointStatus::failed;
  std::string reason;  ///< reason of the first run
  std::size_t runs = 0;
  std::vector<std::size_t> of_candidate;  ///< number of runs per candidate
  std::vector<std::size_t> first;         ///< numbers of the first points
};

/// The results of a study as columns: for its notes, its comparison, its ranking and its page.
struct StudyNumbers {
  std::vector<StudyKey> keys;         ///< the varied ones
  std::vector<StudyRun> runs;         ///< in the order of the points
  std::vector<std::string> metrics;   ///< in the order in which the points first have them
  std::vector<FailureKind> failures;  ///< most runs first
  /// By metric: its value in each run; NaN: not measured.
  std::unordered_map<std::string, std::vector<double>> columns;
};

/// Reads each result once.
StudyNumbers study_numbers(const Plan& plan, const ShardIndex& index);

/// Puts these metrics first, as far as the runs have them.
void put_first(const std::vector<std::string>& first, StudyNumbers& numbers);

/// The runs of one group, with the values of a metric.
struct RunGroup {
  std::size_t runs = 0;
  std::size_t failed = 0;
  std::size_t first_failed = 0;     ///< number of the point
  std::vector<double> values;       ///< sorted, of the runs that have the metric
  std::vector<std::size_t> points;  ///< the number of each one's point

  /// quantile(), with interpolation; NaN without values.
  double at(double share) const;
};

/// `groups` groups of runs. `column` has a value, or NaN, for each run; group_of(run) < groups.
std::vector<RunGroup> grouped(const StudyNumbers& numbers, const std::vector<double>& column,
                              std::size_t groups,
                              const std::function<std::size_t(const StudyRun&)>& group_of);

/// The output 1 for a failed run and 0 for another one.
inline constexpr const char* kFailedOutput = "failed";

/// The rows of indices.csv: sensitivity_indices() for each output, candidate and key, with the
/// outputs in the order of the metrics and the failures last. An output is the mean over the seeds
/// of a metric, or the share of failed seeds. It is missing for a sample if a seed has no value.
/// There are 1000 replicates, or fewer for a very large study, but at least 200. Columns:
/// `candidate`, `output`, `key`, `first_order`, `first_order_lower`, `first_order_upper`, `total`,
/// `total_lower`, `total_upper`, `rows`, `dropped_rows`. A missing value is empty.
std::vector<ResultRow> study_indices(const StudyNumbers& numbers,
                                     const std::vector<std::string>& labels);

/// Writes results.csv, with a row for each finished point in the order of the points. Columns:
/// `point`, `case`, `seed`, the compared and varied keys, `status`, `state_hash`, and `metrics`.
/// Numbers have 17 digits, which identify the double. The bytes depend on the results alone, not on
/// the order or place of the runs. Throws OutputError.
void write_results(const Plan& plan, const ShardIndex& index,
                   const std::vector<std::string>& metrics, const std::filesystem::path& file);
/// Writes the rows of `csv` as the SQLite table `results`, with Python. Throws OutputError.
void write_sqlite(const std::filesystem::path& csv, const std::filesystem::path& file);

/// The reason for equal runs with several seeds.
inline constexpr const char* kNoNoise = "no noise reaches them";

/// Lines such as "y_1 is missing: in 7 of 12 complete runs of plain". `counts` are each metric's
/// runs by candidate.
std::vector<std::string> missing_lines(
    const std::vector<std::string>& candidates,
    const std::map<std::string, std::vector<std::size_t>>& counts,
    const std::vector<std::size_t>& complete);

/// The notes, one per line. They name metrics that some complete runs of a candidate lack, so that
/// its medians are over fewer runs. They also name seeds that change nothing.
std::vector<std::string> notes(const Plan& plan, const StudyNumbers& numbers);

/// The results of a study's candidates, paired by sample and seed. Each row is a test condition
/// that all candidates have finished. Without `metrics` they are those of compare.metrics, or all.
/// Seeds repeat a sample; without varied keys, or with `worlds = "seeds"`, each seed is a block.
/// Equal runs have the same number, failed ones that of number_failed_runs(). Throws
/// std::invalid_argument if the table would be too large for memory.
PairedResults paired_results(const Plan& plan, const StudyNumbers& numbers,
                             const std::vector<std::string>& metrics = {});

/// The number of blocks in a comparison of the candidates, if no run fails. 0: the study compares
/// nothing, since it has one candidate, or more than 20 and no baseline.
std::size_t most_blocks(const Plan& plan);

/// compare_candidates() of them; nothing if the study compares nothing.
std::optional<CandidateComparison> compare_study(const Plan& plan, const StudyNumbers& numbers);

/// rank_candidates() by the first metric with a goal; nothing without a goal, with one candidate or
/// with more than a hundred.
std::optional<Ranking> rank_study(const Plan& plan, const StudyNumbers& numbers);

}  // namespace breakwater
