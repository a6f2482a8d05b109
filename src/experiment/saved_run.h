// Reads the folder of any scenario's run.
#pragma once

#include <cstdio>
#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <breakwater/experiment/run_manifest.h>
#include <breakwater/math/table_function.h>
#include <breakwater/record/hdf5_log.h>
#include <breakwater/record/recording.h>

namespace breakwater {

/// The manifest, metrics, configuration and log of a run. A run that failed or was cut has a reason
/// and no metrics. All are of one run, even if another one replaces it meanwhile.
class SavedRun {
 public:
  /// Throws std::invalid_argument with a hint, one line, if the folder is not that of a run.
  explicit SavedRun(const std::filesystem::path& folder);

  const std::filesystem::path& folder() const { return folder_; }
  const std::string& scenario() const { return manifest_.scenario; }
  const std::string& case_name() const { return manifest_.case_name; }
  const std::string& seed() const { return manifest_.seed; }
  const std::string& state_hash() const { return manifest_.state_hash; }
  const std::string& config_text() const { return config_text_; }
  const std::optional<Failure>& failure() const { return manifest_.failure; }
  /// Its origin besides the configuration; empty if an older version wrote it.
  const std::string& program() const { return manifest_.program; }
  const ModelHashes& models() const { return manifest_.models; }
  /// In the scenario's order. Each unit is the end of the name.
  const std::vector<Metric>& metrics() const { return manifest_.metrics; }
  std::optional<double> metric(const std::string& name) const { return metric_in(metrics(), name); }
  /// The metrics that the run does not have, with the reason; none of an older run.
  const std::vector<AbsentMetric>& absent() const { return manifest_.absent; }
  /// Warnings of the run as it ended.
  const std::vector<std::string>& warnings() const { return manifest_.warnings; }
  /// Warnings, one line each: the run was cut, or the log may have changed after it.
  const std::vector<std::string>& notes() const { return notes_; }

  const std::vector<LogEntry>& signals() const { return signals_; }
  bool has_signal(const std::string& name) const;
  /// A signal by GROUP/NAME, by NAME in the group control, or by NAME[3] for its third value.
  /// Throws std::invalid_argument if the log does not have it.
  Series signal(const std::string& name) const;
  /// The log's entry for a signal, found in the same way.
  const LogEntry& entry(const std::string& name) const;
  /// The unit of a signal, or of one value for NAME[3].
  std::string unit(const std::string& name) const;
  /// A dataset of the log, GROUP/NAME. It has as many rows as GROUP/time_s of its group, whose
  /// times are finite and increasing. The reference is valid as long as the run. Throws
  /// std::invalid_argument if the log does not have it in this form.
  const LoggedSignal& dataset(const std::string& path) const;

 private:
  void read();
  void find_end();
  // Calls `read` with a name of the log that is open.
  template <typename Read>
  auto read_log(const Read& read) const;
  const LogEntry* find(const std::string& place) const;
  void check_rows(const std::string& path, const LoggedSignal& data) const;
  std::string log_file() const { return (folder_ / "log.h5").string(); }

  std::filesystem::path folder_;
  std::shared_ptr<std::FILE> log_;  // stays open: another run may replace the folder
  RunManifest manifest_;
  std::string config_text_;
  std::vector<LogEntry> signals_;
  std::vector<std::string> notes_;
  std::map<std::string, std::size_t> written_rows_;   // by track, if the run was cut
  mutable std::map<std::string, LoggedSignal> read_;  // the datasets that were read so far
};

}  // namespace breakwater
