#include <breakwater/pages/run_report.h>

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <limits>
#include <map>
#include <set>
#include <stdexcept>

#include <breakwater/config/config.h>
#include <breakwater/experiment/differing_keys.h>
#include <breakwater/experiment/saved_run.h>
#include <breakwater/pages/compare.h>
#include <breakwater/pages/html_page.h>
#include <breakwater/pages/replay_part.h>
#include <breakwater/record/partial_file.h>
#include <breakwater/render/render_error.h>
#include <breakwater/shell/child_program.h>
#include <breakwater/shell/did_you_mean.h>
#include <breakwater/shell/digits.h>
#include <breakwater/shell/process.h>
#include <breakwater/shell/progress.h>
#include <breakwater/statistics/paired_comparison.h>
#include <breakwater/study/comparison_table.h>

namespace breakwater {
namespace fs = std::filesystem;
namespace {

constexpr const char* kFigures = "figures.py";

struct RunsArguments {
  std::vector<std::string> runs;
  CompareChoice choice;
  std::string out;
  std::string camera;
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

// The replay opens the runs again and repeats their notes. Each note is printed once.
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
  const std::vector<SavedRun> runs = open_all(arguments.runs);
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

// Pairs runs of one scenario. The cases are the candidates, in the order of their first run. The
// seeds that all cases have are the test conditions. `metrics` selects the metrics; empty means
// all. `baseline` is a case or empty. Throws std::invalid_argument if there is only one case, a
// case has a seed twice, the cases have no common seed, or a name is unknown.
PairedResults paired_runs(const std::vector<SavedRun>& runs,
                          const std::vector<std::string>& metrics, const std::string& baseline,
                          const std::map<std::string, Goal>& goals) {
  check_one_scenario(runs);
  PairedResults results;
  std::vector<std::string> seeds;
  std::map<std::pair<std::string, std::string>, const SavedRun*> found;  // by case and seed
  for (const SavedRun& run : runs) {
    if (run.failure() && run.failure()->is_cut) {
      throw std::invalid_argument(run.folder().string() +
                                  ": was cut and has no metrics: leave it out");
    }
    if (!found.emplace(std::pair(run.case_name(), run.seed()), &run).second) {
      throw std::invalid_argument(fmt::format("{}: {} with seed {} is there twice",
                                              run.folder().string(), run.case_name(), run.seed()));
    }
    for (const auto& [names, name] :
         {std::pair(&results.candidates, run.case_name()), std::pair(&seeds, run.seed())}) {
      if (std::ranges::find(*names, name) == names->end()) names->push_back(name);
    }
  }
  if (results.candidates.size() < 2) {
    throw std::invalid_argument("--paired: all runs are of one case: there is nothing to compare");
  }
  std::erase_if(seeds, [&](const std::string& seed) {
    return !std::ranges::all_of(results.candidates, [&](const std::string& name) {
      return found.contains({name, seed});
    });
  });
  if (seeds.empty()) throw std::invalid_argument("--paired: no seed is common to all cases");
  std::vector<std::string> all;
  for (const Metric& metric : metrics_of(runs)) all.push_back(metric.name);
  for (const std::string& metric : metrics) check_known("--metric", metric, all);
  for (const auto& [metric, goal] : goals) check_known("--goal", metric, all);
  if (!baseline.empty()) {
    check_known("--baseline", baseline, results.candidates);
    results.baseline = static_cast<std::size_t>(std::ranges::find(results.candidates, baseline) -
                                                results.candidates.begin());
  }
  results.metrics = metrics.empty() ? all : metrics;
  results.goals = goals;
  const auto rows = static_cast<Eigen::Index>(seeds.size());
  const auto columns = static_cast<Eigen::Index>(results.candidates.size());
  results.failed = Eigen::MatrixXd::Zero(rows, columns);
  results.values.assign(
      results.metrics.size(),
      Eigen::MatrixXd::Constant(rows, columns, std::numeric_limits<double>::quiet_NaN()));
  for (Eigen::Index i = 0; i < rows; ++i) {
    for (Eigen::Index k = 0; k < columns; ++k) {
      const SavedRun& run = *found.at(
          {results.candidates[static_cast<std::size_t>(k)], seeds[static_cast<std::size_t>(i)]});
      if (run.failure()) results.failed(i, k) = 1.0;
      for (std::size_t m = 0; m < results.metrics.size(); ++m) {
        if (const auto value = run.metric(results.metrics[m])) results.values[m](i, k) = *value;
      }
    }
  }
  return results;
}

// One line if the runs differ in more than their cases and seeds do; else nothing. It names the
// keys and their values: paired by the seed alone, such runs may have other test conditions.
std::vector<std::string> other_differences(const Catalogue& catalogue,
                                           const std::vector<SavedRun>& runs) {
  std::map<std::string, std::set<std::string>> differing;  // the values of a key
  const auto note = [&](const std::vector<SavedRun>& some, const std::set<std::string>* only) {
    for (const DifferingKey& key : differing_keys(some)) {
      if (key.key == "run.seed" || key.key.starts_with("record.")) continue;
      if (only != nullptr && !only->contains(key.key)) continue;
      differing[key.key].insert(key.values.begin(), key.values.end());
    }
  };
  std::map<std::string, std::vector<SavedRun>> of_case;
  for (const SavedRun& run : runs) of_case[run.case_name()].push_back(run);
  std::vector<SavedRun> one_of_each;
  std::set<std::string> changed;  // cases differ, but not in what a user changed
  for (const auto& [name, same] : of_case) {
    note(same, nullptr);
    one_of_each.push_back(same.front());
    for (const ChangedKey& key : changed_keys(catalogue, same.front())) changed.insert(key.key);
  }
  note(one_of_each, &changed);
  if (differing.empty()) return {};
  std::vector<std::string> texts;
  for (const auto& [key, values] : differing) {
    texts.push_back(fmt::format("{} ({})", key, fmt::join(values, "; ")));
  }
  return {fmt::format("--paired: the runs differ in more than case and seed: {}",
                      fmt::join(texts, ", "))};
}

int compare_paired(const Catalogue& catalogue, const RunsArguments& arguments) {
  const std::vector<SavedRun> runs = open_all(arguments.runs);
  const CandidateComparison comparison = compare_candidates(
      paired_runs(runs, arguments.choice.metrics, arguments.baseline, read_goals(arguments.goals)));
  const fs::path file = made_place(arguments.out, "comparison.csv");
  replace_file(file, comparison_csv(comparison));
  say("compare", other_differences(catalogue, runs), runs);
  if (!arguments.quiet) {
    fmt::print("{}\n{}\n", comparison_text(comparison, output_width()), file.string());
  }
  return kSuccess;
}

int report(const Catalogue& catalogue, const RunsArguments& arguments) {
  const std::vector<SavedRun> runs = open_all(arguments.runs);
  const fs::path file = made_place(arguments.out, "report.html");
  std::vector<std::string> notes;
  replace_file(file, run_report(catalogue, runs, arguments.choice.with_replay, notes));
  say("report", notes, runs);
  if (!arguments.quiet) fmt::print("report: {}\n", file.string());
  return kSuccess;
}

int replay(const Catalogue& catalogue, const RunsArguments& arguments) {
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
    add_digits(app);
    app.add_flag("--json", arguments.json, "print the table as JSON")->excludes("--paired");
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
  if (arguments.paired) return compare_paired(catalogue, arguments);
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
