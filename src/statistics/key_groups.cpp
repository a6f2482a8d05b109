#include <breakwater/statistics/key_groups.h>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include <breakwater/statistics/distribution.h>

namespace breakwater {
namespace {

// Whether positive numbers over nearly a decade or more have a median nearer to the geometric mean
// of their ends than to the arithmetic one.
bool is_better_in_log(const std::vector<double>& sorted) {
  const double low = sorted.front(), high = sorted.back();
  return low > 0.0 && high >= 8.0 * low &&
         2.0 * quantile(sorted, 0.5) < std::sqrt(low) * std::sqrt(high) + 0.5 * (low + high);
}

using NumberText = std::string (*)(double);

// The shortest format that separates all values: four digits, or all digits of a number with few.
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

}  // namespace breakwater
