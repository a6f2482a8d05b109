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
  std::string output;  ///< a metric; kFailedOutput
  SensitivityIndices indices;
};

/// Whether a run failed, as an output: 1 or 0.
inline constexpr const char* kFailedOutput = "failed";

/// sensitivity_indices() of the mean over seeds of each metric, and of the share of seeds that
/// failed, for each candidate: outputs in the metrics' order, the failures last, candidates in
/// each. Of a sample of which a seed has no value the mean is missing. There are 1000 replicates,
/// of very large studies fewer, but at least 200.
std::vector<OutputIndices> study_indices(const StudyNumbers& numbers, std::size_t candidates);

/// indices.csv: `candidate`, `output`, `key`, `first_order`, `first_order_lower`,
/// `first_order_upper`, `total`, `total_lower`, `total_upper`, `rows`, `dropped_rows`, a line for
/// each output, candidate and key. What there is not is empty. Throws OutputError.
void write_indices(const std::vector<OutputIndices>& all, const StudyNumbers& numbers,
                   const std::vector<std::string>& labels, const std::filesystem::path& file);

}  // namespace breakwater
