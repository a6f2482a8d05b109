#include <breakwater/search/tuner.h>

#include <algorithm>
#include <cmath>
#include <mutex>
#include <stdexcept>

#include <breakwater/search/search.h>

namespace breakwater {
namespace {

constexpr double kLevel = 0.95;
// Larger than any measured value. Still small enough that pagmo can add 1 to it.
constexpr double kInfeasible = 1e10, kFailed = 1e13;
constexpr double kLater = 0x1p-40;

bool has_all(const Tuning& tuning, const PointResult& run) {
  const auto is_there = [&](const auto& one) { return metric_of(run, one.metric).has_value(); };
  return run.status == PointStatus::complete && std::ranges::all_of(tuning.objectives, is_there) &&
         std::ranges::all_of(tuning.constraints, is_there);
}

EstimatedValue gather(const std::vector<PointResult>& runs, const std::string& metric, Over over,
                      bool large_is_bad, bool with_interval) {
  std::vector<double> values;
  for (const PointResult& run : runs) values.push_back(*metric_of(run, metric));
  EstimatedValue result{gathered(values, over, large_is_bad)};
  // No interval covers the mean, or the worst value, of every distribution.
  if (with_interval && (over == Over::median || over == Over::q90)) {
    std::sort(values.begin(), values.end());
    const double share = over == Over::median ? 0.5 : large_is_bad ? 0.9 : 0.1;
    result.interval = quantile_interval(values, share, kLevel);
  }
  return result;
}

// The violation of a bound, relative to it; absolute if the bound is 0.
double beyond(double value, const Constraint& constraint) {
  const double bound = std::isfinite(constraint.max) ? constraint.max : constraint.min;
  const double scale = bound == 0.0 ? 1.0 : std::abs(bound);
  return std::max({0.0, value - constraint.max, constraint.min - value}) / scale;
}

// The runs of a tuning: from the shards or made now.
class Runs {
 public:
  Runs(const TuningPlan& plan, const StudyFolder& folder, const TunerOptions& options)
      : plan_(plan),
        folder_(folder),
        options_(options),
        origin_(folder.origin()),
        shard_(folder.shards(), origin_) {
    look();
  }

  // Returns the runs with these numbers, in this order.
  std::vector<PointResult> of(const std::vector<std::size_t>& numbers) {
    const std::vector<std::size_t> missing = take(numbers);
    if (!missing.empty()) run(missing);
    std::vector<PointResult> results;
    for (const std::size_t number : numbers) results.push_back(known_.at(number));
    return results;
  }

  // All runs, after the last one. Throws OutputError.
  std::map<std::size_t, PointResult> finish() {
    shard_.finish();
    return known_;
  }

 private:
  // Reads the shards.
  void look() {
    ShardIndex(folder_.shards(), plan_.size()).check_models();
    earlier_ = results_by_key(folder_.shards(), &PointResult::asked);
  }

  // Takes the finished runs out of `earlier_` and returns the numbers of the others.
  std::vector<std::size_t> take(const std::vector<std::size_t>& numbers) {
    std::vector<std::size_t> missing;
    for (const std::size_t number : numbers) {
      if (known_.contains(number)) continue;
      const auto found = earlier_.find(asked_of(origin_, plan_.asked(number)));
      if (found == earlier_.end()) {
        missing.push_back(number);
        continue;
      }
      PointResult result = found->second;
      if (result.number != number) {  // another evaluation had the same values
        result.number = number;
        result.asked = plan_.asked(number);
        shard_.add(result);
      }
      keep(result);
    }
    return missing;
  }

  void keep(const PointResult& result) {
    known_.emplace(result.number, result);
    if (options_.on_run) options_.on_run(result.number);
  }

  void run(const std::vector<std::size_t>& numbers) {
    if (options_.elsewhere) {
      options_.elsewhere(numbers);
      look();
      if (!take(numbers).empty()) throw std::logic_error("runs were to be made elsewhere");
      return;
    }
    std::mutex mutex;
    ExecutorOptions executor;
    executor.threads = options_.jobs;
    executor.stop = options_.stop;
    executor.on_result = [&](const PointResult& result) {
      const std::lock_guard lock(mutex);
      keep(result);
    };
    if (run_points(numbers, plan_, shard_, executor) == numbers.size()) return;
    shard_.finish();
    throw Interrupted();
  }

