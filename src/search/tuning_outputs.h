// The output files of a tuning.
#pragma once

#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include <breakwater/search/tuner.h>
#include <breakwater/search/tuning_plan.h>
#include <breakwater/statistics/ranking.h>
#include <breakwater/study/result_row.h>

namespace breakwater {

/// One row of front.csv or tuned.csv. `label` is its number in
/// front/LABEL.toml, or its case in tuned/LABEL.toml.
struct FrontRow {
  std::size_t tuned = 0;
  std::size_t evaluation = 0;
  std::string label;
  ResultRow cells;
};

struct FrontTable {
  std::vector<std::string> columns;
  std::vector<FrontRow> rows;
  /// The best candidates of the cases, by the objective's metric in the validation. Each of its
  /// test conditions is a block. Nothing with several objectives, without a validation, or for
  /// fewer than two cases with a feasible candidate.
  std::optional<Ranking> ranking;
};

/// docs/how-to/tuning.md says what the columns are. Cells that do not apply are empty.
FrontTable front_table(const TuningPlan& plan, const TuningResult& result);

/// Writes results.csv, and front.csv and front/N.toml. With one objective there
/// are tuned.csv, tuned/CASE.toml and ranking.json instead. Throws OutputError.
void write_outputs(const TuningPlan& plan, const TuningResult& result, const FrontTable& table,
                   const std::filesystem::path& folder);

}  // namespace breakwater
