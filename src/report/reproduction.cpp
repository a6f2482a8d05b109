#include "report/reproduction.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>
#include <map>
#include <set>

#include "report/file_bytes.h"
#include "report/saved_run.h"
#include "scenario/all_cores.h"
#include "scenario/progress.h"
#include "scenario/runner.h"
#include "version.h"

namespace breakwater {
namespace fs = std::filesystem;
namespace {

constexpr const char* kLargest = "max ";

struct Job {
  std::string name;
  std::size_t repetition = 0;
  PreparedRun run;
  std::set<std::string> derived;  // metrics made of signals
  bool is_logged = false;
  std::string key;
  double cost = 0.0;  // physics steps
};

// The scenario files, each read once.
class ScenarioFiles {
 public:
  const ScenarioFile& file(const std::string& scenario) {
    const auto found = files_.find(scenario);
    if (found != files_.end()) return found->second;
    return files_.emplace(scenario, ScenarioFile(scenario_file(scenario).string(), scenario))
        .first->second;
  }

 private:
  std::map<std::string, ScenarioFile> files_;
};

// For each run, the metrics that cells want made of its signals.
std::map<std::string, std::set<std::string>> derived_metrics(const Experiments& experiments) {
  std::map<std::string, std::set<std::string>> derived;
  for (const SectionSpec& section : experiments.sections) {
    for (const TableSpec& table : section.tables) {
      for (const auto& row : table.cells) {
        for (const auto& cell : row) {
          if (!cell || !cell->metric.starts_with(kLargest)) continue;
          derived[cell->run].insert(cell->metric);
          if (!cell->over.empty()) derived[cell->over].insert(cell->metric);
        }
      }
    }
  }
  return derived;
}

// The models are part of a configuration that their names alone do not tell. Each is read once.
class Models {
 public:
  std::string of(const Config& config) {
    std::string all;
    for (const char* key : {"model.mjcf", "model.urdf"}) {
      const ConfigEntry* entry = config.find(key);
      const auto* name = entry != nullptr ? std::get_if<std::string>(&entry->value.data) : nullptr;
      if (name == nullptr) continue;
      const std::string file = config.find_file_of(key, *name);
      if (!contents_.contains(file)) contents_[file] = fingerprint({bytes_of(file)});
      all += contents_[file];
    }
    return all;
  }

