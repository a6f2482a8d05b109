// Bounds of shipped cases: cases.txt, one test a table.
#include <regex>

#include "regression/run_case.h"
#include "tables.h"

namespace breakwater::cases_test {

using testing::forms_of;
using testing::Sets;
using testing::Table;
using testing::TableRow;
using testing::words_in;
using testing::operator+;

struct Run {
  std::string scenario;
  std::string case_name;
  Sets sets;
  auto operator<=>(const Run&) const = default;
};

struct Outcome {
  std::map<std::string, std::optional<double>> numbers;  // metrics that rows ask for
  std::uint64_t hash = 0;
  std::string failure;
  std::string warnings;
  bool may_fail = false;
  bool needs_log = false;
  std::set<std::string> defined;  // names of metrics that the scenario may report
};

double extreme(const Recording& run, const std::string& kind, const std::string& name) {
  const std::size_t slash = name.find('/');
  const std::string track = slash == std::string::npos ? "control" : name.substr(0, slash);
  const std::vector<double> all = run.track(track).values(name.substr(slash + 1));
  if (kind == "last") return all.back();
  const auto [least, most] = std::minmax_element(all.begin(), all.end());
  return kind == "min" ? *least : *most;
}

// Whether a metric is an extreme of a signal in the log.
bool is_of_log(const std::string& metric) {
  const std::vector<std::string> words = words_in(metric);
  return words.size() > 1 && words.front() != "abs";
}

// "NAME", "abs NAME", or "max SIGNAL", "min SIGNAL", "last SIGNAL" over the track "control".
// Another track stands before the signal: "physics/SIGNAL".
std::optional<double> number_of(const Recording& run, const std::string& metric) {
  const std::vector<std::string> words = words_in(metric);
  if (metric == "dropped_samples") return static_cast<double>(run.dropped_samples);
  if (words.size() == 1) return run.metric(metric);
  if (is_of_log(metric)) return extreme(run, words.front(), words.back());
  const std::optional<double> value = run.metric(words.back());
  return value ? std::optional(std::abs(*value)) : value;
}

// The metric of each run whose median, or share of the value 1 ("share NAME"), is compared.
std::string metric_of(const std::string& compared) {
  return compared.starts_with("share ") ? compared.substr(6) : compared;
}

// A run of a shipped scenario, or of a plant's file: its scenario is "FILE.toml".
PreparedRun prepare(const Run& run) {
  if (!run.scenario.ends_with(".toml"))
    return testing::prepare(run.scenario, run.case_name, run.sets);
  const ScenarioFile file(testing::source_file(run.scenario), "plant");
  return prepare_run(testing::catalogue(), "plant", file, run.case_name, run.sets);
}

// The runs of a table, each of them once.
class Runs {
 public:
  void want(const Run& run, const std::string& compared, bool may_fail) {
    const std::string metric = metric_of(compared);
    for (const Run& one : seeds_of(run)) {
      outcomes_[one].numbers[metric];
      outcomes_[one].may_fail |= may_fail || metric != compared;
      outcomes_[one].needs_log |= is_of_log(metric);
    }
  }
  void do_all() {
    for (auto& [run, outcome] : outcomes_) {
      const PreparedRun prepared = prepare(run);
      for (const MetricDefinition& metric : prepared.scenario->metric_definitions()) {
        outcome.defined.insert(metric.name);
      }
      const Recording recording =
          prepared.scenario->run(outcome.needs_log ? RunControl{} : testing::kWithoutLog);
      outcome.hash = recording.state_hash;
      if (recording.failure) {
        std::ostringstream text;
        text << recording.failure->reason << " at " << recording.failure->time_s << " s";
        outcome.failure = text.str();
      }
      EXPECT_TRUE(outcome.may_fail || outcome.failure.empty())
          << run.case_name << " " << ::testing::PrintToString(run.sets) << ": " << outcome.failure;
      for (const std::string& line : recording.warnings) outcome.warnings += line + "\n";
      for (auto& [metric, value] : outcome.numbers) {
        const bool is_text = metric == "hash" || metric == "failure" || metric == "warnings";
        if (!is_text) value = number_of(recording, metric);
      }
    }
  }
  const Outcome& outcome(const Run& run) const { return outcomes_.at(seeds_of(run).front()); }
  // The median over the seeds; nothing if a run lacks the metric. Or the share.
  std::optional<double> number(const Run& run, const std::string& compared) const {
    const std::string metric = metric_of(compared);
    std::vector<double> values;
    for (const Run& one : seeds_of(run)) {
      const std::optional<double> value = outcome(one).numbers.at(metric);
      if (!value && metric == compared) return value;
      values.push_back(value.value_or(0.0));
    }
    if (metric == compared) return testing::median(values);
    return static_cast<double>(std::count(values.begin(), values.end(), 1.0)) /
           static_cast<double>(values.size());
  }

