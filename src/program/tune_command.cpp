#include <breakwater/program/commands.h>

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <atomic>
#include <set>
#include <utility>

#include <breakwater/pages/study_report.h>
#include <breakwater/program/study_command.h>
#include <breakwater/record/partial_file.h>
#include <breakwater/shell/child_program.h>
#include <breakwater/shell/process.h>
#include <breakwater/shell/progress.h>
#include <breakwater/shell/table.h>
#include <breakwater/signals/input_file.h>
#include <breakwater/study/shards.h>
#include <breakwater/study/study_reader.h>

namespace breakwater {
namespace {

// Several jobs in a row ended without new runs.
class RunsMissing : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

constexpr int kMostWithoutResult = 3;  // jobs in a row without a result

// A text such as "ours, evaluations 17 to 32: 64 runs".
std::string text_of(const TuningPlan& plan, const std::vector<std::size_t>& runs) {
  const TuningRun first = plan.run(runs.front());
  const std::size_t last = plan.run(runs.back()).evaluation;
  const std::string what = first.is_validation        ? "validation"
                           : first.evaluation == last ? fmt::format("evaluation {}", last + 1)
                                                      : fmt::format("evaluations {} to {}",
                                                                    first.evaluation + 1, last + 1);
  return fmt::format("{}, {}: {}", plan.tuning().cases[first.tuned].name, what,
                     number_of(runs.size(), "run"));
}

// Submits runs as an array job and waits until all of them are in the shards of the folder. Runs
// that are missing after the job are submitted again, unless they are still in the queue. Throws
// RunsMissing after three jobs in a row without a result, Interrupted (the queue stays as it is),
// and std::invalid_argument if Slurm refuses.
void run_on_slurm(const TuningPlan& plan, const StudyFolder& folder, const StudyOptions& options,
                  const std::vector<std::size_t>& runs) {
  std::vector<std::size_t> left = runs;
  for (int without_result = 0;;) {
    wait_for_queue(folder, plan.size());
    if (interrupted()) throw Interrupted();
    const ShardIndex index =
        folder.index(plan.size(), [&](std::size_t run) { return plan.asked(run); });
    const std::size_t before = left.size();
    left = runs;
    std::erase_if(left, [&](std::size_t run) { return index.has(run); });
    if (left.empty()) return;
    if (left.size() < before) without_result = 0;
    if (without_result++ == kMostWithoutResult) {
      throw RunsMissing(fmt::format("{} jobs in a row have brought nothing of {}",
                                    kMostWithoutResult, text_of(plan, left)));
    }
    const SubmittedJob job = submit(folder, left, options.request);
    if (options.quiet) continue;
    fmt::print("{} in {}: job {}\n", text_of(plan, left), number_of(job.tasks, "task"), job.number);
    std::fflush(stdout);  // standard output may be a file that somebody watches
  }
}

namespace fs = std::filesystem;

constexpr std::size_t kTasks = 10;

struct TuneOptions {
  StudyOptions study;
  std::vector<std::string> sets;
};

void add_tune_options(CLI::App& app, TuneOptions& options) {
  options.study.request.tasks = kTasks;
  add_study_options(
      app, options.study,
      {.target = "a tuning's file, or the folder of a tuning, to go on with it",
       .out = "the tuning's folder (default: studies/NAME)",
       .dry_run = "check the file, count the runs, say how long they will take, from one of each\n"
                  "case, and exit",
       .slurm = "run each generation as an array job, and wait here for it"});
  app.add_option("--set", options.sets, "a key of every run, as in [set] of the file")
      ->type_name("KEY=VALUE");
  app.get_option("--slurm")->excludes("--jobs");
  for (const char* option : {"--tasks", "--parallel", "--sbatch"}) {
    app.get_option(option)->needs("--slurm");
  }
  // On a cluster: "@DIR/slurm/N/tasks:LINE". In a process of --isolate: "0-9".
  app.add_option("--points", options.study.points)->group("")->excludes("--slurm", "--rerun");
  app.footer(
      "The tuning's folder gets results.csv (one row a run), report.html, front.csv\n"
      "and front/N.toml (for --config). With one objective there is no front, and\n"
      "it gets tuned.csv and tuned/CASE.toml. The same command goes on where it\n"
      "was, whatever ended it. docs/how-to/tuning.md has the file; one that is there to be tried\n"
      "is studies/impact.toml.\n"
      "Exit status: 0 done, 1 a defect, 2 usage or input, 3 no candidate met the constraints,\n"
      "130 interrupted.");
}

struct OpenedTuning {
  Tuning tuning;
  StudyFolder folder;
};

Tuning tuning_of(const StudyFolder& folder) {
  const std::string file = folder.study_file().string();
  return read_tuning(parse_toml_file(file), file);
}

OpenedTuning open_tuning(const Catalogue& catalogue, const TuneOptions& given) {
  const StudyOptions& options = given.study;
  const fs::path target = options.target;
  if (fs::is_directory(target)) {
    const StudyFolder folder = begun_folder(options.target, kTune);
    if (!options.out.empty() || !given.sets.empty()) {
      throw std::invalid_argument(options.target +
                                  ": is a tuning's folder: leave --out and --set out");
    }
    return {tuning_of(folder), folder};
  }
  const auto file = file_of_study(options.target);
  if (!file) {
    throw std::invalid_argument(options.target +
                                (catalogue.has<ScenarioKind>(options.target)
                                     ? ": is a scenario: a tuning is a file that names it"
                                     : ": there is no such file or folder"));
  }
  toml::table tables = study_tables(file->string());
  lay_sets(given.sets, file->string(), tables);
  return {read_tuning(tables, file->string()), new_folder(options, target.stem().string(), kTune)};
}

// The number of runs of all searches.
std::size_t searches(const TuningPlan& plan) {
  const Tuning& tuning = plan.tuning();
  return plan.evaluations() * tuning.cases.size() * tuning.worlds.size();
}

void print_count(const TuningPlan& plan) {
  const Tuning& tuning = plan.tuning();
  fmt::print("{} runs: {}, {} evaluations of each, {} and seeds together{}\n", searches(plan),
             number_of(tuning.cases.size(), "case"), plan.evaluations(),
             number_of(tuning.worlds.size(), "world"),
             plan.evaluations() == tuning.budget
                 ? ""
                 : fmt::format(" ({} of the budget are left: they make no generation)",
                               tuning.budget - plan.evaluations()));
  if (!tuning.validation) return;
  fmt::print("at most {} more to validate: {} of each {} in {}\n",
             tuning.cases.size() * tuning.validated_points * tuning.validation->size(),
             tuning.validated_points, tuning.has_front() ? "front" : "case",
             tuning.validation->size());
}

// Warns if all test conditions of a candidate give the same run. Copies contain no information
// about other conditions, and their intervals are too narrow.
void warn_of_copies(const TuningPlan& plan, const std::map<std::size_t, PointResult>& runs) {
  std::map<std::pair<std::size_t, std::size_t>, std::set<std::string>> met;  // by candidate
  for (const bool is_validation : {false, true}) {
    std::size_t copies = 0, all = 0;
    for (const auto& [number, run] : runs) {
      const TuningRun one = plan.run(number);
      if (one.is_validation != is_validation) continue;
      if (run.status != PointStatus::complete) continue;  // it may have failed in its first step
      ++all;
      copies += !met[{one.tuned, one.evaluation}].insert(run.state_hash).second;
    }
    if (copies == 0) continue;
    warn(kTune.command,
         {fmt::format("{}: {} of {} runs are the same as another one of their candidate: what "
                      "differs between their conditions, such as the seed, changes nothing there",
                      is_validation ? "validation" : "search", copies, all)});
  }
}

// Returns whether each case has a Pareto front.
bool print_result(const TuningPlan& plan, const TuningResult& result, const FrontTable& table,
                  const StudyFolder& folder, bool quiet) {
  bool has_all = true;
  for (const TunedFront& front : result.fronts) {
    if (!front.points.empty()) continue;
    has_all = false;
    fmt::print(stderr, "{}: {}: no candidate of {} met all constraints without a failure\n",
               kTune.command, front.case_name, front.evaluations.size());
  }
  if (quiet) return has_all;
  const std::string kind = plan.tuning().has_front() ? "front" : "tuned";
  fmt::print("{}\n{}: {}\n", tuning_text(plan, table, output_width()), kind,
             (folder.path() / (kind + ".csv")).string());
  fmt::print("report: {}\n", (folder.path() / "report.html").string());
  return has_all;
}

class TuneCommand : public StudyCommand {
 public:
  TuneCommand(const Catalogue& catalogue, OpenedTuning opened, const TuneOptions& options)
      : StudyCommand(std::move(opened.folder), options.study),
        catalogue_(catalogue),
        plan_(catalogue, std::move(opened.tuning)) {}

