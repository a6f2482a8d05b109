#include <breakwater/record/log_stream.h>

#include <fcntl.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <stdexcept>
#include <utility>

#include <breakwater/record/file_hash.h>
#include <breakwater/record/partial_file.h>
#include <breakwater/record/run_folder.h>
#include <breakwater/record/streamed_files.h>
#include <breakwater/record/text_outputs.h>

namespace breakwater {
namespace fs = std::filesystem;
using detail::DataFile;
using detail::JournalEntry;

namespace {

constexpr const char* kLog = "log.h5";
constexpr std::size_t kBufferBytes = 1 << 20;  // for each track
// The interval counts in simulated time and on the clock. Together with the last sample this is
// less than a second.
constexpr std::chrono::milliseconds kBetweenFlushes(500);

bool same_dataset(const LogEntry& a, const LogEntry& b) {
  return a.group == b.group && a.name == b.name && a.rows == b.rows && a.width == b.width;
}

}  // namespace

struct LogStream::Streamed {
  std::string name;
  std::vector<Signal> signals;
  std::size_t room = 0;
  std::uint32_t number = 0;         // among the tracks of the file
  std::size_t first_dataset = 0;    // the time base
  std::vector<double> buffer = {};  // dataset after dataset, each with `capacity` rows
  std::size_t capacity = 0;         // rows
  std::size_t buffered = 0;         // rows
  std::size_t written = 0;          // rows
};

struct LogStream::Files {
  DataFile log;
  DataFile journal;
  std::uint64_t journal_size = 0;
  BlockHash hash = {};
  std::unique_ptr<DataFile> running = nullptr;  // its lock shows that the run goes on
};

LogStream::LogStream(fs::path folder, const std::string& config_text, std::string manifest)
    : folder_(std::move(folder)), manifest_(std::move(manifest)) {
  write_text_file(folder_ / "config.toml", config_text);
}

LogStream::~LogStream() = default;

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
  std::uint32_t number = 0;
  for (Streamed* track : order) {
    track->number = number++;
    track->first_dataset = datasets_.size();
    std::size_t width = 0;
    for (LogEntry& entry : datasets_of(track->name, track->signals, track->room)) {
      width += entry.width;
      datasets_.push_back(std::move(entry));
    }
    track->capacity =
        std::clamp<std::size_t>(kBufferBytes / (width * sizeof(double)), 1, track->room);
    track->buffer.resize(track->capacity * width);
  }
  places_ = lay_out_hdf5_log(folder_ / kLog, datasets_);
  files_.reset(new Files{DataFile(folder_ / kLog, O_RDWR),
                         DataFile(folder_ / detail::kJournal, O_WRONLY | O_CREAT | O_TRUNC)});
}

// From now on, the partial folder is kept.
void LogStream::announce() {
  nlohmann::ordered_json log = nlohmann::ordered_json::array();
  for (std::size_t i = 0; i < datasets_.size(); ++i) {
    const LogEntry& entry = datasets_[i];
    log.push_back({{"group", entry.group},
                   {"name", entry.name},
                   {"unit", entry.unit},
                   {"description", entry.description},
                   {"rows", entry.rows},
                   {"width", entry.width},
                   {"place", places_[i]}});
  }
  const nlohmann::ordered_json running = {{"manifest", nlohmann::ordered_json::parse(manifest_)},
                                          {"log", log}};
  const std::string text =
      running.dump(1, ' ', false, nlohmann::json::error_handler_t::replace) + "\n";
  replace_file(folder_ / kRunning, text);
  auto running_file = std::make_unique<DataFile>(folder_ / kRunning, O_RDWR);
  running_file->lock();
  files_->running = std::move(running_file);
}

void LogStream::append(std::size_t track, double time_s) {
  if (!files_) begin();
  Streamed& to = tracks_[track];
  if (to.written + to.buffered == to.room) {
    throw std::logic_error("track " + to.name + " has more rows than expected");
  }
  to.buffer[to.buffered] = time_s;
  std::size_t column = to.capacity;
  for (const Signal& signal : to.signals) {
    const std::size_t width = signal.values.size();
    std::copy_n(signal.values.data(), width, &to.buffer[column + to.buffered * width]);
    column += to.capacity * width;
  }
  ++to.buffered;
  if (files_->running && to.buffered < to.capacity && time_s < flush_at_s_ &&
      Clock::now() < flush_at_) {
    return;
  }
  flush();
  flush_at_s_ = time_s + std::chrono::duration<double>(kBetweenFlushes).count();
  flush_at_ = Clock::now() + kBetweenFlushes;
  if (!files_->running && to.number == 0) announce();
}

void LogStream::flush() {
  for (Streamed& track : tracks_) {
    if (track.buffered == 0) continue;
    files_->hash.reset();
    std::size_t column = 0;
    for (std::size_t i = 0; i <= track.signals.size(); ++i) {
      const std::size_t width = datasets_[track.first_dataset + i].width;
      const std::size_t row_bytes = width * sizeof(double);
      const double* const values = &track.buffer[column];
      files_->hash.add(values, track.buffered * row_bytes);
      files_->log.write(values, track.buffered * row_bytes,
                        places_[track.first_dataset + i] + track.written * row_bytes);
      column += track.capacity * width;
    }
    const JournalEntry entry{track.number, static_cast<std::uint32_t>(track.buffered),
                             files_->hash.digest()};
    files_->journal.write(&entry, sizeof entry, files_->journal_size);
    files_->journal_size += sizeof entry;
    track.written += track.buffered;
    track.buffered = 0;
  }
}

fs::path LogStream::finish(const std::vector<Track>& tracks) {
  const fs::path log = folder_ / kLog;
  if (!files_) {
    write_hdf5_log(log, tracks, 0);
    return log;
  }
  flush();
  std::vector<LogEntry> whole;
  for (const Track& track : tracks) {
    for (LogEntry& entry : datasets_of(track.name(), track.all_signals(), track.rows())) {
      whole.push_back(std::move(entry));
    }
  }
  if (std::equal(whole.begin(), whole.end(), datasets_.begin(), datasets_.end(), same_dataset)) {
    return log;
  }
  // The journal still describes log.h5, in case that this process is killed now.
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
        detail::copy(files_->log, places_[from], to, *place,
                     track.rows() * datasets_[from].width * sizeof(double));
      } else {
        const std::vector<double> values = i == 0 ? track.times() : track.values(i - 1);
        to.write(values.data(), values.size() * sizeof(double), *place);
      }
    }
  }
  return other;
}

void forget_stream(const fs::path& folder) {
  std::error_code ignored;
  fs::remove(folder / kRunning, ignored);
  fs::remove(folder / detail::kJournal, ignored);
}

bool is_being_written(const fs::path& folder) {
  try {
    return !DataFile(folder / kRunning, O_RDWR).lock();
  } catch (const OutputError&) {
    return false;
  }
}

}  // namespace breakwater
