#include <fmt/chrono.h>
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <chrono>
#include <filesystem>
#include <map>
#include <nlohmann/json.hpp>
#include <stdexcept>
#include <string>
#include <tuple>

#include <breakwater/experiment/differing_keys.h>
#include <breakwater/experiment/run_manifest.h>
#include <breakwater/program/commands.h>
#include <breakwater/record/recording.h>
#include <breakwater/record/run_folder.h>
#include <breakwater/shell/child_program.h>
#include <breakwater/shell/process.h>
#include <breakwater/shell/progress.h>
#include <breakwater/shell/table.h>
#include <breakwater/study/shards.h>
#include <breakwater/study/study_folder.h>
#include <breakwater/study/study_reader.h>

namespace breakwater {
namespace fs = std::filesystem;
namespace {

constexpr const char* kListIndent = "    ";

// A run or study in the list.
struct ListedFolder {
  fs::path folder;
  fs::file_time_type written = {};
  std::string kind = "run";        // or "study", "tuning"
  std::string status = "damaged";  // or "complete", "failed", "cut", kRunning; a study's results
  std::string reason = "";         // if it is not complete
  RunManifest run = {};            // a study has only its scenario
  std::size_t runs = 0;            // that a study has finished so far
  std::size_t failed = 0;
};

// From the run's small files. The log is not opened.
ListedFolder list_run(const fs::path& folder) {
  ListedFolder listed{folder};
  std::error_code ignored;
  // The manifest's time is no use: drawing a picture changes it.
  listed.written = fs::last_write_time(folder / "log.h5", ignored);
  if (ignored) listed.written = fs::last_write_time(folder / "manifest.json", ignored);
  try {
    read_whole(folder, [&] {
      listed.run = read_manifest(folder);
      check_has_files(folder);
      if (!listed.run.failure) listed.run.metrics = read_metrics(folder);
    });
  } catch (const std::invalid_argument& error) {
    listed.reason = error.what();
    return listed;
  }
  const std::optional<Failure>& failure = listed.run.failure;
  listed.status = !failure ? "complete" : failure->is_cut ? "cut" : "failed";
  if (listed.run.is_unfinished && is_being_written(folder)) {
    listed.status = kRunning;
  } else if (failure) {
    const std::string at = fmt::format("at {:.6g} s: ", failure->time_s);
    listed.reason = (failure->is_cut ? "" : at) + failure->reason;
  }
  return listed;
}

// One unreadable study does not end the list.
ListedFolder list_study(const fs::path& folder) {
  const bool is_tuning = !fs::exists(folder / kSweep.file);
  ListedFolder study{folder, fs::last_write_time(folder / "shards"),
                     is_tuning ? "tuning" : "study"};
  try {
    const std::string file = (folder / (is_tuning ? kTune : kSweep).file).string();
    study.run.scenario = study_root(study_tables(file), file)["scenario"].text_or_nothing();
    const auto results = results_by_key(folder / "shards");
    study.runs = results.size();
    for (const auto& [key, result] : results) {
      if (result.status != PointStatus::complete) ++study.failed;
    }
    study.status = number_of(study.runs, "run");
    if (study.failed > 0) study.status += fmt::format(", {} failed", study.failed);
  } catch (const std::exception& error) {
    study.reason = error.what();
  }
  return study;
}

// It does not search inside the found folders, and does not follow symbolic links. A folder that
// cannot be read, or vanishes meanwhile, counts as empty.
void look_into(const fs::path& folder, std::vector<ListedFolder>& found) {
  std::error_code error;
  if (is_study_folder(folder)) {
    found.push_back(list_study(folder));
    return;
  }
  if (fs::exists(folder / "manifest.json", error)) {
    found.push_back(list_run(folder));
    return;
  }
  for (fs::directory_iterator inside(folder, error), end; !error && inside != end;
       inside.increment(error)) {
    std::error_code ignored;
    const fs::directory_entry& inner = *inside;
    if (!inner.is_directory(ignored) || inner.is_symlink(ignored)) continue;
    if (is_unfinished_run(inner)) {
      if (is_kept(inner)) found.push_back(list_run(inner));
    } else if (!inner.path().filename().string().starts_with('.')) {
      look_into(inner, found);
    }
  }
}

std::time_t seconds_of(fs::file_time_type time) {
  return std::chrono::system_clock::to_time_t(
      std::chrono::time_point_cast<std::chrono::system_clock::duration>(
          std::chrono::file_clock::to_sys(time)));
}

// Newest first.
std::vector<ListedFolder> entries_below(const fs::path& below) {
  if (!fs::is_directory(below)) {
    throw std::invalid_argument(below.string() + (fs::exists(below) ? ": is a file, not a folder"
                                                                    : ": there is no such folder"));
  }
  std::vector<ListedFolder> entries;
  look_into(below, entries);
  std::sort(entries.begin(), entries.end(), [](const ListedFolder& a, const ListedFolder& b) {
    return std::tie(b.written, a.folder) < std::tie(a.written, b.folder);
  });
  return entries;
}

// Scenario and label of a run, if the folder's name does not have them.
std::string origin_of(const Catalogue& catalogue, const ListedFolder& entry) {
  const std::string& scenario = entry.run.scenario;
  if (entry.kind != "run" || scenario.empty()) return "";
  const std::string label = label_of(catalogue, entry.folder, scenario, entry.run.case_name);
  const fs::path folder = entry.folder.lexically_normal();
  if (folder.filename() == label && folder.parent_path().filename() == scenario) return "";
  return scenario + (label.empty() ? "" : ", " + label);
}

void print_lines(const std::string& text, std::size_t width) {
  for (const std::string& line : wrapped(text, width - std::string(kListIndent).size())) {
    if (!line.empty()) fmt::print("{}{}\n", kListIndent, line);
  }
}

void print_entries(const Catalogue& catalogue, const std::vector<ListedFolder>& entries,
                   const fs::path& below) {
  const std::size_t width = output_width();
  std::map<std::string, std::vector<std::string>> main;  // by scenario
  if (entries.empty()) fmt::print("no run below {}\n", below.string());
  for (const ListedFolder& entry : entries) {
    const std::string& scenario = entry.run.scenario;
    const auto [names, is_new] = main.try_emplace(scenario);
    if (is_new && catalogue.has<ScenarioKind>(scenario)) {
      names->second = make_scenario(catalogue, scenario)->main_metrics();
    }
    const std::string when =
        fmt::format("{:%Y-%m-%d %H:%M}", fmt::localtime(seconds_of(entry.written)));
    const std::string status = fmt::format("{:<9}", entry.status);
    const std::string folder = one_line(entry.folder.string());
    const bool fits = when.size() + 2 + status.size() + 1 + folder.size() <= width;
    fmt::print("{}  {}{}{}\n", when, status, fits ? " " : "\n" + std::string(kListIndent), folder);
    print_lines(origin_of(catalogue, entry), width);
    print_lines(brief(main_metrics(names->second, entry.run.metrics)), width);
    print_lines(one_line(entry.reason), width);
  }
}

void print_entries_json(const std::vector<ListedFolder>& entries) {
  nlohmann::ordered_json list = nlohmann::ordered_json::array();
  for (const ListedFolder& entry : entries) {
    nlohmann::ordered_json object = {
        {"folder", entry.folder.string()},
        {"kind", entry.kind},
        {"status", entry.status},
        {"written", fmt::format("{:%Y-%m-%dT%H:%M:%SZ}", fmt::gmtime(seconds_of(entry.written)))},
        {"scenario", entry.run.scenario}};
    if (entry.kind == "run") {
      object.update({{"case", entry.run.case_name}, {"seed", entry.run.seed}});
    } else if (entry.status != "damaged") {
      object.update({{"runs", entry.runs}, {"failed", entry.failed}});
    }
    if (!entry.reason.empty()) object["reason"] = entry.reason;
    if (entry.kind == "run") object["metrics"] = nlohmann::ordered_json::object();
    for (const Metric& metric : entry.run.metrics) object["metrics"][metric.name] = metric.value;
    list.push_back(object);
  }
  fmt::print("{}\n", list.dump(2, ' ', false, nlohmann::json::error_handler_t::replace));
}

}  // namespace

int list_runs_main(const Catalogue& catalogue, int argc, const char* const* argv) {
  const std::string program = own_program_name() + " ls";
  return guarded(program, [&] {
    CLI::App app("The runs and studies below a folder with their main metrics, newest first.",
                 program);
    std::string below = "runs";
    bool json = false;
    app.add_option("DIR", below, "where to look")->capture_default_str();
    app.add_flag("--json", json, "print a list of objects instead, with all metrics");
    app.footer("A study is one entry, whatever runs it keeps. Exit status: 0 success, 2 usage.");
    if (const auto status = parse(app, argc, argv)) return *status;
    const std::vector<ListedFolder> entries = entries_below(below);
    json ? print_entries_json(entries) : print_entries(catalogue, entries, below);
    return static_cast<int>(kSuccess);
  });
}

}  // namespace breakwater
