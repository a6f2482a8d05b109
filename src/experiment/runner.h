// Runs cases of a scenario file and writes their folders.
#pragma once

#include <atomic>
#include <filesystem>
#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

#include <breakwater/experiment/catalogue.h>
#include <breakwater/experiment/known_models.h>
#include <breakwater/experiment/provenance.h>
#include <breakwater/record/log_stream.h>
#include <breakwater/record/recording.h>
#include <breakwater/record/run_folder.h>

namespace breakwater {

/// An ineffective key that the case or --set sets.
struct IneffectiveKey {
  std::string origin;  ///< "FILE:LINE" or "--set"
  std::string key;
  std::string reason;
};

/// One case, read, checked and ready to run.
struct PreparedRun {
  std::shared_ptr<Scenario> scenario;
  std::string case_name;
  std::string config_text;                  ///< the effective configuration, as a scenario file
  std::vector<IneffectiveKey> ineffective;  ///< ineffective keys of the case or --set
  bool is_as_shipped = false;               ///< found by is_as_shipped(), if anybody asks
  std::vector<std::string> model_files;     ///< the files that its keys name
};

/// The results of a run whose folder is written, without its log.
struct RunSummary : Recording {
  std::string case_name;
  std::filesystem::path folder;
  bool is_as_shipped = false;  ///< required for a comparison with printed values
  double wall_s = 0.0;
};

/// Prepares one case of a file for a given scenario, with `sets` (key=value) on top. The run has
/// the name of its case, or `called`. Throws std::invalid_argument, one line.
PreparedRun prepare_scenario(std::unique_ptr<Scenario> scenario, const ScenarioFile& file,
                             const std::string& case_name, const std::vector<std::string>& sets,
                             const std::string& called = "");

/// The same by the scenario's name.
inline PreparedRun prepare_run(const Catalogue& catalogue, const std::string& scenario,
                               const ScenarioFile& file, const std::string& case_name,
                               const std::vector<std::string>& sets) {
  return prepare_scenario(make_scenario(catalogue, scenario), file, case_name, sets);
}

/// Whether the run has the configuration of Breakwater's own case with its name. The seed and the
/// record of the log may differ.
bool is_as_shipped(const Catalogue& catalogue, const PreparedRun& run);

/// Scenarios of one file whose keys are bound. Threads may share it.
class BoundCases {
 public:
  struct Case;
  using Shape = std::vector<std::string>;  ///< the case and its sets, without their numbers

  /// A case of this shape; null if none is free.
  std::shared_ptr<Case> take(const Shape& shape);
  void give_back(const Shape& shape, const std::shared_ptr<Case>& one) noexcept;

 private:
  std::mutex mutex_;
  std::multimap<Shape, std::shared_ptr<Case>> free_;
};

/// The same for one run of many. The file's tables are checked. With `bound` its ineffective keys
/// are unknown. It then takes the scenario of an earlier run that has ended and differed in numbers
/// alone, if its kind may be shared.
PreparedRun prepare_point(const Catalogue& catalogue, const std::string& scenario,
                          const ScenarioFile& file, const std::string& case_name,
                          const std::vector<std::string>& sets,
                          const std::shared_ptr<BoundCases>& bound = nullptr);

struct RunOptions {
  bool csv = false;
  bool quiet = false;
  const std::atomic<bool>* stop = nullptr;
  /// The models of the prepared runs, under SharedModels; null: each run reads its own.
  KnownModels* models = nullptr;
};

/// A run at its end. Its log is in memory, unless it was streamed.
struct EndedRun {
  ModelHashes models;
  Recording recording;
  double wall_s = 0.0;
};

/// Runs one. With a `folder`, all its files are there then, also the log while it is streamed.
/// Throws as Scenario::run() and write_run().
EndedRun run_to_end(const PreparedRun& run, ModelHashes models, RunControl control,
                    RunFolder* folder = nullptr, bool csv = false);

/// Writes all files of a run into its folder and moves this to its target. `stream` has the log,
/// unless it is null. Throws OutputError.
void write_run(const PreparedRun& run, const EndedRun& ended, RunFolder& folder, bool csv = false,
               LogStream* stream = nullptr);

/// Runs all of `runs` on all cores, each into its folder of `targets`. It begins only if all
/// folders can be written. Throws std::invalid_argument (also if a known model has changed),
/// OutputError or Interrupted. A failed run is in its summary.
std::vector<RunSummary> execute_runs(const std::vector<PreparedRun>& runs,
                                     const std::vector<std::filesystem::path>& targets,
                                     const RunOptions& options);

}  // namespace breakwater
