// Sensitivity indices of a study's metrics and failures.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include <breakwater/pages/study_numbers.h>
#include <breakwater/statistics/sensitivity.h>

namespace breakwater {

/// The indices of one output under one candidate.
struct OutputIndices {
  std::size_t candidate = 0;
  std::string output;  ///< a metric or kFailedOutput
  SensitivityIndices indices;
};

/// The output 1 for a failed run and 0 for another one.
inline constexpr const char* kFailedOutput = "failed";

/// sensitivity_indices() for each output and candidate, with the outputs in the order of the
/// metrics and the failures last. An output is the mean over the seeds of a metric, or the share of
/// failed seeds. It is missing for a sample if a seed has no value. There are 1000 replicates, or
/// fewer for a very large study, but at least 200.
std::vector<OutputIndices> study_indices(const StudyNumbers& numbers, std::size_t candidates);

/// Writes indices.csv with a line for each output, candidate and key. Columns: `candidate`,
/// `output`, `key`, `first_order`, `first_order_lower`, `first_order_upper`, `total`,
/// `total_lower`, `total_upper`, `rows`, `dropped_rows`. A missing value is empty. Throws
/// OutputError.
void write_indices(const std::vector<OutputIndices>& all, const StudyNumbers& numbers,
                   const std::vector<std::string>& labels, const std::filesystem::path& file);

}  // namespace breakwater
