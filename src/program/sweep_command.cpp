#include <breakwater/program/commands.h>

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <atomic>
#include <cstdio>
#include <nlohmann/json.hpp>
#include <numeric>
#include <unordered_set>

#include <breakwater/config/config.h>
#include <breakwater/pages/study_report.h>
#include <breakwater/program/study_command.h>
#include <breakwater/record/partial_file.h>
#include <breakwater/shell/child_program.h>
#include <breakwater/shell/process.h>
#include <breakwater/shell/progress.h>
#include <breakwater/shell/table.h>
#include <breakwater/statistics/paired_comparison.h>
#include <breakwater/study/comparison_table.h>
#include <breakwater/study/results.h>
#include <breakwater/study/study.h>
#include <breakwater/study/study_reader.h>
#include <breakwater/study/sweep.h>

namespace breakwater {
namespace {

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

// Whether another seed changes the runs, and what follows for the seeds of the study. Empty if
// nothing does.
std::string seed_warning(const Sweep& sweep, const std::vector<PointResult>& runs) {
  const Plan& plan = sweep.plan();
  if (plan.study().seeds.empty()) return "";
  const bool is_one = plan.seeds() == 1;
  std::optional<Sweep> next_seed;
  if (is_one) next_seed.emplace(sweep.with_next_seed());
  const Sweep& other = next_seed ? *next_seed : sweep;
  const std::size_t place = is_one ? 0 : 1;  // where the second seed is
  const std::uint64_t first = plan.study().seeds[0], second = other.plan().study().seeds[place];
  RunControl control;
  control.stop = &interrupted();
  for (std::size_t c = 0; c < runs.size(); ++c) {
    if (runs[c].status != PointStatus::complete) continue;
    const PointResult run = run_point(place * runs.size() + c, other, control);
    if (run.state_hash == runs[c].state_hash && run.metrics == runs[c].metrics) continue;
    if (!is_one) return "";
    return fmt::format(
        "seeds: {} gives another run of {} than {}: one seed is one draw of the "
        "noise, and more of them show what depends on it",
        second, plan.candidates()[c].label, first);
  }
  if (is_one || runs.front().status != PointStatus::complete) return "";
  return fmt::format("seeds: {} and {} give the same runs: {}", first, second, kNoNoise);
}

// Why the runs, of which some failed, lack a metric, behind "no run has it": they failed, are too
// short, or it is misspelt.
std::string why_missing(const Sweep& sweep, const NamedMetric& metric, std::size_t runs,
                        std::size_t failed) {
  if (failed == runs) return ": they failed";
  const std::vector<std::string> defined = sweep.defined_metrics(0);
  if (std::find(defined.begin(), defined.end(), metric.name) == defined.end()) return metric.meant;
  const std::string which = failed > 0 ? fmt::format("{} failed, the others", failed) : "they";
  std::string why = ": " + which + " have no window or event for it";
  for (const std::string& set : sweep.plan().study().sets) {
    if (set.starts_with("run.duration_s=")) why += " (" + set + ")";
  }
  return why;
}

// Warnings from one run of each candidate.
std::vector<std::string> warnings_of(const Sweep& sweep, const std::vector<PointResult>& runs) {
  const Plan& plan = sweep.plan();
  std::vector<std::string> warnings;
  std::vector<std::string> all;
  std::size_t failed = 0;
  for (std::size_t c = 0; c < runs.size(); ++c) {
    if (runs[c].status != PointStatus::complete) {
      ++failed;
      warnings.push_back(fmt::format("{}: the first run {}: {}", plan.candidates()[c].label,
                                     name_of(runs[c].status), runs[c].reason));
    }
    for (const auto& [name, value] : runs[c].metrics) {
      if (std::find(all.begin(), all.end(), name) == all.end()) all.push_back(name);
    }
  }
  for (std::size_t c = 0; c < runs.size(); ++c) {
    if (runs[c].status != PointStatus::complete) continue;
    std::vector<std::string> lacking = all;
    for (const auto& [name, value] : runs[c].metrics) std::erase(lacking, name);
    if (lacking.empty()) continue;
    warnings.push_back(fmt::format("{}: the first run lacks {}", plan.candidates()[c].label,
                                   fmt::join(lacking, ", ")));
  }
  for (const NamedMetric& one : unknown_metrics(plan.study(), all)) {
    warnings.push_back(fmt::format("{}: none of these runs has it{}", one.place,
                                   why_missing(sweep, one, runs.size(), failed)));
  }
  const std::string warning = seed_warning(sweep, runs);
  if (!warning.empty()) warnings.push_back(warning);
  const std::size_t blocks = most_blocks(plan);
  const std::size_t tests = tests_shown(plan, runs);
  const double p = least_p(blocks, std::max<std::size_t>(1, tests));
  if (blocks > 0 && p > kAlpha) {
    warnings.push_back(few_text(blocks, plan.samples() * plan.seeds(), tests, p,
                                plan.study().goals.empty() ? kFewerMetrics : "fewer candidates"));
  }
  return warnings;
}

// Prints the number of runs and their time on `jobs` cores (0: all), estimated from one run of
// each candidate. Also prints their warnings. Throws Interrupted.
void print_preview(const Sweep& sweep, std::size_t jobs) {
  const Plan& plan = sweep.plan();
  fmt::print("{}: {}, {}, {}\n", number_of(plan.size(), "run"), number_of(plan.samples(), "sample"),
             number_of(plan.seeds(), "seed"), number_of(plan.candidates().size(), "candidate"));
  std::fflush(stdout);
  const std::size_t candidates = plan.candidates().size();
  RunControl control;
  control.stop = &interrupted();
  std::vector<PointResult> runs;
  double seconds = 0.0;
  TextRows rows = {{"candidate", "one run", "metrics"}};
  for (std::size_t c = 0; c < candidates; ++c) {
    runs.push_back(run_point(c, sweep, control));
    seconds += runs[c].cost_s * static_cast<double>(plan.size() / candidates);
    rows.push_back({plan.candidates()[c].label, fmt::format("{:.3g} s", runs[c].cost_s),
                    std::to_string(runs[c].metrics.size())});
  }
  fmt::print("\n{}\n{}", in_columns(std::move(rows), output_width()), time_needed(seconds, jobs));
  std::fflush(stdout);
  warn(kSweep.command, warnings_of(sweep, runs));
}

// A text such as "3 of 40 points are done; of these 1 failed".
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

namespace fs = std::filesystem;

struct OpenedStudy {
  Study study;
  StudyFolder folder;
};

OpenedStudy open_study(const Catalogue& catalogue, const SweepOptions& options) {
  const std::string& given = options.study.target;
  const fs::path target = given;
  if (fs::is_directory(target) && !catalogue.has<ScenarioKind>(given)) {
    const StudyFolder folder = begun_folder(given, kSweep);
    if (options.says_what()) {
      throw std::invalid_argument(given +
                                  ": is a study's folder, and its study.toml says what is run: "
                                  "leave --case, --vary, --out and the like out");
    }
    return {folder.study(), folder};
  }
  toml::table tables;
  std::string name = given;
  std::string origin = given;
  if (const auto file = file_of_study(given)) {
    origin = file->string();
    tables = study_tables(origin);
    name = file->stem().string();
    if (tables.contains("default_case") || tables["case"].is_table()) {
      const std::string scenario = scenario_name_in(catalogue, origin);
      tables = toml::table{{"scenario", scenario},
                           {"config", fs::absolute(*file).lexically_normal().string()}};
    }
  } else if (target.extension() == ".toml" || given.find('/') != std::string::npos) {
    throw std::invalid_argument(given + ": there is no such file or folder");
  } else {
    tables.insert_or_assign("scenario", catalogue.get<ScenarioKind>(given).name);
  }
  lay_on(options, tables);
  Study study = read_study(tables, origin);
  if (!options.run.duration.empty()) study.places["set.run.duration_s"] = "--duration";
  return {std::move(study), new_folder(options.study, name, kSweep)};
}

// The first point, in the order of the study, that did not end well; nothing if all did.
std::optional<PointResult> first_failure(const ShardIndex& index) {
  if (index.count(PointStatus::complete) == index.done()) return std::nullopt;
  std::size_t point = 0;
  while (!index.has(point) || index.status(point) == PointStatus::complete) ++point;
  return index.read(point);
}

class SweepCommand : public StudyCommand {
 public:
  SweepCommand(const Catalogue& catalogue, OpenedStudy opened, const SweepOptions& options)
      : StudyCommand(std::move(opened.folder), options.study),
        catalogue_(catalogue),
        sweep_(catalogue, std::move(opened.study)),
        sqlite_(options.sqlite),
        prints_all_(options.all) {}

