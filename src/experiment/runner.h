// From a scenario file to finished run folders.
#pragma once

#include <atomic>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <breakwater/experiment/catalogue.h>
#include <breakwater/experiment/known_models.h>
#include <breakwater/experiment/provenance.h>
#include <breakwater/record/recording.h>
#include <breakwater/record/run_folder.h>

namespace breakwater {

/// A key that its case or --set gives though it has no effect in the run.
struct IneffectiveKey {
  std::string origin;  ///< "FILE:LINE" or "--set"
  std::string key;
  std::string reason;
};

/// One case, read and checked, that may be run.
struct PreparedRun {
  std::unique_ptr<Scenario> scenario;
  std::string case_name;
  std::string config_text;                  ///< the effective configuration, as a scenario file
  std::vector<IneffectiveKey> ineffective;  ///< what the case or --set gives
  bool is_as_shipped = false;            ///< the project's own case, but for seed and compression
  std::vector<std::string> model_files;  ///< that its keys name
};

/// What is left of a run once its folder is written.
struct RunSummary {
  std::string case_name;
  std::filesystem::path folder;
  std::vector<Metric> metrics;
  bool is_as_shipped = true;  ///< so that a comparison with printed values means something
  std::optional<Failure> failure;
  std::vector<std::string> warnings;
  double simulated_s = 0.0;
  double wall_s = 0.0;
};

/// Whether the tables of a scenario file are known to be right, since one of its cases was
/// prepared.
enum class Tables { checked, unchecked };

/// The run of a scenario that was made, by one case of a file, with `sets` (key=value) on top; as
/// shipped or not is not known. It is called after its case, or `called`. Throws
/// std::invalid_argument, one line.
PreparedRun prepare_scenario(std::unique_ptr<Scenario> scenario, const ScenarioFile& file,
                             const std::string& case_name, const std::vector<std::string>& sets,
                             Tables tables, const std::string& called = "");

/// The same of a scenario's name; whether it is as shipped is found out.
PreparedRun prepare_run(const Catalogue& catalogue, const std::string& scenario,
                        const ScenarioFile& file, const std::string& case_name,
                        const std::vector<std::string>& sets);

/// The same of a file whose tables are checked, for one run of very many: not known to be as
/// shipped.
PreparedRun prepare_point(const Catalogue& catalogue, const std::string& scenario,
                          const ScenarioFile& file, const std::string& case_name,
                          const std::vector<std::string>& sets);

struct RunOptions {
  bool csv = false;
  bool quiet = false;
  const std::atomic<bool>* stop = nullptr;
  /// Those that the runs were prepared with, while SharedModels lived; null: each run reads its
  /// own.
  KnownModels* models = nullptr;
};

/// Writes all that a run leaves into its folder, which then takes its place. `models` are those
/// that it was made of. Throws OutputError.
void write_run(const PreparedRun& run, const ModelHashes& models, const Recording& recording,
               double wall_s, RunFolder& folder, bool csv);

/// Runs all of `runs`, on all cores, each into its folder of `targets`. Nothing runs unless all
/// of them can be written. Throws std::invalid_argument, OutputError or Interrupted; a run that
/// fails is in its summary. A known model that changed since it was read is an invalid argument.
std::vector<RunSummary> execute_runs(const std::vector<PreparedRun>& runs,
                                     const std::vector<std::filesystem::path>& targets,
                                     const RunOptions& options);

}  // namespace breakwater