 protected:
  const PointSource& source() const override { return plan_; }
  const ScenarioFile& file() const override { return plan_.file(); }
  std::size_t size() const override { return plan_.size(); }
  std::string text() const override { return plan_.tuning().print(); }
  std::string text_there() const override {
    return TuningPlan(catalogue_, tuning_of(folder_)).tuning().print();
  }

  void print_dry_run() const override {
    warn(name(), plan_.check());
    if (!options_.quiet) print_count(plan_);
    std::fflush(stdout);
    const double seconds = try_each_case();
    if (!options_.quiet) fmt::print("{}", time_needed(seconds, options_.jobs));
  }

  void print_status(const ShardIndex& index) const override {
    std::size_t validated = 0;
    for (std::size_t number = plan_.searches(); number < index.points(); ++number) {
      validated += index.has(number);
    }
    fmt::print("{}: {} of {} of the search are done{}\n", folder_.path().string(),
               index.done() - validated, number_of(searches(plan_), "run"),
               validated > 0 ? fmt::format(", {} of the validation", validated) : "");
  }

  void check() const override { warn(name(), plan_.check()); }

  std::vector<std::size_t> task_points() override {
    plan_.begin(candidates_);
    std::vector<std::size_t> runs = StudyCommand::task_points();
    for (const std::size_t number : runs) {
      const TuningRun run = plan_.run(number);
      if (plan_.has(run.tuned, run.evaluation)) continue;
      throw std::invalid_argument(
          fmt::format("{}: lacks the candidate of run {}", candidates_.string(), number));
    }
    return runs;
  }

