#include <breakwater/program/reference_pages.h>

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <map>
#include <vector>

#include <breakwater/experiment/runner.h>
#include <breakwater/program/commands.h>
#include <breakwater/shell/child_program.h>
#include <breakwater/shell/exit_statuses.h>

namespace breakwater {
namespace {

constexpr std::size_t kTrack = 3;  // cell of a column's row with its track
constexpr const char* kFineLog = "record.fine_from_s";

using Row = std::vector<std::string>;

std::string cell(const std::string& text) {
  std::string safe;
  for (const char c : text) safe += c == '|' ? "\\|" : c == '\n' ? " " : std::string(1, c);
  return safe;
}

std::string code(const std::string& text) {
  return text.empty() ? "" : "`" + text + "`";
}

std::string table(const Row& heading, const std::vector<Row>& rows) {
  const auto line = [](const Row& row) { return fmt::format("| {} |\n", fmt::join(row, " | ")); };
  std::string text = line(heading) + line(Row(heading.size(), "---"));
  for (const Row& row : rows) {
    Row cells;
    for (const std::string& one : row) cells.push_back(cell(one));
    text += line(cells);
  }
  return text + "\n";
}

std::string help_of(const std::vector<std::string>& words) {
  ReadProgram called(words);
  std::string text;
  while (const auto line = called.next()) text += *line + "\n";
  called.wait();
  return text.substr(0, text.find_last_not_of('\n') + 1);
}

std::string with_help(const std::string& heading, const std::vector<std::string>& words) {
  return fmt::format("## {}\n\n```text\n{}\n```\n\n", heading, help_of(words));
}

std::string capital(std::string text) {
  if (!text.empty()) text[0] = static_cast<char>(std::toupper(static_cast<unsigned char>(text[0])));
  return text;
}

// A help text with unit, such as "the limit [N m]", split into text and unit.
struct TextAndUnit {
  std::string text;
  std::string unit;
};
TextAndUnit split(const std::string& doc) {
  TextAndUnit found = {doc, ""};
  std::size_t units = 0;
  for (std::size_t i = doc.find('['); i != std::string::npos; i = doc.find('[', i + 1)) {
    if (i == 0 || doc[i - 1] != ' ') continue;  // NAME[2]
    const std::size_t end = doc.find(']', i);
    if (end == std::string::npos) break;
    found.unit += (units++ == 0 ? "" : ", ") + doc.substr(i + 1, end - i - 1);
  }
  if (units == 1 && doc.ends_with("]")) {
    const std::string text = doc.substr(0, doc.rfind(" ["));
    found.text = text.substr(0, text.find_last_not_of(' ') + 1);
  }
  return found;
}

std::string used_by(const KeyHelp& key) {
  std::vector<std::string> conditions = key.conditions;
  if (!key.parts.empty()) {
    conditions.insert(conditions.begin(),
                      fmt::format("{} is {}", key.choice, fmt::join(key.parts, ", ")));
  }
  return conditions.empty() ? "always" : fmt::format("{}", fmt::join(conditions, "; "));
}

std::string table_of(const std::string& key) {
  const std::size_t dot = key.rfind('.');
  return dot == std::string::npos ? "" : key.substr(0, dot);
}

std::string keys(const std::vector<KeyHelp>& all) {
  std::vector<std::string> tables;
  for (const KeyHelp& key : all) {
    const std::string table = table_of(key.key);
    if (std::find(tables.begin(), tables.end(), table) == tables.end()) tables.push_back(table);
  }
  std::string text;
  for (const std::string& name : tables) {
    std::vector<Row> rows;
    for (const KeyHelp& key : all) {
      if (table_of(key.key) != name) continue;
      const auto [words, unit] = split(key.text);
      rows.push_back({code(key.key), words, unit, code(key.value), key.takes, used_by(key)});
    }
    text += fmt::format("### {}\n\n", name.empty() ? "No table" : code(name)) +
            table({"Key", "Meaning", "Unit", "Default", "Takes", "Used where"}, rows);
  }
  return text;
}

// The values of the keys that the scenario has read, as TOML.
std::map<std::string, std::string> values(const std::vector<KeyHelp>& all) {
  std::map<std::string, std::string> found;
  for (const KeyHelp& key : all) found.try_emplace(key.key, key.value);
  return found;
}

std::string cases(const Catalogue& catalogue, const ScenarioKind& kind, const ScenarioFile& file) {
  const std::vector<Config> tables = file.tables();  // first the common table, then one per case
  std::vector<Row> rows;
  for (std::size_t i = 0; i < file.cases().size(); ++i) {
    const std::string& name = file.cases()[i];
    const auto scenario = kind.make(catalogue);
    scenario->learn(file.config(name));
    Fields fields = scenario->fields();
    fields.read_incomplete(file.config(name));
    const auto value = values(fields.help());
    std::vector<std::string> sets;
    for (const auto& entry : tables[i + 1].entries()) {
      sets.push_back(code(entry.first + " = " + value.at(entry.first)));
    }
    rows.push_back({code(name), fmt::format("{}", fmt::join(sets, ", "))});
  }
  return table({"Case", "Its own keys"}, rows);
}

std::string metrics(const Scenario& scenario) {
  std::vector<Row> rows;
  for (const MetricDefinition& metric : scenario.metric_definitions()) {
    rows.push_back({code(metric.name), metric.unit, metric.text});
  }
  if (rows.empty()) return "The scenario defines none.\n\n";
  return table({"Metric", "Unit", "Definition"}, rows);
}

// The columns in the logs of all cases, without repetition.
std::string columns(const Catalogue& catalogue, const ScenarioKind& kind, const ScenarioFile& file,
                    const std::vector<std::string>& brief_run) {
  std::vector<Row> rows = {{code("time_s"), "s", "1", "all", "time of the row", ""}};
  std::vector<std::vector<std::string>> have = {file.cases()};
  for (const std::string& name : file.cases()) {
    std::vector<std::string> sets = brief_run;
    // The window with the fine log may begin after the end of a brief run.
    if (file.config(name).find(kFineLog) != nullptr) sets.push_back(std::string(kFineLog) + "=0");
    const PreparedRun run =
        prepare_scenario(kind.make(catalogue), file, name, sets, Tables::checked);
    const Recording recording = run.scenario->run({});
    for (const Track& track : recording.tracks) {
      for (std::size_t i = 0; i < track.signals(); ++i) {
        const Signal& signal = track.signal(i);
        const Row row = {
            code(signal.name), signal.unit,        std::to_string(signal.values.size()),
            track.name(),      signal.description, ""};
        const auto found = std::find(rows.begin(), rows.end(), row);
        const auto index = static_cast<std::size_t>(found - rows.begin());
        if (found == rows.end()) {
          rows.push_back(row);
          have.emplace_back();
        }
        have[index].push_back(name);
      }
    }
  }
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const bool in_all = have[i].size() == file.cases().size();
    rows[i].back() = in_all ? "all" : fmt::format("{}", fmt::join(have[i], ", "));
  }
  std::stable_sort(rows.begin(), rows.end(),
                   [](const Row& a, const Row& b) { return a[kTrack] < b[kTrack]; });
  return table({"Column", "Unit", "Values", "Track", "Description", "Cases"}, rows);
}

// The file beside the scenario's own one that shows all of its tables, or the own one.
ScenarioFile file_of_keys(const ScenarioKind& kind) {
  const std::filesystem::path all = kind.file().parent_path() / "reference.toml";
  return {(std::filesystem::exists(all) ? all : kind.file()).string(), kind.name};
}

}  // namespace

