// The check of a constructor's arguments.
#pragma once

#include <stdexcept>

namespace breakwater {

/// Throws std::invalid_argument `what` unless the condition holds.
inline void refuse_unless(bool holds, const char* what) {
  if (!holds) throw std::invalid_argument(what);
}

}  // namespace breakwater
