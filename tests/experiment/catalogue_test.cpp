// The catalogue of a program, its printed configurations and its hash.
#include <toml++/toml.h>
#include <charconv>

#include <breakwater/experiment/catalogue.h>
#include <breakwater/experiment/provenance.h>
#include <breakwater/experiment/runner.h>
#include <breakwater/record/file_hash.h>
#include <breakwater/record/track.h>
#include <breakwater/sim/model.h>
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

// A case, and the numbers of its keys.
struct Origin {
  std::string scenario, case_name;
  ScenarioFile file;
  std::vector<std::pair<std::string, double>> numbers;
};

std::vector<Origin> all_origins() {
  std::vector<Origin> origins;
  for (const ScenarioKind& kind : testing::catalogue().all<ScenarioKind>()) {
    const ScenarioFile file = testing::scenario_file(kind.name);
    for (const std::string& name : file.cases()) {
      const PreparedRun run = prepare_point(testing::catalogue(), kind.name, file, name, {});
      Origin origin{kind.name, name, file, {}};
      add_numbers(toml::parse(run.config_text), "", origin.numbers);
      std::erase_if(origin.numbers,
                    [](const auto& one) { return one.first.starts_with("cases."); });
      origins.push_back(std::move(origin));
    }
  }
  return origins;
}

double changed_number(testing::Random& random, double value) {
  const double factor = random.uniform(0.0, 1.0) < 0.5
                            ? random.uniform(0.9, 1.1)
                            : std::pow(10.0, random.uniform(-20.0, 20.0));
  return value == 0.0 ? factor : factor * value;
}

TEST(PrintedConfig, PropertyReadsAsItself) {
  const int count = testing::property_count(100);
  const Catalogue& catalogue = testing::catalogue();
  const testing::TemporaryPath path("printed.toml");
  testing::Random random(12);
  const std::vector<Origin> origins = all_origins();
  const auto any_of = [&random](std::size_t size) {
    return static_cast<std::size_t>(random.uniform(0.0, static_cast<double>(size)));
  };
  int refused = 0;
  for (int accepted = 0; accepted < count;) {
    const Origin& origin = origins[any_of(origins.size())];
    const auto& [key, value] = origin.numbers[any_of(origin.numbers.size())];
    const double changed = changed_number(random, value);
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

TEST(BoundCases, RenewsKeysWithoutTheNameOfAnAxis) {
  const ScenarioFile file = testing::scenario_file("plant");
  const auto bound = std::make_shared<BoundCases>();
  const Scenario* first = nullptr;
  for (const char* set : {"observer.alpha=10", "observer.alpha=100", "observer.alpha=1e3"}) {
    const auto prepared = [&](const std::shared_ptr<BoundCases>& cases) {
      return prepare_point(testing::catalogue(), "plant", file, file.default_case(), {set}, cases);
    };
    const PreparedRun run = prepared(bound);
    EXPECT_EQ(run.config_text, prepared(nullptr).config_text) << set;
    if (first == nullptr) first = run.scenario.get();
    EXPECT_EQ(run.scenario.get(), first);  // it is shared
  }
  Catalogue own = testing::catalogue();
  ScenarioKind kind = own.get<ScenarioKind>("plant");
  kind.name = "own";
  kind.may_be_shared = false;
  own.add(kind);
  const auto of_own = std::make_shared<BoundCases>();
  const auto one = [&] {
    return prepare_point(own, "own", file, file.default_case(), {"observer.alpha=10"}, of_own);
  };
  one();
  EXPECT_EQ(of_own->take({file.default_case(), "observer.alpha"}), nullptr);
}

// Runs of a case that differ in numbers share a scenario: its earlier numbers change nothing.
TEST(BoundCases, PropertyRunAsBoundAnew) {
  const int count = std::min(testing::property_count(100), 3000);
  testing::Random random(13);
  const std::vector<Origin> origins = all_origins();
  const SharedModels shared;
  const auto bound = std::make_shared<BoundCases>();
  const auto any_of = [&random](std::size_t size) {
    return static_cast<std::size_t>(random.uniform(0.0, static_cast<double>(size)));
  };
  int runs = 0, refusals = 0;
  for (int i = 0; i < count; ++i) {
    const Origin& origin = origins[any_of(origins.size())];
    const auto [first, of_first] = origin.numbers[any_of(origin.numbers.size())];
    const auto [second, of_second] = origin.numbers[any_of(origin.numbers.size())];
    const auto prepared = [&](double one, double other, const auto& cases) {
      std::vector<std::string> sets = {first + "=" + shortest(one)};
      if (second != first) sets.push_back(second + "=" + shortest(other));
      if (first != "run.duration_s" && second != "run.duration_s") {
        sets.emplace_back("run.duration_s=0.02");
      }
      return prepare_point(testing::catalogue(), origin.scenario, origin.file, origin.case_name,
                           sets, cases);
    };
    for (int k = 0; k < 4; ++k) {
      const double one = k == 2 ? 0.0 : changed_number(random, of_first);
      const double other = k == 3 ? 0.0 : k == 0 ? of_second : changed_number(random, of_second);
      PreparedRun anew;
      try {
        anew = prepared(one, other, nullptr);
      } catch (const std::invalid_argument& error) {
        ++refusals;
        ASSERT_EQ(complaint_of([&] { prepared(one, other, bound); }), error.what());
        continue;
      }
      const PreparedRun again = prepared(one, other, bound);
      ASSERT_EQ(again.config_text, anew.config_text);
      ASSERT_EQ(again.model_files, anew.model_files);
      ASSERT_EQ(again.scenario->warnings(), anew.scenario->warnings());
      if (anew.scenario->run_settings().duration_s > 0.1) continue;
      Recording was;
      try {
        was = anew.scenario->run({});
      } catch (const LogTooLong&) {
        continue;
      }
      const Recording is = again.scenario->run({});
      ASSERT_EQ(is.warnings, was.warnings) << anew.config_text;
      ASSERT_EQ(is.state_hash, was.state_hash) << anew.config_text;
      ASSERT_EQ(is.metrics.size(), was.metrics.size()) << anew.config_text;
      for (std::size_t m = 0; m < is.metrics.size(); ++m) {
        ASSERT_EQ(is.metrics[m].name, was.metrics[m].name);
        ASSERT_EQ(is.metrics[m].value, was.metrics[m].value) << is.metrics[m].name;
      }
      ++runs;
    }
  }
  std::printf("%d runs are those bound anew; %d values were refused\n", runs, refusals);
}

}  // namespace breakwater::catalogue_test
