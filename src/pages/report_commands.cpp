#include <breakwater/pages/run_report.h>

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <stdexcept>

#include <breakwater/config/config.h>
#include <breakwater/experiment/saved_run.h>
#include <breakwater/pages/compare.h>
#include <breakwater/pages/html_page.h>
#include <breakwater/pages/replay_part.h>
#include <breakwater/pictures/picture_commands.h>
#include <breakwater/record/partial_file.h>
#include <breakwater/shell/child_program.h>
#include <breakwater/shell/process.h>
#include <breakwater/shell/progress.h>
#include <breakwater/shell/table.h>

namespace breakwater {
namespace fs = std::filesystem;
namespace {

constexpr const char* kFigures = "figures.py";

struct RunsArguments {
  std::vector<std::string> runs;
  CompareChoice choice;
  std::string out;
  std::string camera;
  bool csv = false;
  bool json = false;
  bool latex = false;
  bool svg = false;
  bool pdf = false;
  bool quiet = false;
};

// The replay repeats the notes of its runs. Each note is printed once.
void say(const std::string& program, std::vector<std::string> notes,
         const std::vector<SavedRun>& runs) {
  for (const SavedRun& run : runs) {
    for (const std::string& note : run.notes()) {
      if (std::find(notes.begin(), notes.end(), note) == notes.end()) notes.push_back(note);
    }
  }
  for (const std::string& note : notes) fmt::print(stderr, "{}: {}\n", program, note);
}

// The file to write: --out names it, or its folder, which is made.
fs::path made_place(const std::string& out, const char* name) {
  const fs::path place = out;
  std::error_code error;
  const bool is_file = place.extension() == fs::path(name).extension() && !fs::is_directory(place);
  const fs::path folder = is_file ? place.parent_path() : place;
  if (!folder.empty()) fs::create_directories(folder, error);
  if (error) {
    throw std::invalid_argument(folder.string() + ": cannot be made (" + error.message() + ")");
  }
  return is_file ? place : folder / name;
}

int compare(const Catalogue& catalogue, const RunsArguments& arguments) {
  const std::vector<SavedRun> runs(arguments.runs.begin(), arguments.runs.end());
  const Comparison comparison(catalogue, runs, arguments.choice);
  const bool has_figures = arguments.svg || arguments.pdf;
  if (has_figures && arguments.choice.signals.empty()) {
    throw std::invalid_argument("--svg and --pdf: say which signals with --signal");
  }
  if (has_figures &&
      call_script("figures (python3-matplotlib)", kFigures, {"--check"}) != kSuccess) {
    return kUsage;
  }
  std::vector<fs::path> written = {made_place(arguments.out, "compare.html")};
  const fs::path out = written.front().parent_path();
  std::vector<std::string> notes;
  replace_file(written[0], comparison.html(notes));
  say("compare", notes, runs);
  if (arguments.csv) {
    written.push_back(out / "compare.csv");
    replace_file(written.back(), comparison.csv());
  }
  int status = kSuccess;
  for (const auto& [kind, is_asked] :
       {std::pair("tex", arguments.latex), std::pair("svg", arguments.svg),
        std::pair("pdf", arguments.pdf)}) {
    if (!is_asked) continue;
    const fs::path file = out / (std::string("compare.") + kind);
    if (call_script("figures", kFigures, {written[0].string(), "--out", file.string()}) ==
        kSuccess) {
      written.push_back(file);
    } else {
      status = kLaterOutputFailed;
    }
  }
  if (arguments.json) {
    fmt::print("{}", comparison.json());
  } else if (!arguments.quiet) {
    fmt::print("{}\n", comparison.text(output_width()));
    for (const fs::path& file : written) fmt::print("{}\n", file.string());
  }
  return status;
}

int report(const Catalogue& catalogue, const RunsArguments& arguments) {
  const std::vector<SavedRun> runs(arguments.runs.begin(), arguments.runs.end());
  const fs::path file = made_place(arguments.out, "report.html");
  std::vector<std::string> notes;
  replace_file(file, run_report(catalogue, runs, arguments.choice.with_replay, notes));
  say("report", notes, runs);
  if (!arguments.quiet) fmt::print("report: {}\n", file.string());
  return kSuccess;
}

int replay(const Catalogue& catalogue, const RunsArguments& arguments) {
  const std::vector<FinishedRun> runs = open_runs(catalogue, arguments.runs);
  const fs::path file =
      arguments.out.empty() ? runs.front().folder() / "replay.html" : fs::path(arguments.out);
  std::vector<std::string> notes;
  return drawing_status([&] {
    replace_file(file, replay_page(runs, arguments.camera, notes));
    for (const std::string& note : notes) fmt::print(stderr, "replay: {}\n", note);
    if (!arguments.quiet) fmt::print("replay: {}\n", file.string());
    return kSuccess;
  });
}

int runs_main(const Catalogue& catalogue, int argc, const char* const* argv) {
  const std::string name = argv[0];
  const bool is_comparison = name == "compare", is_replay = name == "replay";
  CLI::App app(own_program_name() + " " + name +
                   (is_comparison ? ": metrics and signals of finished runs side by side."
                    : is_replay ? ": finished runs in three dimensions, as a page for any browser."
                                : ": one page about finished runs."),
               name);
  RunsArguments arguments;
  app.add_option("RUN", arguments.runs,
                 is_replay ? "folders of finished runs of one scenario, up to 4: in one scene, or "
                             "side by side"
                           : "the folders of finished runs")
      ->required();
  if (is_replay) {
    app.add_option("--camera", arguments.camera,
                   "the camera to begin with: one of the model's (default: the shot list's)")
        ->type_name("NAME");
    app.add_option("--out", arguments.out, "the page (default: RUN/replay.html)")
        ->type_name("FILE");
  } else {
    arguments.out = ".";
    app.add_option("--out", arguments.out, "the folder for what is written, or the page's .html")
        ->type_name("DIR")
        ->capture_default_str();
  }
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
    app.add_flag("--json", arguments.json, "print the table as JSON");
    app.add_flag("--csv", arguments.csv, "write compare.csv: the metrics and their differences");
    app.add_flag("--latex", arguments.latex, "write compare.tex: the page's tables for booktabs");
    app.add_flag("--svg", arguments.svg, "write compare.svg: the signals, for a paper");
    app.add_flag("--pdf", arguments.pdf, "write compare.pdf: the same");
  }
  if (!is_replay) {
    app.add_flag("!--no-replay", arguments.choice.with_replay, "leave out the replay");
  }
  app.add_flag("--quiet", arguments.quiet, "print errors only");
  app.footer(
      is_comparison ? "It writes compare.html, a page that needs no network. Figures are drawn by\n"
                      "scripts/figures.py (python3-matplotlib), which you may copy."
      : is_replay   ? "The page is one file and needs no network. It plays what the run's log has, "
                      "with the\n"
                      "arrows and chart of the scenario's shots.toml; nothing is simulated again.\n"
                      "Exit status: 0 success, 1 a defect, 2 usage or input, 4 it could not be made "
                      "or written."
                    : "It writes report.html, a page that needs no network.");
  if (const auto status = parse(app, argc, argv)) return *status;
  if (is_replay) return replay(catalogue, arguments);
  return is_comparison ? compare(catalogue, arguments) : report(catalogue, arguments);
}

int report_main(const Catalogue& catalogue, int argc, const char* const* argv) {
  return guarded(argv[0], [&] { return runs_main(catalogue, argc, argv); });
}

}  // namespace

std::vector<CommandKind> report_commands() {
  return {{"report", "write one page about finished runs: report RUN...", report_main},
          {"compare", "compare finished runs side by side: compare RUN RUN...", report_main},
          {"replay", "replay finished runs in 3-D in a browser: replay RUN...", report_main}};
}

}  // namespace breakwater
