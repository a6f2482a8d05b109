#include <breakwater/experiment/runner.h>

#include <fmt/format.h>

#include <Eigen/Core>
#include <algorithm>
#include <chrono>
#include <filesystem>
#include <forward_list>
#include <nlohmann/json.hpp>
#include <optional>
#include <set>
#include <stdexcept>

#include <breakwater/config/toml_text.h>
#include <breakwater/experiment/run_manifest.h>
#include <breakwater/experiment/version.h>
#include <breakwater/math/float_environment.h>
#include <breakwater/record/file_hash.h>
#include <breakwater/record/hdf5_log.h>
#include <breakwater/record/partial_file.h>
#include <breakwater/record/recording.h>
#include <breakwater/record/text_outputs.h>
#include <breakwater/shell/all_cores.h>
#include <breakwater/shell/child_program.h>
#include <breakwater/shell/progress.h>
#include <breakwater/sim/engine_guard.h>

namespace breakwater {
namespace {

using nlohmann::ordered_json;

// manifest.json: the name of a run, its results and its origin.
std::string manifest_text(const PreparedRun& run, const ModelHashes& models,
                          const ordered_json& results) {
  ordered_json entries = {{"scenario", run.scenario->name()},
                          {"case", run.case_name},
                          {"seed", run.scenario->run_settings().seed}};
  entries.update(results);
  entries.update({{"point", point_key(run.config_text, models)},
                  {"breakwater", kVersion},
                  {"git_commit", kGitCommit},
                  {"program", program_hash()},
                  {"models", models},
                  {"versions",
                   {{"mujoco", engine_version()},
                    {"eigen", fmt::format("{}.{}.{}", EIGEN_WORLD_VERSION, EIGEN_MAJOR_VERSION,
                                          EIGEN_MINOR_VERSION)},
                    {"hdf5", hdf5_version()},
                    {"compiler", __VERSION__}}}});
  return entries.dump(2) + "\n";
}

// With the hashes of the files that it has in `folder`.
ordered_json results_of(const EndedRun& ended, const std::filesystem::path& folder) {
  const Recording& recording = ended.recording;
  ordered_json entries;
  entries["status"] = recording.failure ? "failed" : "complete";
  if (recording.failure) {
    entries["reason"] = recording.failure->reason;
    entries["time_s"] = recording.failure->time_s;
  }
  if (!recording.warnings.empty()) entries["warnings"] = recording.warnings;
  for (const AbsentMetric& metric : recording.absent) {
    entries["absent"][metric.name] = metric.reason;
  }
  entries["state_hash"] = fmt::format("{:016x}", recording.state_hash);
  entries["simulated_s"] = recording.simulated_s;
  entries["dropped_samples"] = recording.dropped_samples;
  entries["wall_time_s"] = ended.wall_s;
  entries["costs"] = ordered_json::object();
  for (const Metric& cost : recording.costs) entries["costs"][cost.name] = cost.value;
  for (const char* file : {"config.toml", "metrics.json", "log.h5"}) {
    const std::filesystem::path path = folder / file;
    if (std::filesystem::exists(path)) entries[path.stem().string() + "_hash"] = file_hash(path);
  }
  return entries;
}

// The folder with the log of a streamed run that did not end, in words for messages.
std::string where_the_log_is(const std::filesystem::path& folder) {
  return "its log so far is in " + shell_word(folder.string());
}

RunSummary execute(const PreparedRun& run, RunFolder& folder, const RunOptions& options,
                   RunControl control) {
  const math::FloatEnvironment floats;
  // The models may have changed since the preparation: other runs may have taken hours.
  if (options.models != nullptr) options.models->check_unchanged(run.model_files);
  ModelHashes models = options.models != nullptr ? options.models->of(run.model_files)
                                                 : model_hashes(run.model_files);
  try {
    EndedRun ended = run_to_end(run, std::move(models), control, &folder, options.csv);
    ended.recording.tracks.clear();
    return {std::move(ended.recording), run.case_name, folder.target(), run.is_as_shipped,
            ended.wall_s};
  } catch (const OutputError& error) {
    if (!is_kept(folder.path())) throw with_final_name(error, folder.path(), folder.target());
    throw OutputError(fmt::format("{}; {}", error.what(), where_the_log_is(folder.path())));
  }
}

// The sets of a case without their numbers, which BoundCases::Case can change. Empty if a key is
// given twice: its last number would count.
BoundCases::Shape shape_of(const std::string& case_name, const std::vector<std::string>& sets) {
  BoundCases::Shape shape = {case_name};
  std::set<std::string> keys;
  for (const std::string& set : sets) {
    const std::size_t equals = std::min(set.find('='), set.size() - 1);
    const std::string key = set.substr(0, equals);
    if (!keys.insert(key).second) return {};
    const bool is_number = whole_key(key) == key && number_in(set.substr(equals + 1));
    shape.push_back(is_number ? key : set);
  }
  return shape;
}

}  // namespace

// A case of a file, bound to a scenario.
struct BoundCases::Case {
  Case(std::unique_ptr<Scenario> made, const Config& config)
      : scenario(std::move(made)), given(config) {
    scenario->learn(config);
    fields = scenario->fields();
  }