 protected:
  const PointSource& source() const override { return sweep_; }
  const ScenarioFile& file() const override { return sweep_.file(); }
  std::size_t size() const override { return plan_.size(); }
  std::string text() const override { return plan_.study().print(); }
  std::string text_there() const override { return folder_.study().print(); }
  void check_growth() const override {
    const Study there = folder_.study();
    const bool may_grow =
        there.scenario == plan_.study().scenario && keeps_results_of({catalogue_, there});
    if (!may_grow) folder_.check_is(text(), there.print());
    sweep_.check_metrics();  // a finished study may get a goal
  }

  void print_dry_run() const override {
    warn(name(), sweep_.check());
    print_preview(sweep_, options_.jobs);
  }

  void print_status(const ShardIndex& index) const override {
    fmt::print("{}: {}\n", folder_.path().string(), counted(index));
  }

  void check() const override { warn(name(), sweep_.check()); }

  int collect(const ShardIndex& index) const override {
    index.check_models();
    const fs::path csv = folder_.path() / "results.csv";
    StudyNumbers numbers = study_numbers(plan_, index);
    write_results(plan_, index, numbers.metrics, csv);
    for (const NamedMetric& one : unknown_metrics(plan_.study(), numbers.metrics)) {
      fmt::print(stderr, "{}: {}: no run has it{}\n", name(), one.place,
                 why_missing(sweep_, one, index.done(),
                             index.done() - index.count(PointStatus::complete)));
    }
    const auto comparison = compare_study(plan_, numbers);
    const fs::path compared = folder_.path() / "comparison.csv";
    if (comparison) replace_file(compared, csv_table(comparison_rows(*comparison)));
    const auto ranking = rank_study(plan_, numbers);
    if (ranking) {
      replace_file(folder_.path() / "ranking.json", ranking_json(*ranking).dump(1) + "\n");
    }
    const std::vector<std::string> lines = notes(plan_, numbers);
    write_study_report(catalogue_, plan_, index, std::move(numbers), folder_, comparison, ranking);
    const int status = collect_sqlite(csv);
    if (options_.quiet) {
      warn(name(), lines);
      return status;
    }
    if (ranking) fmt::print("{}\n", ranking_text(*ranking, output_width()));
    if (comparison && prints_all_) {
      fmt::print("{}\n", comparison_text(*comparison, output_width()));
    }
    print_notes(lines, comparison && plan_.study().goals.empty());
    fmt::print("{}\nresults: {}\n", counted(index), csv.string());
    if (comparison) fmt::print("comparison: {}\n", compared.string());
    fmt::print("report: {}\n", (folder_.path() / "report.html").string());
    return status;
  }

