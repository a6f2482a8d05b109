// Progress on a terminal.
#pragma once

#include <chrono>
#include <cstddef>
#include <mutex>
#include <string>
#include <vector>

namespace breakwater {

/// One line on stderr, rewritten in place: how much of some jobs is done, and how long it still
/// takes. Silent unless stderr is a terminal. Thread-safe.
class Progress {
 public:
  Progress(std::string what, std::size_t jobs, bool quiet);
  /// Jobs that take unequally long, in proportion to `weights`. Unless quiet, it speaks on what is
  /// no terminal too: a line every half minute.
  Progress(std::string what, std::vector<double> weights, bool quiet);
  ~Progress();
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;

  void update(std::size_t job, double fraction_done);
  void finish(std::size_t job) { update(job, 1.0); }
  /// What stands behind the line from now on, as far as the terminal is wide enough.
  void note(std::string text);
  /// Whether anybody sees it: a note is worth making.
  bool is_seen() const { return visible_ && in_place_; }

 private:
  void draw();
  void clear() const;

  std::string what_;
  std::vector<double> weights_;
  std::vector<double> done_;
  bool visible_;
  bool in_place_ = true;
  std::chrono::steady_clock::time_point start_;
  std::chrono::steady_clock::time_point drawn_;
  std::string note_;
  std::mutex mutex_;
};

/// How wide tables may be: the terminal on stdout; else COLUMNS, or 80.
std::size_t output_width();

}  // namespace breakwater
