#include <breakwater/search/evaluation.h>

#include <algorithm>
#include <cmath>
#include <string>

#include <breakwater/statistics/binomial.h>

namespace breakwater {
namespace {

constexpr double kLevel = 0.95;
// Larger than any measured value. Still small enough that pagmo can add 1 to it.
constexpr double kInfeasible = 1e10, kFailed = 1e13;
constexpr double kLater = 0x1p-40;

bool has_all(const Tuning& tuning, const PointResult& run) {
  return run.status == PointStatus::complete &&
         std::all_of(tuning.objectives.begin(), tuning.objectives.end(),
                     [&](const Objective& one) { return metric_of(run, one.metric); }) &&
         std::all_of(tuning.constraints.begin(), tuning.constraints.end(),
                     [&](const Constraint& one) { return metric_of(run, one.metric); });
}

std::optional<ConfidenceInterval> interval_of(std::vector<double> values, Over over,
                                              bool large_is_bad) {
  std::sort(values.begin(), values.end());
  switch (over) {
    case Over::median:
      return quantile_interval(values, 0.5, kLevel);
    case Over::q90:
      return quantile_interval(values, large_is_bad ? 0.9 : 0.1, kLevel);
    case Over::mean:  // no interval covers the mean of every distribution
    case Over::worst:
      break;
  }
  return std::nullopt;
}

GatheredValue gather(const std::vector<PointResult>& runs, const std::string& metric, Over over,
                     bool large_is_bad, bool with_interval) {
  std::vector<double> values;
  for (const PointResult& run : runs) values.push_back(*metric_of(run, metric));
  GatheredValue result{gathered(values, over, large_is_bad)};
  if (with_interval) result.interval = interval_of(values, over, large_is_bad);
  return result;
}

// The violation of a bound, relative to it; absolute if the bound is 0.
double beyond(double value, const Constraint& constraint) {
  const double bound = std::isfinite(constraint.max) ? constraint.max : constraint.min;
  const double scale = bound == 0.0 ? 1.0 : std::abs(bound);
  return std::max({0.0, value - constraint.max, constraint.min - value}) / scale;
}

}  // namespace

std::optional<double> metric_of(const PointResult& run, const std::string& metric) {
  const auto found = std::find_if(run.metrics.begin(), run.metrics.end(),
                                  [&](const auto& entry) { return entry.first == metric; });
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

}  // namespace breakwater
