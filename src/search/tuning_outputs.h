// What a tuning leaves in its folder.
#pragma once

#include <cstddef>
#include <filesystem>
#include <string>
#include <vector>

#include <breakwater/search/tuner.h>
#include <breakwater/search/tuning_plan.h>

namespace breakwater {

/// One point of a front as front.csv has it: cells by their columns' names. `label` is its number,
/// that of front/LABEL.toml.
struct FrontRow {
  std::size_t tuned = 0;
  std::size_t label = 0;
  std::vector<std::string> cells;
};

struct FrontTable {
  std::vector<std::string> columns;
  std::vector<FrontRow> rows;
};

/// `case`, `front`, `evaluation`, every searched key, and of each objective METRIC as it was tuned
/// and, if there is a validation, METRIC_fresh, METRIC_fresh_lower, METRIC_fresh_upper; of each
/// constraint the same as METRIC_constraint…; `fresh_failures`. Cells that do not apply are empty.
FrontTable front_table(const TuningPlan& plan, const TuningResult& result);

/// Writes results.csv, front.csv, hypervolume.csv and front/N.toml. Throws OutputError.
void write_outputs(const TuningPlan& plan, const TuningResult& result,
                   const std::filesystem::path& folder);

/// A number in so many digits; what is none, as it is.
std::string in_short(const std::string& value, int digits);

/// The fronts for people.
std::string fronts_text(const TuningPlan& plan, const TuningResult& result, std::size_t width);

}  // namespace breakwater
