#include <breakwater/tuning/tune_command.h>

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <stdexcept>
#include <string>

#include <breakwater/scenario/child_program.h>
#include <breakwater/scenario/process.h>
#include <breakwater/scenario/progress.h>
#include <breakwater/scenario/table.h>
#include <breakwater/scenario/toml_file.h>
#include <breakwater/study/study_notes.h>
#include <breakwater/study/study_reader.h>
#include <breakwater/tuning/tuning_outputs.h>

namespace breakwater {
namespace {

namespace fs = std::filesystem;

constexpr const char* kTuningFile = "tune.toml";

struct TuneArguments {
  std::string target;
  std::string out;
  std::size_t jobs = 0;
  bool rerun = false;
  bool dry_run = false;
  bool quiet = false;
};

void describe_tune(CLI::App& app, TuneArguments& arguments) {
  app.add_option("TARGET", arguments.target,
                 "a tuning's file, or the folder of a tuning, to go on with it")
      ->required();
  app.add_option("--out", arguments.out, "the tuning's folder (default: studies/NAME)")
      ->type_name("DIR");
  app.add_option("--jobs", arguments.jobs, "how many runs at a time (default: all cores)")
      ->type_name("N")
      ->check(CLI::Range(1, 4096));
  app.add_flag("--dry-run", arguments.dry_run, "check the file, count the runs, and exit");
  app.add_flag("--rerun", arguments.rerun, "remove what is there and begin anew");
  app.add_flag("--quiet", arguments.quiet, "print errors only");
  app.footer(
      "It leaves results.csv (one row a run), front.csv, front/N.toml (for --config),\n"
      "hypervolume.csv and report.html in the tuning's folder. The same command goes on where it\n"
      "was, whatever ended it. docs/tuning.md has the file.\n"
      "Exit status: 0 done, 1 a defect, 2 usage or input, 3 no candidate met the constraints,\n"
      "130 interrupted.");
}

struct OpenedTuning {
  Tuning tuning;
  StudyFolder folder;
};

OpenedTuning open_tuning(const TuneArguments& arguments) {
  const fs::path target = arguments.target;
  if (fs::is_directory(target)) {
    const StudyFolder folder(fs::absolute(target).lexically_normal(), kTuningFile);
    if (!folder.is_there()) {
      throw std::invalid_argument(arguments.target +
                                  ": has no tune.toml: it is no tuning's folder");
    }
    if (!arguments.out.empty()) {
      throw std::invalid_argument(arguments.target + ": is a tuning's folder: leave --out out");
    }
    fs::current_path(folder.working_folder());
    const std::string file = folder.study_file().string();
    return {read_tuning(parse_toml_file(file), file), folder};
  }
  if (!fs::is_regular_file(target)) {
    throw std::invalid_argument(arguments.target + ": there is no such file or folder");
  }
  const fs::path out =
      arguments.out.empty() ? fs::path("studies") / target.stem() : fs::path(arguments.out);
  return {read_tuning(study_tables(arguments.target), arguments.target),
          StudyFolder(fs::absolute(out).lexically_normal(), kTuningFile)};
}

void print_count(const TuningPlan& plan) {
  const Tuning& tuning = plan.tuning();
  const std::size_t runs = tuning.cases.size() * tuning.budget * tuning.worlds.size();
  fmt::print("{} runs: {}, {} evaluations of each, {} and seeds together\n", runs,
             number_of(tuning.cases.size(), "case"), tuning.budget,
             number_of(tuning.worlds.size(), "world"));
  if (!tuning.validation) return;
  fmt::print("at most {} more to validate: {} of each front in {}\n",
             tuning.cases.size() * tuning.validated_points * tuning.validation->size(),
             tuning.validated_points, tuning.validation->size());
}

int run_tune(const Catalogue& catalogue, const TuningExtras& extras,
             const TuneArguments& arguments) {
  stop_on_signals();
  OpenedTuning opened = open_tuning(arguments);
  const StudyFolder& folder = opened.folder;
  TuningPlan plan(catalogue, std::move(opened.tuning));
  if (arguments.dry_run) {
    warn(kTune, plan.check());
    print_count(plan);
    return kSuccess;
  }
  if (folder.is_there()) {
    const std::string file = folder.study_file().string();
    const TuningPlan there(catalogue, read_tuning(parse_toml_file(file), file));
    folder.check_is(plan.tuning().print(), there.tuning().print());
    if (arguments.rerun) {
      warn(kTune, plan.check());  // while what is there is still there
      folder.make_anew(plan.tuning().print(), plan.file());
    } else {
      folder.check_made_by_this(plan.file(), ShardIndex(folder.shards(), plan.size()));
    }
  }
  if (!folder.is_there()) {
    warn(kTune, plan.check());
    plan.check_metrics(interrupted());
    folder.make(plan.tuning().print(), plan.file());
  }
  TuningResult result;
  try {
    const Tuning& tuning = plan.tuning();
    const std::size_t searches = tuning.cases.size() * tuning.budget * tuning.worlds.size();
    Progress progress(kTune, std::vector<double>(searches, 1.0), arguments.quiet);
    result = tune(plan, folder, {arguments.jobs, &interrupted(), [&](std::size_t run) {
                                   if (run < searches) progress.finish(run);
                                 }});
  } catch (const Interrupted&) {
    fmt::print(stderr, "{}: interrupted; what ran is kept, and the same command goes on\n", kTune);
    return kInterrupted;
  }
  write_outputs(plan, result, folder.path());
  if (extras.write_report) extras.write_report(plan, result, folder.path());
  bool has_all = true;
  for (const TunedFront& front : result.fronts) {
    if (!front.points.empty()) continue;
    has_all = false;
    fmt::print(stderr, "{}: {}: no candidate of {} met all constraints without a failure\n", kTune,
               front.case_name, front.evaluations.size());
  }
  if (!arguments.quiet) {
    fmt::print("{}\nfront: {}\n", fronts_text(plan, result, output_width()),
               (folder.path() / "front.csv").string());
    if (extras.write_report) {
      fmt::print("report: {}\n", (folder.path() / "report.html").string());
    }
  }
  return has_all ? kSuccess : kRunFailed;
}

}  // namespace

int tune_main(const Catalogue& catalogue, const TuningExtras& extras, int argc,
              const char* const* argv) {
  return guarded(kTune, [&] {
    CLI::App app(own_program_name() + " tune: the best values of some keys, as a front.", kTune);
    TuneArguments arguments;
    describe_tune(app, arguments);
    if (const auto status = parse(app, argc, argv)) return *status;
    return run_tune(catalogue, extras, arguments);
  });
}

}  // namespace breakwater
