#include <breakwater/program/tune_command.h>

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <csignal>
#include <map>
#include <optional>
#include <set>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include <breakwater/cluster/slurm_options.h>
#include <breakwater/cluster/slurm_queue.h>
#include <breakwater/config/toml_file.h>
#include <breakwater/pages/tuning_report.h>
#include <breakwater/program/sweep_command.h>
#include <breakwater/search/cluster_runs.h>
#include <breakwater/search/make_runs.h>
#include <breakwater/search/tuning_outputs.h>
#include <breakwater/shell/all_cores.h>
#include <breakwater/shell/child_program.h>
#include <breakwater/shell/paths.h>
#include <breakwater/shell/process.h>
#include <breakwater/shell/progress.h>
#include <breakwater/shell/table.h>
#include <breakwater/study/study_reader.h>

namespace breakwater {
namespace {

namespace fs = std::filesystem;

constexpr const char* kTuningFile = "tune.toml";

struct TuneArguments {
  std::string target;
  std::string out;
  std::size_t jobs = 0;
  bool isolate = false;
  bool rerun = false;
  bool dry_run = false;
  bool quiet = false;
  bool status = false;
  bool slurm = false;
  SlurmRequest request;
  std::string points;
  std::vector<std::string> candidates;
};

constexpr double kMinutesOfTask = 5.0;  // few: a generation waits for its last task

void describe_tune(CLI::App& app, TuneArguments& arguments) {
  app.add_option("TARGET", arguments.target,
                 "a tuning's file, or the folder of a tuning, to go on with it")
      ->required();
  app.add_option("--out", arguments.out, "the tuning's folder (default: studies/NAME)")
      ->type_name("DIR");
  app.add_option("--jobs", arguments.jobs, "how many runs at a time (default: all cores)")
      ->type_name("N")
      ->check(CLI::Range(1, 4096));
  app.add_flag("--isolate", arguments.isolate,
               "in processes of their own: a run that crashes is one failed run");
  app.add_flag("--dry-run", arguments.dry_run,
               "check the file, count the runs, say how long they will take, from one of each\n"
               "case, and exit")
      ->excludes("--isolate");
  app.add_flag("--rerun", arguments.rerun, "remove what is there and begin anew");
  app.add_flag("--status", arguments.status, "say what is done, and exit")->excludes("--rerun");
  app.add_flag("--quiet", arguments.quiet, "print errors and warnings only");
  app.add_flag("--slurm", arguments.slurm,
               "run each generation as an array job, and wait here for it")
      ->group(kOnCluster)
      ->excludes("--jobs");
  add_slurm_options(app, arguments.request);
  for (const char* option : {"--tasks", "--minutes", "--parallel", "--sbatch"}) {
    app.get_option(option)->needs("--slurm");
  }
  // A task of a cluster: "@DIR/slurm/N/tasks:LINE"; a process of --isolate: "0-9", and candidates.
  app.add_option("--points", arguments.points)->group("")->excludes("--slurm", "--rerun");
  app.add_option("--candidate", arguments.candidates)->expected(1)->take_all()->group("");
  app.footer(
      "It leaves results.csv (one row a run), front.csv, front/N.toml (for --config),\n"
      "hypervolume.csv and report.html in the tuning's folder. The same command goes on where it\n"
      "was, whatever ended it. docs/tuning.md has the file; one that is there to be tried is\n"
      "studies/impact.toml.\n"
      "Exit status: 0 done, 1 a defect, 2 usage or input, 3 no candidate met the constraints,\n"
      "130 interrupted.");
}

struct OpenedTuning {
  Tuning tuning;
  StudyFolder folder;
  std::string target;  // wherever the working folder is
};

OpenedTuning open_tuning(const Catalogue& catalogue, const TuneArguments& arguments) {
  const fs::path target = arguments.target;
  if (fs::is_directory(target)) {
    const StudyFolder folder(fs::absolute(target).lexically_normal(), kTuningFile);
    if (!folder.is_there()) {
      throw std::invalid_argument(arguments.target + ": has no tune.toml: it is " +
                                  (StudyFolder(target).is_there()
                                       ? fmt::format("a study's: {} {}", own_program_name(), kSweep)
                                       : "no tuning's folder"));
    }
    if (!arguments.out.empty()) {
      throw std::invalid_argument(arguments.target + ": is a tuning's folder: leave --out out");
    }
    fs::current_path(folder.working_folder());
    const std::string file = folder.study_file().string();
    return {read_tuning(parse_toml_file(file), file), folder, folder.path().string()};
  }
  // Those that Breakwater brings with it are found from everywhere.
  const std::optional<fs::path> file =
      fs::is_regular_file(target) ? target : look_for(arguments.target);
  if (!file || !fs::is_regular_file(*file)) {
    throw std::invalid_argument(arguments.target +
                                (catalogue.has<ScenarioKind>(arguments.target)
                                     ? ": is a scenario: a tuning is a file that names it"
                                     : ": there is no such file or folder"));
  }
  const fs::path out =
      arguments.out.empty() ? fs::path("studies") / target.stem() : fs::path(arguments.out);
  return {read_tuning(study_tables(file->string()), file->string()),
          StudyFolder(fs::absolute(out).lexically_normal(), kTuningFile), file->string()};
}

// Runs of all searches.
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
  fmt::print("at most {} more to validate: {} of each front in {}\n",
             tuning.cases.size() * tuning.validated_points * tuning.validation->size(),
             tuning.validated_points, tuning.validation->size());
}

void print_dry_run(const TuningPlan& plan, const TuneArguments& arguments) {
  warn(kTune, plan.check());
  if (!arguments.quiet) print_count(plan);
  std::fflush(stdout);
  const Trial trial = plan.try_each_case(interrupted());
  warn(kTune, trial.warnings);
  if (arguments.quiet) return;
  const double seconds = trial.search_s + trial.validation_s;
  const std::size_t jobs = arguments.jobs > 0 ? arguments.jobs : usable_cores();
  fmt::print("about {} on {} ({} of processor time)\n",
             duration_text(seconds / static_cast<double>(jobs)), number_of(jobs, "core"),
             duration_text(seconds));
}

void print_status(const TuningPlan& plan, const StudyFolder& folder) {
  const ShardIndex index(folder.shards(), plan.size());
  std::size_t validated = 0;
  for (std::size_t number = plan.searches(); number < index.points(); ++number) {
    validated += index.has(number);
  }
  fmt::print("{}: {} of {} of the search are done{}\n", folder.path().string(),
             index.done() - validated, number_of(searches(plan), "run"),
             validated > 0 ? fmt::format(", {} of the validation", validated) : "");
  print_slurm_status(folder, index);
}

void warn_of_single_candidates(const Tuning& tuning) {
  if (has_several_objectives(tuning.algorithm)) return;
  warn(kTune, {fmt::format("{} asks for one candidate at a time: each is an array job of its own, "
                           "of {}",
                           name_of(search_algorithms(), tuning.algorithm),
                           number_of(tuning.worlds.size(), "run"))});
}

// What is wrong with a tuning that its runs tell. One may end the process: with --isolate another
// one makes them.
void check_apart(const std::string& target) {
  EndedProgram ended =
      run_beside({own_program(), kTune, target, "--dry-run", "--quiet"}, [](ReadProgram& child) {
        if (interrupted()) child.interrupt();
      });
  if (interrupted()) throw Interrupted();
  std::string error;
  if (ended.has_crashed()) {
    warn(kTune, {fmt::format("a candidate in the middle crashes: {}", ended.end())});
  } else if (ended.exit_status() == kUsage) {
    error = ended.take_reason();
  } else if (ended.status != 0) {
    error = "--isolate: the process that tries each case ended with " + ended.end();
  }
  ended.repeat_said();
  if (!error.empty()) throw std::invalid_argument(error);
}

// Makes the folder, or sees that what is in it is of this tuning.
void make_ready(const TuningPlan& plan, const StudyFolder& folder, const std::string& target,
                const TuneArguments& arguments) {
  const bool is_there = folder.is_there();
  if (is_there && !arguments.rerun) {
    folder.check_made_by_this(plan.file(), ShardIndex(folder.shards(), plan.size()));
    return;
  }
  if (is_there) check_not_queued(queued(folder, plan.size()), folder, "--rerun");
  if (arguments.isolate) {  // while what is there is still there
    check_apart(target);
  } else {
    warn(kTune, plan.check());
    warn(kTune, plan.try_each_case(interrupted()).warnings);
  }
  if (is_there) {
    folder.make_anew(plan.tuning().print(), plan.file());
  } else {
    folder.make(plan.tuning().print(), plan.file());
  }
}

// One line while the searches are made, another one for the validations, which are not known
// before.
class TuningProgress {
 public:
  TuningProgress(const TuningPlan& plan, bool quiet) : plan_(plan), quiet_(quiet) {
    begin(kTune, searches(plan));
  }

