// The folder of a finished run.
#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include <breakwater/config/config.h>
#include <breakwater/experiment/catalogue.h>
#include <breakwater/experiment/saved_run.h>
#include <breakwater/math/table_function.h>
#include <breakwater/record/hdf5_log.h>
#include <breakwater/sim/model.h>

namespace breakwater {

/// The results of a finished run, its scenario with the run's settings, and its log.
class FinishedRun {
 public:
  /// The catalogue must outlive it. Throws std::invalid_argument, one line, if it lacks the run's
  /// scenario.
  FinishedRun(const Catalogue& catalogue, SavedRun saved);

  const std::filesystem::path& folder() const { return saved_.folder(); }
  const std::string& case_name() const { return saved_.case_name(); }
  const SavedRun& saved() const { return saved_; }
  const Catalogue& catalogue() const { return *catalogue_; }
  /// Notes, one line each: on the log, and on keys that an older version did not have.
  const std::vector<std::string>& notes() const { return notes_; }
  const Scenario& scenario() const { return *scenario_; }
  /// The place of its shot list, if any.
  const std::filesystem::path& shots_file() const { return shots_file_; }

  /// The times of the log's control samples [s], at least two.
  const std::vector<double>& times_s() const { return saved_.dataset("control/time_s").values; }
  /// The end of the last sample's period [s].
  double end_s() const { return times_s().back() + (times_s()[1] - times_s()[0]); }
  /// The generalised positions at these times.
  const LoggedSignal& qpos() const { return saved_.dataset("control/qpos"); }

  /// The plant for pictures.
  Model load_scene() const;

  /// Whether an arrow or a line may use this name: a signal or a key.
  bool has(const std::string& key_or_signal) const {
    return config_->number(key_or_signal) || saved_.has_signal(key_or_signal);
  }
  /// A number of the run's configuration as a constant series, or a signal.
  Series value(const std::string& key_or_signal) const;
  /// `text` with each {KEY} replaced by the value of the key. Throws if there is no such key.
  std::string fill_in(const std::string& text) const;

 private:
  std::string log_file() const { return (folder() / "log.h5").string(); }
  void note_changed_models();
  void read_settings(const ScenarioKind& kind);

  const Catalogue* catalogue_;
  SavedRun saved_;
  std::vector<std::string> notes_;
  std::filesystem::path shots_file_;
  std::unique_ptr<Scenario> scenario_;
  std::unique_ptr<Config> config_;
};

/// The place of a run's shot list: shots.toml beside the run's model, or else the scenario's. It
/// may be missing.
std::filesystem::path shots_file(const ScenarioKind& kind, const Config& config);

}  // namespace breakwater
