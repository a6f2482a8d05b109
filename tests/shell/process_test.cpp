// Signals to work that ignores them.
#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <csignal>
#include <thread>

#include <breakwater/shell/process.h>

namespace breakwater {
namespace {
using namespace std::chrono_literals;

std::atomic<bool> is_compiling = false;

// For a child process. A signal comes while the work ignores signals or not; the work then ignores
// them until it is ended, or hears them for three seconds. The process exits with 0 if these end.
void work(bool is_deaf_before, bool is_deaf_after) {
  end_soon_while([] { return is_compiling.load(); });
  stop_on_signals();
  is_compiling = is_deaf_before;
  std::raise(SIGTERM);
  is_compiling = is_deaf_after;
  while (is_compiling) std::this_thread::sleep_for(1s);
  std::this_thread::sleep_for(3s);
  std::exit(interrupted() ? 0 : 1);
}

TEST(Process, ASignalEndsWorkThatIgnoresIt) {
  struct Row {
    bool is_deaf_before, is_deaf_after;
    int status;
    const char* said;
  };
  for (const Row& row : {Row{true, true, kInterrupted, "interrupted while a model was compiled"},
                         Row{false, true, kInterrupted, "interrupted while a model was compiled"},
                         Row{true, false, 0, ""}, Row{false, false, 0, ""}}) {
    EXPECT_EXIT(work(row.is_deaf_before, row.is_deaf_after), ::testing::ExitedWithCode(row.status),
                row.said)
        << row.is_deaf_before << row.is_deaf_after;
  }
}

}  // namespace
}  // namespace breakwater
