#include <breakwater/scenario/all_cores.h>

#include <algorithm>
#include <atomic>
#include <exception>
#include <mutex>
#include <thread>
#include <vector>

namespace breakwater {

void on_all_cores(std::size_t count, const std::function<void(std::size_t)>& work) {
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
    const std::size_t cores = std::max(1U, std::thread::hardware_concurrency());
    std::vector<std::jthread> threads;
    for (std::size_t i = 1; i < std::min(cores, count); ++i) threads.emplace_back(take_pieces);
    take_pieces();
  }
  if (error) std::rethrow_exception(error);
}

}  // namespace breakwater
