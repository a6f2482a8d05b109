// Processor time of a thread, for the cost of solvers and filters.
#pragma once

#include <ctime>

namespace breakwater {

/// Processor time of the calling thread [s], independent of other load. POSIX.
inline double thread_time_s() {
  timespec now{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

}  // namespace breakwater
