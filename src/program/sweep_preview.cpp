#include <breakwater/program/sweep_preview.h>

#include <fmt/format.h>

#include <algorithm>
#include <cstdio>
#include <numeric>
#include <optional>
#include <stdexcept>
#include <vector>

#include <breakwater/program/study_command.h>
#include <breakwater/shell/process.h>
#include <breakwater/shell/progress.h>
#include <breakwater/shell/table.h>
#include <breakwater/statistics/paired_comparison.h>
#include <breakwater/study/comparison_table.h>
#include <breakwater/study/study_notes.h>

namespace breakwater {
namespace {

std::vector<std::string> metric_names(const PointResult& run) {
  std::vector<std::string> names;
  for (const auto& [name, value] : run.metrics) names.push_back(name);
  return names;
}

// Adds the names of metrics that are not there.
void add_metrics(const PointResult& run, std::vector<std::string>& names) {
  for (const std::string& name : metric_names(run)) {
    if (std::find(names.begin(), names.end(), name) == names.end()) names.push_back(name);
  }
}

// The number of tests in Holm's correction: of the ranking if there is a goal, else of the
// comparison. A test is a metric and a pair of candidates that differ in these runs.
std::size_t tests_shown(const Plan& plan, const std::vector<PointResult>& runs) {
  const Study& study = plan.study();
  std::vector<std::string> metrics = study.metrics;
  if (!study.goals.empty()) metrics = {study.goals.front().first};
  std::size_t tests = 0;
  for (std::size_t y = 0; y < runs.size(); ++y) {
    const bool is_baseline = study.goals.empty() && plan.candidates()[y].label == study.baseline;
    if (study.goals.empty() && !study.baseline.empty() && !is_baseline) continue;
    for (const auto& [name, value] : runs[y].metrics) {
      const auto is_named = std::find(metrics.begin(), metrics.end(), name);
      if (!metrics.empty() && is_named == metrics.end()) continue;
      for (std::size_t x = is_baseline ? 0 : y + 1; x < runs.size(); ++x) {
        // Clang 14 captures no structured bindings by themselves.
        const auto differs = [&name = name, &value = value](const auto& other) {
          return other.first == name && other.second != value;
        };
        tests += std::any_of(runs[x].metrics.begin(), runs[x].metrics.end(), differs);
      }
    }
  }
  return tests;
}

// The metrics of the first point's scenario, also those that a run may be too short for.
std::vector<std::string> defined_metrics(const Sweep& sweep) {
  std::vector<std::string> names;
  for (const MetricDefinition& one : sweep.prepare(0).scenario->metric_definitions()) {
    names.push_back(one.name);
  }
  return names;
}

// Whether another seed changes the runs, and what follows for the seeds of the study. Empty if
// nothing does, or if a run takes long.
std::string seed_warning(const Sweep& sweep, const std::vector<PointResult>& runs) {
  const Plan& plan = sweep.plan();
  if (plan.study().seeds.empty()) return "";
  const bool is_one = plan.seeds() == 1;
  std::optional<Sweep> next_seed;
  if (is_one) next_seed.emplace(sweep.with_next_seed());
  const Sweep& other = next_seed ? *next_seed : sweep;
  const std::size_t place = is_one ? 0 : 1;  // where the second seed is
  const std::uint64_t first = plan.study().seeds[0], second = other.plan().study().seeds[place];
  try {
    for (std::size_t c = 0; c < runs.size(); ++c) {
      if (runs[c].status != PointStatus::complete) continue;
      BriefLook look(interrupted());
      const PointResult run = run_point(place * runs.size() + c, other, look.control());
      if (are_same_run(run, runs[c])) continue;
      if (!is_one) return "";
      return fmt::format(
          "seeds: {} gives another run of {} than {}: one seed is one draw of the "
          "noise, and more of them show what depends on it",
          second, plan.candidates()[c].label, first);
    }
  } catch (const Interrupted&) {
    if (interrupted()) throw;
    return "";
  }
  if (is_one || runs.front().status != PointStatus::complete) return "";
  return fmt::format("seeds: {} and {} give the same runs: {}", first, second, kNoNoise);
}

// Warnings from one run of each candidate.
std::vector<std::string> warnings_of(const Sweep& sweep, const std::vector<PointResult>& runs) {
  const Plan& plan = sweep.plan();
  std::vector<std::string> warnings;
  std::vector<std::string> all;
  for (std::size_t c = 0; c < runs.size(); ++c) {
    if (runs[c].status != PointStatus::complete) {
      warnings.push_back(fmt::format("{}: the first run {}: {}", plan.candidates()[c].label,
                                     name_of(runs[c].status), runs[c].reason));
    }
    add_metrics(runs[c], all);
  }
  for (std::size_t c = 0; c < runs.size(); ++c) {
    if (runs[c].status != PointStatus::complete) continue;
    std::vector<std::string> lacking = all;
    for (const std::string& name : metric_names(runs[c])) std::erase(lacking, name);
    if (lacking.empty()) continue;
    warnings.push_back(fmt::format("{}: the first run lacks {}", plan.candidates()[c].label,
                                   fmt::join(lacking, ", ")));
  }
  check_names(sweep);
  for (const UnknownMetric& one : unknown_metrics(plan.study(), all)) {
    warnings.push_back(
        fmt::format("{}: none of these runs has it{}", one.place, why_missing(sweep, one)));
  }
  const std::string warning = seed_warning(sweep, runs);
  if (!warning.empty()) warnings.push_back(warning);
  const std::size_t blocks = most_blocks(plan);
  const std::size_t tests = tests_shown(plan, runs);
  const double p = least_p(blocks, std::max<std::size_t>(1, tests));
  if (blocks > 0 && p > ComparisonSettings{}.alpha) {
    warnings.push_back(few_text(blocks, plan.samples() * plan.seeds(), tests, p,
                                plan.study().goals.empty() ? kFewerMetrics : "fewer candidates"));
  }
  return warnings;
}

}  // namespace

void print_preview(const Sweep& sweep, std::size_t jobs) {
  const Plan& plan = sweep.plan();
  fmt::print("{}: {}, {}, {}\n", number_of(plan.size(), "run"), number_of(plan.samples(), "sample"),
             number_of(plan.seeds(), "seed"), number_of(plan.candidates().size(), "candidate"));
  std::fflush(stdout);
  const Estimate time = estimate(sweep, interrupted());
  Table table({"candidate", "one run", "metrics"});
  for (std::size_t c = 0; c < time.runs.size(); ++c) {
    table.add({plan.candidates()[c].label, fmt::format("{:.3g} s", time.runs[c].cost_s),
               time.is_whole[c] ? std::to_string(time.runs[c].metrics.size()) : "–"});
  }
  fmt::print("\n{}\n{}", table.print(output_width()), time_needed(time.seconds, jobs));
  std::fflush(stdout);
  const auto cut = std::find(time.is_whole.begin(), time.is_whole.end(), false);
  if (cut == time.is_whole.end()) {
    warn(kSweep.command, warnings_of(sweep, time.runs));
  } else {
    const auto c = static_cast<std::size_t>(cut - time.is_whole.begin());
    warn(kSweep.command, {fmt::format("{}: a run takes so long that it was stopped: its metrics "
                                      "are not checked",
                                      plan.candidates()[c].label)});
  }
}

std::string why_missing(const Sweep& sweep, const UnknownMetric& metric) {
  const std::vector<std::string> defined = defined_metrics(sweep);
  if (std::find(defined.begin(), defined.end(), metric.name) == defined.end()) return metric.meant;
  std::string why = ": they have no window or event for it";
  for (const std::string& set : sweep.plan().study().sets) {
    if (set.starts_with("run.duration_s=")) why += " (" + set + ")";
  }
  return why;
}

void check_names(const Sweep& sweep) {
  const Study& study = sweep.plan().study();
  std::vector<std::string> known = defined_metrics(sweep);
  RunControl control;
  control.stop = &interrupted();
  const std::size_t candidates = sweep.plan().candidates().size();
  for (const std::size_t first : {std::size_t{0}, sweep.plan().size() - candidates}) {
    for (std::size_t c = 0; c < candidates; ++c) {
      if (unknown_metrics(study, known).empty()) return;
      const PointResult run = run_point(first + c, sweep, control);
      if (run.status != PointStatus::complete) return;
      add_metrics(run, known);
    }
  }
  for (const UnknownMetric& one : unknown_metrics(study, known)) {
    if (one.meant.empty()) continue;
    throw std::invalid_argument(one.place + ": there is no such metric" + one.meant);
  }
}

std::string counted(const ShardIndex& index) {
  std::string text = fmt::format("{} of {} points are done", index.done(), index.points());
  std::vector<std::string> kinds;
  for (const auto status : {PointStatus::failed, PointStatus::refused, PointStatus::crashed}) {
    if (index.count(status) > 0) {
      kinds.push_back(fmt::format("{} {}", index.count(status), name_of(status)));
    }
  }
  if (!kinds.empty()) text += fmt::format("; of these {}", fmt::join(kinds, ", "));
  return text;
}

double time_to_go_s(const Plan& plan, const ShardIndex& index) {
  const std::size_t candidates = plan.candidates().size();
  std::vector<double> cost_s(candidates);
  std::vector<std::size_t> done(candidates);
  for (std::size_t point = 0; point < index.points(); ++point) {
    if (!index.has(point)) continue;
    cost_s[point % candidates] += index.cost_s(point);
    ++done[point % candidates];
  }
  const double each_s =
      std::accumulate(cost_s.begin(), cost_s.end(), 0.0) / static_cast<double>(index.done());
  double all_s = 0.0;
  for (std::size_t c = 0; c < candidates; ++c) {
    const std::size_t left = plan.size() / candidates - done[c];
    all_s += static_cast<double>(left) *
             (done[c] > 0 ? cost_s[c] / static_cast<double>(done[c]) : each_s);
  }
  return all_s;
}

}  // namespace breakwater
