#include <breakwater/pages/study_indices.h>

#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <optional>

#include <breakwater/record/csv.h>
#include <breakwater/record/partial_file.h>

namespace breakwater {
namespace {

constexpr Eigen::Index kDraws = 4'000'000;  // drawn rows for the intervals of one output

// The mean of a quantity over the seeds, a row of the design per row; NaN if a seed has no value.
template <typename Quantity>
Eigen::MatrixXd design(const StudyNumbers& numbers, std::size_t candidate, Quantity quantity) {
  const auto rows = static_cast<Eigen::Index>(numbers.blocks);
  const auto columns = static_cast<Eigen::Index>(numbers.keys.size()) + 2;
  Eigen::MatrixXd sum = Eigen::MatrixXd::Zero(rows, columns);
  Eigen::MatrixXd seeds = Eigen::MatrixXd::Zero(rows, columns);
  for (std::size_t i = 0; i < numbers.runs.size(); ++i) {
    const StudyRun& run = numbers.runs[i];
    if (run.candidate != candidate) continue;
    sum(run.block, run.in_block) += quantity(i);
    seeds(run.block, run.in_block) += 1.0;
  }
  return sum.cwiseQuotient(seeds);  // 0/0: no runs
}

}  // namespace

std::vector<OutputIndices> study_indices(const StudyNumbers& numbers, std::size_t candidates) {
  BootstrapSettings bootstrap;
  const auto rows = std::max<Eigen::Index>(1, static_cast<Eigen::Index>(numbers.blocks));
  bootstrap.replicates = static_cast<int>(std::clamp<Eigen::Index>(kDraws / rows, 200, 1000));
  std::vector<OutputIndices> all;
  for (std::size_t m = 0; m <= numbers.metrics.size(); ++m) {
    for (std::size_t c = 0; c < candidates; ++c) {
      const bool is_failed = m == numbers.metrics.size();
      const Eigen::MatrixXd f = design(numbers, c, [&](std::size_t i) {
        return is_failed ? static_cast<double>(numbers.runs[i].failed) : numbers.columns[m][i];
      });
      all.push_back(
          {c, is_failed ? kFailedOutput : numbers.metrics[m], sensitivity_indices(f, bootstrap)});
    }
  }
  return all;
}

void write_indices(const std::vector<OutputIndices>& all, const StudyNumbers& numbers,
                   const std::vector<std::string>& labels, const std::filesystem::path& file) {
  std::string text = csv_line({"candidate", "output", "key", "first_order", "first_order_lower",
                               "first_order_upper", "total", "total_lower", "total_upper", "rows",
                               "dropped_rows"});
  const auto add = [](std::vector<std::string>& cells, const std::vector<SensitivityIndex>& indices,
                      std::size_t k) {
    const bool is_there = k < indices.size();
    const bool has_interval = is_there && indices[k].interval;
    cells.push_back(is_there ? fmt::format("{:.17g}", indices[k].value) : "");
    cells.push_back(has_interval ? fmt::format("{:.17g}", indices[k].interval->lower) : "");
    cells.push_back(has_interval ? fmt::format("{:.17g}", indices[k].interval->upper) : "");
  };
  for (const OutputIndices& one : all) {
    for (std::size_t k = 0; k < numbers.keys.size(); ++k) {
      std::vector<std::string> cells = {labels[one.candidate], one.output, numbers.keys[k].name};
      add(cells, one.indices.first_order, k);
      add(cells, one.indices.total, k);
      cells.push_back(std::to_string(one.indices.rows));
      cells.push_back(std::to_string(one.indices.dropped_rows));
      text += csv_line(cells);
    }
  }
  replace_file(file, text);
}

}  // namespace breakwater