  const TuningPlan& plan_;
  const StudyFolder& folder_;
  const TunerOptions& options_;
  const std::string origin_;
  Shard shard_;
  std::unordered_map<std::string, PointResult> earlier_;  // from the shards, by PointResult::asked
  std::map<std::size_t, PointResult> known_;              // in use by the search
};

// Makes the runs of several evaluations together and evaluates each.
std::vector<Evaluation> evaluate_all(const TuningPlan& plan, Runs& runs, std::size_t tuned,
                                     const std::vector<std::size_t>& evaluations,
                                     bool is_validation) {
  const std::size_t worlds = plan.worlds(is_validation).size();
  std::vector<std::size_t> numbers;
  for (const std::size_t evaluation : evaluations) {
    for (std::size_t world = 0; world < worlds; ++world) {
      numbers.push_back(plan.number({tuned, evaluation, is_validation, world}));
    }
  }
  const auto results = runs.of(numbers);
  const auto each = static_cast<std::ptrdiff_t>(worlds);
  std::vector<Evaluation> all;
  for (auto first = results.begin(); first != results.end(); first += each) {
    all.push_back(evaluate(plan.tuning(), {first, first + each}, is_validation));
  }
  return all;
}

std::vector<Evaluation> search_case(TuningPlan& plan, Runs& runs, std::size_t tuned) {
  const Tuning& tuning = plan.tuning();
  std::vector<Evaluation> evaluations;
  search(tuning.settings(tuning.cases[tuned]), [&](const Vectors& points) {
    std::vector<std::size_t> numbers;
    for (const std::vector<double>& u : points) {
      const std::size_t number = evaluations.size() + numbers.size();
      if (number >= tuning.budget) throw std::logic_error("the search goes beyond its budget");
      plan.begin(tuned, number, plan.values(tuned, u));
      numbers.push_back(number);
    }
    Vectors answers;
    for (Evaluation& one : evaluate_all(plan, runs, tuned, numbers, false)) {
      answers.push_back(fitness(tuning, one, evaluations.size()));
      evaluations.push_back(std::move(one));
    }
    return answers;
  });
  return evaluations;
}

std::vector<FrontPoint> front_points(const Tuning& tuning,
                                     const std::vector<Evaluation>& evaluations) {
  std::vector<std::size_t> feasible;
  Vectors objectives;
  for (std::size_t i = 0; i < evaluations.size(); ++i) {
    if (!evaluations[i].is_feasible()) continue;
    feasible.push_back(i);
    objectives.push_back(minimised(tuning, evaluations[i]));
  }
  std::vector<std::size_t> front = front_of(objectives);
  std::stable_sort(front.begin(), front.end(),
                   [&](std::size_t a, std::size_t b) { return objectives[a] < objectives[b]; });
  std::vector<FrontPoint> points;
  for (const std::size_t i : front) points.push_back({feasible[i], evaluations[feasible[i]]});
  return points;
}

void validate_all(const TuningPlan& plan, Runs& runs, const TunerOptions& options,
                  std::vector<TunedFront>& fronts) {
  std::vector<std::vector<std::size_t>> chosen;  // points of each front
  std::size_t count = 0;
  for (const TunedFront& front : fronts) {
    chosen.push_back(evenly_spaced(front.points.size(), plan.tuning().validated_points));
    count += chosen.back().size() * plan.worlds(true).size();
  }
  if (options.on_validation) options.on_validation(count);
  for (std::size_t c = 0; c < fronts.size(); ++c) {
    std::vector<std::size_t> evaluations;
    for (const std::size_t i : chosen[c]) evaluations.push_back(fronts[c].points[i].evaluation);
    const std::vector<Evaluation> fresh = evaluate_all(plan, runs, c, evaluations, true);
    for (std::size_t i = 0; i < fresh.size(); ++i) fronts[c].points[chosen[c][i]].fresh = fresh[i];
  }
}

}  // namespace

std::optional<double> metric_of(const PointResult& run, const std::string& metric) {
  const auto found = std::ranges::find(run.metrics, metric, &std::pair<std::string, double>::first);
  if (found == run.metrics.end()) return std::nullopt;
  return found->second;
}

Evaluation evaluate(const Tuning& tuning, const std::vector<PointResult>& runs,
                    bool with_intervals) {
  Evaluation evaluation;
  evaluation.runs = runs.size();
  evaluation.failures = static_cast<std::size_t>(std::count_if(
      runs.begin(), runs.end(), [&](const PointResult& run) { return !has_all(tuning, run); }));
  if (evaluation.failures > 0) return evaluation;
  for (const Objective& one : tuning.objectives) {
    evaluation.objectives.push_back(
        gather(runs, one.metric, one.over, one.goal == Goal::min, with_intervals));
  }
  for (const Constraint& one : tuning.constraints) {
    evaluation.constraints.push_back(
        gather(runs, one.metric, one.over, std::isfinite(one.max), with_intervals));
    evaluation.violation += beyond(evaluation.constraints.back().value, one);
  }
  return evaluation;
}

std::vector<double> minimised(const Tuning& tuning, const Evaluation& evaluation) {
  std::vector<double> values;
  for (std::size_t i = 0; i < tuning.objectives.size(); ++i) {
    const double value = evaluation.objectives[i].value;
    values.push_back(tuning.objectives[i].goal == Goal::min ? value : -value);
  }
  return values;
}

std::vector<double> fitness(const Tuning& tuning, const Evaluation& evaluation,
                            std::size_t number) {
  if (evaluation.is_feasible()) return minimised(tuning, evaluation);
  const double later = 1.0 + kLater * static_cast<double>(number);
  double penalty = kInfeasible * (1.0 + evaluation.violation / (1.0 + evaluation.violation));
  if (evaluation.failures > 0) {
    penalty = kFailed * (1.0 + static_cast<double>(evaluation.failures) /
                                   static_cast<double>(evaluation.runs));
  }
  std::vector<double> penalties(tuning.objectives.size(), penalty * later);
  return penalties;
}

TuningResult tune(TuningPlan& plan, const StudyFolder& folder, const TunerOptions& options) {
  const Tuning& tuning = plan.tuning();
  Runs runs(plan, folder, options);
  TuningResult result;
  for (std::size_t c = 0; c < tuning.cases.size(); ++c) {
    TunedFront front;
    front.case_name = tuning.cases[c].name;
    front.evaluations = search_case(plan, runs, c);
    front.points = front_points(tuning, front.evaluations);
    result.fronts.push_back(std::move(front));
  }
  if (tuning.validation) validate_all(plan, runs, options, result.fronts);
  result.runs = runs.finish();
  return result;
}

}  // namespace breakwater
