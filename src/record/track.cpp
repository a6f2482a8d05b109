#include "record/track.h"

#include <algorithm>
#include <stdexcept>
#include <utility>

namespace breakwater {

Track::Track(std::string name, std::vector<Signal> signals, std::size_t expected_rows)
    : name_(std::move(name)), signals_(std::move(signals)) {
  for (const Signal& signal : signals_) {
    offsets_.push_back(width_);
    width_ += signal.values.size();
  }
  rows_.reserve(expected_rows * width_);
}

void Track::append(double time_s) {
  rows_.push_back(time_s);
  for (const Signal& signal : signals_) {
    rows_.insert(rows_.end(), signal.values.begin(), signal.values.end());
  }
}

std::vector<double> Track::times() const {
  return columns(0, 1);
}

std::vector<double> Track::values(std::size_t signal) const {
  return columns(offsets_[signal], signals_[signal].values.size());
}

std::vector<double> Track::values(const std::string& signal) const {
  const auto found = std::find_if(signals_.begin(), signals_.end(),
                                  [&](const Signal& s) { return s.name == signal; });
  if (found == signals_.end()) throw std::out_of_range("track " + name_ + " has no " + signal);
  return values(static_cast<std::size_t>(found - signals_.begin()));
}

std::vector<double> Track::columns(std::size_t first, std::size_t count) const {
  std::vector<double> values;
  values.reserve(rows() * count);
  for (std::size_t i = 0; i < rows(); ++i) {
    const auto begin = rows_.begin() + static_cast<std::ptrdiff_t>(i * width_ + first);
    values.insert(values.end(), begin, begin + static_cast<std::ptrdiff_t>(count));
  }
  return values;
}

}  // namespace breakwater