  std::size_t make(const std::vector<std::size_t>& runs) override { return run_here(runs, {}); }

  int go_on(const ShardIndex&) override {
    const Tuning& tuning = plan_.tuning();
    if (options_.slurm && !has_several_objectives(tuning.algorithm)) {
      warn(name(), {fmt::format("{} asks for one candidate at a time: each is an array job of its "
                                "own, of {}",
                                name_of(search_algorithms(), tuning.algorithm),
                                number_of(tuning.worlds.size(), "run"))});
    }
    if (!options_.slurm) {
      const auto queue = queued_if_known(folder_, plan_.size());
      if (queue) check_not_queued(*queue, folder_, "without --slurm");
    }
    try {
      const TuningResult result = search_and_validate();
      warn_of_copies(plan_, result.runs);
      const FrontTable table = front_table(plan_, result);
      write_outputs(plan_, result, table, folder_.path());
      write_tuning_report(catalogue_, plan_, result, table, folder_.path());
      return print_result(plan_, result, table, folder_, options_.quiet) ? kSuccess : kRunFailed;
    } catch (const Interrupted&) {
      fmt::print(stderr, "{}: interrupted; {}\n", name(),
                 options_.slurm ? "what is in the queue goes on, and so does the same command"
                                : "what ran is kept, and the same command goes on");
    } catch (const RunsMissing& missing) {
      fmt::print(stderr, "{}: {}; --status says why, the same command goes on\n", name(),
                 missing.what());
    }
    return kInterrupted;
  }