  // Reads the keys of `given`.
  void read() {
    read_config = fields.read(given);
    scenario->check(read_config, fields);
  }

  // Reads those of other sets with the same shape. False if they have to be bound anew.
  bool read(const std::vector<std::string>& others) {
    for (std::size_t i = 0; i < others.size(); ++i) {
      if (others[i] == sets[i]) continue;
      Config one("", {});
      one.set(others[i]);
      const auto& [key, entry] = *one.entries().begin();
      if (!fields.renew(read_config, key, entry.value)) return false;
    }
    sets = others;
    fields.read_again(read_config);
    scenario->check(read_config, fields);
    return true;
  }

  std::vector<IneffectiveKey> ineffective() const {
    std::vector<IneffectiveKey> keys;
    for (const UnusedKey& unused : fields.unused()) {
      const ConfigEntry& entry = *given.find(unused.key);
      if (!entry.is_chosen) continue;
      // A case may set keys for its own choice. A user who chooses another part made no mistake.
      const ConfigEntry* choice = given.find(unused.choice);
      const bool is_chosen_otherwise = choice != nullptr && choice->is_set() && !entry.is_set();
      if (!is_chosen_otherwise) keys.push_back({entry.origin, unused.key, unused.reason});
    }
    return keys;
  }

  // The run, without its scenario and its ineffective keys.
  PreparedRun run(const std::string& name) const {
    PreparedRun run;
    run.case_name = name;
    run.config_text = fields.print(scenario->name(), name);
    run.model_files = fields.files();
    return run;
  }

