#include <breakwater/record/cut_run.h>

#include <fcntl.h>
#include <fmt/format.h>

#include <algorithm>
#include <fstream>
#include <nlohmann/json.hpp>
#include <stdexcept>

#include <breakwater/record/file_hash.h>
#include <breakwater/record/run_folder.h>

namespace breakwater {
namespace fs = std::filesystem;
using detail::DataFile;
using detail::JournalEntry;

namespace {

constexpr std::size_t kReadAtOnce = 1 << 20;
constexpr std::size_t kWidest = 1 << 20;

fs::path checked(const fs::path& folder) {
  if (!fs::is_directory(folder)) {
    throw std::invalid_argument(folder.string() + ": there is no such folder");
  }
  if (is_run_folder(folder) && !is_unfinished_run(folder)) {
    throw std::invalid_argument(folder.string() +
                                ": is a finished run: there is nothing to recover");
  }
  if (!fs::is_regular_file(folder / kRunning)) {
    throw std::invalid_argument(
        folder.string() + ": is not what a killed run with record.stream=true left: it has no " +
        kRunning);
  }
  return folder;
}

[[noreturn]] void not_recoverable(const fs::path& file, const std::string& why) {
  throw std::invalid_argument(file.string() + ": " + why + ": the run cannot be recovered");
}

[[noreturn]] void damaged(const fs::path& file) {
  not_recoverable(file, "is damaged");
}

// Refuses numbers with a point too: they may be too large.
std::uint64_t whole(const nlohmann::ordered_json& value) {
  return value.get_ref<const std::uint64_t&>();
}

}  // namespace

CutRun::CutRun(const fs::path& folder)
    : running_(checked(folder) / kRunning, O_RDWR), log_(folder / "log.h5", O_RDONLY) {
  if (!running_.lock()) {
    throw std::invalid_argument(folder.string() +
                                ": a process still writes this run: stop it first");
  }
  read_running(folder / kRunning, folder / "log.h5");
  read_journal(folder / detail::kJournal);
}

void CutRun::read_running(const fs::path& file, const fs::path& log) {
  const std::uint64_t bytes = log_.size();
  try {
    std::ifstream stream(file);
    const auto running = nlohmann::ordered_json::parse(stream);
    const auto& manifest = running.at("manifest");
    whole(manifest.at("seed"));
    if (!manifest.at("scenario").is_string() || !manifest.at("case").is_string()) damaged(file);
    manifest_ = manifest.dump();
    for (const auto& dataset : running.at("log")) {
      Dataset next;
      next.entry = {dataset.at("group"),
                    dataset.at("name"),
                    dataset.at("unit"),
                    dataset.at("description"),
                    0,
                    whole(dataset.at("width"))};
      next.room = whole(dataset.at("rows"));
      next.place = whole(dataset.at("place"));
      const bool is_next = !datasets_.empty() && datasets_.back().entry.group != next.entry.group;
      next.track = datasets_.empty() ? 0 : datasets_.back().track + (is_next ? 1 : 0);
      const std::size_t width = next.entry.width;
      if (width < 1 || width > kWidest) damaged(file);
      if (next.place > bytes || next.room > (bytes - next.place) / (width * sizeof(double))) {
        not_recoverable(log, fmt::format("is smaller than {} says", kRunning));
      }
      datasets_.push_back(std::move(next));
    }
  } catch (const nlohmann::json::exception&) {
    damaged(file);
  }
  if (datasets_.empty()) damaged(file);
}

// Whether the next rows of a track are those of the journal.
bool CutRun::holds(const JournalEntry& block) const {
  BlockHash hash;
  std::vector<char> values(kReadAtOnce);
  bool is_known = false;
  for (const Dataset& dataset : datasets_) {
    if (dataset.track != block.track) continue;
    is_known = true;
    if (block.rows > dataset.room - dataset.entry.rows) return false;
    const std::uint64_t row = dataset.entry.width * sizeof(double);
    std::uint64_t place = dataset.place + dataset.entry.rows * row;
    for (std::uint64_t left = block.rows * row; left > 0;) {
      const std::size_t read =
          log_.read(values.data(), std::min<std::uint64_t>(left, values.size()), place);
      if (read == 0) return false;
      hash.add(values.data(), read);
      place += read;
      left -= read;
    }
  }
  return is_known && hash.digest() == block.hash;
}

void CutRun::read_journal(const fs::path& file) {
  const DataFile journal(file, O_RDONLY);
  JournalEntry block;
  for (std::uint64_t at = 0; journal.read(&block, sizeof block, at) == sizeof block;
       at += sizeof block) {
    if (!holds(block)) {
      is_damaged_ = true;
      break;
    }
    for (Dataset& dataset : datasets_) {
      if (dataset.track == block.track) dataset.entry.rows += block.rows;
    }
  }
  if (datasets_.front().entry.rows == 0) {  // its control track comes first
    not_recoverable(file, is_damaged_ ? "differs from log.h5 from the first row" : "lists no rows");
  }
  std::erase_if(datasets_, [](const Dataset& dataset) { return dataset.entry.rows == 0; });
  const Dataset& times = datasets_.front();
  log_.read(&end_s_, sizeof end_s_, times.place + (times.entry.rows - 1) * sizeof end_s_);
}

void CutRun::write_log(const fs::path& file) const {
  std::vector<LogEntry> entries;
  for (const Dataset& dataset : datasets_) entries.push_back(dataset.entry);
  const std::vector<std::uint64_t> places = lay_out_hdf5_log(file, entries);
  DataFile to(file, O_RDWR);
  for (std::size_t i = 0; i < entries.size(); ++i) {
    detail::copy(log_, datasets_[i].place, to, places[i],
                 entries[i].rows * entries[i].width * sizeof(double));
  }
}

}  // namespace breakwater
