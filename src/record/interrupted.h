// Work that was asked to stop.
#pragma once

#include <stdexcept>
#include <string>

namespace breakwater {

/// Thrown by work that was asked to stop. `kept` ends the message: "; what is kept" of a run that
/// was cut. Complete runs are always kept.
class Interrupted : public std::runtime_error {
 public:
  explicit Interrupted(const std::string& kept = "") : std::runtime_error("interrupted" + kept) {}
};

}  // namespace breakwater
