// Checks of a constructor's arguments.
#pragma once

#include <cmath>
#include <stdexcept>

namespace breakwater {

inline bool is_positive(double value) {
  return std::isfinite(value) && value > 0.0;
}

inline bool is_not_negative(double value) {
  return std::isfinite(value) && value >= 0.0;
}

/// Throws std::invalid_argument `what` unless the condition holds.
inline void refuse_unless(bool holds, const char* what) {
  if (!holds) throw std::invalid_argument(what);
}

}  // namespace breakwater
