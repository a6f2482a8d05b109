// Fewer points, the same picture.
#pragma once

#include <cstddef>

#include <breakwater/record/series.h>

namespace breakwater {

/// The part of a series from `from_s` to `to_s`, both included.
Series cut(const Series& series, double from_s, double to_s);

/// At most two points for each of `buckets` equal numbers of samples: the smallest and the largest
/// value there, each at its own time, and the first and last sample of all. So no peak is lost,
/// and none is moved. Of values that stay the same, only the ends are kept.
Series decimate(const Series& series, std::size_t buckets);

}  // namespace breakwater
