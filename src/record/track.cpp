#include <breakwater/record/track.h>

#include <algorithm>
#include <stdexcept>
#include <string_view>
#include <utility>

#include <breakwater/record/log_stream.h>
#include <breakwater/record/text_outputs.h>

namespace breakwater {
namespace {

constexpr const char* kIndex = "index_";

// A signal with the name of another part of the log would be lost.
bool can_be_logged(const std::string& name) {
  return is_column_name(name) && name != "time_s" && !is_index_name(name);
}

void check_names(const std::string& track, const std::vector<Signal>& signals) {
  if (!can_be_logged(track)) {
    throw std::invalid_argument("a track cannot be named \"" + track + "\" in a log");
  }
  for (std::size_t i = 0; i < signals.size(); ++i) {
    const Signal& signal = signals[i];
    const std::string which = "(" + signal.description + ")";
    if (!can_be_logged(signal.name)) {
      throw std::invalid_argument("track " + track + ": a signal cannot be named \"" + signal.name +
                                  "\" in a log " + which);
    }
    if (signal.values.empty()) {
      throw std::invalid_argument(track + "/" + signal.name + ": the signal has no values " +
                                  which);
    }
    for (std::size_t k = 0; k < i; ++k) {
      if (signals[k].name != signal.name) continue;
      throw std::invalid_argument(track + "/" + signal.name + ": two signals have this name (" +
                                  signals[k].description + ") " + which);
    }
  }
}

}  // namespace

bool is_index_name(const std::string& name) {
  const std::string_view digits = "0123456789";
  const std::size_t begin = std::string_view(kIndex).size();
  return name.starts_with(kIndex) && name.size() > begin &&
         name.find_first_not_of(digits, begin) == std::string::npos;
}

Track::Track(std::string name, std::vector<Signal> signals, std::size_t expected_rows,
             LogStream* stream)
    : name_(std::move(name)), signals_(std::move(signals)), stream_(stream) {
  check_names(name_, signals_);
  for (const Signal& signal : signals_) {
    offsets_.push_back(width_);
    width_ += signal.values.size();
  }
  if (stream_ != nullptr) {
    place_ = stream_->add(name_, signals_, expected_rows);
    return;
  }
  try {
    rows_.reserve(expected_rows * width_);
  } catch (const std::bad_alloc&) {
    throw LogTooLong();
  } catch (const std::length_error&) {
    throw LogTooLong();
  }
}

void Track::append(double time_s) {
  ++row_count_;
  if (stream_ != nullptr) {
    stream_->append(place_, time_s);
    return;
  }
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
