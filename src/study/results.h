// The results of a study: their files, their columns, and the comparison of its candidates.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include <breakwater/statistics/key_groups.h>
#include <breakwater/statistics/paired_comparison.h>
#include <breakwater/statistics/ranking.h>
#include <breakwater/study/plan.h>
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
  std::vector<StudyKey> keys;                ///< the varied ones
  std::vector<StudyRun> runs;                ///< in the order of the points
  std::vector<std::string> metrics;          ///< in the order in which the points first have them
  std::vector<std::vector<double>> columns;  ///< for each metric, by run; NaN: not measured
  std::vector<FailureKind> failures;         ///< most runs first
};

/// Reads each result once.
StudyNumbers study_numbers(const Plan& plan, const ShardIndex& index);

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
