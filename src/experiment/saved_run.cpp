#include <breakwater/experiment/saved_run.h>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include <breakwater/config/config.h>
#include <breakwater/experiment/run_manifest.h>
#include <breakwater/record/run_folder.h>
#include <breakwater/shell/did_you_mean.h>
#include <breakwater/signals/input_file.h>

namespace breakwater {
namespace fs = std::filesystem;
namespace {

// With more runs than this, a process could open no other file.
constexpr int kMostOpenFiles = 512;

// NAME means control/NAME.
SignalName place_of(const std::string& name) {
  SignalName place = signal_name(name);
  if (place.name.find('/') == std::string::npos) place.name = "control/" + place.name;
  return place;
}

}  // namespace

SavedRun::SavedRun(const fs::path& folder) : folder_(folder) {
  read_whole(folder_, [&] { read(); });
}

template <typename Read>
auto SavedRun::read_log(const Read& read) const {
  // A path of the open file, which this process can open again.
  const std::string name = log_ ? fmt::format("/proc/self/fd/{}", fileno(log_.get())) : log_file();
  try {
    return read(name);
  } catch (const std::invalid_argument& error) {
    std::string text = error.what();
    if (text.starts_with(name)) text.replace(0, name.size(), log_file());
    throw std::invalid_argument(text);
  }
}

void SavedRun::read() {
  notes_.clear();
  signals_.clear();
  read_.clear();
  written_rows_.clear();
  if (!fs::is_directory(folder_)) {
    throw std::invalid_argument(
        folder_.string() +
        (fs::exists(folder_) ? ": is a file, not a folder" : ": there is no such folder") +
        "; give the folder of a run");
  }
  if (!fs::exists(folder_ / "manifest.json")) {
    throw std::invalid_argument(folder_.string() +
                                ": is not the folder of a finished run: it has no manifest.json; "
                                "run the scenario again with --out");
  }
  manifest_ = read_manifest(folder_);
  if (manifest_.is_unfinished && is_being_written(folder_)) {
    throw std::invalid_argument(folder_.string() + ": a process still writes this run");
  }
  check_has_files(folder_);
  open_input(log_file());
  log_.reset(std::fopen(log_file().c_str(), "re"), [](std::FILE* file) {
    if (file != nullptr) std::fclose(file);
  });
  if (log_ && fileno(log_.get()) > kMostOpenFiles) log_.reset();
  config_text_ = bytes_of(folder_ / "config.toml");
  check_file(folder_, "config.toml");
  if (!failure()) manifest_.metrics = read_metrics(folder_);
  const bool is_known = check_file(folder_, "log.h5");
  if (!is_known) {
    const bool is_whole = !manifest_.is_unfinished;
    read_log([&](const std::string& log) { check_foreign_log(log, is_whole); });
    if (is_whole) {
      notes_.push_back(log_file() +
                       ": may not be what the run wrote: its manifest.json has no log_hash");
    }
  }
  signals_ = read_log([](const std::string& log) { return list_hdf5_signals(log); });
  if (manifest_.is_unfinished) find_end();
  if (!is_known) {
    for (const LogEntry& entry : signals_) {
      check_rows(entry.group + "/" + entry.name, {entry.rows, entry.width, {}});
    }
  }
  if (failure() && failure()->is_cut) {
    notes_.push_back(fmt::format("{}: was cut at {:.6g} s: {}", folder_.string(), failure()->time_s,
                                 failure()->reason));
  }
}

// A run that was cut has room for rows that were never written.
void SavedRun::find_end() {
  for (LogEntry& entry : signals_) {
    const auto [place, is_new] = written_rows_.try_emplace(entry.group, 0);
    if (is_new) {
      place->second =
          read_log([&](const std::string& log) { return written_rows(log, entry.group); });
    }
    entry.rows = place->second;
  }
  std::erase_if(signals_,
                [](const LogEntry& entry) { return entry.rows == 0 && entry.group != "control"; });
  const std::vector<double>& times = dataset("control/time_s").values;
  if (!times.empty()) manifest_.failure->time_s = times.back();
}

// Functions that use a log rely on these properties.
void SavedRun::check_rows(const std::string& path, const LoggedSignal& data) const {
  const auto refuse = [&](const std::string& what) {
    throw std::invalid_argument(log_file() + ": " + path + ": " + what + "; run it again");
  };
  const std::string base = path.substr(0, path.find('/')) + "/time_s";
  if (path != base) {
    const std::size_t rows = dataset(base).rows;
    if (data.rows != rows) refuse(fmt::format("has {} rows, but {} has {}", data.rows, base, rows));
    return;
  }
  if (data.width != 1) refuse("must have one value a row");
  for (std::size_t i = 0; i < data.rows; ++i) {
    const double time_s = data.values[i];
    // The factor keeps the sums and differences of two times finite.
    const bool is_finite = std::isfinite(4.0 * time_s);
    if (is_finite && (i == 0 || time_s > data.values[i - 1])) continue;
    refuse(fmt::format("must be finite and rise, is {} in row {}", time_s, i + 1));
  }
}

const LoggedSignal& SavedRun::dataset(const std::string& path) const {
  const auto found = read_.find(path);
  if (found != read_.end()) return found->second;
  const auto written = written_rows_.find(path.substr(0, path.find('/')));
  const std::size_t rows = written != written_rows_.end() ? written->second : SIZE_MAX;
  LoggedSignal data =
      read_log([&](const std::string& log) { return read_hdf5_signal(log, path, rows); });
  check_rows(path, data);
  return read_.emplace(path, std::move(data)).first->second;
}

const LogEntry* SavedRun::find(const std::string& place) const {
  const auto found = std::ranges::find_if(
      signals_, [&](const LogEntry& entry) { return entry.group + "/" + entry.name == place; });
  return found != signals_.end() ? &*found : nullptr;
}

bool SavedRun::has_signal(const std::string& name) const {
  return find(place_of(name).name) != nullptr;
}

const LogEntry& SavedRun::entry(const std::string& name) const {
  if (const LogEntry* found = find(place_of(name).name)) return *found;
  std::vector<std::string> names;
  for (const LogEntry& entry : signals_) {
    names.push_back(entry.group == "control" ? entry.name : entry.group + "/" + entry.name);
  }
  throw std::invalid_argument(log_file() + ": has no signal " + name + did_you_mean(name, names));
}

std::string SavedRun::unit(const std::string& name) const {
  return entry(name).unit_of(std::max<std::size_t>(1, place_of(name).index));
}

Series SavedRun::signal(const std::string& name) const {
  const LogEntry& found = entry(name);
  const std::size_t index = std::max<std::size_t>(1, place_of(name).index);
  if (index > found.width || (place_of(name).index == 0 && found.width > 1)) {
    throw std::invalid_argument(log_file() + ": " + name + " has " + std::to_string(found.width) +
                                " values; choose one, as NAME[1]");
  }
  const LoggedSignal& values = dataset(found.group + "/" + found.name);
  Series series{dataset(found.group + "/time_s").values, std::vector<double>(values.rows)};
  for (std::size_t i = 0; i < values.rows; ++i) series.values[i] = values.row(i)[index - 1];
  return series;
}

}  // namespace breakwater
