// Whether work that waits should stop.
#pragma once

#include <atomic>

namespace breakwater {

/// Asked where a signal breaks off a wait: true ends the work with Interrupted, false waits again.
/// A program or the Python module sets it; null never stops. The handler of the signal has run.
inline std::atomic<bool (*)()> stop_asked = nullptr;

}  // namespace breakwater
