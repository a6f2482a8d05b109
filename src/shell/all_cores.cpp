#include <breakwater/shell/all_cores.h>

#include <sched.h>

#include <algorithm>
#include <atomic>
#include <exception>
#include <mutex>
#include <system_error>
#include <thread>
#include <vector>

namespace breakwater {

std::size_t usable_cores() {
  cpu_set_t set;
  if (sched_getaffinity(0, sizeof set, &set) == 0) {
    return static_cast<std::size_t>(std::max(1, CPU_COUNT(&set)));
  }
  return std::max(1U, std::thread::hardware_concurrency());
}

void on_all_cores(std::size_t count, const std::function<void(std::size_t)>& work,
                  std::size_t threads) {
  std::atomic<std::size_t> next = 0;
  std::atomic<bool> give_up = false;
  std::exception_ptr error;
  std::mutex error_mutex;
  const auto take_pieces = [&] {
    for (std::size_t i = next++; i < count && !give_up; i = next++) {
      try {
        work(i);
      } catch (...) {
        const std::lock_guard lock(error_mutex);
        if (!error) error = std::current_exception();
        give_up = true;
      }
    }
  };
  {
    const std::size_t all = threads > 0 ? threads : usable_cores();
    std::vector<std::jthread> others;
    try {
      for (std::size_t i = 1; i < std::min(all, count); ++i) others.emplace_back(take_pieces);
    } catch (const std::system_error&) {
      // No further thread can be started: the existing ones do the work.
    }
    take_pieces();
  }
  if (error) std::rethrow_exception(error);
}

}  // namespace breakwater
