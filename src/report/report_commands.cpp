#include <breakwater/report/report_commands.h>

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <set>
#include <stdexcept>

#include <breakwater/record/partial_file.h>
#include <breakwater/record/text_outputs.h>
#include <breakwater/report/compare.h>
#include <breakwater/report/figure_script.h>
#include <breakwater/report/html_page.h>
#include <breakwater/report/reproduction.h>
#include <breakwater/report/run_report.h>
#include <breakwater/report/thesis_report.h>
#include <breakwater/report/verdict_list.h>
#include <breakwater/scenario/child_program.h>
#include <breakwater/scenario/paths.h>
#include <breakwater/scenario/process.h>
#include <breakwater/scenario/progress.h>
#include <breakwater/scenario/saved_run.h>

namespace breakwater {
namespace fs = std::filesystem;
namespace {

struct ReproduceArguments {
  std::string only = "all";
  std::string out = "runs/reproduce";
  std::string file;
  bool quick = false;
  bool no_video = false;
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
  if (!fs::is_empty(out) && !fs::exists(out / "measurements.jsonl")) {
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
  const Reproduction reproduction{
      catalogue,     experiments,     choose_sections(experiments, arguments.only),
      arguments.out, arguments.quiet, &interrupted()};
  const Measured measured = measure(reproduction);
  const int status = make_pictures(reproduction, !arguments.no_video);
  if (status == kInterrupted) throw Interrupted(measured.size());
  const ThesisReport report = thesis_report(reproduction, measured, effort);
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
  std::vector<std::string> metrics;
  std::vector<std::string> signals;
  std::string out = ".";
  bool csv = false;
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
  const Comparison comparison(catalogue, open_all(arguments.runs), arguments.metrics,
                              arguments.signals);
  const bool has_figures = arguments.svg || arguments.pdf;
  if (has_figures && arguments.signals.empty()) {
    throw std::invalid_argument("--svg and --pdf: say which signals with --signal");
  }
  if (has_figures && !can_draw_figures()) return kUsage;
  const fs::path out = made_folder(arguments.out);
  std::vector<fs::path> written = {out / "compare.html"};
  replace_file(written[0], comparison.html());
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
    const int made = draw_figure(folders, comparison.signals(), file);
    if (made != kSuccess) status = made;
    if (made == kSuccess) written.push_back(file);
  }
  if (!arguments.quiet) {
    fmt::print("{}\n", comparison.text(output_width()));
    for (const fs::path& file : written) fmt::print("{}\n", file.string());
  }
  return status;
}

int report(const Catalogue& catalogue, const RunsArguments& arguments) {
  const std::vector<SavedRun> runs = open_all(arguments.runs);
  const fs::path file = made_folder(arguments.out) / "report.html";
  replace_file(file, run_report(catalogue, runs));
  if (!arguments.quiet) fmt::print("report: {}\n", file.string());
  return kSuccess;
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
    app.add_option("--metric", arguments.metrics,
                   "which metrics (default: all); may be given again")
        ->type_name("NAME")
        ->allow_extra_args(false);
    app.add_option("--signal", arguments.signals,
                   "which signals: NAME, GROUP/NAME or NAME[2] (default: all); may be given again")
        ->type_name("NAME")
        ->allow_extra_args(false);
    app.add_flag("--csv", arguments.csv, "write compare.csv: the metrics and their differences");
    app.add_flag("--latex", arguments.latex, "write compare.tex: a booktabs table of the metrics");
    app.add_flag("--svg", arguments.svg, "write compare.svg: the signals, for a paper");
    app.add_flag("--pdf", arguments.pdf, "write compare.pdf: the same");
  }
  app.add_flag("--quiet", arguments.quiet, "print errors only");
  app.footer(is_comparison
                 ? "It writes compare.html, a page that needs no network. Figures are drawn by\n"
                   "scripts/figures.py (python3-h5py, python3-matplotlib), which you may copy."
                 : "It writes report.html, a page that needs no network.");
  if (const auto status = parse(app, argc, argv)) return *status;
  return is_comparison ? compare(catalogue, arguments) : report(catalogue, arguments);
}

}  // namespace

const std::vector<std::pair<std::string, std::string>>& report_commands() {
  static const std::vector<std::pair<std::string, std::string>> commands = {
      {"reproduce", "run every experiment of the thesis, beside what is printed"},
      {"report", "one page about finished runs: report RUN..."},
      {"compare", "finished runs side by side: compare RUN RUN..."}};
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
    return runs_main(catalogue, name == "compare", argc, argv);
  });
}

}  // namespace breakwater
