#include <breakwater/thesis/reproduce_command.h>

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <set>
#include <stdexcept>

#include <breakwater/config/config.h>
#include <breakwater/record/partial_file.h>
#include <breakwater/shell/child_program.h>
#include <breakwater/shell/did_you_mean.h>
#include <breakwater/shell/paths.h>
#include <breakwater/shell/process.h>
#include <breakwater/shell/table.h>
#include <breakwater/thesis/reproduction.h>
#include <breakwater/thesis/thesis_report.h>

namespace breakwater {
namespace fs = std::filesystem;
namespace {

// Whether a reading changes a run of the section.
bool changes(const Experiments& experiments, const std::string& name, const SectionSpec& section) {
  const std::vector<std::string> runs = section.runs();
  return std::any_of(experiments.readings.begin(), experiments.readings.end(),
                     [&](const ReadingSpec& reading) {
                       return reading.name == name &&
                              std::any_of(runs.begin(), runs.end(), [&](const std::string& run) {
                                return matches_pattern(reading.runs, run);
                              });
                     });
}

std::vector<std::string> sections_of(const Experiments& experiments, const std::string& name) {
  std::vector<std::string> sections;
  for (const SectionSpec& section : experiments.sections) {
    if (changes(experiments, name, section)) sections.push_back(section.id);
  }
  return sections;
}

constexpr std::size_t kWidth = 78;  // for an indented text

struct ReproduceArguments {
  std::string only = "all";
  std::string out = "runs/reproduce";
  std::string file;
  std::vector<std::string> readings;
  bool list_readings = false;
  bool quick = false;
  bool no_video = false;
  bool with_replay = true;
  bool quiet = false;
};

// The sections of a group, or all whose number begins with `only`: "2.4" selects 2.4.3.2.
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

// The readings, with the sections whose runs they change. The first row of one has its reason.
void print_readings(const Experiments& experiments) {
  std::set<std::string> known;
  for (const ReadingSpec& reading : experiments.readings) {
    if (known.insert(reading.name).second) {
      fmt::print("{} (sections {})\n", reading.name,
                 fmt::join(sections_of(experiments, reading.name), ", "));
      for (const std::string& line : wrapped(reading.why, kWidth)) fmt::print("  {}\n", line);
    }
    fmt::print("  {}: {}\n", reading.runs, fmt::join(reading.sets, " "));
  }
}

// A reading that changes no run of the chosen sections is a mistake.
void check_readings(const ReproduceArguments& arguments, const Experiments& experiments,
                    const std::vector<const SectionSpec*>& chosen) {
  for (const std::string& name : arguments.readings) {
    const bool is_heeded = std::any_of(
        chosen.begin(), chosen.end(),
        [&](const SectionSpec* section) { return changes(experiments, name, *section); });
    if (is_heeded) continue;
    throw std::invalid_argument(
        fmt::format("--reading {}: changes no run of --only {}, but runs of the sections {}", name,
                    arguments.only, fmt::join(sections_of(experiments, name), ", ")));
  }
}

// Refuses a folder with contents that are not ours.
void check_out(const fs::path& out) {
  if (!fs::exists(out)) return;
  if (!fs::is_directory(out))
    throw std::invalid_argument(out.string() + ": is a file, not a folder");
  const bool is_study = fs::exists(out / "study.toml");  // a study of `sweep` has shards too
  if (!fs::is_empty(out) && (!fs::exists(shards_folder(out)) || is_study)) {
    throw std::invalid_argument(out.string() +
                                ": holds something that is not a reproduction; give another --out");
  }
}

// Makes pictures and videos that are missing or older than the run. Returns the status of the last
// failure.
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
  const Experiments experiments = read_experiments(file.string(), effort, arguments.readings);
  if (arguments.list_readings) {
    print_readings(experiments);
    return kSuccess;
  }
  const std::vector<const SectionSpec*> sections = choose_sections(experiments, arguments.only);
  check_readings(arguments, experiments, sections);
  check_out(arguments.out);
  stop_on_signals();
  const Reproduction reproduction{
      catalogue,      experiments,          sections, arguments.out, arguments.quiet,
      &interrupted(), arguments.with_replay};
  const Measured measured = measure(reproduction);
  const int status = make_pictures(reproduction, !arguments.no_video);
  if (status == kInterrupted) throw Interrupted(measured.size());
  const ThesisReport report = thesis_report(reproduction, measured, effort);
  for (const std::string& note : report.notes) fmt::print(stderr, "reproduce: {}\n", note);
  const fs::path page = reproduction.out / "report.html";
  replace_file(page, report.html);
  const fs::path verdicts = reproduction.out / "verdicts.csv";
  replace_file(verdicts, report.verdicts);
  if (!experiments.is_own) {
    for (const std::string& line : report.score.headline()) fmt::print("{}\n", line);
  }
  if (!arguments.readings.empty()) {
    fmt::print("other readings: {}; a reason is that of the shipped one unless it names another\n",
               fmt::join(arguments.readings, ", "));
  }
  fmt::print("{}", report.failures);
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
  app.add_option("--reading", arguments.readings,
                 "other readings of the text, by their names in the list of experiments")
      ->type_name("NAME[,NAME]")
      ->delimiter(',');
  app.add_flag("--list-readings", arguments.list_readings, "print the readings, and end");
  app.add_flag("--no-video", arguments.no_video, "leave out the video");
  app.add_flag("!--no-replay", arguments.with_replay, "leave out the replays");
  app.add_flag("--quiet", arguments.quiet, "print errors and the score only");
  app.footer(
      "Results of the same configuration, models and program are kept, so an interrupted\n"
      "reproduction continues. data/reproduced.toml has the criteria.\n"
      "Exit status: 0 success, 1 a defect, 2 usage or input, 4 a picture or video could not be\n"
      "made, 130 interrupted.");
  if (const auto status = parse(app, argc, argv)) return *status;
  return reproduce(catalogue, arguments);
}

}  // namespace

CommandKind reproduce_command() {
  return {"reproduce", "run every experiment of the thesis, beside the printed results",
          [](const Catalogue& catalogue, int argc, const char* const* argv) {
            return guarded(argv[0], [&] { return reproduce_main(catalogue, argc, argv); });
          }};
}

}  // namespace breakwater
