// Progress on a terminal.
#pragma once

#include <chrono>
#include <cstddef>
#include <mutex>
#include <string>
#include <vector>

namespace breakwater {

/// One line on stderr, rewritten in place: the finished part of some jobs and the remaining time.
/// A line every half minute if stderr is not a terminal. Thread-safe.
class Progress {
 public:
  /// The jobs take times in proportion to `weights`.
  Progress(std::string what, std::vector<double> weights, bool quiet);
  ~Progress();
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;

  void update(std::size_t job, double fraction_done);
  void finish(std::size_t job) { update(job, 1.0); }

 private:
  void draw();

  std::string what_;
  std::vector<double> weights_;
  std::vector<double> done_;
  bool visible_;
  bool in_place_;
  std::chrono::steady_clock::time_point start_;
  std::chrono::steady_clock::time_point drawn_;
  std::mutex mutex_;
};

/// The width of tables: that of the terminal on stdout, otherwise COLUMNS or 80.
std::size_t output_width();

}  // namespace breakwater
