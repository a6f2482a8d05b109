#include <breakwater/thesis/reproduction.h>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>

#include <breakwater/experiment/runner.h>
#include <breakwater/experiment/saved_run.h>
#include <breakwater/shell/did_you_mean.h>
#include <breakwater/shell/progress.h>
#include <breakwater/statistics/quantile.h>
#include <breakwater/study/executor.h>

namespace breakwater {
namespace fs = std::filesystem;
namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
constexpr double kNever = std::numeric_limits<double>::infinity();

struct Job {
  const RunSpec* spec = nullptr;
  std::size_t repetition = 0;
  std::string config_text;
  ModelHashes models;
  bool is_logged = false;
  std::string key;
  double cost = 0.0;  // number of physics steps

  // Names its result by this program.
  std::string asked() const { return asked_of(program_hash(), key); }
};

[[noreturn]] void fail(const Experiments& experiments, std::size_t line, const std::string& what) {
  throw std::invalid_argument(fmt::format("{}:{}: {}", experiments.file, line, what));
}

// The runs of a reproduction: each point is a job.
class Jobs : public PointSource {
 public:
  explicit Jobs(const Reproduction& reproduction);

  const std::vector<Job>& all() const { return jobs_; }
  /// The models that the keys of the jobs were computed from.
  KnownModels& models() { return models_; }

  PreparedRun prepare(std::size_t point) const override;
  std::string unprepared_key(std::size_t point) const override { return jobs_[point].key; }
  fs::path folder(std::size_t point, const std::string&, bool) const override {
    const Job& job = jobs_[point];
    return job.is_logged ? run_folder(reproduction_.out, job.spec->name) : fs::path();
  }
  bool logs(std::size_t point) const override { return jobs_[point].is_logged; }

 private:
  Job make_job(const RunSpec& spec, std::size_t repetition);

  const Reproduction& reproduction_;
  std::map<std::string, std::shared_ptr<const ScenarioFile>> files_;
  KnownModels models_;
  std::vector<Job> jobs_;  // the longest first
};

Jobs::Jobs(const Reproduction& reproduction) : reproduction_(reproduction) {
  const Experiments& experiments = reproduction.experiments;
  std::set<std::string> names;
  std::set<std::string> logged;
  for (const SectionSpec* section : reproduction.sections) {
    for (const std::string& name : section->runs()) names.insert(name);
    for (const std::string& name : section->logged_runs()) logged.insert(name);
  }
  for (const std::string& name : names) {
    const RunSpec& spec = experiments.runs.at(name);
    for (std::size_t i = 0; i < spec.repetitions.size(); ++i) {
      try {
        jobs_.push_back(make_job(spec, i));
      } catch (const std::invalid_argument& error) {
        fail(experiments, spec.line, fmt::format("run {}: {}", name, error.what()));
      }
      jobs_.back().is_logged = i == 0 && logged.contains(name);
    }
  }
  std::stable_sort(jobs_.begin(), jobs_.end(),
                   [](const Job& a, const Job& b) { return a.cost > b.cost; });
}

Job Jobs::make_job(const RunSpec& spec, std::size_t repetition) {
  const Catalogue& catalogue = reproduction_.catalogue;
  auto found = files_.find(spec.scenario);
  const bool is_first = found == files_.end();
  if (is_first) {
    const auto file = catalogue.get<ScenarioKind>(spec.scenario).scenario_file();
    found = files_.emplace(spec.scenario, file).first;
  }
  const std::vector<std::string> sets = spec.sets_of(repetition);
  // The first one also checks every table of the file.
  const ScenarioFile& file = *found->second;
  const PreparedRun run = is_first
                              ? prepare_run(catalogue, spec.scenario, file, spec.case_name, sets)
                              : prepare_point(catalogue, spec.scenario, file, spec.case_name, sets);
  const Config config = file.config(spec.case_name, sets);
  Job job;
  job.spec = &spec;
  job.repetition = repetition;
  job.config_text = run.config_text;
  job.models = models_.of(run.model_files);
  job.key = point_key(job.config_text, job.models);
  job.cost = config.number("run.duration_s").value_or(1.0) /
             config.number("physics.timestep_s").value_or(1e-3);
  return job;
}

PreparedRun Jobs::prepare(std::size_t point) const {
  const Job& job = jobs_[point];
  return prepare_point(reproduction_.catalogue, job.spec->scenario, *files_.at(job.spec->scenario),
                       job.spec->case_name, job.spec->sets_of(job.repetition));
}

// Whether the folder has this run, made with the same models and program as its result.
bool is_kept(const fs::path& folder, const Job& job) {
  if (!fs::exists(folder)) return false;
  try {
    const SavedRun run(folder);
    return run.config_text() == job.config_text && run.models() == job.models &&
           run.program() == program_hash();
  } catch (const std::invalid_argument&) {
    return false;
  }
}

// The other results mean that the run could not be made.
bool has_run(const PointResult& result) {
  return result.status == PointStatus::complete || result.status == PointStatus::failed;
}

// Runs the points and saves the results.
void run_pending(Jobs& jobs, const std::vector<std::size_t>& points,
                 const Reproduction& reproduction) {
  std::vector<double> costs;
  for (const std::size_t point : points) costs.push_back(jobs.all()[point].cost);
  Progress progress("reproduce", costs, reproduction.quiet);
  ExecutorOptions options;
  options.stop = reproduction.stop;
  options.models = &jobs.models();
  options.progress = [&](std::size_t i, double done) { progress.update(i, done); };
  // Each job was prepared before, so a refusal is an error.
  options.on_result = [&](const PointResult& result) {
    if (has_run(result)) return;
    const Job& job = jobs.all()[result.number];
    fail(reproduction.experiments, job.spec->line,
         fmt::format("run {}: {}", job.spec->name, result.reason));
  };
  Shard shard(shards_folder(reproduction.out), program_hash());
  const std::size_t finished = run_points(points, jobs, shard, options);
  shard.finish();
  if (finished < points.size()) throw Interrupted();
}

// The metrics that any run of a scenario has. A failed run has none.
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

// Refuses a metric that no run of the scenario has, unless the cell allows it. If all runs failed,
// the metrics are unknown and nothing is refused.
void check_metrics(const Reproduction& reproduction,
                   const std::map<std::string, std::set<std::string>>& known) {
  const Experiments& experiments = reproduction.experiments;
  const auto check = [&](const CellSpec& cell) {
    for (const Quantity& quantity : cell.quantities()) {
      const std::string& scenario = experiments.runs.at(quantity.run).scenario;
      const std::set<std::string>& names = known.at(scenario);
      const std::string name = quantity.name();
      if (names.empty() || names.contains(name) || cell.absent_is_never) continue;
      fail(experiments, cell.line,
           fmt::format("metric: no run of {} has {}{}", scenario, name,
                       did_you_mean(name, {names.begin(), names.end()})));
    }
  };
  for (const SectionSpec* section : reproduction.sections) {
    for (const TableSpec& table : section->tables) std::ranges::for_each(table.cells, check);
  }
}

}  // namespace

