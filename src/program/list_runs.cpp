#include <fmt/chrono.h>
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <chrono>
#include <filesystem>
#include <map>
#include <nlohmann/json.hpp>
#include <string>

#include <breakwater/experiment/differing_keys.h>
#include <breakwater/experiment/run_list.h>
#include <breakwater/program/commands.h>
#include <breakwater/record/recording.h>
#include <breakwater/record/run_folder.h>
#include <breakwater/shell/child_program.h>
#include <breakwater/shell/process.h>
#include <breakwater/shell/progress.h>
#include <breakwater/shell/table.h>
#include <breakwater/study/study_folder.h>

namespace breakwater {
namespace fs = std::filesystem;
namespace {

constexpr const char* kListIndent = "    ";

// A run or study in the list.
struct Entry {
  fs::path folder;
  fs::file_time_type written;
  std::string kind;      // run, study or tuning
  std::string status;    // status of a run; for a study the number of its runs
  std::string scenario;  // empty: unknown
  std::string reason;
  std::vector<Metric> metrics;
  nlohmann::ordered_json more;  // fields of one kind only
};

Entry entry_of(const ListedRun& run) {
  return {run.folder,   run.written, "run",       run.status,
          run.scenario, run.reason,  run.metrics, {{"case", run.case_name}, {"seed", run.seed}}};
}

Entry entry_of(const StudySummary& study) {
  const std::string failed = study.failed > 0 ? fmt::format(", {} failed", study.failed) : "";
  return {study.folder,
          study.written,
          study.kind,
          number_of(study.runs, "run") + failed,
          study.scenario,
          "",
          {},
          {{"runs", study.runs}, {"failed", study.failed}}};
}

Entry study_entry(const fs::path& folder) {
  try {
    return entry_of(summarise_study(folder));
  } catch (const std::exception& error) {  // one unreadable study does not end the list
    std::error_code ignored;
    return {folder, fs::last_write_time(folder, ignored), "study", "damaged", "", error.what(),
            {},     nlohmann::ordered_json::object()};
  }
}

std::time_t seconds_of(fs::file_time_type time) {
  return std::chrono::system_clock::to_time_t(
      std::chrono::time_point_cast<std::chrono::system_clock::duration>(
          std::chrono::file_clock::to_sys(time)));
}

// Newest first.
std::vector<Entry> entries_below(const fs::path& below) {
  const FoundRuns found = find_runs(below, is_study_folder);
  std::vector<Entry> entries;
  for (const fs::path& folder : found.runs) entries.push_back(entry_of(list_run(folder)));
  for (const fs::path& folder : found.unfinished) {
    if (is_kept(folder)) entries.push_back(entry_of(list_run(folder)));
  }
  for (const fs::path& folder : found.others) entries.push_back(study_entry(folder));
  std::stable_sort(entries.begin(), entries.end(),
                   [](const Entry& a, const Entry& b) { return a.written > b.written; });
  return entries;
}

// The main metrics of the scenarios, read once each.
class MainMetrics {
 public:
  explicit MainMetrics(const Catalogue& catalogue) : catalogue_(catalogue) {}

  std::vector<Metric> of(const Entry& entry) {
    const auto [place, is_new] = names_.try_emplace(entry.scenario);
    if (is_new && catalogue_.has<ScenarioKind>(entry.scenario)) {
      place->second = make_scenario(catalogue_, entry.scenario)->main_metrics();
    }
    return main_metrics(place->second, entry.metrics);
  }

 private:
  const Catalogue& catalogue_;
  std::map<std::string, std::vector<std::string>> names_;
};

// Scenario and label of a run, if the folder's name does not have them.
std::string origin_of(const Catalogue& catalogue, const Entry& entry) {
  if (entry.kind != "run" || entry.scenario.empty()) return "";
  const auto name = entry.more.value("case", "");
  const std::string label = label_of(catalogue, entry.folder, entry.scenario, name);
  const fs::path folder = entry.folder.lexically_normal();
  if (folder.filename() == label && folder.parent_path().filename() == entry.scenario) return "";
  return entry.scenario + (label.empty() ? "" : ", " + label);
}

void print_lines(const std::string& text, std::size_t width) {
  for (const std::string& line : wrapped(text, width - std::string(kListIndent).size())) {
    if (!line.empty()) fmt::print("{}{}\n", kListIndent, line);
  }
}

void print_entries(const Catalogue& catalogue, const std::vector<Entry>& entries,
                   const fs::path& below) {
  const std::size_t width = output_width();
  MainMetrics main(catalogue);
  if (entries.empty()) fmt::print("no run below {}\n", below.string());
  for (const Entry& entry : entries) {
    const std::string when =
        fmt::format("{:%Y-%m-%d %H:%M}", fmt::localtime(seconds_of(entry.written)));
    const std::string status = fmt::format("{:<9}", entry.status);
    const std::string folder = one_line(entry.folder.string());
    const bool fits = when.size() + 2 + status.size() + 1 + folder.size() <= width;
    fmt::print("{}  {}{}{}\n", when, status, fits ? " " : "\n" + std::string(kListIndent), folder);
    print_lines(origin_of(catalogue, entry), width);
    print_lines(brief(main.of(entry)), width);
    print_lines(one_line(entry.reason), width);
  }
}

void print_entries_json(const std::vector<Entry>& entries) {
  nlohmann::ordered_json list = nlohmann::ordered_json::array();
  for (const Entry& entry : entries) {
    nlohmann::ordered_json object = {
        {"folder", entry.folder.string()},
        {"kind", entry.kind},
        {"status", entry.status},
        {"written", fmt::format("{:%Y-%m-%dT%H:%M:%SZ}", fmt::gmtime(seconds_of(entry.written)))},
        {"scenario", entry.scenario}};
    object.update(entry.more);
    if (!entry.reason.empty()) object["reason"] = entry.reason;
    if (entry.kind == "run") object["metrics"] = nlohmann::ordered_json::object();
    for (const Metric& metric : entry.metrics) object["metrics"][metric.name] = metric.value;
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
    const std::vector<Entry> entries = entries_below(below);
    json ? print_entries_json(entries) : print_entries(catalogue, entries, below);
    return static_cast<int>(kSuccess);
  });
}

}  // namespace breakwater