  // Runs a point once more and compares it with its result.
  int replay(const ShardIndex& index) override {
    const std::size_t point = index.find(options_.replay);
    if (point == index.points()) {
      throw std::invalid_argument(
          fmt::format("--replay: no point of {} that ran is {}: the column `point` of results.csv "
                      "names them",
                      folder_.path().string(), options_.replay));
    }
    const PointResult then = index.read(point);
    const bool has_crashed = then.status == PointStatus::crashed;
    if (has_crashed) {
      fmt::print(stderr, "{}: point {} has crashed: {}; now this process runs it\n", name(),
                 then.key, then.reason);
    }
    sweep_.keep_in(folder_, Keep::all);
    RunControl control;
    control.stop = &interrupted();
    const PointResult now = run_point(point, sweep_, control);
    if (now.status == PointStatus::refused) {
      fmt::print(stderr, "{}: point {} is refused, and has no folder: {}\n", name(), then.key,
                 now.reason);
      return kRunFailed;
    }
    if (!options_.quiet) {
      fmt::print("{}: {}\n", name_of(now.status), folder_.run(now.key).string());
    }
    const bool is_same = now.status == then.status && now.state_hash == then.state_hash;
    if (is_same || has_crashed) return kSuccess;
    fmt::print(
        stderr,
        "{}: this is not the run of results.csv: {} with state_hash {}, there {} with {}: was "
        "it made on another machine?\n",
        name(), name_of(now.status), now.state_hash, name_of(then.status), then.state_hash);
    return kRunFailed;
  }