fs::path run_folder(const fs::path& out, const std::string& run) {
  return out / "runs" / run;
}

fs::path shards_folder(const fs::path& out) {
  return out / "shards";
}

Measurement measurement_of(const PointResult& result) {
  Measurement measurement;
  measurement.failed = result.status == PointStatus::failed;
  for (const auto& [name, value] : result.metrics) {
    measurement.values[name] = std::isfinite(value) ? value : kNaN;
  }
  return measurement;
}

Measured measure(const Reproduction& reproduction) {
  Jobs jobs(reproduction);
  const fs::path shards = shards_folder(reproduction.out);
  fs::create_directories(shards);
  auto results = results_by_key(shards, &PointResult::asked);
  std::vector<std::size_t> points;  // still without a result
  for (std::size_t point = 0; point < jobs.all().size(); ++point) {
    const Job& job = jobs.all()[point];
    const auto found = results.find(job.asked());
    const bool has_result = found != results.end() && has_run(found->second);
    const bool has_folder =
        !job.is_logged || is_kept(run_folder(reproduction.out, job.spec->name), job);
    if (!has_result || !has_folder) points.push_back(point);
  }
  if (!reproduction.quiet) {
    fmt::print(stderr, "reproduce: {} runs, {} of them there already\n", jobs.all().size(),
               jobs.all().size() - points.size());
  }
  if (!points.empty()) {
    run_pending(jobs, points, reproduction);
    results = results_by_key(shards, &PointResult::asked);
  }

  Measured measured;
  for (const Job& job : jobs.all()) {
    std::vector<Measurement>& repetitions = measured[job.spec->name];
    repetitions.resize(std::max(repetitions.size(), job.repetition + 1));
    repetitions[job.repetition] = measurement_of(results.at(job.asked()));
  }
  const auto metrics = known_metrics(reproduction.experiments, measured);
  check_metrics(reproduction, metrics);
  for (auto& [name, repetitions] : measured) {
    for (Measurement& measurement : repetitions) {
      for (const std::string& metric :
           metrics.at(reproduction.experiments.runs.at(name).scenario)) {
        measurement.values.emplace(metric, kNever);
      }
    }
  }
  return measured;
}

std::vector<double> values_of(const CellSpec& cell, const Measured& measured) {
  const auto value_of = [&](const Measurement& measurement, const std::string& name) {
    if (measurement.failed) return cell.if_failed;
    const auto found = measurement.values.find(name);
    const double value = found == measurement.values.end() ? kNaN : found->second;
    return value == kNever && !cell.absent_is_never ? kNaN : value;
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
    // A time is no part of never.
    const bool is_of_never =
        cell.absent_is_never && std::isinf(divisors[i]) && std::isfinite(values[i]);
    values[i] = is_of_never ? 0.0 : values[i] / (is_part ? divisors[i] * cell.divisor : kNaN);
  }
  return values;
}

double median(std::vector<double> values) {
  const bool is_measured =
      std::none_of(values.begin(), values.end(), [](double v) { return std::isnan(v); });
  return is_measured ? sample_median(values) : kNaN;
}

}  // namespace breakwater