  std::unique_ptr<Scenario> scenario;
  Config given;  // with the numbers of its first run
  Fields fields;
  Config read_config{"", {}};
  std::vector<std::string> sets;
};

std::shared_ptr<BoundCases::Case> BoundCases::take(const Shape& shape) {
  const std::lock_guard lock(mutex_);
  const auto found = free_.find(shape);
  if (found == free_.end()) return nullptr;
  std::shared_ptr<Case> one = std::move(found->second);
  free_.erase(found);
  return one;
}

void BoundCases::give_back(const Shape& shape, const std::shared_ptr<Case>& one) noexcept {
  constexpr std::size_t kMost = 32;  // each about 1 MB
  const std::lock_guard lock(mutex_);
  if (free_.size() == kMost) free_.clear();
  try {
    free_.emplace(shape, one);
  } catch (const std::bad_alloc&) {  // the next point binds its own
  }
}

PreparedRun prepare_scenario(std::unique_ptr<Scenario> scenario, const ScenarioFile& file,
                             const std::string& case_name, const std::vector<std::string>& sets,
                             const std::string& called) {
  const math::FloatEnvironment floats;
  BoundCases::Case bound(std::move(scenario), file.config(case_name, sets));
  bound.fields.check(file);
  bound.read();
  PreparedRun run = bound.run(called.empty() ? case_name : called);
  run.ineffective = bound.ineffective();
  run.scenario = std::move(bound.scenario);
  return run;
}

bool is_as_shipped(const Catalogue& catalogue, const PreparedRun& run) {
  const auto& kind = catalogue.get<ScenarioKind>(run.scenario->name());
  const auto file = kind.scenario_file();
  if (!file->has_case(run.case_name)) return false;
  const RunSettings& settings = run.scenario->run_settings();
  std::vector<std::string> sets = {fmt::format("run.seed={}", settings.seed),
                                   fmt::format("record.compression={}", settings.compression)};
  if (settings.stream) sets.emplace_back("record.stream=true");
  BoundCases::Case shipped(kind.make(catalogue), file->config(run.case_name, sets));
  shipped.read();
  return shipped.fields.print(kind.name, run.case_name) == run.config_text;
}

PreparedRun prepare_point(const Catalogue& catalogue, const std::string& scenario,
                          const ScenarioFile& file, const std::string& case_name,
                          const std::vector<std::string>& sets,
                          const std::shared_ptr<BoundCases>& bound) {
  const math::FloatEnvironment floats;
  const bool is_shared = bound && catalogue.get<ScenarioKind>(scenario).may_be_shared;
  const BoundCases::Shape shape = is_shared ? shape_of(case_name, sets) : BoundCases::Shape();
  std::shared_ptr<BoundCases::Case> one = shape.empty() ? nullptr : bound->take(shape);
  try {
    if (one && !one->read(sets)) one.reset();
  } catch (const std::invalid_argument&) {
    one.reset();  // the case that is bound anew says it
  }
  if (!one) {
    one = std::make_shared<BoundCases::Case>(make_scenario(catalogue, scenario),
                                             file.config(case_name, sets));
    one->read();
    one->sets = sets;
  }
  PreparedRun run = one->run(case_name);
  if (!bound) run.ineffective = one->ineffective();
  const auto end = [one, bound, shape](Scenario*) {
    if (!shape.empty()) bound->give_back(shape, one);
  };
  run.scenario = {one->scenario.get(), end};
  return run;
}

EndedRun run_to_end(const PreparedRun& run, ModelHashes models, RunControl control,
                    RunFolder* folder, bool csv) {
  const auto start = std::chrono::steady_clock::now();
  std::optional<LogStream> stream;
  if (folder != nullptr && run.scenario->run_settings().stream) {
    stream.emplace(folder->path(), run.config_text,
                   manifest_text(run, models, {{"status", kRunning}, {"state_hash", ""}}));
    control.stream = &*stream;
  }
  EndedRun ended{std::move(models), run.scenario->run(control)};
  ended.wall_s = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  if (folder != nullptr) write_run(run, ended, *folder, csv, control.stream);
  return ended;
}

void write_run(const PreparedRun& run, const EndedRun& ended, RunFolder& folder, bool csv,
               LogStream* stream) try {
  const Recording& recording = ended.recording;
  const std::filesystem::path& path = folder.path();
  std::filesystem::path log = path / "log.h5";
  if (stream != nullptr) {
    log = stream->finish(recording.tracks);
  } else {
    write_text_file(path / "config.toml", run.config_text);
    write_hdf5_log(log, recording.tracks, run.scenario->run_settings().compression);
  }
  if (csv) write_csv_log(path / "log.csv", recording.tracks.front());
  if (!recording.failure) write_metrics(path / "metrics.json", recording.metrics);
  std::filesystem::rename(log, path / "log.h5");
  const std::string manifest = manifest_text(run, ended.models, results_of(ended, path));
  // A streamed run has one already, which must stay whole if this process is killed.
  const std::filesystem::path file = path / "manifest.json";
  stream != nullptr ? replace_file(file, manifest) : write_text_file(file, manifest);
  folder.commit();
} catch (const OutputError& error) {
  if (is_kept(folder.path())) throw;
  throw with_final_name(error, folder.path(), folder.target());
}

std::vector<RunSummary> execute_runs(const std::vector<PreparedRun>& runs,
                                     const std::vector<std::filesystem::path>& targets,
                                     const RunOptions& options) {
  for (const PreparedRun& run : runs) {
    if (options.csv && run.scenario->run_settings().stream) {
      throw std::invalid_argument(
          "--csv: needs the log in memory, so leave out record.stream=true");
    }
  }
  // Destroyed last first: the first one may have made the parent folders, and removes only empty
  // ones.
  std::forward_list<RunFolder> owned;
  std::vector<RunFolder*> folders;
  for (const auto& target : targets) folders.push_back(&owned.emplace_front(target));
  std::vector<RunSummary> summaries(runs.size());
  Progress progress(runs.front().scenario->name(), std::vector<double>(runs.size(), 1.0),
                    options.quiet);
  try {
    on_all_cores(runs.size(), [&](std::size_t i) {
      RunControl control{[&progress, i](double done) { progress.update(i, done); }, options.stop};
      summaries[i] = execute(runs[i], *folders[i], options, control);
      progress.finish(i);
    });
  } catch (const Interrupted&) {
    std::string kept;
    for (const RunFolder* folder : folders) {
      if (is_kept(folder->path())) kept += "; " + where_the_log_is(folder->path());
    }
    throw Interrupted(kept);
  }
  return summaries;
}

}  // namespace breakwater
