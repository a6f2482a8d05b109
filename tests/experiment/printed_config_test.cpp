// A configuration with any values is printed as a file that reads as the same configuration.
#include <breakwater/experiment/runner.h>

#include <toml++/toml.h>

#include <charconv>

#include "catalogue.h"
#include "support.h"

namespace breakwater::printed_config_test {
namespace {

// The dotted keys of numbers in a printed file, with their values.
void add_numbers(const toml::table& table, const std::string& prefix,
                 std::vector<std::pair<std::string, double>>& numbers) {
  for (const auto& [name, node] : table) {
    const std::string key = prefix + std::string(name.str());
    if (const toml::table* inner = node.as_table()) add_numbers(*inner, key + ".", numbers);
    if (const auto* whole = node.as_integer()) {
      numbers.emplace_back(key, static_cast<double>(whole->get()));
    }
    if (const auto* number = node.as_floating_point()) numbers.emplace_back(key, number->get());
  }
}

std::string shortest(double value) {
  char text[32];
  const auto end = std::to_chars(text, text + sizeof text, value).ptr;
  return {text, end};
}

TEST(PrintedConfig, PropertyReadsAsItself) {
  const int count = testing::property_count(250);
  const Catalogue& catalogue = testing::catalogue();
  const testing::TemporaryPath path("printed.toml");
  testing::Random random(12);
  struct Origin {
    std::string scenario, case_name;
    ScenarioFile file;
    std::vector<std::pair<std::string, double>> numbers;
  };
  std::vector<Origin> origins;
  for (const ScenarioKind& kind : catalogue.all<ScenarioKind>()) {
    const ScenarioFile file = testing::scenario_file(kind.name);
    for (const std::string& name : file.cases()) {
      const PreparedRun run = prepare_point(catalogue, kind.name, file, name, {});
      Origin origin{kind.name, name, file, {}};
      add_numbers(toml::parse(run.config_text), "", origin.numbers);
      std::erase_if(origin.numbers,
                    [](const auto& one) { return one.first.starts_with("cases."); });
      origins.push_back(std::move(origin));
    }
  }
  const auto any_of = [&random](std::size_t size) {
    return static_cast<std::size_t>(random.uniform(0.0, static_cast<double>(size)));
  };
  int refused = 0;
  for (int accepted = 0; accepted < count;) {
    const Origin& origin = origins[any_of(origins.size())];
    const auto& [key, value] = origin.numbers[any_of(origin.numbers.size())];
    const double factor = random.uniform(0.0, 1.0) < 0.5
                              ? random.uniform(0.9, 1.1)
                              : std::pow(10.0, random.uniform(-20.0, 20.0));
    const double changed = value == 0.0 ? factor : factor * value;
    const std::string set = key + "=" + shortest(changed);
    PreparedRun run;
    try {
      run = prepare_point(catalogue, origin.scenario, origin.file, origin.case_name, {set});
    } catch (const std::invalid_argument&) {
      ASSERT_LT(++refused, 20 * count) << "almost nothing is accepted";
      continue;
    }
    ++accepted;
    std::ofstream(path) << run.config_text;
    const PreparedRun again =
        prepare_run(catalogue, origin.scenario, ScenarioFile(path.string(), origin.scenario),
                    origin.case_name, {});
    ASSERT_EQ(again.config_text, run.config_text) << origin.scenario << " " << set;
    std::vector<std::pair<std::string, double>> numbers;
    add_numbers(toml::parse(run.config_text), "", numbers);
    const auto found = std::find_if(numbers.begin(), numbers.end(),
                                    [&](const auto& one) { return one.first == key; });
    ASSERT_TRUE(found != numbers.end()) << set;
    ASSERT_EQ(found->second, changed) << origin.scenario << " " << set;
  }
  std::printf("%d configurations are printed and read; %d values were refused\n", count, refused);
}

}  // namespace
}  // namespace breakwater::printed_config_test