 private:
  std::map<std::string, std::string> contents_;
};

std::vector<Job> plan(const Reproduction& reproduction) {
  const Experiments& experiments = reproduction.experiments;
  const auto derived = derived_metrics(experiments);
  std::set<std::string> names;
  std::set<std::string> logged;
  for (const SectionSpec* section : reproduction.sections) {
    for (const std::string& name : section->runs()) names.insert(name);
    for (const std::string& name : section->logged_runs()) logged.insert(name);
  }
  ScenarioFiles files;
  Models models;
  // A version's name does not tell two builds of changed sources apart.
  const std::string program = fingerprint({bytes_of("/proc/self/exe")});
  std::vector<Job> jobs;
  for (const std::string& name : names) {
    const RunSpec& spec = experiments.runs.at(name);
    for (std::size_t i = 0; i < spec.repetitions.size(); ++i) {
      std::vector<std::string> sets = spec.sets;
      sets.insert(sets.end(), spec.repetitions[i].begin(), spec.repetitions[i].end());
      Job job;
      std::string contents;
      job.name = name;
      job.repetition = i;
      try {
        const ScenarioFile& file = files.file(spec.scenario);
        job.run = prepare_run(spec.scenario, file, spec.case_name, sets);
        const Config config = file.config(spec.case_name, sets);
        contents = models.of(config);
        job.cost = config.number("run.duration_s").value_or(1.0) /
                   config.number("physics.timestep_s").value_or(1e-3);
      } catch (const std::invalid_argument& error) {
        throw std::invalid_argument(
            fmt::format("{}: run {}: {}", experiments.file, name, error.what()));
      }
      if (derived.contains(name)) job.derived = derived.at(name);
      job.is_logged = i == 0 && logged.contains(name);
      std::vector<std::string> parts = {spec.scenario, job.run.config_text, contents, program};
      parts.insert(parts.end(), job.derived.begin(), job.derived.end());
      job.key = fingerprint(parts);
      jobs.push_back(std::move(job));
    }
  }
  std::stable_sort(jobs.begin(), jobs.end(),
                   [](const Job& a, const Job& b) { return a.cost > b.cost; });
  return jobs;
}

// Whether the folder holds this very run of this very version.
bool is_kept(const fs::path& folder, const Job& job) {
  if (!fs::exists(folder)) return false;
  try {
    const SavedRun run(folder);
    return run.config_text() == job.run.config_text && run.git_commit() == kGitCommit;
  } catch (const std::invalid_argument&) {
    return false;
  }
}

Measurement measurement_of(const Job& job, const Recording& recording) {
  Measurement measurement;
  if (recording.failure) {
    measurement.failed = true;
    measurement.failure =
        fmt::format("at {:.4g} s: {}", recording.failure->time_s, recording.failure->reason);
    return measurement;
  }
  for (const Metric& metric : recording.metrics) {
    if (std::isfinite(metric.value)) measurement.values[metric.name] = metric.value;
  }
  for (const std::string& name : job.derived) {
    const std::vector<double> values =
        recording.track("control").values(name.substr(std::string(kLargest).size()));
    measurement.values[name] = *std::max_element(values.begin(), values.end());
  }
  return measurement;
}

Measurement execute(const Job& job, const Reproduction& reproduction, const RunControl& control) {
  const auto start = std::chrono::steady_clock::now();
  const Recording recording = job.run.scenario->run(control);
  if (job.is_logged) {
    RunFolder folder(run_folder(reproduction.out, job.name));
    const double wall_s =
        std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    write_run(job.run, recording, wall_s, folder, false);
  }
  return measurement_of(job, recording);
}

}  // namespace

fs::path run_folder(const fs::path& out, const std::string& run) {
  return out / "runs" / run;
}

Measured measure(const Reproduction& reproduction) {
  const std::vector<Job> all = plan(reproduction);
  fs::create_directories(reproduction.out);
  Measurements known(reproduction.out / "measurements.jsonl");
  std::vector<const Job*> jobs;  // what is left to do
  std::vector<double> costs;
  for (const Job& job : all) {
    const bool has_folder = !job.is_logged || is_kept(run_folder(reproduction.out, job.name), job);
    if (known.find(job.key) && has_folder) continue;
    jobs.push_back(&job);
    costs.push_back(job.cost);
  }
  if (!reproduction.quiet) {
    fmt::print(stderr, "reproduce: {} runs, {} of them there already\n", all.size(),
               all.size() - jobs.size());
  }

  if (!jobs.empty()) {
    Progress progress("reproduce", costs, reproduction.quiet);
    std::atomic<std::size_t> finished = 0;
    try {
      on_all_cores(jobs.size(), [&](std::size_t i) {
        const RunControl control{[&progress, i](double done) { progress.update(i, done); },
                                 reproduction.stop};
        known.add(jobs[i]->key, jobs[i]->name, execute(*jobs[i], reproduction, control));
        progress.finish(i);
        ++finished;
      });
    } catch (const Interrupted&) {
      throw Interrupted(all.size() - jobs.size() + finished);
    }
  }

  Measured measured;
  for (const Job& job : all) {
    std::vector<Measurement>& repetitions = measured[job.name];
    repetitions.resize(std::max(repetitions.size(), job.repetition + 1));
    repetitions[job.repetition] = *known.find(job.key);
  }
  return measured;
}

std::vector<double> values_of(const CellSpec& cell, const Measured& measured) {
  const bool is_absolute = cell.metric.starts_with('|') && cell.metric.ends_with('|');
  const std::string name =
      is_absolute ? cell.metric.substr(1, cell.metric.size() - 2) : cell.metric;
  const auto all_of = [&](const std::string& run) {
    std::vector<double> values;
    for (const Measurement& measurement : measured.at(run)) {
      const auto found = measurement.values.find(name);
      double value = found != measurement.values.end() ? found->second
                                                       : std::numeric_limits<double>::infinity();
      if (measurement.failed) value = cell.if_failed;
      values.push_back((is_absolute ? std::abs(value) : value) / cell.divisor);
    }
    return values;
  };
  std::vector<double> values = all_of(cell.run);
  if (!cell.over.empty()) {
    double over = median(all_of(cell.over));
    if (!std::isfinite(over) || over == 0.0) over = std::numeric_limits<double>::quiet_NaN();
    for (double& value : values) value /= over;
  }
  return values;
}

double median(std::vector<double> values) {
  if (std::any_of(values.begin(), values.end(), [](double v) { return std::isnan(v); })) {
    return std::numeric_limits<double>::quiet_NaN();
  }
  std::sort(values.begin(), values.end());
  const std::size_t middle = values.size() / 2;
  if (values.size() % 2 == 1 || values[middle - 1] == values[middle]) return values[middle];
  return 0.5 * (values[middle - 1] + values[middle]);
}

}  // namespace breakwater
