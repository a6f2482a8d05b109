// Keys reported as ineffective have no effect, and no shipped case sets one.
#include <fmt/format.h>

#include <breakwater/experiment/runner.h>
#include <breakwater/shell/all_cores.h>
#include "catalogue.h"
#include "tables.h"

namespace breakwater::unused_keys_test {

TEST(UnusedKeys, NoShippedCaseSetsOne) {
  for (const std::string& name : testing::scenario_names()) {
    const ScenarioFile file = testing::scenario_file(name);
    for (const std::string& case_name : file.cases()) {
      for (const IneffectiveKey& ineffective : testing::prepare(name, case_name).ineffective) {
        ADD_FAILURE() << name << " " << case_name << ": " << ineffective.origin << ": "
                      << ineffective.key;
      }
    }
  }
}

// Another option of a choice.
std::string other_option(const std::string& key, const std::string& now) {
  static const std::vector<std::vector<std::string>> options = testing::rows_of("Options");
  // "axis.NAME.observer.name" is an axis' "observer.name".
  const std::size_t axis_ends = key.starts_with("axis.") ? key.find('.', 5) + 1 : 0;
  for (const auto& row : options) {
    if (row.at(0) == key.substr(axis_ends)) return row.at(1) != now ? row.at(1) : row.at(2);
  }
  throw std::out_of_range(key);
}

// A similar legal value.
std::string other_value(const std::string& key, const ConfigValue& value) {
  // γ must be at least 1, and periods are multiples of each other.
  const double factor = key.find("gamma") != std::string::npos ? 1.1
                        : key.ends_with("period_s")            ? 2.0
                                                               : 0.9;
  if (const auto* real = std::get_if<double>(&value.data)) {
    return fmt::format("{}", *real == 0.0 ? 0.01 : *real * factor);
  }
  if (const auto* whole = std::get_if<std::int64_t>(&value.data)) {
    return fmt::format("{}", *whole > 1 ? *whole - 1 : *whole + 1);
  }
  if (const auto* flag = std::get_if<bool>(&value.data)) return *flag ? "false" : "true";
  if (const auto* text = std::get_if<std::string>(&value.data)) {
    return '"' + other_option(key, *text) + '"';
  }
  std::string list;
  for (const ConfigValue& element : std::get<ConfigValue::Array>(value.data)) {
    list += (list.empty() ? "" : ", ") + other_value(key, element);
  }
  return "[" + list + "]";
}

struct Trial {
  std::string scenario;
  std::string case_name;
  std::vector<std::string> sets;
};

// Every shipped case, shortened, and keys that no case has.
std::vector<Trial> all_trials() {
  std::vector<Trial> trials;
  for (const auto& row : testing::rows_of("UnusedKeys")) {
    const ScenarioFile file = testing::scenario_file(row.at(0));
    Trial trial{row.at(0), file.default_case(), testing::words_in(row.at(1))};
    if (row.size() > 2) {
      for (const std::string& set : testing::words_in(row.at(2))) trial.sets.push_back(set);
      trials.push_back(trial);
      continue;
    }
    for (const std::string& name : file.cases()) trials.push_back({row.at(0), name, trial.sets});
  }
  std::set<std::string> scenarios;
  for (const Trial& trial : trials) scenarios.insert(trial.scenario);
  EXPECT_EQ(scenarios.size(), testing::scenario_names().size());
  return trials;
}

struct Result {
  std::size_t keys = 0;
  std::string changed;
  bool is_same = false;
};

// Runs the trial, then again with each ineffective key changed.
Result result_of(const Trial& trial) {
  const ScenarioFile file = testing::scenario_file(trial.scenario);
  const PreparedRun run = testing::prepare(trial.scenario, trial.case_name, trial.sets);
  const auto fresh = make_scenario(testing::catalogue(), trial.scenario);
  const Config config = file.config(trial.case_name, trial.sets);
  fresh->learn(config);
  Fields fields = fresh->fields();
  fields.read(config);
  Result result;
  std::vector<std::string> sets = trial.sets;
  for (const UnusedKey& unused : fields.unused()) {
    sets.push_back(unused.key + "=" + other_value(unused.key, config.find(unused.key)->value));
    result.changed += " " + sets.back();
    ++result.keys;
  }
  const PreparedRun other = testing::prepare(trial.scenario, trial.case_name, sets);
  const Recording one = run.scenario->run({});
  const Recording two = other.scenario->run({});
  result.is_same = one.state_hash == two.state_hash;
  return result;
}

TEST(UnusedKeys, DoNotChangeTheStateHash) {
  const std::vector<Trial> trials = all_trials();
  std::vector<Result> results(trials.size());
  on_all_cores(trials.size(), [&](std::size_t i) { results[i] = result_of(trials[i]); });
  std::size_t keys = 0;
  for (std::size_t i = 0; i < trials.size(); ++i) {
    EXPECT_TRUE(results[i].is_same)
        << trials[i].scenario << " " << trials[i].case_name << results[i].changed;
    keys += results[i].keys;
  }
  EXPECT_GT(keys, 500U);
}

}  // namespace breakwater::unused_keys_test
