#include <breakwater/experiment/runner.h>

#include <fmt/format.h>

#include <Eigen/Core>
#include <algorithm>
#include <chrono>
#include <nlohmann/json.hpp>

#include <breakwater/experiment/main_metrics.h>
#include <breakwater/record/file_hash.h>
#include <breakwater/record/hdf5_log.h>
#include <breakwater/record/text_outputs.h>
#include <breakwater/shell/all_cores.h>
#include <breakwater/shell/progress.h>
#include <breakwater/sim/engine_guard.h>
#include <breakwater/version.h>

namespace breakwater {
namespace {

std::string manifest(const PreparedRun& run, const ModelHashes& models, const Recording& recording,
                     double wall_s, const std::string& log_hash) {
  nlohmann::ordered_json entries;
  entries["scenario"] = run.scenario->name();
  entries["case"] = run.case_name;
  entries["seed"] = run.scenario->run_settings().seed;
  entries["status"] = recording.failure ? "failed" : "complete";
  if (recording.failure) {
    entries["reason"] = recording.failure->reason;
    entries["time_s"] = recording.failure->time_s;
  }
  if (!recording.warnings.empty()) entries["warnings"] = recording.warnings;
  entries["point"] = point_key(run.config_text, models);
  entries["state_hash"] = fmt::format("{:016x}", recording.state_hash);
  entries["log_hash"] = log_hash;
  entries["simulated_s"] = recording.simulated_s;
  entries["dropped_samples"] = recording.dropped_samples;
  entries["wall_time_s"] = wall_s;
  entries["costs"] = nlohmann::ordered_json::object();
  for (const Metric& cost : recording.costs) entries["costs"][cost.name] = cost.value;
  entries["breakwater"] = kVersion;
  entries["git_commit"] = kGitCommit;
  entries["program"] = program_hash();
  entries["models"] = models;
  entries["versions"] = {{"mujoco", engine_version()},
                         {"eigen", fmt::format("{}.{}.{}", EIGEN_WORLD_VERSION, EIGEN_MAJOR_VERSION,
                                               EIGEN_MINOR_VERSION)},
                         {"hdf5", hdf5_version()},
                         {"compiler", __VERSION__}};
  return entries.dump(2) + "\n";
}

// Destroyed last first: the first one may have made the parent folders, and removes only empty
// ones.
class RunFolders {
 public:
  RunFolders() = default;
  // Delegates, so that the destructor also runs if a later target is refused.
  explicit RunFolders(const std::vector<std::filesystem::path>& targets) : RunFolders() {
    for (const auto& target : targets) folders_.push_back(std::make_unique<RunFolder>(target));
  }
  ~RunFolders() {
    while (!folders_.empty()) folders_.pop_back();
  }
  RunFolders(const RunFolders&) = delete;
  RunFolders& operator=(const RunFolders&) = delete;

  RunFolder& operator[](std::size_t i) { return *folders_[i]; }

