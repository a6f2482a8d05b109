// results.csv and results.sqlite: the runs of a study as one table.
#pragma once

#include <filesystem>
#include <string>
#include <unordered_map>
#include <vector>

#include <breakwater/study/plan.h>
#include <breakwater/study/shards.h>

namespace breakwater {

/// All metrics, in the order in which the points first have them.
std::vector<std::string> metrics_of(const ShardIndex& index);

/// The table of a study. Columns: `point`, `case`, `seed`, the compared and varied keys, `status`,
/// `state_hash`, and all metrics in the order in which the points first have them. The table
/// depends on the results alone, not on the order or place of the runs.
class ResultsTable {
 public:
  ResultsTable(const Plan& plan, const ShardIndex& index);

  const std::vector<std::string>& metrics() const { return metrics_; }

  /// Writes one row per finished point, in the order of the points. Numbers have 17 digits, which
  /// identify the double. Throws OutputError.
  void write_csv(const std::filesystem::path& file) const;
  /// Writes the same rows as the SQLite table `results`. Throws OutputError.
  void write_sqlite(const std::filesystem::path& file) const;

 private:
  std::vector<std::string> header() const;
  // The cells before the metrics.
  std::vector<std::string> head(const PointResult& result) const;

  const Plan& plan_;
  const ShardIndex& index_;
  std::vector<std::string> metrics_;
  std::unordered_map<std::string, std::size_t> columns_;  // metric → column
};

/// Whether two runs have the same states and metrics.
bool are_same_run(const PointResult& one, const PointResult& other);
/// The reason for equal runs with several seeds.
inline constexpr const char* kNoNoise = "no noise reaches them";

/// The notes, one per line. They name metrics that some complete runs of a candidate lack, so that
/// its medians are over fewer runs. They also name seeds that change nothing.
std::vector<std::string> notes(const Plan& plan, const ShardIndex& index);

}  // namespace breakwater
