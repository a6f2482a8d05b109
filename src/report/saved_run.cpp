#include "report/saved_run.h"

#include <algorithm>
#include <array>
#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>
#include <stdexcept>

#include "record/run_folder.h"
#include "scenario/config.h"

namespace breakwater {
namespace fs = std::filesystem;
namespace {

// NAME is control/NAME.
SignalName place_of(const std::string& name) {
  SignalName place = signal_name(name);
  if (place.name.find('/') == std::string::npos) place.name = "control/" + place.name;
  return place;
}

}  // namespace

SavedRun::SavedRun(const fs::path& folder) : folder_(folder) {
  if (!fs::is_directory(folder_)) {
    throw std::invalid_argument(folder_.string() +
                                ": there is no such folder; give the folder of a run");
  }
  if (!fs::exists(folder_ / "manifest.json")) {
    throw std::invalid_argument(folder_.string() +
                                ": is not the folder of a finished run: it has no manifest.json; "
                                "run the scenario again with --out");
  }
  if (!is_run_folder(folder_)) {
    throw std::invalid_argument((folder_ / "manifest.json").string() +
                                ": is not a run's manifest; give the folder of a run");
  }
  for (const char* file : {"config.toml", "log.h5"}) {
    if (!fs::is_regular_file(folder_ / file)) {
      throw std::invalid_argument(folder_.string() + ": the run is incomplete: it has no " + file +
                                  "; run it again");
    }
  }
  std::ifstream manifest_file(folder_ / "manifest.json");
  const auto manifest = nlohmann::json::parse(manifest_file);
  scenario_ = manifest.value("scenario", "");
  case_name_ = manifest.value("case", "");
  seed_ = manifest.contains("seed") ? manifest["seed"].dump() : "";
  git_commit_ = manifest.value("git_commit", "");
  if (manifest.value("status", "") == "failed") {
    failure_ = Failure{manifest.value("time_s", 0.0), manifest.value("reason", "")};
  }
  std::stringstream config;
  config << std::ifstream(folder_ / "config.toml").rdbuf();
  config_text_ = config.str();

  if (!failure_) {
    std::ifstream metrics_file(folder_ / "metrics.json");
    const auto metrics = nlohmann::ordered_json::parse(metrics_file, nullptr, false);
    if (!metrics.is_object()) {
      throw std::invalid_argument(folder_.string() +
                                  ": the run is incomplete: it has no metrics.json; run it again");
    }
    for (const auto& [name, value] : metrics.items()) {
      if (value.is_number()) metrics_.push_back({name, unit_of(name), value.get<double>()});
    }
  }
  signals_ = list_hdf5_signals((folder_ / "log.h5").string());
}

std::optional<double> SavedRun::metric(const std::string& name) const {
  for (const Metric& metric : metrics_) {
    if (metric.name == name) return metric.value;
  }
  return std::nullopt;
}

const LoggedSignal& SavedRun::dataset(const std::string& path) const {
  const auto found = read_.find(path);
  if (found != read_.end()) return found->second;
  return read_.emplace(path, read_hdf5_signal((folder_ / "log.h5").string(), path)).first->second;
}

const LogEntry& SavedRun::entry(const std::string& name) const {
  const SignalName place = place_of(name);
  std::vector<std::string> names;
  for (const LogEntry& entry : signals_) {
    if (entry.group + "/" + entry.name == place.name) return entry;
    names.push_back(entry.group == "control" ? entry.name : entry.group + "/" + entry.name);
  }
  throw std::invalid_argument((folder_ / "log.h5").string() + ": has no signal " + name +
                              did_you_mean(name, names));
}

std::string SavedRun::unit(const std::string& name) const {
  return entry(name).unit_of(std::max<std::size_t>(1, place_of(name).index));
}

Series SavedRun::signal(const std::string& name) const {
  const LogEntry& found = entry(name);
  const std::size_t index = std::max<std::size_t>(1, place_of(name).index);
  if (index > found.width || (place_of(name).index == 0 && found.width > 1)) {
    throw std::invalid_argument((folder_ / "log.h5").string() + ": " + name + " has " +
                                std::to_string(found.width) + " values; say which: NAME[1]");
  }
  const LoggedSignal& values = dataset(found.group + "/" + found.name);
  Series series{dataset(found.group + "/time_s").values, std::vector<double>(values.rows)};
  for (std::size_t i = 0; i < values.rows; ++i) series.values[i] = values.row(i)[index - 1];
  return series;
}

std::string unit_of(const std::string& metric) {
  struct Ending {
    const char* end;
    const char* unit;
  };
  static constexpr std::array<Ending, 10> kEndings = {{{"_rad_s", "rad/s"},
                                                       {"_m_s", "m/s"},
                                                       {"_Nm", "N m"},
                                                       {"_Ns", "N s"},
                                                       {"_rad", "rad"},
                                                       {"_us", "µs"},
                                                       {"_N", "N"},
                                                       {"_m", "m"},
                                                       {"_s", "s"},
                                                       {"_Hz", "Hz"}}};
  for (const Ending& ending : kEndings) {
    if (metric.ends_with(ending.end)) return ending.unit;
  }
  return "";
}

}  // namespace breakwater