std::string commands_page(const Catalogue& catalogue) {
  const std::string program = own_program_name();
  std::vector<Row> rows;
  std::string details;
  for (const CommandKind& command : all_commands(catalogue)) {
    rows.push_back({fmt::format("[`{}`](#{})", command.name, command.name), command.summary});
    details += with_help(command.name, {own_program(), command.name, "--help"});
  }
  const auto& scenarios = catalogue.all<ScenarioKind>();
  if (!scenarios.empty()) {
    details += with_help("run SCENARIO", {own_program(), "run", scenarios.front().name, "--help"});
  }
  return fmt::format("# Commands\n\n`{} COMMAND --help` prints the same.\n\n", program) +
         table({"Command", "Purpose"}, rows) + details;
}

std::string scenario_page(const Catalogue& catalogue, const ScenarioKind& kind,
                          const std::vector<std::string>& brief_run) {
  const auto scenario = kind.make(catalogue), shipped = kind.make(catalogue);
  const auto read = [](Scenario& target, const ScenarioFile& from) {
    const Config config = from.config(from.default_case());
    target.learn(config);
    Fields fields = target.fields();
    fields.read_incomplete(config);
    return fields;
  };
  const ScenarioFile file(kind.file().string(), kind.name), shown = file_of_keys(kind);
  read(*shipped, file);
  const Fields fields = read(*scenario, shown);
  const bool is_own = shown.file() == file.file();
  return fmt::format("# {}\n\n{}.\n\n## Cases\n\n", code(kind.name), capital(scenario->summary())) +
         fmt::format("The default case is `{}`.\n\n", file.default_case()) +
         cases(catalogue, kind, file) + "## Keys\n\n" +
         (is_own
              ? fmt::format("The default values are those of the case `{}`. ", file.default_case())
              : "A table with `NAME` stands for all tables of its kind, and `NAME_` in the log "
                "for all columns of an axis. The values are those of an example. ") +
         "A key without a default value must be given where it is used.\n\n" + keys(fields.help()) +
         "## Metrics\n\nA metric that does not apply to a run is absent.\n\n" + metrics(*shipped) +
         "## Columns of the log\n\n"
         "`log.h5` has these columns, in a group for each track. A column with several values is "
         "`NAME_1`, `NAME_2`, … in `log.csv`.\n\n" +
         columns(catalogue, kind, shown, brief_run);
}

std::string exit_statuses_page() {
  std::vector<Row> rows;
  for (const StatusMeaning& meaning : kStatusMeanings) {
    rows.push_back({std::to_string(meaning.status), meaning.brief, meaning.text});
  }
  return "# Exit statuses\n\nEach command ends with one of these statuses.\n\n" +
         table({"Status", "In brief", "Meaning"}, rows);
}

}  // namespace breakwater
