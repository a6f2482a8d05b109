#include <breakwater/thesis/reproduction.h>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <set>

#include <breakwater/experiment/runner.h>
#include <breakwater/experiment/saved_run.h>
#include <breakwater/shell/did_you_mean.h>
#include <breakwater/shell/progress.h>
#include <breakwater/statistics/distribution.h>
#include <breakwater/study/executor.h>

namespace breakwater {
namespace fs = std::filesystem;
namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
constexpr double kNever = std::numeric_limits<double>::infinity();

struct Job {
  const RunSpec* spec;
  std::size_t repetition;
  std::string key;
  double cost;  // number of physics steps
  bool is_logged;

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
  std::string asked(std::size_t point) const override { return jobs_[point].key; }
  fs::path folder(std::size_t point, const std::string&, bool) const override {
    const Job& job = jobs_[point];
    return job.is_logged ? run_folder(reproduction_.out, job.spec->name) : fs::path();
  }

 private:
  void add(const RunSpec& spec, std::size_t repetition, bool is_logged);
  void check_metrics() const;

  const Reproduction& reproduction_;
  std::map<std::string, std::shared_ptr<const ScenarioFile>> files_;
  std::map<std::string, std::set<std::string>> metrics_;  // that the runs of a scenario may have
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
        add(spec, i, i == 0 && logged.contains(name));
      } catch (const std::invalid_argument& error) {
        fail(experiments, spec.line, fmt::format("run {}: {}", name, error.what()));
      }
    }
  }
  std::ranges::stable_sort(jobs_, std::greater<>(), &Job::cost);
  check_metrics();
}

void Jobs::add(const RunSpec& spec, std::size_t repetition, bool is_logged) {
  const Catalogue& catalogue = reproduction_.catalogue;
  std::shared_ptr<const ScenarioFile>& file = files_[spec.scenario];
  const bool is_first = file == nullptr;
  if (is_first) file = catalogue.get<ScenarioKind>(spec.scenario).scenario_file();
  const std::vector<std::string> sets = spec.sets_of(repetition);
  // The first one also checks every table of the file.
  const PreparedRun run =
      is_first ? prepare_run(catalogue, spec.scenario, *file, spec.case_name, sets)
               : prepare_point(catalogue, spec.scenario, *file, spec.case_name, sets);
  const Config config = file->config(spec.case_name, sets);
  jobs_.push_back({&spec, repetition, point_key(run.config_text, models_.of(run.model_files)),
                   config.number("run.duration_s").value_or(1.0) /
                       config.number("physics.timestep_s").value_or(1e-3),
                   is_logged});
  if (repetition > 0) return;
  std::set<std::string>& names = metrics_[spec.scenario];
  for (const MetricDefinition& one : run.scenario->metric_definitions()) names.insert(one.name);
}

// Refuses a metric that no run of the scenario can have, if the scenario says its metrics.
void Jobs::check_metrics() const {
  const Experiments& experiments = reproduction_.experiments;
  const auto check = [&](const CellSpec& cell) {
    for (const Quantity& quantity : cell.quantities()) {
      const std::string& scenario = experiments.runs.at(quantity.run).scenario;
      const std::set<std::string>& names = metrics_.at(scenario);
      const std::string name = quantity.name();
      if (names.empty() || names.contains(name)) continue;
      fail(experiments, cell.line,
           fmt::format("metric: no run of {} has {}{}", scenario, name,
                       did_you_mean(name, {names.begin(), names.end()})));
    }
  };
  for (const SectionSpec* section : reproduction_.sections) {
    for (const TableSpec& table : section->tables) std::ranges::for_each(table.cells, check);
  }
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
    return point_key(run.config_text(), run.models()) == job.key && run.program() == program_hash();
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

}  // namespace

fs::path run_folder(const fs::path& out, const std::string& run) {
  return out / "runs" / run;
}

fs::path shards_folder(const fs::path& out) {
  return out / "shards";
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
    std::vector<PointResult>& repetitions = measured[job.spec->name];
    repetitions.resize(job.spec->repetitions.size());
    repetitions[job.repetition] = results.at(job.asked());
  }
  return measured;
}

std::vector<double> values_of(const CellSpec& cell, const Measured& measured) {
  const auto value_of = [&](const PointResult& run, const std::string& name) {
    if (run.status == PointStatus::failed) return cell.if_failed;
    for (const auto& [metric, value] : run.metrics) {
      if (metric == name) return std::isfinite(value) ? value : kNaN;
    }
    return cell.absent_is_never ? kNever : kNaN;
  };
  const auto all_of = [&](const Quantity& quantity) {
    std::vector<double> values;
    for (const PointResult& run : measured.at(quantity.run)) {
      const double value = value_of(run, quantity.name());
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
