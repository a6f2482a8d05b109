// results.csv and results.sqlite: a study's runs as one table.
#pragma once

#include <filesystem>
#include <string>
#include <unordered_map>
#include <vector>

#include <breakwater/study/plan.h>
#include <breakwater/study/shards.h>

namespace breakwater {

/// What the rows of a study's table have: `point`, `case`, `seed`, the compared and varied keys,
/// `status`, `state_hash`, and every metric that any run has, in the order in which the points
/// first have them. It follows from the results alone, whoever ran what when.
class ResultsTable {
 public:
  ResultsTable(const Plan& plan, const ShardIndex& index);

  const std::vector<std::string>& metrics() const { return metrics_; }

  /// One row a point that is there, in the points' order; numbers have the 17 digits that give the
  /// same double again. Throws OutputError.
  void write_csv(const std::filesystem::path& file) const;
  /// The same as the table `results`. Throws OutputError.
  void write_sqlite(const std::filesystem::path& file) const;

 private:
  std::vector<std::string> header() const;
  // The cells before the metrics.
  std::vector<std::string> head(const PointResult& result) const;

  const Plan& plan_;
  const ShardIndex& index_;
  std::vector<std::string> metrics_;
  std::unordered_map<std::string, std::size_t> columns_;  // of the metrics, by their names
};

}  // namespace breakwater
