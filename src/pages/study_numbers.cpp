#include <breakwater/pages/study_numbers.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <string_view>
#include <unordered_map>
#include <utility>

#include <breakwater/statistics/quantile.h>

namespace breakwater {
namespace {

constexpr Eigen::Index kDraws = 4'000'000;  // drawn rows for the intervals of one output

// The mean of an output over the seeds, a row of the design per row; NaN if a seed has no value.
Eigen::MatrixXd design(const StudyNumbers& numbers, std::size_t candidate,
                       const std::vector<double>& output) {
  const auto rows = static_cast<Eigen::Index>(numbers.blocks);
  const auto columns = static_cast<Eigen::Index>(numbers.keys.size()) + 2;
  Eigen::MatrixXd sum = Eigen::MatrixXd::Zero(rows, columns);
  Eigen::MatrixXd seeds = Eigen::MatrixXd::Zero(rows, columns);
  for (std::size_t i = 0; i < numbers.runs.size(); ++i) {
    const StudyRun& run = numbers.runs[i];
    if (run.candidate != candidate) continue;
    sum(run.block, run.in_block) += output[i];
    seeds(run.block, run.in_block) += 1.0;
  }
  return sum.cwiseQuotient(seeds);  // 0/0: no runs
}

constexpr std::size_t kPointsOfAKind = 5;  // points named per kind of failures

// "at 3.1 s: diverged" and "at 4 s: diverged" are one kind.
std::string without_numbers(std::string reason) {
  constexpr std::string_view kOfNumbers = "0123456789.e+-";
  std::erase_if(reason, [&](char c) { return kOfNumbers.find(c) != std::string_view::npos; });
  return reason;
}

}  // namespace

StudyNumbers study_numbers(const Plan& plan, const ShardIndex& index,
                           const std::vector<std::string>& first) {
  StudyNumbers numbers;
  numbers.keys = study_keys(plan.study());
  const std::size_t candidates = plan.candidates().size();
  const std::size_t points_of_a_sample = candidates * plan.seeds();
  for (std::size_t sample = 0; sample < plan.samples(); ++sample) {
    const StudyPoint point = plan.point(sample * points_of_a_sample);
    for (std::size_t k = 0; k < numbers.keys.size(); ++k) {
      numbers.keys[k].values.push_back(key_number(numbers.keys[k], point.values[k]));
    }
  }
  const std::size_t block_size =
      plan.study().method == Method::saltelli ? numbers.keys.size() + 2 : 1;

  std::map<std::pair<PointStatus, std::string>, FailureKind> failures;
  std::vector<std::string> metrics = first;
  std::vector<std::vector<double>> columns(first.size());
  std::unordered_map<std::string, std::size_t> column_of;
  for (std::size_t i = 0; i < metrics.size(); ++i) column_of.emplace(metrics[i], i);

  for (std::size_t number = 0; number < index.points(); ++number) {
    if (!index.has(number)) continue;
    const PointResult result = index.read(number);
    const std::size_t sample = number / points_of_a_sample;
    StudyRun run;
    run.number = number;
    run.sample = static_cast<std::uint32_t>(sample);
    run.block = static_cast<std::uint32_t>(sample / block_size);
    run.in_block = static_cast<std::uint32_t>(sample % block_size);
    run.candidate = static_cast<std::uint32_t>(number % candidates);
    run.failed = result.status != PointStatus::complete;
    if (run.failed) {
      FailureKind& kind = failures[{result.status, without_numbers(result.reason)}];
      if (kind.runs++ == 0) {
        kind.status = result.status;
        kind.reason = result.reason;
        kind.of_candidate.resize(candidates);
      }
      ++kind.of_candidate[run.candidate];
      if (kind.first.size() < kPointsOfAKind) kind.first.push_back(number);
    }
    numbers.blocks = run.block + 1;  // points ascend
    numbers.runs.push_back(run);
    for (const auto& [name, value] : result.metrics) {
      const auto [found, is_new] = column_of.emplace(name, metrics.size());
      if (is_new) {
        metrics.push_back(name);
        columns.emplace_back();
      }
      std::vector<double>& column = columns[found->second];
      column.resize(numbers.runs.size(), std::numeric_limits<double>::quiet_NaN());
      column.back() = value;
    }
  }

  for (std::size_t i = 0; i < metrics.size(); ++i) {
    if (columns[i].empty()) continue;  // a metric of `first` that no run has
    columns[i].resize(numbers.runs.size(), std::numeric_limits<double>::quiet_NaN());
    numbers.metrics.push_back(metrics[i]);
    numbers.columns.push_back(std::move(columns[i]));
  }
  for (const auto& [name, kind] : failures) numbers.failures.push_back(kind);
  std::stable_sort(numbers.failures.begin(), numbers.failures.end(),
                   [](const auto& a, const auto& b) { return a.runs > b.runs; });
  return numbers;
}

std::vector<QuantileBand> bands(const StudyNumbers& numbers, const std::vector<double>& column,
                                std::size_t groups,
                                const std::function<std::size_t(const StudyRun&)>& group_of) {
  std::vector<QuantileBand> all(groups);
  std::vector<std::vector<std::pair<double, std::size_t>>> of_group(groups);  // values and points
  for (std::size_t i = 0; i < numbers.runs.size(); ++i) {
    const StudyRun& run = numbers.runs[i];
    const std::size_t group = group_of(run);
    QuantileBand& band = all[group];
    ++band.runs;
    if (run.failed && band.failed++ == 0) band.first_failed = run.number;
    if (std::isfinite(column[i])) of_group[group].emplace_back(column[i], run.number);
  }
  std::vector<double> sorted;
  for (std::size_t g = 0; g < groups; ++g) {
    auto& members = of_group[g];
    if (members.empty()) continue;
    std::sort(members.begin(), members.end());
    sorted.clear();
    for (const auto& [value, point] : members) sorted.push_back(value);
    QuantileBand& band = all[g];
    band.measured = members.size();
    band.q10 = quantile(sorted, 0.1);
    band.q25 = quantile(sorted, 0.25);
    band.median = quantile(sorted, 0.5);
    band.q75 = quantile(sorted, 0.75);
    band.q90 = quantile(sorted, 0.9);
    band.smallest = sorted.front();
    band.largest = sorted.back();
    band.at_smallest = members.front().second;
    band.at_middle = members[(members.size() - 1) / 2].second;
    band.at_largest = members.back().second;
  }
  return all;
}

std::vector<ResultRow> study_indices(const StudyNumbers& numbers,
                                     const std::vector<std::string>& labels) {
  BootstrapSettings bootstrap;
  const auto rows_of_design = std::max<Eigen::Index>(1, static_cast<Eigen::Index>(numbers.blocks));
  bootstrap.replicates =
      static_cast<int>(std::clamp<Eigen::Index>(kDraws / rows_of_design, 200, 1000));
  std::vector<ResultRow> rows;
  const auto add = [&](const std::string& output, const std::vector<double>& values) {
    for (std::size_t c = 0; c < labels.size(); ++c) {
      const SensitivityIndices indices = sensitivity_indices(design(numbers, c, values), bootstrap);
      for (std::size_t k = 0; k < numbers.keys.size(); ++k) {
        ResultRow& row = rows.emplace_back();
        row.put("candidate", labels[c]);
        row.put("output", output);
        row.put("key", numbers.keys[k].name);
        const auto put = [&](const char* column, const std::vector<EstimatedValue>& of_keys) {
          row.put(column, k < of_keys.size() ? of_keys[k] : EstimatedValue{std::nan("")});
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
