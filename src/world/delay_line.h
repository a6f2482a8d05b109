// A delay of a whole number of samples.
#pragma once

#include <cstddef>
#include <stdexcept>
#include <vector>

namespace breakwater {

/// Returns the input of `samples` calls ago, or the first input before that.
class DelayLine {
 public:
  /// Throws std::invalid_argument if `samples` is negative.
  explicit DelayLine(int samples) {
    if (samples < 0) throw std::invalid_argument("delay: must be 0 samples or more");
    values_.resize(static_cast<std::size_t>(samples) + 1);
  }

  double update(double value) {
    if (!is_filled_) values_.assign(values_.size(), value);
    is_filled_ = true;
    values_[newest_] = value;
    newest_ = (newest_ + 1) % values_.size();
    return values_[newest_];  // the oldest value
  }

 private:
  std::vector<double> values_;
  std::size_t newest_ = 0;
  bool is_filled_ = false;
};

}  // namespace breakwater
