#include <breakwater/pages/decimation.h>

#include <algorithm>
#include <cmath>

namespace breakwater {
namespace {

void append(Series& to, const Series& from, std::size_t i) {
  to.times_s.push_back(from.times_s[i]);
  to.values.push_back(from.values[i]);
}

// Drops the samples that equal both their neighbours.
Series without_repetition(const Series& series) {
  Series kept;
  const std::vector<double>& v = series.values;
  for (std::size_t i = 0; i < v.size(); ++i) {
    const bool is_inside = i > 0 && i + 1 < v.size();
    if (!is_inside || v[i] != v[i - 1] || v[i] != v[i + 1]) append(kept, series, i);
  }
  return kept;
}

}  // namespace

Series cut(const Series& series, double from_s, double to_s) {
  Series part;
  for (std::size_t i = 0; i < series.times_s.size(); ++i) {
    if (series.times_s[i] >= from_s && series.times_s[i] <= to_s) append(part, series, i);
  }
  return part;
}

Series decimate(const Series& series, std::size_t buckets) {
  const std::size_t size = series.values.size();
  if (size <= 2 * buckets) return without_repetition(series);
  Series kept;
  append(kept, series, 0);
  for (std::size_t bucket = 0; bucket < buckets; ++bucket) {
    const auto begin = series.values.begin() + static_cast<std::ptrdiff_t>(bucket * size / buckets);
    const auto end =
        series.values.begin() + static_cast<std::ptrdiff_t>((bucket + 1) * size / buckets);
    // A value that is not finite is a gap, not an extreme.
    const auto finite = std::find_if(begin, end, [](double v) { return std::isfinite(v); });
    auto smallest = finite;
    auto largest = finite;
    for (auto v = finite; v != end; ++v) {
      if (*v < *smallest) smallest = v;
      if (*v > *largest) largest = v;
    }
    if (finite == end) smallest = largest = begin;
    for (const auto& extreme : {std::min(smallest, largest), std::max(smallest, largest)}) {
      const auto i = static_cast<std::size_t>(extreme - series.values.begin());
      if (series.times_s[i] > kept.times_s.back()) append(kept, series, i);
    }
  }
  if (kept.times_s.back() < series.times_s.back()) append(kept, series, size - 1);
  return without_repetition(kept);
}

}  // namespace breakwater
