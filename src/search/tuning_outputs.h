// The output files of a tuning.
#pragma once

#include <cstddef>
#include <filesystem>
#include <string>
#include <vector>

#include <breakwater/search/tuner.h>
#include <breakwater/search/tuning_plan.h>

namespace breakwater {

/// One row of front.csv, with a cell for each column. `label` is its number, as in
/// front/LABEL.toml.
struct FrontRow {
  std::size_t tuned = 0;
  std::size_t label = 0;
  std::vector<std::string> cells;
};

struct FrontTable {
  std::vector<std::string> columns;
  std::vector<FrontRow> rows;
};

/// Columns: `case`, `front`, `evaluation`, every searched key, and METRIC of each objective as
/// tuned. A validation adds METRIC_fresh, METRIC_fresh_lower and METRIC_fresh_upper. Constraints
/// have the same columns as METRIC_constraint…. The last column is `fresh_failures`. Cells that do
/// not apply are empty.
FrontTable front_table(const TuningPlan& plan, const TuningResult& result);

/// Writes results.csv, front.csv, hypervolume.csv and front/N.toml. Throws OutputError.
void write_outputs(const TuningPlan& plan, const TuningResult& result,
                   const std::filesystem::path& folder);

/// A number with this many digits. Other texts stay as they are.
std::string in_short(const std::string& value, int digits);

/// A text table of the fronts for readers.
std::string fronts_text(const TuningPlan& plan, const TuningResult& result, std::size_t width);

}  // namespace breakwater