  void begin_validation(std::vector<std::size_t> runs) {
    validations_ = std::move(runs);
    std::sort(validations_.begin(), validations_.end());
    begin(fmt::format("{}: validation", kTune), validations_.size());
  }
  void finish(std::size_t number) {
    const TuningRun run = plan_.run(number);
    if (run.is_validation) {
      const auto found = std::lower_bound(validations_.begin(), validations_.end(), number);
      return line_->finish(static_cast<std::size_t>(found - validations_.begin()));
    }
    const std::size_t evaluation = run.tuned * plan_.evaluations() + run.evaluation;
    line_->finish(evaluation * plan_.worlds(false).size() + run.world);
  }

 private:
  void begin(const std::string& what, std::size_t runs) {
    line_.emplace(what, std::vector<double>(runs, 1.0), quiet_);
  }

  const TuningPlan& plan_;
  bool quiet_;
  std::vector<std::size_t> validations_;
  std::optional<Progress> line_;
};

TuningResult tune_or_go_on(TuningPlan& plan, const StudyFolder& folder,
                           const TuneArguments& arguments) {
  // On a cluster the lines of its jobs are the progress.
  TuningProgress progress(plan, arguments.quiet || arguments.slurm);
  TunerOptions options;
  options.jobs = arguments.jobs;
  options.stop = &interrupted();
  options.on_run = [&](std::size_t run) { progress.finish(run); };
  options.on_validation = [&](const std::vector<std::size_t>& runs) {
    progress.begin_validation(runs);
  };
  const ClusterTuning cluster{folder, arguments.request, arguments.isolate, arguments.quiet};
  if (arguments.slurm) {
    options.elsewhere = [&](const std::vector<std::size_t>& runs) {
      run_on_slurm(plan, cluster, runs);
    };
  } else if (arguments.isolate) {
    options.elsewhere = [&](const std::vector<std::size_t>& runs) {
      ExecutorOptions executor;
      executor.threads = arguments.jobs;
      executor.on_result = [&](const PointResult& result) { progress.finish(result.number); };
      make_runs(plan, folder, runs, true, executor);
      if (interrupted()) throw Interrupted();
    };
  }
  return tune(plan, folder, options);
}

// Where a candidate's worlds do not differ, its runs are copies of each other: they say nothing
// about other worlds, and intervals over them are too narrow.
void warn_of_copies(const TuningPlan& plan, const std::vector<PointResult>& runs) {
  struct Count {
    std::size_t copies = 0;
    std::size_t all = 0;
  };
  Count search, validation;
  std::map<std::pair<std::size_t, std::size_t>, std::set<std::string>> met;  // by each candidate
  for (const PointResult& run : runs) {
    if (run.state_hash.empty()) continue;
    const TuningRun one = plan.run(run.number);
    Count& count = one.is_validation ? validation : search;
    ++count.all;
    if (!met[{one.tuned, one.evaluation}].insert(run.state_hash).second) ++count.copies;
  }
  for (const auto& [use, count] : {std::pair("search", search), {"validation", validation}}) {
    if (count.copies == 0) continue;
    warn(kTune, {fmt::format("{}: {} of {} runs are the same as another one of their candidate: "
                             "without noise seeds change nothing",
                             use, count.copies, count.all)});
  }
}

// Returns whether each case has a front.
bool print_result(const TuningPlan& plan, const TuningResult& result, const StudyFolder& folder,
                  bool quiet) {
  bool has_all = true;
  for (const TunedFront& front : result.fronts) {
    if (!front.points.empty()) continue;
    has_all = false;
    fmt::print(stderr, "{}: {}: no candidate of {} met all constraints without a failure\n", kTune,
               front.case_name, front.evaluations.size());
  }
  if (quiet) return has_all;
  fmt::print("{}\nfront: {}\n", fronts_text(plan, result, output_width()),
             (folder.path() / "front.csv").string());
  fmt::print("report: {}\n", (folder.path() / "report.html").string());
  return has_all;
}

int run_tune(const Catalogue& catalogue, const TuneArguments& arguments) {
  const bool is_task = !arguments.points.empty();
  if (is_task) {
    stop_on_signals({SIGUSR1});  // a scheduler's warning that time is up
  } else {
    stop_on_signals();
  }
  OpenedTuning opened = open_tuning(catalogue, arguments);
  const StudyFolder& folder = opened.folder;
  TuningPlan plan(catalogue, std::move(opened.tuning));
  if (arguments.dry_run) {
    print_dry_run(plan, arguments);
    return kSuccess;
  }
  if (folder.is_there()) {
    const std::string file = folder.study_file().string();
    const TuningPlan there(catalogue, read_tuning(parse_toml_file(file), file));
    folder.check_is(plan.tuning().print(), there.tuning().print());
  } else if (arguments.status || is_task) {
    throw std::invalid_argument(folder.path().string() + ": has no tune.toml: nothing was begun");
  }
  if (arguments.status) {
    print_status(plan, folder);
    return kSuccess;
  }
  if (arguments.slurm) {
    check_for_scripts(folder);
    most_tasks();  // that there is no cluster is said before all else
  }
  make_ready(plan, folder, opened.target, arguments);
  if (is_task) {
    const TuningTask task = {arguments.points, arguments.candidates, arguments.jobs,
                             arguments.isolate};
    if (run_task(plan, folder, task)) return kSuccess;
    fmt::print(stderr, "{}: interrupted before all runs of this task were made\n", kTune);
    return kInterrupted;
  }
  if (arguments.slurm) {
    warn_of_single_candidates(plan.tuning());
  } else if (const auto queue = queued_if_known(folder, plan.size(), kTune)) {
    check_not_queued(*queue, folder, "without --slurm");
  }
  TuningResult result;
  try {
    result = tune_or_go_on(plan, folder, arguments);
  } catch (const Interrupted&) {
    fmt::print(stderr, "{}: interrupted; {}\n", kTune,
               arguments.slurm ? "what is in the queue goes on, and so does the same command"
                               : "what ran is kept, and the same command goes on");
    return kInterrupted;
  } catch (const RunsMissing& missing) {
    fmt::print(stderr, "{}: {}; --status says why, the same command goes on\n", kTune,
               missing.what());
    return kInterrupted;
  }
  warn_of_copies(plan, result.runs);
  write_outputs(plan, result, folder.path());
  write_tuning_report(plan, result, folder.path());
  return print_result(plan, result, folder, arguments.quiet) ? kSuccess : kRunFailed;
}

}  // namespace

int tune_main(const Catalogue& catalogue, int argc, const char* const* argv) {
  return guarded(kTune, [&] {
    CLI::App app(own_program_name() + " tune: the best values of some keys, as a front.", kTune);
    TuneArguments arguments;
    arguments.request.minutes = kMinutesOfTask;
    describe_tune(app, arguments);
    if (const auto status = parse(app, argc, argv)) return *status;
    if (arguments.isolate) arguments.request.of_task = {"--isolate"};
    return run_tune(catalogue, arguments);
  });
}

}  // namespace breakwater
