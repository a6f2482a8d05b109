// Work that was asked to stop: whether it was, and its exception.
#pragma once

#include <cstddef>
#include <stdexcept>
#include <string>
#include <utility>

namespace breakwater {

/// Thrown by work that was asked to stop. `finished_runs` runs are complete and kept. `kept` says
/// what else is left behind; empty: nothing.
class Interrupted : public std::runtime_error {
 public:
  explicit Interrupted(std::size_t finished_runs = 0, std::string kept = "")
      : std::runtime_error("interrupted"), finished_runs_(finished_runs), kept_(std::move(kept)) {}

  std::size_t finished_runs() const { return finished_runs_; }
  const std::string& kept() const { return kept_; }

 private:
  std::size_t finished_runs_;
  std::string kept_;
};

}  // namespace breakwater