 private:
  // Runs each case in the middle of its ranges, in the first test condition, and warns of what may
  // fail. Returns the processor time of search and validation. Throws Interrupted.
  double try_each_case() const {
    const Tuning& tuning = plan_.tuning();
    const std::size_t fresh =
        tuning.validation ? tuning.validated_points * tuning.validation->size() : 0;
    const std::size_t runs = plan_.evaluations() * tuning.worlds.size() + fresh;
    TuningPlan plan = plan_;
    RunControl control;
    control.stop = &interrupted();
    double seconds = 0.0;
    for (std::size_t c = 0; c < tuning.cases.size(); ++c) {
      const TunedCase& tuned = tuning.cases[c];
      plan.begin(c, 0, plan.values(c, std::vector<double>(tuned.search.size(), 0.5)));
      const PointResult run = run_point(plan.number({.tuned = c}), plan, control);
      seconds += static_cast<double>(runs) * run.cost_s;
      if (run.status != PointStatus::complete) {
        warn(name(),
             {fmt::format("{}: the candidate in the middle fails: {}", tuned.name, run.reason)});
        continue;
      }
      for (const NamedMetric& one : tuning.named) {
        if (metric_of(run, one.name)) continue;
        warn(name(), {fmt::format("{}: a run of {} lacks it", one.place, tuned.name)});
      }
    }
    return seconds;
  }

  TuningResult search_and_validate() {
    // Progress: one line for the searches and one for the validation, whose runs are known later.
    std::optional<Progress> progress;
    std::size_t expected = 0;
    std::atomic<std::size_t> finished = 0;
    const auto begin = [&](const std::string& what, std::size_t count) {
      expected = count;
      finished = 0;
      // On a cluster the lines of the jobs show it.
      progress.emplace(what, std::vector<double>(count, 1.0), options_.quiet || options_.slurm);
    };
    begin(kTune.command, searches(plan_));
    TunerOptions tuner;
    tuner.jobs = options_.jobs;
    tuner.stop = &interrupted();
    tuner.on_run = [&](std::size_t) {
      if (const std::size_t run = finished++; run < expected) progress->finish(run);
    };
    tuner.on_validation = [&](std::size_t runs) {
      begin(fmt::format("{}: validation", kTune.command), runs);
    };
    const auto elsewhere = [&](std::vector<std::size_t> runs) {
      const std::string lines = plan_.candidate_lines();
      // Another process of this tuning may be ahead.
      const bool has_all = fs::exists(candidates_) && bytes_of(candidates_).starts_with(lines);
      if (!has_all) replace_file(candidates_, lines);
      if (options_.slurm) return run_on_slurm(plan_, folder_, options_, runs);
      std::sort(runs.begin(), runs.end());
      const std::size_t left = make(runs);
      if (interrupted()) throw Interrupted();
      if (left > 0) fail_for_undone(left);
    };
    if (options_.slurm || options_.isolate) tuner.elsewhere = elsewhere;
    return tune(plan_, folder_, tuner);
  }

  const Catalogue& catalogue_;
  TuningPlan plan_;
  // All candidates so far, from the process that searches, for those of its tasks.
  const fs::path candidates_ = folder_.path() / "candidates";
};

}  // namespace

int tune_main(const Catalogue& catalogue, int argc, const char* const* argv) {
  return guarded(kTune.command, [&] {
    CLI::App app(own_program_name() + " tune: search for the best values of some keys.",
                 kTune.command);
    TuneOptions options;
    add_tune_options(app, options);
    if (const auto status = parse(app, argc, argv)) return *status;
    return TuneCommand(catalogue, open_tuning(catalogue, options), options).run();
  });
}

}  // namespace breakwater
