#include <breakwater/record/log_stream.h>

#include <fcntl.h>

#include <algorithm>
#include <fstream>
#include <limits>
#include <span>
#include <utility>

#include <breakwater/record/partial_file.h>
#include <breakwater/record/run_folder.h>
#include <breakwater/record/text_outputs.h>

namespace breakwater {
namespace fs = std::filesystem;
using detail::DataFile;

namespace {

constexpr const char* kLog = "log.h5";
constexpr std::size_t kCopiedAtOnce = 1 << 20;
constexpr std::chrono::milliseconds kBetweenWrites(500);

using RowsOf = std::size_t (Track::*)() const;

std::vector<LogEntry> all_datasets(const std::vector<Track>& tracks, RowsOf rows) {
  std::vector<LogEntry> all;
  for (const Track& track : tracks) {
    const std::vector<LogEntry> own = datasets_of(track, (track.*rows)());
    all.insert(all.end(), own.begin(), own.end());
  }
  return all;
}

// Copies `bytes` bytes.
void copy(std::ifstream& from, std::uint64_t from_place, DataFile& to, std::uint64_t to_place,
          std::uint64_t bytes) {
  std::vector<char> block(std::min<std::uint64_t>(bytes, kCopiedAtOnce));
  from.seekg(static_cast<std::streamoff>(from_place));
  for (std::uint64_t done = 0; done < bytes; done += block.size()) {
    block.resize(std::min<std::uint64_t>(block.size(), bytes - done));
    from.read(block.data(), static_cast<std::streamsize>(block.size()));
    if (!from) throw OutputError("the log cannot be read again");
    to.write(block.data(), block.size(), to_place + done);
  }
}

}  // namespace

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
      for (const Track& track : tracks_) {
        track.rows_->untimed -= track.rows_->buffered;
        track.rows_->buffered = 0;
      }
    }
  }
}

void LogStream::begin() {
  if (log_) return;
  std::erase_if(tracks_, [](const Track& track) { return track.room() == 0; });
  // Like the tracks of a recording: "control" first.
  std::stable_partition(tracks_.begin(), tracks_.end(),
                        [](const Track& track) { return track.name() == "control"; });
  datasets_ = all_datasets(tracks_, &Track::room);
  // A process that is killed before all times are NaN leaves no log.
  const fs::path unfinished = folder_ / ".log.h5.partial";
  try {
    places_ = lay_out_hdf5_log(unfinished, datasets_);
    DataFile log(unfinished, O_RDWR);
    std::size_t dataset = 0;
    for (const Track& track : tracks_) {
      Track::Rows& rows = *track.rows_;
      rows.first_dataset = dataset;
      dataset += 1 + track.signals();
      std::fill_n(rows.times.get(), rows.times_capacity, std::numeric_limits<double>::quiet_NaN());
      for (std::size_t row = 0; row < track.room(); row += rows.times_capacity) {
        log.write(rows.times.get(),
                  std::min(rows.times_capacity, track.room() - row) * sizeof(double),
                  places_[rows.first_dataset] + row * sizeof(double));
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

void LogStream::write_full(const Track& track) {
  const Track::Rows& rows = *track.rows_;
  if (rows.buffered == rows.capacity) write_values(track);
  if (rows.untimed == rows.times_capacity || Clock::now() >= write_at_) write_rows();
}

void LogStream::write_values(const Track& track) {
  Track::Rows& rows = *track.rows_;
  for (std::size_t i = 0; i < track.signals() && rows.buffered > 0; ++i) {
    const std::size_t row_bytes = track.signal(i).values.size() * sizeof(double);
    log_->write(track.buffer(i, 0), rows.buffered * row_bytes,
                places_[rows.first_dataset + 1 + i] + (track.rows() - rows.buffered) * row_bytes);
  }
  rows.buffered = 0;
}

// A time must not be on the disk before the values of its row.
void LogStream::write_rows() {
  for (const Track& track : tracks_) write_values(track);
  log_->sync();
  for (const Track& track : tracks_) {
    Track::Rows& rows = *track.rows_;
    if (rows.untimed == 0) continue;
    log_->write(rows.times.get(), rows.untimed * sizeof(double),
                places_[rows.first_dataset] + rows.written * sizeof(double));
    rows.written += rows.untimed;
    rows.untimed = 0;
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
  const bool is_whole = std::ranges::all_of(tracks, [](const Track& track) {
    return track.is_streamed() && track.rows() == track.room();
  });
  if (is_whole && tracks.size() == tracks_.size()) return log;
  // log.h5 stays as it is, in case that this process is killed now.
  fs::path other = folder_ / ".log.h5.partial-whole";
  const auto places = lay_out_hdf5_log(other, all_datasets(tracks, &Track::rows));
  std::ifstream from(log, std::ios::binary);
  DataFile to(other, O_RDWR);
  auto place = places.begin();
  for (const Track& track : tracks) {
    for (std::size_t i = 0; i <= track.signals(); ++i, ++place) {
      if (track.is_streamed()) {
        const std::size_t dataset = track.rows_->first_dataset + i;
        copy(from, places_[dataset], to, *place,
             track.rows() * datasets_[dataset].width * sizeof(double));
      } else {
        const std::span<const double> values = i == 0 ? track.times() : track.values(i - 1);
        to.write(values.data(), values.size_bytes(), *place);
      }
    }
  }
  return other;
}

}  // namespace breakwater
