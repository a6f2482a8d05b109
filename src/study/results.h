// results.csv and results.sqlite: the runs of a study as one table.
#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include <breakwater/study/plan.h>
#include <breakwater/study/shards.h>

namespace breakwater {

/// All metrics, in the order in which the points first have them.
std::vector<std::string> metrics_of(const ShardIndex& index);

/// Writes results.csv, with a row for each finished point in the order of the points. Columns:
/// `point`, `case`, `seed`, the compared and varied keys, `status`, `state_hash`, and metrics_of().
/// Numbers have 17 digits, which identify the double. The bytes depend on the results alone, not on
/// the order or place of the runs. Returns the metrics. Throws OutputError.
std::vector<std::string> write_results(const Plan& plan, const ShardIndex& index,
                                       const std::filesystem::path& file);
/// Writes the rows of `csv` as the SQLite table `results`, with Python. Throws OutputError.
void write_sqlite(const std::filesystem::path& csv, const std::filesystem::path& file);

/// Whether two runs have the same states and metrics.
bool are_same_run(const PointResult& one, const PointResult& other);
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
std::vector<std::string> notes(const Plan& plan, const ShardIndex& index);

}  // namespace breakwater
