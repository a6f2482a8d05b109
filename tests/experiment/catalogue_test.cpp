// The catalogue of a program, its printed configurations and its hash.
#include <toml++/toml.h>
#include <charconv>

#include <breakwater/experiment/catalogue.h>
#include <breakwater/experiment/provenance.h>
#include <breakwater/experiment/runner.h>
#include <breakwater/record/file_hash.h>
#include "catalogue.h"
#include "shell.h"
#include "support.h"

namespace breakwater::catalogue_test {

TEST(ScenarioKindTest, ReadsItsFileOnceAndAgainWhenItsTextChanges) {
  const testing::TemporaryPath folder{"door"};
  std::filesystem::create_directory(folder);
  const ScenarioKind kind{"door", nullptr, folder};
  const auto write = [&](const std::string& last) {
    std::ofstream(kind.file()) << "scenario = \"door\"\nk = 1\n[case." << last << "]\n";
  };
  write("open");
  const auto first = kind.scenario_file();
  EXPECT_EQ(first->cases(), std::vector<std::string>{"open"});
  EXPECT_EQ(kind.scenario_file(), first);
  write("shut");  // as long, and within the resolution of the file's time
  EXPECT_EQ(kind.scenario_file()->cases(), std::vector<std::string>{"shut"});
  EXPECT_EQ(first->cases(), std::vector<std::string>{"open"});
  EXPECT_NE(kind.scenario_file(kind.file()), kind.scenario_file());
  std::filesystem::remove(kind.file());
  EXPECT_EQ(complaint_of([&] { kind.scenario_file(); }),
            kind.file().string() + ": cannot be read (No such file or directory)");
}

TEST(ProgramHash, IsThatOfTheBuildId) {
  const std::string file = std::filesystem::read_symlink("/proc/self/exe").string();
  const std::string digits = testing::output_of("readelf --notes '" + file +
                                                "' | sed -n 's/ *Build ID: //p' | tr -d '\\n'");
  ASSERT_EQ(digits.size(), 40U);
  std::string id;
  for (std::size_t i = 0; i < digits.size(); i += 2) {
    id += static_cast<char>(std::stoi(digits.substr(i, 2), nullptr, 16));
  }
  EXPECT_EQ(program_hash(), text_hash(id));
}

// A configuration with any values is printed as a file that reads as the same configuration.

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
  const int count = testing::property_count(100);
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

}  // namespace breakwater::catalogue_test
