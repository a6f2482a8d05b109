// What any run's folder tells, whatever its scenario.
#pragma once

#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include <breakwater/experiment/run_manifest.h>
#include <breakwater/record/hdf5_log.h>
#include <breakwater/record/recording.h>
#include <breakwater/record/series.h>

namespace breakwater {

/// A run's manifest, metrics, configuration and log. A failed run is one too: it has a reason and
/// no metrics.
class SavedRun {
 public:
  /// Throws std::invalid_argument, one line that says what to do, if the folder is no run's.
  explicit SavedRun(const std::filesystem::path& folder);

  const std::filesystem::path& folder() const { return folder_; }
  const std::string& scenario() const { return manifest_.scenario; }
  const std::string& case_name() const { return manifest_.case_name; }
  const std::string& seed() const { return manifest_.seed; }
  const std::string& state_hash() const { return manifest_.state_hash; }
  const std::string& config_text() const { return config_text_; }
  const std::optional<Failure>& failure() const { return manifest_.failure; }
  /// What it is made of besides its configuration; empty where an older version wrote it.
  const std::string& program() const { return manifest_.program; }
  const ModelHashes& models() const { return manifest_.models; }
  /// In the scenario's order. Units are the ends of the names.
  const std::vector<Metric>& metrics() const { return metrics_; }
  std::optional<double> metric(const std::string& name) const;
  /// Warnings for the user, one line each: that nothing vouches for the log.
  const std::vector<std::string>& notes() const { return notes_; }

  const std::vector<LogEntry>& signals() const { return signals_; }
  bool has_signal(const std::string& name) const;
  /// A signal, GROUP/NAME, NAME of the group control, or NAME[3] for the third of its values.
  /// Throws std::invalid_argument if the log does not have it.
  Series signal(const std::string& name) const;
  /// What the log says about it, found in the same way.
  const LogEntry& entry(const std::string& name) const;
  /// A signal's unit: of NAME[3] that of the third of its values.
  std::string unit(const std::string& name) const;
  /// A dataset of the log, GROUP/NAME: as many rows as its group's GROUP/time_s, which is finite
  /// and rises. It is kept as long as the run. Throws std::invalid_argument if the log does not
  /// have it so.
  const LoggedSignal& dataset(const std::string& path) const;

 private:
  const LogEntry* find(const std::string& place) const;
  void check_rows(const std::string& path, const LoggedSignal& data) const;
  std::string log_file() const { return (folder_ / "log.h5").string(); }

  std::filesystem::path folder_;
  RunManifest manifest_;
  std::string config_text_;
  std::vector<Metric> metrics_;
  std::vector<LogEntry> signals_;
  std::vector<std::string> notes_;
  bool is_read_whole_ = false;                        // since nothing vouches for its log
  mutable std::map<std::string, LoggedSignal> read_;  // datasets, as they were asked for
};

/// The metrics of a run that did not fail, in the scenario's order. Throws std::invalid_argument,
/// one line, if they are missing or damaged.
std::vector<Metric> read_metrics(const std::filesystem::path& folder);

/// "N" of "peak_force_raw_N": the unit at the end of a metric's name, as people write it.
std::string unit_of(const std::string& metric);

}  // namespace breakwater
