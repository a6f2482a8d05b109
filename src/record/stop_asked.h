// Whether work that waits should stop.
#pragma once

#include <atomic>

namespace breakwater {

/// Called when a signal interrupts a wait: true stops the work with Interrupted, false goes on
/// waiting. A program or the Python module sets it. Null never stops. The handler has run before.
inline std::atomic<bool (*)()> stop_asked = nullptr;

}  // namespace breakwater
