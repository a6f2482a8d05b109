#include <breakwater/pages/quantile_bands.h>

#include <algorithm>
#include <cmath>

#include <breakwater/math/functions.h>
#include <breakwater/statistics/quantile.h>

namespace breakwater {
std::vector<std::uint32_t> in_order(const std::vector<double>& column) {
  std::vector<std::uint32_t> order;
  order.reserve(column.size());
  for (std::uint32_t i = 0; i < column.size(); ++i) {
    if (std::isfinite(column[i])) order.push_back(i);
  }
  std::stable_sort(order.begin(), order.end(),
                   [&](std::uint32_t a, std::uint32_t b) { return column[a] < column[b]; });
  return order;
}

std::vector<QuantileBand> bands(const StudyNumbers& numbers, const std::vector<double>& column,
                                const std::vector<std::uint32_t>& order, std::size_t groups,
                                const std::function<std::size_t(const StudyRun&)>& group_of) {
  std::vector<QuantileBand> all(groups);
  for (const StudyRun& run : numbers.runs) {
    QuantileBand& band = all[group_of(run)];
    ++band.runs;
    if (run.failed && band.failed++ == 0) band.first_failed = run.number;
  }
  std::vector<std::vector<std::uint32_t>> of_group(groups);  // in the order of their values
  for (const std::uint32_t i : order) of_group[group_of(numbers.runs[i])].push_back(i);
  std::vector<double> sorted;
  for (std::size_t g = 0; g < groups; ++g) {
    const std::vector<std::uint32_t>& members = of_group[g];
    if (members.empty()) continue;
    sorted.clear();
    for (const std::uint32_t i : members) sorted.push_back(column[i]);
    QuantileBand& band = all[g];
    band.measured = members.size();
    band.q10 = quantile(sorted, 0.1);
    band.q25 = quantile(sorted, 0.25);
    band.median = quantile(sorted, 0.5);
    band.q75 = quantile(sorted, 0.75);
    band.q90 = quantile(sorted, 0.9);
    band.smallest = sorted.front();
    band.largest = sorted.back();
    band.at_smallest = numbers.runs[members.front()].number;
    band.at_middle = numbers.runs[members[(members.size() - 1) / 2]].number;
    band.at_largest = numbers.runs[members.back()].number;
  }
  return all;
}

}  // namespace breakwater
