// Decimation of series for charts.
#pragma once

#include <cstddef>

#include <breakwater/record/series.h>

namespace breakwater {

/// The part of a series from `from_s` to `to_s`, both included.
Series cut(const Series& series, double from_s, double to_s);

/// Reduces a series for drawing. Each of `buckets` equal parts keeps its smallest and largest value
/// with their times, so no peak moves or disappears. The first and last sample stay. A constant
/// stretch keeps only its ends.
Series decimate(const Series& series, std::size_t buckets);

}  // namespace breakwater
