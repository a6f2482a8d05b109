// The standard normal distribution. Its quantile is in distribution.h.
#pragma once

#include <breakwater/math/error_function.h>

namespace breakwater {

/// Φ(z) = erfc(−z/√2)/2, the same bits on every processor.
inline double normal_cdf(double z) {
  constexpr double kSqrtHalf = 0.70710678118654752440;
  return 0.5 * math::erfc(-kSqrtHalf * z);
}

}  // namespace breakwater