 private:
  std::vector<std::unique_ptr<RunFolder>> folders_;
};

RunSummary execute(const PreparedRun& run, RunFolder& folder, const RunOptions& options,
                   const RunControl& control) {
  const auto start = std::chrono::steady_clock::now();
  // The models may have changed since the preparation: other runs may have taken hours.
  if (options.models != nullptr) options.models->check_unchanged(run.model_files);
  const ModelHashes models = options.models != nullptr ? options.models->of(run.model_files)
                                                       : model_hashes(run.model_files);
  const Recording recording = run.scenario->run(control);

  const double wall_s =
      std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  write_run(run, models, recording, wall_s, folder, options.csv);
  return {run.case_name,     folder.target(),    recording.metrics,     run.is_as_shipped,
          recording.failure, recording.warnings, recording.simulated_s, wall_s};
}

// The configuration of Breakwater's own case with this name, with the seed and the compression of
// `scenario`; empty if there is none.
std::string shipped_config(const Catalogue& catalogue, const Scenario& scenario,
                           const std::string& case_name) {
  const auto& kind = catalogue.get<ScenarioKind>(scenario.name());
  const ScenarioFile file(kind.file().string(), kind.name);
  if (!file.has_case(case_name)) return "";
  const RunSettings& settings = scenario.run_settings();
  const Config config =
      file.config(case_name, {fmt::format("run.seed={}", settings.seed),
                              fmt::format("record.compression={}", settings.compression)});
  const auto shipped = kind.make(catalogue);
  shipped->learn(config);
  Fields fields = shipped->fields();
  fields.read(config);
  shipped->check(config);
  return fields.print(scenario.name(), case_name);
}

}  // namespace

PreparedRun prepare_scenario(std::unique_ptr<Scenario> scenario, const ScenarioFile& file,
                             const std::string& case_name, const std::vector<std::string>& sets,
                             Tables tables, const std::string& called) {
  PreparedRun run;
  run.scenario = std::move(scenario);
  run.case_name = called.empty() ? case_name : called;
  const Config config = file.config(case_name, sets);
  run.scenario->learn(config);
  Fields fields = run.scenario->fields();
  if (tables == Tables::unchecked) fields.check(file);
  fields.read(config);
  run.scenario->check(config);
  for (const UnusedKey& unused : fields.unused()) {
    const ConfigEntry& entry = *config.find(unused.key);
    if (!entry.is_chosen) continue;
    // A case may set keys for its own choice. A user who chooses another part made no mistake.
    const ConfigEntry* choice = config.find(unused.choice);
    const bool is_chosen_otherwise = choice != nullptr && choice->is_set() && !entry.is_set();
    if (!is_chosen_otherwise) run.ineffective.push_back({entry.origin, unused.key, unused.reason});
  }
  run.config_text = fields.print(run.scenario->name(), run.case_name);
  run.model_files = fields.files();
  return run;
}

PreparedRun prepare_run(const Catalogue& catalogue, const std::string& scenario,
                        const ScenarioFile& file, const std::string& case_name,
                        const std::vector<std::string>& sets) {
  PreparedRun run = prepare_scenario(make_scenario(catalogue, scenario), file, case_name, sets,
                                     Tables::unchecked);
  run.is_as_shipped = shipped_config(catalogue, *run.scenario, case_name) == run.config_text;
  return run;
}

PreparedRun prepare_point(const Catalogue& catalogue, const std::string& scenario,
                          const ScenarioFile& file, const std::string& case_name,
                          const std::vector<std::string>& sets) {
  return prepare_scenario(make_scenario(catalogue, scenario), file, case_name, sets,
                          Tables::checked);
}

void write_run(const PreparedRun& run, const ModelHashes& models, const Recording& recording,
               double wall_s, RunFolder& folder, bool csv) {
  const std::filesystem::path& path = folder.path();
  write_text_file(path / "config.toml", run.config_text);
  write_hdf5_log(path / "log.h5", recording.tracks, run.scenario->run_settings().compression);
  if (csv) write_csv_log(path / "log.csv", recording.tracks.front());
  if (!recording.failure) write_metrics(path / "metrics.json", recording.metrics);
  write_text_file(path / "manifest.json",
                  manifest(run, models, recording, wall_s, file_hash(path / "log.h5")));
  folder.commit();
}

std::vector<RunSummary> execute_runs(const std::vector<PreparedRun>& runs,
                                     const std::vector<std::filesystem::path>& targets,
                                     const RunOptions& options) {
  RunFolders folders(targets);
  std::vector<RunSummary> summaries(runs.size());
  Progress progress(runs.front().scenario->name(), runs.size(), options.quiet);
  try {
    on_all_cores(runs.size(), [&](std::size_t i) {
      RunControl control{[&progress, i](double done) { progress.update(i, done); }, options.stop};
      // Only for a single run: the numbers of several would alternate.
      if (runs.size() == 1 && progress.is_seen()) {
        control.measured = [&](const std::vector<Metric>& so_far) {
          progress.note(brief(main_metrics(runs[i].scenario->main_metrics(), so_far)));
        };
      }
      summaries[i] = execute(runs[i], folders[i], options, control);
      progress.finish(i);
    });
  } catch (const Interrupted&) {
    throw Interrupted(static_cast<std::size_t>(
        std::count_if(summaries.begin(), summaries.end(),
                      [](const RunSummary& run) { return !run.folder.empty(); })));
  }
  return summaries;
}

}  // namespace breakwater
