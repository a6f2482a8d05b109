#include <breakwater/report/reproduction.h>

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>
#include <map>
#include <set>

#include <breakwater/scenario/all_cores.h>
#include <breakwater/scenario/progress.h>
#include <breakwater/scenario/runner.h>
#include <breakwater/scenario/saved_run.h>

namespace breakwater {
namespace fs = std::filesystem;
namespace {

constexpr const char* kLargest = "max ";
constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

// Metrics made of signals, "max SIGNAL", and the line that asks for each.
using Derived = std::map<std::string, std::size_t>;

struct Job {
  std::string name;
  std::size_t repetition = 0;
  PreparedRun run;
  ModelHashes models;
  Derived derived;
  bool is_logged = false;
  std::string key;
  double cost = 0.0;  // physics steps
};

// The scenario files, each read once.
class ScenarioFiles {
 public:
  explicit ScenarioFiles(const Catalogue& catalogue) : catalogue_(catalogue) {}

  const ScenarioFile& file(const std::string& scenario) {
    const auto found = files_.find(scenario);
    if (found != files_.end()) return found->second;
    const std::string file = catalogue_.get<ScenarioKind>(scenario).file().string();
    return files_.emplace(scenario, ScenarioFile(file, scenario)).first->second;
  }

 private:
  const Catalogue& catalogue_;
  std::map<std::string, ScenarioFile> files_;
};

// Calls `body` for each cell of the sections.
template <typename Sections, typename Body>
void each_cell(const Sections& sections, Body&& body) {
  for (const SectionSpec* section : sections) {
    for (const TableSpec& table : section->tables) {
      for (const auto& row : table.cells) {
        for (const auto& cell : row) {
          if (cell) body(*cell);
        }
      }
    }
  }
}

[[noreturn]] void fail(const Experiments& experiments, std::size_t line, const std::string& what) {
  throw std::invalid_argument(fmt::format("{}:{}: {}", experiments.file, line, what));
}

// For each run, the metrics that cells want made of its signals.
std::map<std::string, Derived> derived_metrics(const Experiments& experiments) {
  std::vector<const SectionSpec*> sections;
  for (const SectionSpec& section : experiments.sections) sections.push_back(&section);
  std::map<std::string, Derived> derived;
  each_cell(sections, [&](const CellSpec& cell) {
    for (const Quantity& quantity : cell.quantities()) {
      const std::string name = quantity.name();
      if (name.starts_with(kLargest)) derived[quantity.run].emplace(name, cell.line);
    }
  });
  return derived;
}

std::vector<Job> plan(const Reproduction& reproduction) {
  const Experiments& experiments = reproduction.experiments;
  const auto derived = derived_metrics(experiments);
  std::set<std::string> names;
  std::set<std::string> logged;
  for (const SectionSpec* section : reproduction.sections) {
    for (const std::string& name : section->runs()) names.insert(name);
    for (const std::string& name : section->logged_runs()) logged.insert(name);
  }
  ScenarioFiles files(reproduction.catalogue);
  std::map<std::vector<std::string>, ModelHashes> models;  // many runs have the same
  std::vector<Job> jobs;
  for (const std::string& name : names) {
    const RunSpec& spec = experiments.runs.at(name);
    for (std::size_t i = 0; i < spec.repetitions.size(); ++i) {
      std::vector<std::string> sets = spec.sets;
      sets.insert(sets.end(), spec.repetitions[i].begin(), spec.repetitions[i].end());
      Job job;
      job.name = name;
      job.repetition = i;
      try {
        const ScenarioFile& file = files.file(spec.scenario);
        job.run = prepare_run(reproduction.catalogue, spec.scenario, file, spec.case_name, sets);
        const Config config = file.config(spec.case_name, sets);
        const auto [known, is_new] = models.try_emplace(job.run.model_files);
        if (is_new) known->second = model_hashes(job.run.model_files);
        job.models = known->second;
        job.cost = config.number("run.duration_s").value_or(1.0) /
                   config.number("physics.timestep_s").value_or(1e-3);
      } catch (const std::invalid_argument& error) {
        fail(experiments, spec.line, fmt::format("run {}: {}", name, error.what()));
      }
      if (derived.contains(name)) job.derived = derived.at(name);
      job.is_logged = i == 0 && logged.contains(name);
      std::vector<std::string> parts = {spec.scenario, job.run.config_text, program_hash()};
      for (const auto& [file, hash] : job.models) parts.insert(parts.end(), {file, hash});
      for (const auto& [metric, line] : job.derived) parts.push_back(metric);
      job.key = fingerprint(parts);
      jobs.push_back(std::move(job));
    }
  }
  std::stable_sort(jobs.begin(), jobs.end(),
                   [](const Job& a, const Job& b) { return a.cost > b.cost; });
  return jobs;
}

// Whether the folder holds this very run, of the models and by the program that gave its numbers.
bool is_kept(const fs::path& folder, const Job& job) {
  if (!fs::exists(folder)) return false;
  try {
    const SavedRun run(folder);
    return run.config_text() == job.run.config_text && run.models() == job.models &&
           run.program() == program_hash();
  } catch (const std::invalid_argument&) {
    return false;
  }
}

double largest(const std::vector<double>& values) {
  const auto is_finite = [](double value) { return std::isfinite(value); };
  if (values.empty() || !std::all_of(values.begin(), values.end(), is_finite)) return kNaN;
  return *std::max_element(values.begin(), values.end());
}

// All values of the signal that `metric`, "max SIGNAL", is made of.
std::vector<double> values_for(const std::string& metric, std::size_t line, const Job& job,
                               const Experiments& experiments, const Track& track) {
  const std::string signal = metric.substr(std::string(kLargest).size());
  std::vector<std::string> names;
  for (std::size_t i = 0; i < track.signals(); ++i) {
    names.push_back(track.signal(i).name);
    if (names.back() == signal) return track.values(i);
  }
  fail(experiments, line,
       fmt::format("metric: run {} has no signal {}{}", job.name, signal,
                   did_you_mean(signal, names)));
}

Measurement measurement_of(const Job& job, const Experiments& experiments,
                           const Recording& recording) {
  Measurement measurement;
  if (recording.failure) {
    measurement.failed = true;
    measurement.failure =
        fmt::format("at {:.4g} s: {}", recording.failure->time_s, recording.failure->reason);
    return measurement;
  }
  for (const Metric& metric : recording.metrics) {
    measurement.values[metric.name] = std::isfinite(metric.value) ? metric.value : kNaN;
  }
  for (const auto& [metric, line] : job.derived) {
    measurement.values[metric] =
        largest(values_for(metric, line, job, experiments, recording.track("control")));
  }
  return measurement;
}

Measurement execute(const Job& job, const Reproduction& reproduction, const RunControl& control) {
  const auto start = std::chrono::steady_clock::now();
  const Recording recording = job.run.scenario->run(control);
  if (model_hashes(job.run.model_files) != job.models) {
    throw std::invalid_argument(
        fmt::format("run {}: its models were changed while it ran; start again", job.name));
  }
  if (job.is_logged) {
    RunFolder folder(run_folder(reproduction.out, job.name));
    const double wall_s =
        std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    write_run(job.run, job.models, recording, wall_s, folder, false);
  }
  return measurement_of(job, reproduction.experiments, recording);
}

// What the runs of each scenario have. One that failed has nothing.
std::map<std::string, std::set<std::string>> known_metrics(const Experiments& experiments,
                                                           const Measured& measured) {
  std::map<std::string, std::set<std::string>> known;
  for (const auto& [name, repetitions] : measured) {
    std::set<std::string>& names = known[experiments.runs.at(name).scenario];
    for (const Measurement& measurement : repetitions) {
      for (const auto& [metric, value] : measurement.values) names.insert(metric);
    }
  }
  return known;
}

// Refuses what no run of its scenario has, unless the cell says that it need not be there. Where
// all of them failed, nobody knows.
void check_metrics(const Reproduction& reproduction,
                   const std::map<std::string, std::set<std::string>>& known) {
  const Experiments& experiments = reproduction.experiments;
  each_cell(reproduction.sections, [&](const CellSpec& cell) {
    for (const Quantity& quantity : cell.quantities()) {
      const std::string& scenario = experiments.runs.at(quantity.run).scenario;
      const std::set<std::string>& names = known.at(scenario);
      const std::string name = quantity.name();
      if (names.empty() || names.contains(name)) continue;
      if (cell.absent_is_never) continue;
      fail(experiments, cell.line,
           fmt::format("metric: no run of {} has {}{}", scenario, name,
                       did_you_mean(name, {names.begin(), names.end()})));
    }
  });
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
  const auto metrics = known_metrics(reproduction.experiments, measured);
  check_metrics(reproduction, metrics);
  for (auto& [name, repetitions] : measured) {
    for (Measurement& measurement : repetitions) {
      for (const std::string& metric :
           metrics.at(reproduction.experiments.runs.at(name).scenario)) {
        if (!measurement.values.contains(metric)) measurement.absent.insert(metric);
      }
    }
  }
  return measured;
}

std::vector<double> values_of(const CellSpec& cell, const Measured& measured) {
  const auto value_of = [&](const Measurement& measurement, const std::string& name) {
    if (measurement.failed) return cell.if_failed;
    const auto found = measurement.values.find(name);
    if (found != measurement.values.end()) return found->second;
    const bool is_never = cell.absent_is_never && measurement.absent.contains(name);
    return is_never ? std::numeric_limits<double>::infinity() : kNaN;
  };
  const auto all_of = [&](const Quantity& quantity) {
    const std::string name = quantity.name();
    std::vector<double> values;
    for (const Measurement& measurement : measured.at(quantity.run)) {
      const double value = value_of(measurement, name);
      values.push_back(quantity.is_magnitude() ? std::abs(value) : value);
    }
    return values;
  };
  std::vector<double> values = all_of(cell.quantity);
  std::vector<double> divisors(values.size(), 1.0);
  if (cell.over) {
    divisors = all_of(*cell.over);
    if (cell.over->run != cell.quantity.run) divisors.assign(values.size(), median(divisors));
  }
  for (std::size_t i = 0; i < values.size(); ++i) {
    const bool is_part = std::isfinite(divisors[i]) && divisors[i] != 0.0;
    values[i] /= is_part ? divisors[i] * cell.divisor : kNaN;
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
