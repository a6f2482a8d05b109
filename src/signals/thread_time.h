// How long this thread has worked: what a solver or a filter takes, whoever else is busy.
#pragma once

#include <ctime>

namespace breakwater {

/// Processor time of the calling thread [s]; other load does not count. POSIX.
inline double thread_time_s() {
  timespec now{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

}  // namespace breakwater
