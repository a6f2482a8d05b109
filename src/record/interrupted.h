// The exception of work that was asked to stop.
#pragma once

#include <cstddef>
#include <stdexcept>

namespace breakwater {

/// Thrown by work that was asked to stop. `finished_runs` runs are complete and kept.
class Interrupted : public std::runtime_error {
 public:
  explicit Interrupted(std::size_t finished_runs = 0)
      : std::runtime_error("interrupted"), finished_runs_(finished_runs) {}

  std::size_t finished_runs() const { return finished_runs_; }

 private:
  std::size_t finished_runs_;
};

}  // namespace breakwater
