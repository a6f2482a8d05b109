// A run's folder, read back.
#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include <breakwater/record/hdf5_log.h>
#include <breakwater/record/series.h>
#include <breakwater/scenario/catalogue.h>
#include <breakwater/scenario/config.h>
#include <breakwater/sim/model.h>

namespace breakwater {

/// What a finished run left, its scenario with the run's settings, and its log.
class FinishedRun {
 public:
  /// Throws std::invalid_argument, one line, if the folder is not a run's or lacks a file, or the
  /// catalogue lacks its scenario.
  FinishedRun(const Catalogue& catalogue, const std::filesystem::path& folder);

  const std::filesystem::path& folder() const { return folder_; }
  const std::string& case_name() const { return case_name_; }
  const Scenario& scenario() const { return *scenario_; }
  /// Where its scenario's shot list is, if there is one.
  const std::filesystem::path& shots_file() const { return shots_file_; }

  /// The times of the log's control samples [s]; two at least.
  const std::vector<double>& times_s() const { return times_s_; }
  /// When the last sample's period ends [s].
  double end_s() const { return times_s_.back() + (times_s_[1] - times_s_[0]); }
  /// The generalised positions at these times.
  const LoggedSignal& qpos() const { return qpos_; }

  /// The plant as it looks in pictures.
  Model load_scene() const;

  /// A signal at the control rate, NAME or NAME[3] for the third of its values. Throws
  /// std::invalid_argument if the log does not have it.
  Series signal(const std::string& name) const;
  /// A vector signal's values, one series each.
  std::vector<Series> vector_signal(const std::string& name) const;
  /// A number of the run's configuration, constant over time, or a signal.
  Series value(const std::string& key_or_signal) const;
  /// `text` with each {KEY} replaced by that key's value. Throws if there is no such key.
  std::string fill_in(const std::string& text) const;

 private:
  std::string log_file() const { return (folder_ / "log.h5").string(); }

  std::filesystem::path folder_;
  std::string case_name_;
  std::filesystem::path shots_file_;
  std::unique_ptr<Scenario> scenario_;
  std::unique_ptr<Config> config_;
  std::vector<double> times_s_;
  LoggedSignal qpos_;
};

}  // namespace breakwater
