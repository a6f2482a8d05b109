#include <breakwater/report/quantile_bands.h>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include <breakwater/math/functions.h>
#include <breakwater/study/quantile.h>

namespace breakwater {
namespace {

// The largest gap between neighbours as a share of the range: 1/(n − 1) if they are spread evenly.
template <typename Scale>
double largest_gap(const std::vector<double>& sorted, Scale scale) {
  double largest = 0.0;
  for (std::size_t i = 1; i < sorted.size(); ++i) {
    largest = std::max(largest, scale(sorted[i]) - scale(sorted[i - 1]));
  }
  return largest / (scale(sorted.back()) - scale(sorted.front()));
}

// Whether positive numbers over nearly a decade or more are more even in their logarithms.
bool is_better_in_log(const std::vector<double>& sorted) {
  if (sorted.size() < 3 || sorted.front() <= 0.0 || sorted.back() < 8.0 * sorted.front()) {
    return false;
  }
  const auto log = [](double x) { return math::log(x); };
  const auto same = [](double x) { return x; };
  return largest_gap(sorted, log) < largest_gap(sorted, same);
}

using NumberText = std::string (*)(double);

// As short as it may be while all are told apart: four digits, or all of a number that has few.
NumberText shortest(const std::vector<double>& distinct) {
  constexpr NumberText kFew = [](double value) {
    const std::string all = fmt::format("{:.6g}", value);
    const bool has_few = std::abs(std::stod(all) - value) <= 1e-12 * std::abs(value);
    return has_few ? all : fmt::format("{:.4g}", value);
  };
  constexpr NumberText kMany = [](double value) { return fmt::format("{:.10g}", value); };
  for (std::size_t i = 1; i < distinct.size(); ++i) {
    if (kFew(distinct[i]) == kFew(distinct[i - 1])) return kMany;
  }
  return kFew;
}

}  // namespace

KeyGroups group_values(const StudyKey& key, std::size_t most) {
  KeyGroups groups;
  groups.name = key.name;
  groups.is_number = key.is_number;
  std::vector<double> sorted = key.values;
  std::sort(sorted.begin(), sorted.end());
  std::vector<double> distinct = sorted;
  distinct.erase(std::unique(distinct.begin(), distinct.end()), distinct.end());

  groups.is_binned = distinct.size() > most;
  // The first value of each group.
  std::vector<double> begins;
  if (distinct.size() <= most) {
    begins = distinct;
  } else {
    for (std::size_t g = 0; g < most; ++g) {
      const double begin = sorted[g * sorted.size() / most];
      if (begins.empty() || begin > begins.back()) begins.push_back(begin);
    }
  }
  const NumberText number = shortest(distinct);
  const auto text = [&](double value) {
    if (!key.is_number) return key.texts[static_cast<std::size_t>(value)];
    return groups.is_binned ? fmt::format("{:.4g}", value) : number(value);
  };
  for (std::size_t g = 0; g < begins.size(); ++g) {
    const auto begin = std::lower_bound(sorted.begin(), sorted.end(), begins[g]);
    const auto end = g + 1 < begins.size()
                         ? std::lower_bound(sorted.begin(), sorted.end(), begins[g + 1])
                         : sorted.end();
    const double last = *(end - 1);
    const std::vector<double> values(begin, end);
    groups.centre.push_back(key.is_number ? quantile(values, 0.5) : static_cast<double>(g));
    groups.labels.push_back(last == begins[g] ? text(last) : text(begins[g]) + " to " + text(last));
  }
  groups.is_log = key.is_number && is_better_in_log(groups.centre);
  groups.of_sample.reserve(key.values.size());
  for (const double value : key.values) {
    const auto after = std::upper_bound(begins.begin(), begins.end(), value);
    groups.of_sample.push_back(static_cast<std::uint16_t>(after - begins.begin() - 1));
  }
  return groups;
}

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
  std::vector<std::vector<std::uint32_t>> of_group(groups);  // in order of their values
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