  bool has_to_stop() const override {
    if (!stops()) return false;
    const auto failure = first_failure(index());
    if (!failure) return false;
    fmt::print(stderr, "{}: point {} {}: {}\n", name(), failure->key, name_of(failure->status),
               failure->reason);
    return true;
  }

  std::size_t make(const std::vector<std::size_t>& points) override {
    sweep_.keep_in(folder_, plan_.study().keep);
    std::atomic<bool> has_failed = false;
    ExecutorOptions options;
    options.on_result = [&](const PointResult& result) {
      if (result.status != PointStatus::complete) has_failed = true;
    };
    if (stops()) options.is_over = [&] { return has_failed.load(); };
    Progress progress(name(), std::vector<double>(points.size(), 1.0), options_.quiet);
    options.progress = [&](std::size_t i, double done) { progress.update(i, done); };
    return run_here(points, options);
  }

  int go_on(const ShardIndex& before) override {
    if (has_to_stop()) return kRunFailed;
    std::vector<std::size_t> points(size());
    std::iota(points.begin(), points.end(), std::size_t{0});
    std::erase_if(points, [&](std::size_t point) { return before.has(point); });
    if (!options_.quiet && before.done() > 0 && !points.empty()) {
      fmt::print(stderr, "{}: {}\n", name(), counted(before));
    }
    const bool is_queued = leave_out_queued(points);
    if (options_.print_tasks) {
      print_tasks(folder_, points, options_.request);
      return kSuccess;
    }
    if (options_.slurm && (is_queued || !points.empty())) {
      if (!points.empty()) submit_points(points);
      if (!options_.wait) return kSuccess;
      wait_for_queue(folder_, plan_.size());
      if (interrupted()) {
        fmt::print(stderr, "{}: interrupted; what is in the queue goes on\n", name());
        return kInterrupted;
      }
    } else if (!points.empty()) {
      warn_of_others();
      make(points);
    }
    const ShardIndex now = index();
    const bool is_complete = now.done() == now.points();
    const bool is_stopped = stops() && first_failure(now);
    if (!is_complete && !is_stopped && (options_.slurm || interrupted())) {
      fmt::print(stderr, "{}: {}; {}; {}the same command goes on\n", name(),
                 options_.slurm ? "the tasks have ended" : "interrupted", counted(now),
                 options_.slurm ? "--status says why, " : "");
      return kInterrupted;
    }
    folder_.check_is(text(), text_there());  // it may have grown meanwhile
    const int status = collect(now);
    if (has_to_stop()) return kRunFailed;
    if (!is_complete) fail_for_undone(now.points() - now.done());
    return status;
  }

 private:
  int collect_sqlite(const fs::path& csv) const {
    const fs::path sqlite = folder_.path() / "results.sqlite";
    if (!sqlite_ && !fs::exists(sqlite)) return kSuccess;
    try {
      write_sqlite(csv, sqlite);
      return kSuccess;
    } catch (const OutputError& error) {
      fmt::print(stderr, "{}: {}\n", name(), error.what());
      return kLaterOutputFailed;
    }
  }

  // Whether there are results of another study, and each is that of a point of this one, too.
  bool keeps_results_of(const Sweep& other) const {
    const ShardIndex results =
        folder_.index(other.plan().size(), [&](std::size_t i) { return other.asked(i); });
    std::unordered_set<std::string> left;
    for (std::size_t point = 0; point < results.points(); ++point) {
      if (results.has(point)) left.insert(other.asked(point));
    }
    for (std::size_t point = 0; point < size() && !left.empty(); ++point) {
      left.erase(sweep_.asked(point));
    }
    return results.done() > 0 && left.empty();
  }

