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
constexpr std::size_t kStreamedBytes = 1 << 20;  // for the times in memory, and for the values

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

Track::Track(std::string name, std::vector<Signal> signals, std::size_t room, LogStream* stream)
    : name_(std::move(name)), signals_(std::move(signals)), room_(room), stream_(stream) {
  check_names(name_, signals_);
  std::size_t width = 0;
  for (const Signal& signal : signals_) {
    offsets_.push_back(width);
    width += signal.values.size();
  }
  const auto rows_of_width = [&](std::size_t values) {
    const std::size_t streamed = kStreamedBytes / (values * sizeof(double));
    return stream == nullptr ? room : std::min(room, std::max<std::size_t>(1, streamed));
  };
  const std::size_t times = rows_of_width(1), capacity = rows_of_width(1 + width);
  try {
    // Without values, so that memory is taken row by row.
    rows_ = std::make_shared<Rows>(Rows{std::make_unique_for_overwrite<double[]>(times),
                                        std::make_unique_for_overwrite<double[]>(capacity * width),
                                        times, capacity});
  } catch (const std::bad_alloc&) {
    throw LogTooLong();
  }
  if (stream_ != nullptr) stream_->add(*this);
}

void Track::append(double time_s) {
  if (rows() == room_) throw std::logic_error("track " + name_ + " has more rows than expected");
  if (stream_ != nullptr) stream_->begin();
  rows_->times[rows_->untimed++] = time_s;
  for (std::size_t i = 0; i < signals_.size(); ++i) {
    const std::span<const double> values = signals_[i].values;
    std::copy_n(values.data(), values.size(), buffer(i, rows_->buffered));
  }
  ++rows_->buffered;
  if (stream_ != nullptr) stream_->write_full(*this);
}

std::span<const double> Track::values(std::size_t signal) const {
  return {buffer(signal, 0), rows() * signals_[signal].values.size()};
}

std::vector<double> Track::values(const std::string& signal) const {
  const auto found = std::ranges::find(signals_, signal, &Signal::name);
  if (found == signals_.end()) throw std::out_of_range("track " + name_ + " has no " + signal);
  const auto all = values(static_cast<std::size_t>(found - signals_.begin()));
  return {all.begin(), all.end()};
}

}  // namespace breakwater