 private:
  // "run.seed=1..5" is five runs.
  static std::vector<Run> seeds_of(const Run& run) {
    const auto range = std::find_if(run.sets.begin(), run.sets.end(), [](const std::string& set) {
      return set.starts_with("run.seed=") && set.find("..") != std::string::npos;
    });
    if (range == run.sets.end()) return {run};
    std::vector<Run> runs;
    const std::size_t first = range->find('=') + 1;
    for (int seed = std::stoi(range->substr(first));
         seed <= std::stoi(range->substr(range->find("..") + 2)); ++seed) {
      runs.push_back(run);
      runs.back().sets[static_cast<std::size_t>(range - run.sets.begin())] =
          "run.seed=" + std::to_string(seed);
    }
    return runs;
  }

  std::map<Run, Outcome> outcomes_;
};

// "< 0.5", "= 2 ± 1%", "> 0.7 (CASE SETS: METRIC)", "present", "has TEXT" …
struct Bound {
  std::string relation;
  std::string text;  // behind has and lacks
  double factor = 1.0;
  std::optional<std::string> other;  // between the parentheses
  double tolerance = 0.0;
  bool is_relative = false;
};

Bound bound_of(const std::string& text) {
  static const std::regex words("(has|lacks) (.*)|present|absent|never|none");
  static const std::string number = "([-+]?[0-9.]+(?:e[-+]?[0-9]+)?)";
  static const std::regex relation("(<=|>=|!=|<|>|=)(?: " + number + ")?(?: \\(([^)]*)\\))?(?: ± " +
                                   number + "(%?))?");
  std::smatch part;
  if (std::regex_match(text, part, words)) return {part[1].matched ? part.str(1) : text, part[2]};
  if (!std::regex_match(text, part, relation) || (!part[2].matched && !part[3].matched))
    throw std::invalid_argument("no bound: " + text);
  Bound bound{.relation = part[1]};
  if (part[2].matched) bound.factor = std::stod(part[2]);
  if (part[3].matched) bound.other = part[3];
  if (part[4].matched) bound.tolerance = std::stod(part[4]);
  bound.is_relative = part[5].length() > 0;
  if (bound.is_relative) bound.tolerance /= 100.0;
  return bound;
}

struct Check {
  const TableRow* row;
  Run run;
  std::string metric;
  Bound bound;
  Run other;
  std::string other_metric;
};

// "CASE", or "SCENARIO/CASE"; the heading begins with the usual scenario.
Run run_of(const std::vector<std::string>& heading, const std::string& case_name,
           const Sets& sets) {
  const Sets common(heading.begin() + 1, heading.end());
  const std::size_t slash = case_name.find('/');
  if (slash == std::string::npos) return {heading.front(), case_name, common + sets};
  return {case_name.substr(0, slash), case_name.substr(slash + 1), common + sets};
}

// The other run of a bound: "CASE" has the sets of the row, "CASE SET…" these ones, "CASE -" none.
// "." is the row's case.
void set_other(Check& check, const std::vector<std::string>& heading, const std::string& case_name,
               const Sets& sets) {
  std::string text = check.bound.other.value();
  check.other_metric = check.metric;
  if (const std::size_t colon = text.find(": "); colon != std::string::npos) {
    check.other_metric = text.substr(colon + 2);
    text.resize(colon);
  }
  std::vector<std::string> words = words_in(text);
  const std::string name = words.front() == "." ? case_name : words.front();
  words.erase(words.begin());
  const bool is_alone = words.size() == 1 && words.front() == "-";
  check.other = run_of(heading, name, is_alone ? Sets() : words.empty() ? sets : words);
}

std::vector<Check> checks_of(const Table& table) {
  const std::vector<std::string> heading = words_in(table.heading);
  std::vector<Check> checks;
  for (const TableRow& row : table.rows) {
    if (row.cells.size() < 4) {
      throw std::invalid_argument(table.name + ", line " + std::to_string(row.line) +
                                  ": needs case | sets | metric | bound | why");
    }
    for (const std::string& name : forms_of(row.cells[0])) {
      for (const std::string& form : forms_of(row.cells[1])) {
        const Sets sets = words_in(form);
        for (const std::string& metric : forms_of(row.cells[2])) {
          Check check{&row, run_of(heading, name, sets), metric, bound_of(row.cells[3]), {}, ""};
          if (check.bound.other) set_other(check, heading, name, sets);
          checks.push_back(check);
        }
      }
    }
  }
  return checks;
}

void expect(const Check& check, const Runs& runs) {
  const auto& [relation, text, factor, other, tolerance, is_relative] = check.bound;
  if (!text.empty() || relation == "none") {
    const Outcome& outcome = runs.outcome(check.run);
    const std::string& said = check.metric == "failure" ? outcome.failure : outcome.warnings;
    EXPECT_TRUE(relation == "none"  ? said.empty()
                : relation == "has" ? said.find(text) != std::string::npos
                                    : said.find(text) == std::string::npos)
        << said;
    return;
  }
  if (check.metric == "hash") {
    const auto own = runs.outcome(check.run).hash, others = runs.outcome(check.other).hash;
    EXPECT_TRUE(relation == "=" ? own == others : own != others) << relation;
    return;
  }
  const std::optional<double> value = runs.number(check.run, check.metric);
  if (!value) {
    EXPECT_TRUE(runs.outcome(check.run).defined.contains(check.metric))
        << "there is no such metric";
  }
  if (relation == "absent" || relation == "never") {
    EXPECT_FALSE(value) << value.value_or(0.0);
    return;
  }
  // A run that failed is not what the bound excludes.
  if (relation == "!=" && !value) return;
  ASSERT_TRUE(value) << "is absent";
  if (relation == "present") return;
  double bound = factor;
  if (other) {
    const std::optional<double> reference = runs.number(check.other, check.other_metric);
    ASSERT_TRUE(reference) << "the other one is absent";
    bound *= *reference;
  }
  const double near = is_relative ? tolerance * std::abs(bound) : tolerance;
  EXPECT_TRUE(relation == "<"    ? *value < bound
              : relation == "<=" ? *value <= bound
              : relation == ">"  ? *value > bound
              : relation == ">=" ? *value >= bound
              : relation == "!=" ? *value != bound
                                 : std::abs(*value - bound) <= near)
      << *value << " against " << bound;
}

class Cases : public ::testing::TestWithParam<Table> {};

TEST_P(Cases, KeepTheirBounds) {
  const std::vector<Check> checks = checks_of(GetParam());
  Runs runs;
  for (const Check& check : checks) {
    const bool may_fail = check.metric == "failure" || check.bound.relation == "never" ||
                          (check.bound.relation == "!=" && check.metric != "hash");
    runs.want(check.run, check.metric, may_fail);
    if (check.bound.other) runs.want(check.other, check.other_metric, false);
  }
  runs.do_all();
  for (const Check& check : checks) {
    const auto& cells = check.row->cells;
    SCOPED_TRACE("cases.txt:" + std::to_string(check.row->line) + ": " + check.run.case_name +
                 " | " + ::testing::PrintToString(check.run.sets) + " | " + check.metric + " | " +
                 cells[3] + " | " + (cells.size() > 4 ? cells[4] : ""));
    expect(check, runs);
  }
}

INSTANTIATE_TEST_SUITE_P(Shipped, Cases,
                         ::testing::ValuesIn(testing::tables_of("tests/regression/cases.txt")),
                         testing::test_name);

}  // namespace breakwater::cases_test
