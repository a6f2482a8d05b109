#include <breakwater/report/report_commands.h>

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <set>
#include <stdexcept>

#include <breakwater/record/partial_file.h>
#include <breakwater/record/text_outputs.h>
#include <breakwater/render/render_error.h>
#include <breakwater/report/compare.h>
#include <breakwater/report/figure_script.h>
#include <breakwater/report/html_page.h>
#include <breakwater/report/paired_runs.h>
#include <breakwater/report/replay_part.h>
#include <breakwater/report/reproduction.h>
#include <breakwater/report/run_report.h>
#include <breakwater/report/thesis_report.h>
#include <breakwater/report/verdict_list.h>
#include <breakwater/scenario/child_program.h>
#include <breakwater/scenario/differing_keys.h>
#include <breakwater/scenario/paths.h>
#include <breakwater/scenario/process.h>
#include <breakwater/scenario/progress.h>
#include <breakwater/scenario/saved_run.h>
#include <breakwater/study/comparison_table.h>

namespace breakwater {
namespace fs = std::filesystem;
namespace {

struct ReproduceArguments {
  std::string only = "all";
  std::string out = "runs/reproduce";
  std::string file;
  bool quick = false;
  bool no_video = false;
  bool with_replay = true;
  bool quiet = false;
};

// Those of a group, or those whose number begins with `only`: "2.4" has 2.4.3.2.
std::vector<const SectionSpec*> choose_sections(const Experiments& experiments,
                                                const std::string& only) {
  std::vector<const SectionSpec*> chosen;
  std::vector<std::string> names;
  std::set<std::string> groups;
  for (const SectionSpec& section : experiments.sections) {
    names.push_back(section.id);
    names.push_back(section.group);
    groups.insert(section.group);
    if (only == "all" || only == section.group || only == section.id ||
        section.id.starts_with(only + ".")) {
      chosen.push_back(&section);
    }
  }
  if (chosen.empty()) {
    throw std::invalid_argument(fmt::format(
        "--only {}: must be all, {} or a section, such as {}{}", only, fmt::join(groups, ", "),
        experiments.sections.front().id, did_you_mean(only, names)));
  }
  return chosen;
}

// Refuses a folder that holds something that is not ours.
void check_out(const fs::path& out) {
  if (!fs::exists(out)) return;
  if (!fs::is_directory(out))
    throw std::invalid_argument(out.string() + ": is a file, not a folder");
  const bool is_study = fs::exists(out / "study.toml");  // of `sweep`, with shards of its own
  if (!fs::is_empty(out) && (!fs::exists(shards_folder(out)) || is_study)) {
    throw std::invalid_argument(out.string() +
                                ": holds something that is not a reproduction; give another --out");
  }
}

// Makes what is not there, or older than the run. Returns the status of the last that failed.
int make_pictures(const Reproduction& reproduction, bool with_video) {
  int status = kSuccess;
  const auto make = [&](const std::string& run, const char* command, const char* file,
                        std::vector<std::string> options) {
    const fs::path folder = run_folder(reproduction.out, run);
    if (run.empty() || fs::exists(folder / file)) return;
    std::vector<std::string> words = {own_program(), command, folder.string(), "--quiet"};
    words.insert(words.end(), options.begin(), options.end());
    if (!reproduction.quiet) fmt::print(stderr, "reproduce: {} of {}\n", command, run);
    const int made = call_program(command, words);
    if (made != kSuccess) status = made == kInterrupted ? kInterrupted : kLaterOutputFailed;
  };
  for (const SectionSpec* section : reproduction.sections) {
    if (status == kInterrupted) break;
    if (with_video) make(section->video, "video", "video.mp4", {"--size", "800x450"});
    make(section->strip, "strip", "strip.png", {"--size", "420x240"});
  }
  return status;
}

int reproduce(const Catalogue& catalogue, const ReproduceArguments& arguments) {
  const fs::path file =
      arguments.file.empty() ? data_file("data/experiments.toml") : fs::path(arguments.file);
  const Effort effort = arguments.quick ? Effort::quick : Effort::full;
  const Experiments experiments = read_experiments(file.string(), effort);
  check_out(arguments.out);
  stop_on_signals();
  const Reproduction reproduction{catalogue,
                                  experiments,
                                  choose_sections(experiments, arguments.only),
                                  arguments.out,
                                  arguments.quiet,
                                  &interrupted(),
                                  arguments.with_replay};
  const Measured measured = measure(reproduction);
  const int status = make_pictures(reproduction, !arguments.no_video);
  if (status == kInterrupted) throw Interrupted(measured.size());
  const ThesisReport report = thesis_report(reproduction, measured, effort);
  for (const std::string& note : report.notes) fmt::print(stderr, "reproduce: {}\n", note);
  const fs::path page = reproduction.out / "report.html";
  replace_file(page, report.html);
  const fs::path verdicts = reproduction.out / "verdicts.csv";
  write_text_file(verdicts.string(), verdict_list(reproduction, measured));
  fmt::print("{}\n{} figures\nreport: {}\nverdicts: {}\n", report.score.text(), report.figures,
             page.string(), verdicts.string());
  return status;
}

int reproduce_main(const Catalogue& catalogue, int argc, const char* const* argv) {
  CLI::App app(
      own_program_name() +
          " reproduce: run every experiment of the thesis, and put its results beside the printed "
          "ones.",
      "reproduce");
  ReproduceArguments arguments;
  app.add_option("--only", arguments.only,
                 "all, arm, cart, motor, quadrotor or a section of the thesis")
      ->type_name("WHAT");
  app.add_flag("--quick", arguments.quick, "fewer seeds and encoder phases");
  app.add_option("--out", arguments.out, "where runs and report.html go")
      ->type_name("DIR")
      ->capture_default_str();
  app.add_option("--experiments", arguments.file,
                 "another list of experiments than data/experiments.toml")
      ->type_name("FILE");
  app.add_flag("--no-video", arguments.no_video, "leave out the video");
  app.add_flag("!--no-replay", arguments.with_replay, "leave out the replays");
  app.add_flag("--quiet", arguments.quiet, "print errors and the score only");
  app.footer(
      "What is there already for the same configuration, models and program is kept: a run that\n"
      "was stopped, however, goes on where it was. What counts as reproduced:\n"
      "data/reproduced.toml.\n"
      "Exit status: 0 success, 1 a defect, 2 usage or input, 4 a picture or video could not be\n"
      "made, 130 interrupted.");
  if (const auto status = parse(app, argc, argv)) return *status;
  return reproduce(catalogue, arguments);
}

struct RunsArguments {
  std::vector<std::string> runs;
  CompareChoice choice;
  std::string out = ".";
  bool paired = false;
  std::string baseline;
  std::vector<std::string> goals;
  bool csv = false;
  bool json = false;
  bool latex = false;
  bool svg = false;
  bool pdf = false;
  bool quiet = false;
};

std::vector<SavedRun> open_all(const std::vector<std::string>& folders) {
  std::vector<SavedRun> runs;
  for (const std::string& folder : folders) runs.emplace_back(folder);
  return runs;
}

fs::path made_folder(const std::string& folder) {
  std::error_code error;
  fs::create_directories(folder, error);
  if (error) throw std::invalid_argument(folder + ": cannot be made (" + error.message() + ")");
  return folder;
}

int compare(const Catalogue& catalogue, const RunsArguments& arguments) {
  const Comparison comparison(catalogue, open_all(arguments.runs), arguments.choice);
  const bool has_figures = arguments.svg || arguments.pdf;
  if (has_figures && arguments.choice.signals.empty()) {
    throw std::invalid_argument("--svg and --pdf: say which signals with --signal");
  }
  if (has_figures && !can_draw_figures()) return kUsage;
  const fs::path out = made_folder(arguments.out);
  std::vector<fs::path> written = {out / "compare.html"};
  std::vector<std::string> notes;
  replace_file(written[0], comparison.html(notes));
  for (const std::string& note : notes) fmt::print(stderr, "compare: {}\n", note);
  const auto write = [&](const char* name, const std::string& text) {
    written.push_back(out / name);
    write_text_file(written.back().string(), text);
  };
  if (arguments.csv) write("compare.csv", comparison.csv());
  if (arguments.latex) write("compare.tex", comparison.latex());
  int status = kSuccess;
  const std::vector<fs::path> folders(arguments.runs.begin(), arguments.runs.end());
  for (const char* kind : {"svg", "pdf"}) {
    if (!(kind[0] == 's' ? arguments.svg : arguments.pdf)) continue;
    const fs::path file = out / (std::string("compare.") + kind);
    const int made = draw_figure({folders, comparison.labels(), comparison.signals(),
                                  arguments.choice.from_s, arguments.choice.to_s},
                                 file);
    if (made != kSuccess) status = made;
    if (made == kSuccess) written.push_back(file);
  }
  if (arguments.json) {
    fmt::print("{}", comparison.json());
  } else if (!arguments.quiet) {
    fmt::print("{}\n", comparison.text(output_width()));
    for (const fs::path& file : written) fmt::print("{}\n", file.string());
  }
  return status;
}

std::map<std::string, Goal> read_goals(const std::vector<std::string>& texts) {
  std::map<std::string, Goal> goals;
  for (const std::string& text : texts) {
    const std::size_t equals = text.find('=');
    const std::string name = equals == std::string::npos ? "" : text.substr(equals + 1);
    const auto goal = std::find_if(goal_names().begin(), goal_names().end(),
                                   [&](const auto& entry) { return entry.first == name; });
    if (goal == goal_names().end()) {
      throw std::invalid_argument("--goal: " + text + ": must be METRIC=min or METRIC=max");
    }
    goals[text.substr(0, equals)] = goal->second;
  }
  return goals;
}

int compare_paired(const RunsArguments& arguments) {
  const CandidateComparison comparison =
      compare_candidates(paired_runs(open_all(arguments.runs), arguments.choice.metrics,
                                     arguments.baseline, read_goals(arguments.goals)));
  const fs::path file = made_folder(arguments.out) / "comparison.csv";
  replace_file(file, comparison_csv(comparison));
  if (!arguments.quiet) {
    fmt::print("{}\n{}\n", comparison_text(comparison, output_width()), file.string());
  }
  return kSuccess;
}

int report(const Catalogue& catalogue, const RunsArguments& arguments) {
  const std::vector<SavedRun> runs = open_all(arguments.runs);
  const fs::path file = made_folder(arguments.out) / "report.html";
  std::vector<std::string> notes;
  replace_file(file, run_report(catalogue, runs, {arguments.choice.with_replay}, notes));
  for (const std::string& note : notes) fmt::print(stderr, "report: {}\n", note);
  if (!arguments.quiet) fmt::print("report: {}\n", file.string());
  return kSuccess;
}

struct ReplayArguments {
  std::vector<std::string> runs;
  std::string camera;
  std::string out;
  bool quiet = false;
};

int replay(const Catalogue& catalogue, const ReplayArguments& arguments) {
  const std::deque<FinishedRun> runs = open_runs(catalogue, arguments.runs);
  const fs::path file =
      arguments.out.empty() ? runs.front().folder() / "replay.html" : fs::path(arguments.out);
  std::vector<std::string> notes;
  try {
    replace_file(file, replay_page(runs, labels_of(catalogue, open_all(arguments.runs)),
                                   arguments.camera, notes));
  } catch (const RenderError& error) {
    fmt::print(stderr, "{}\n", error.what());
    return kLaterOutputFailed;
  }
  for (const std::string& note : notes) fmt::print(stderr, "replay: {}\n", note);
  if (!arguments.quiet) fmt::print("replay: {}\n", file.string());
  return kSuccess;
}

int replay_main(const Catalogue& catalogue, int argc, const char* const* argv) {
  CLI::App app(
      own_program_name() + " replay: finished runs in three dimensions, as a page for any browser.",
      "replay");
  ReplayArguments arguments;
  app.add_option("RUN", arguments.runs,
                 "folders of finished runs of one scenario, up to 4: in one scene, or side by side")
      ->required();
  app.add_option("--camera", arguments.camera,
                 "the camera to begin with: one of the model's (default: the shot list's)")
      ->type_name("NAME");
  app.add_option("--out", arguments.out, "the page (default: RUN/replay.html)")->type_name("FILE");
  app.add_flag("--quiet", arguments.quiet, "print errors only");
  app.footer(
      "The page is one file and needs no network. It plays what the run's log has, with the\n"
      "arrows and chart of the scenario's shots.toml; nothing is simulated again.\n"
      "Exit status: 0 success, 1 a defect, 2 usage or input, 4 it could not be made or written.");
  if (const auto status = parse(app, argc, argv)) return *status;
  return replay(catalogue, arguments);
}

int runs_main(const Catalogue& catalogue, bool is_comparison, int argc, const char* const* argv) {
  CLI::App app(own_program_name() +
                   (is_comparison ? " compare: metrics and signals of finished runs side by side."
                                  : " report: one page about finished runs."),
               argv[0]);
  RunsArguments arguments;
  app.add_option("RUN", arguments.runs, "the folders of finished runs")->required();
  app.add_option("--out", arguments.out, "the folder for what is written")
      ->type_name("DIR")
      ->capture_default_str();
  if (is_comparison) {
    app.add_option("--metric", arguments.choice.metrics,
                   "which metrics (default: all); may be given again")
        ->type_name("NAME")
        ->allow_extra_args(false);
    app.add_option("--signal", arguments.choice.signals,
                   "which signals: NAME, GROUP/NAME or NAME[2] (default: all); may be given again")
        ->type_name("NAME")
        ->allow_extra_args(false);
    app.add_option("--from", arguments.choice.from_s,
                   "simulated time that charts and figures begin with (default: the shot list's)")
        ->type_name("S");
    app.add_option("--to", arguments.choice.to_s, "simulated time that they end with")
        ->type_name("S");
    app.add_flag("--paired", arguments.paired,
                 "instead: sets of runs, several seeds of each case, paired by seed; writes\n"
                 "comparison.csv with intervals, tests and verdicts");
    app.add_option("--baseline", arguments.baseline, "with --paired: the case to compare with")
        ->type_name("CASE")
        ->needs("--paired");
    app.add_option("--goal", arguments.goals,
                   "with --paired: what is better, METRIC=min or METRIC=max; may be given again")
        ->type_name("METRIC=GOAL")
        ->allow_extra_args(false)
        ->needs("--paired");
    app.add_flag("--json", arguments.json, "print the table as JSON")->excludes("--paired");
    app.add_flag("--csv", arguments.csv, "write compare.csv: the metrics and their differences");
    app.add_flag("--latex", arguments.latex, "write compare.tex: a booktabs table of the metrics");
    app.add_flag("--svg", arguments.svg, "write compare.svg: the signals, for a paper");
    app.add_flag("--pdf", arguments.pdf, "write compare.pdf: the same");
  }
  app.add_flag("!--no-replay", arguments.choice.with_replay, "leave out the replay");
  app.add_flag("--quiet", arguments.quiet, "print errors only");
  app.footer(is_comparison
                 ? "It writes compare.html, a page that needs no network. Figures are drawn by\n"
                   "scripts/figures.py (python3-h5py, python3-matplotlib), which you may copy."
                 : "It writes report.html, a page that needs no network.");
  if (const auto status = parse(app, argc, argv)) return *status;
  if (arguments.paired) return compare_paired(arguments);
  return is_comparison ? compare(catalogue, arguments) : report(catalogue, arguments);
}

}  // namespace

const std::vector<std::pair<std::string, std::string>>& report_commands() {
  static const std::vector<std::pair<std::string, std::string>> commands = {
      {"reproduce", "run every experiment of the thesis, beside what is printed"},
      {"report", "one page about finished runs: report RUN..."},
      {"compare", "finished runs side by side: compare RUN RUN..."},
      {"replay", "finished runs in three dimensions, in a browser: replay RUN..."}};
  return commands;
}

bool is_report_command(const std::string& name) {
  const auto& all = report_commands();
  return std::any_of(all.begin(), all.end(),
                     [&](const auto& entry) { return entry.first == name; });
}

int report_main(const Catalogue& catalogue, int argc, const char* const* argv) {
  return guarded(argv[0], [&] {
    const std::string name = argv[0];
    if (name == "reproduce") return reproduce_main(catalogue, argc, argv);
    if (name == "replay") return replay_main(catalogue, argc, argv);
    return runs_main(catalogue, name == "compare", argc, argv);
  });
}

}  // namespace breakwater
