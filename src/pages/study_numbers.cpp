#include <breakwater/pages/study_numbers.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

#include <breakwater/statistics/quantile.h>

namespace breakwater {
namespace {

constexpr Eigen::Index kDraws = 4'000'000;  // drawn rows for the intervals of one output

// The mean of an output over the seeds, a row of the design per row; NaN if a seed has no value.
Eigen::MatrixXd design(const StudyNumbers& numbers, Eigen::Index rows, std::size_t candidate,
                       const std::vector<double>& output) {
  const auto columns = static_cast<Eigen::Index>(numbers.keys.size()) + 2;  // A, AB⁽¹⁾ … B
  Eigen::MatrixXd sum = Eigen::MatrixXd::Zero(rows, columns);
  Eigen::MatrixXd seeds = Eigen::MatrixXd::Zero(rows, columns);
  for (std::size_t i = 0; i < numbers.runs.size(); ++i) {
    const StudyRun& run = numbers.runs[i];
    if (run.candidate != candidate) continue;
    sum(run.sample / columns, run.sample % columns) += output[i];
    seeds(run.sample / columns, run.sample % columns) += 1.0;
  }
  return sum.cwiseQuotient(seeds);  // 0/0: no runs
}

}  // namespace

void put_first(const std::vector<std::string>& first, StudyNumbers& numbers) {
  std::vector<std::size_t> order(numbers.metrics.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::ranges::stable_sort(order, std::ranges::less(), [&](std::size_t metric) {
    return std::ranges::find(first, numbers.metrics[metric]) - first.begin();
  });
  std::vector<std::string> metrics;
  std::vector<std::vector<double>> columns;
  for (const std::size_t metric : order) {
    metrics.push_back(std::move(numbers.metrics[metric]));
    columns.push_back(std::move(numbers.columns[metric]));
  }
  numbers.metrics = std::move(metrics);
  numbers.columns = std::move(columns);
}

double RunGroup::at(double share) const {
  return values.empty() ? std::nan("") : quantile(values, share);
}

std::vector<RunGroup> grouped(const StudyNumbers& numbers, const std::vector<double>& column,
                              std::size_t groups,
                              const std::function<std::size_t(const StudyRun&)>& group_of) {
  std::vector<RunGroup> all(groups);
  std::vector<std::vector<std::pair<double, std::size_t>>> members(groups);  // values and points
  for (std::size_t i = 0; i < numbers.runs.size(); ++i) {
    const StudyRun& run = numbers.runs[i];
    const std::size_t g = group_of(run);
    RunGroup& group = all[g];
    ++group.runs;
    if (run.failed && group.failed++ == 0) group.first_failed = run.number;
    if (std::isfinite(column[i])) members[g].emplace_back(column[i], run.number);
  }
  for (std::size_t g = 0; g < groups; ++g) {
    std::sort(members[g].begin(), members[g].end());
    for (const auto& [value, point] : members[g]) {
      all[g].values.push_back(value);
      all[g].points.push_back(point);
    }
  }
  return all;
}

std::vector<ResultRow> study_indices(const StudyNumbers& numbers,
                                     const std::vector<std::string>& labels) {
  BootstrapSettings bootstrap;
  const auto rows_of_design =
      static_cast<Eigen::Index>(numbers.keys.front().values.size() / (numbers.keys.size() + 2));
  bootstrap.replicates =
      static_cast<int>(std::clamp<Eigen::Index>(kDraws / rows_of_design, 200, 1000));
  std::vector<ResultRow> rows;
  const auto add = [&](const std::string& output, const std::vector<double>& values) {
    for (std::size_t c = 0; c < labels.size(); ++c) {
      const SensitivityIndices indices =
          sensitivity_indices(design(numbers, rows_of_design, c, values), bootstrap);
      for (std::size_t k = 0; k < numbers.keys.size(); ++k) {
        ResultRow& row = rows.emplace_back();
        row.put("candidate", labels[c]);
        row.put("output", output);
        row.put("key", numbers.keys[k].name);
        const auto put = [&](const char* column, const std::vector<EstimatedValue>& of_keys) {
          row.put(column, k < of_keys.size() ? of_keys[k] : EstimatedValue{});
        };
        put("first_order", indices.first_order);
        put("total", indices.total);
        row.put("rows", std::to_string(indices.rows));
        row.put("dropped_rows", std::to_string(indices.dropped_rows));
      }
    }
  };
  for (std::size_t m = 0; m < numbers.metrics.size(); ++m) {
    add(numbers.metrics[m], numbers.columns[m]);
  }
  std::vector<double> failed;
  for (const StudyRun& run : numbers.runs) failed.push_back(run.failed ? 1.0 : 0.0);
  add(kFailedOutput, failed);
  return rows;
}

}  // namespace breakwater
