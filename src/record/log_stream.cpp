#include <breakwater/record/log_stream.h>

#include <fcntl.h>

#include <algorithm>
#include <fstream>
#include <limits>
#include <stdexcept>
#include <utility>

#include <breakwater/record/partial_file.h>
#include <breakwater/record/run_folder.h>
#include <breakwater/record/text_outputs.h>

namespace breakwater {
namespace fs = std::filesystem;
using detail::DataFile;

namespace {

constexpr const char* kLog = "log.h5";
constexpr std::size_t kBufferBytes = 1 << 20;  // for a track's times, and for its values
constexpr std::chrono::milliseconds kBetweenWrites(500);

bool same_dataset(const LogEntry& a, const LogEntry& b) {
  return a.group == b.group && a.name == b.name && a.rows == b.rows && a.width == b.width;
}

// The number of rows, at most `room`, that fit into a buffer.
std::size_t rows_of_buffer(std::size_t width, std::size_t room) {
  return std::clamp<std::size_t>(kBufferBytes / (width * sizeof(double)), 1, room);
}

}  // namespace

struct LogStream::Streamed {
  std::string name;
  std::vector<Signal> signals;
  std::size_t room = 0;             // rows
  std::size_t first_dataset = 0;    // the time base
  std::vector<double> times = {};   // for the rows without one in the file
  std::size_t untimed = 0;          // their number
  std::vector<double> values = {};  // dataset after dataset, each with `capacity` rows
  std::size_t capacity = 0;         // rows
  std::size_t buffered = 0;         // rows
  std::size_t written = 0;          // rows that have a time in the file
};

LogStream::LogStream(fs::path folder, const std::string& config_text, std::string manifest)
    : folder_(std::move(folder)), manifest_(std::move(manifest)) {
  write_text_file(folder_ / "config.toml", config_text);
}

LogStream::~LogStream() {
  for (int tries = 0; log_ && tries < 2; ++tries) {
    try {
      write_rows();
      return;
    } catch (const OutputError&) {
      // On a full disk there is room for the times of the rows whose values are written.
      for (Streamed& track : tracks_) {
        track.untimed -= track.buffered;
        track.buffered = 0;
      }
    }
  }
}

std::size_t LogStream::add(std::string name, std::vector<Signal> signals, std::size_t rows) {
  tracks_.push_back({std::move(name), std::move(signals), rows});
  return tracks_.size() - 1;
}

void LogStream::begin() {
  // Like the tracks of a recording: "control" first.
  std::vector<Streamed*> order;
  for (Streamed& track : tracks_) {
    if (track.room > 0) order.push_back(&track);
  }
  std::stable_partition(order.begin(), order.end(),
                        [](const Streamed* track) { return track->name == "control"; });
  for (Streamed* track : order) {
    track->first_dataset = datasets_.size();
    std::size_t width = 0;
    for (LogEntry& entry : datasets_of(track->name, track->signals, track->room)) {
      width += entry.width;
      datasets_.push_back(std::move(entry));
    }
    track->times.resize(rows_of_buffer(1, track->room));
    track->capacity = rows_of_buffer(width, track->room);
    track->values.resize(track->capacity * (width - 1));
  }
  // A process that is killed before all times are NaN leaves no log.
  const fs::path unfinished = folder_ / ".log.h5.partial";
  try {
    places_ = lay_out_hdf5_log(unfinished, datasets_);
    DataFile log(unfinished, O_RDWR);
    for (Streamed* track : order) {
      std::fill(track->times.begin(), track->times.end(), std::numeric_limits<double>::quiet_NaN());
      for (std::size_t row = 0; row < track->room; row += track->times.size()) {
        log.write(track->times.data(),
                  std::min(track->times.size(), track->room - row) * sizeof(double),
                  places_[track->first_dataset] + row * sizeof(double));
      }
    }
    log.sync();
  } catch (const OutputError& error) {
    throw with_final_name(error, unfinished, folder_ / kLog);
  }
  std::error_code error;
  fs::rename(unfinished, folder_ / kLog, error);
  if (error) {
    throw OutputError((folder_ / kLog).string() + ": cannot be written (" + error.message() + ")");
  }
  log_ = std::make_unique<DataFile>(folder_ / kLog, O_RDWR);
  // From now on, the partial folder is a run that only the user removes.
  replace_file(folder_ / "manifest.json", manifest_);
  std::ofstream(folder_ / kKept).flush();
  write_at_ = Clock::now() + kBetweenWrites;
}

void LogStream::append(std::size_t track, double time_s) {
  if (!log_) begin();
  Streamed& to = tracks_[track];
  if (to.written + to.untimed == to.room) {
    throw std::logic_error("track " + to.name + " has more rows than expected");
  }
  to.times[to.untimed++] = time_s;
  std::size_t column = 0;
  for (const Signal& signal : to.signals) {
    const std::size_t width = signal.values.size();
    std::copy_n(signal.values.data(), width, &to.values[column + to.buffered * width]);
    column += to.capacity * width;
  }
  ++to.buffered;
  if (to.buffered == to.capacity) write_values(to);
  if (to.untimed == to.times.size() || Clock::now() >= write_at_) write_rows();
}

void LogStream::write_values(Streamed& track) {
  const std::size_t first_row = track.written + track.untimed - track.buffered;
  std::size_t column = 0;
  for (std::size_t i = 1; i <= track.signals.size() && track.buffered > 0; ++i) {
    const std::size_t width = datasets_[track.first_dataset + i].width;
    const std::size_t row_bytes = width * sizeof(double);
    log_->write(&track.values[column], track.buffered * row_bytes,
                places_[track.first_dataset + i] + first_row * row_bytes);
    column += track.capacity * width;
  }
  track.buffered = 0;
}

// A time must not be on the disk before the values of its row.
void LogStream::write_rows() {
  for (Streamed& track : tracks_) write_values(track);
  log_->sync();
  for (Streamed& track : tracks_) {
    if (track.untimed == 0) continue;
    log_->write(track.times.data(), track.untimed * sizeof(double),
                places_[track.first_dataset] + track.written * sizeof(double));
    track.written += track.untimed;
    track.untimed = 0;
  }
  write_at_ = Clock::now() + kBetweenWrites;
}

fs::path LogStream::finish(const std::vector<Track>& tracks) {
  const fs::path log = folder_ / kLog;
  if (!log_) {
    write_hdf5_log(log, tracks, 0);
    return log;
  }
  write_rows();
  std::vector<LogEntry> whole;
  for (const Track& track : tracks) {
    for (LogEntry& entry : datasets_of(track.name(), track.all_signals(), track.rows())) {
      whole.push_back(std::move(entry));
    }
  }
  if (std::equal(whole.begin(), whole.end(), datasets_.begin(), datasets_.end(), same_dataset)) {
    return log;
  }
  // log.h5 stays as it is, in case that this process is killed now.
  fs::path other = folder_ / ".log.h5.partial-whole";
  const std::vector<std::uint64_t> places = lay_out_hdf5_log(other, whole);
  DataFile to(other, O_RDWR);
  auto place = places.begin();
  for (const Track& track : tracks) {
    const auto streamed = std::find_if(tracks_.begin(), tracks_.end(), [&](const Streamed& s) {
      return track.is_streamed() && s.name == track.name();
    });
    for (std::size_t i = 0; i <= track.signals(); ++i, ++place) {
      if (streamed != tracks_.end()) {
        const std::size_t from = streamed->first_dataset + i;
        detail::copy(*log_, places_[from], to, *place,
                     track.rows() * datasets_[from].width * sizeof(double));
      } else {
        const std::vector<double> values = i == 0 ? track.times() : track.values(i - 1);
        to.write(values.data(), values.size() * sizeof(double), *place);
      }
    }
  }
  return other;
}

}  // namespace breakwater