  // Long lists of notes stand behind --all.
  void print_notes(std::vector<std::string> notes, bool is_unranked) const {
    constexpr std::size_t kMostLines = 6;
    if (is_unranked) {
      notes.insert(
          notes.begin(),
          "Nothing is ranked without a goal: --goal METRIC=min or METRIC=max (compare.goal)");
    }
    std::size_t printed = 0, shown = 0;
    for (const std::string& note : notes) {
      const std::vector<std::string> lines = wrapped(note, output_width());
      printed += lines.size();
      if (!prints_all_ && printed > kMostLines) break;
      fmt::print("{}\n", fmt::join(lines, "\n"));
      ++shown;
    }
    if (shown == notes.size() && (prints_all_ || !is_unranked)) return;
    fmt::print("--all prints {}the comparison of each metric\n",
               shown < notes.size() ? number_of(notes.size() - shown, "more note") + " and " : "");
  }

  bool stops() const { return plan_.study().stops_on_failure; }
  // Removes points in the queue from `points`, so that they do not run twice, and reports them.
  // Returns whether there were any.
  bool leave_out_queued(std::vector<std::size_t>& points) const {
    if (points.empty()) return false;
    const auto queue =
        options_.slurm ? queued(folder_, plan_.size()) : queued_if_known(folder_, plan_.size());
    if (!queue || queue->tasks.empty()) return false;
    const std::vector<bool> is_queued = queue->points(plan_.size());
    const std::size_t left =
        std::erase_if(points, [&](std::size_t point) { return is_queued[point]; });
    // A task may have ended after `points` were read. It has left the queue and its points are
    // done.
    const ShardIndex now = index();
    std::erase_if(points, [&](std::size_t point) { return now.has(point); });
    if (left == 0) return false;
    const std::string text = fmt::format("{} {} still in the queue ({})", number_of(left, "point"),
                                         left == 1 ? "is" : "are", queue->text);
    if (!options_.slurm && !options_.print_tasks) {
      throw std::invalid_argument(fmt::format(
          "{}: {}: --status says how far it is; to go on here, end it first with scancel",
          folder_.path().string(), text));
    }
    if (!options_.quiet) {
      fmt::print(stderr, "{}: {}{}\n", name(), text,
                 points.empty() ? "; nothing else is left to submit" : "");
    }
    return true;
  }

  void submit_points(const std::vector<std::size_t>& points) const {
    const SubmittedJob job = submit(folder_, points, options_.request);
    if (options_.quiet) return;
    fmt::print("{} in {}: job {}\n", number_of(points.size(), "point"),
               number_of(job.tasks, "task"), job.number);
    if (options_.wait) return;
    fmt::print("--status says how far it is; when it is over, {} {} {} collects the results\n",
               own_program_name(), name(), folder_.path().string());
  }

  void warn_of_others() const {
    const std::vector<int> others = other_writers(folder_.shards());
    if (others.empty()) return;
    const bool is_one = others.size() == 1;
    warn(name(), {fmt::format("process{} {} {} at this study too: points may be run twice",
                              is_one ? "" : "es", fmt::join(others, ", "), is_one ? "is" : "are")});
  }

  const Catalogue& catalogue_;
  Sweep sweep_;
  const Plan& plan_ = sweep_.plan();
  bool sqlite_;
  bool prints_all_;
};

}  // namespace

int sweep_main(const Catalogue& catalogue, int argc, const char* const* argv) {
  return guarded(kSweep.command, [&] {
    CLI::App app(
        own_program_name() + " sweep: run a scenario over many values and seeds, as one table.",
        kSweep.command);
    app.footer(
        "It leaves study.toml, results.csv (one row a run), comparison.csv (of several cases) and\n"
        "report.html in the study's folder.\n"
        "The same command goes on where it was, whatever ended it.\n"
        "Exit status: 0 all runs are done, 1 a defect, 2 usage or input, 3 a run failed (with\n"
        "--on-failure stop), 130 interrupted.");
    SweepOptions options;
    add_sweep_options(app, options);
    if (const auto status = parse(app, argc, argv)) return *status;
    return SweepCommand(catalogue, open_study(catalogue, options), options).run();
  });
}

}  // namespace breakwater
