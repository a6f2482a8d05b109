// Scenario files, their cases, assignments and messages.
#include <breakwater/config/config.h>
#include <breakwater/config/fields.h>
#include <breakwater/config/toml_entry.h>
#include <breakwater/pictures/shot_list.h>
#include <breakwater/shell/did_you_mean.h>
#include <breakwater/thesis/printed_results.h>
#include "support.h"
#include "tables.h"

namespace breakwater::config_test {

using testing::repeated;
using testing::replaced;

enum class Color { red, blue };

struct Settings {
  double speed = 0.0;
  int steps = 0;
  std::uint64_t seed = 0;
  std::string name;
  Color color = Color::red;
  std::vector<double> gains;
  std::vector<std::vector<double>> poles;
  std::optional<double> limit;

  Fields fields() {
    Fields fields;
    fields.number("motion.speed_m_s", speed, positive(), "how fast");
    fields.count("motion.steps", steps, between(1, 10), "how many");
    fields.count("run.seed", seed, not_negative(), "of noise");
    fields.text("run.name", name, "what it is called");
    fields.choice("motion.color", color, {{"red", Color::red}, {"blue", Color::blue}}, "of it");
    fields.numbers("motion.gains", gains, any(), "of each joint");
    fields.number_groups("motion.poles", poles, any(), "of each joint");
    fields.number("motion.limit", limit, positive(), "of the speed, if any");
    return fields;
  }
};

const char* const kText = R"(scenario = "test"
default_case = "slow"
[motion]
speed_m_s = 2
steps = 3
color = "blue"
gains = [1, 2.5]
poles = [[-1, -2], [-3]]
[run]
seed = 4
name = "a \"quoted\" name"
[case.slow]
[case."very-1.5"]
motion.speed_m_s = 1.5
[case.another]
motion.color = "red"
)";

using Rows = std::vector<std::pair<std::string, std::string>>;

class ConfigTest : public ::testing::Test {
 protected:
  ScenarioFile file(const std::string& text = kText) {
    std::ofstream(path_) << text;
    return {path_.string(), "test"};
  }

  // Reads a case with assignments. Returns the error message without the file's name, or "".
  std::string read(const std::string& case_name, const std::vector<std::string>& sets,
                   const std::string& text = kText) {
    return complaint_without_place([&] {
      Config config = file(text).config(case_name);
      for (const auto& set : sets) config.set(set);
      settings_.fields().read(config);
    });
  }

  // Reads a file for a run. Returns the same as read().
  std::string read_run(const std::string& case_name, const std::string& text) {
    return complaint_without_place([&] {
      const ScenarioFile scenario = file(text);
      Fields fields = settings_.fields();
      fields.check(scenario);
      fields.read(scenario.config(case_name));
    });
  }
  std::string complaint_without_place(const std::function<void()>& call) const {
    std::string what = complaint_of(call);
    EXPECT_TRUE(lacks(what, "\n"));
    const auto at = what.find(path_.string());
    return at == std::string::npos ? what : what.replace(at, path_.string().size(), "FILE");
  }

  const testing::TemporaryPath path_{"scenario.toml"};
  Settings settings_;
};

TEST_F(ConfigTest, ReadsTheDefaultCase) {
  ASSERT_EQ(read("slow", {}), "");
  EXPECT_EQ(settings_.speed, 2.0);
  EXPECT_EQ(settings_.steps, 3);
  EXPECT_EQ(settings_.seed, 4U);
  EXPECT_EQ(settings_.name, "a \"quoted\" name");
  EXPECT_EQ(settings_.color, Color::blue);
  EXPECT_EQ(settings_.gains, (std::vector<double>{1, 2.5}));
  EXPECT_EQ(settings_.poles, (std::vector<std::vector<double>>{{-1, -2}, {-3}}));
}

TEST_F(ConfigTest, CasesStandInTheFilesOrder) {
  EXPECT_EQ(file().cases(), (std::vector<std::string>{"slow", "very-1.5", "another"}));
  EXPECT_EQ(file().default_case(), "slow");
}

TEST_F(ConfigTest, AnOnlyCaseIsTheDefaultCase) {
  EXPECT_EQ(file("scenario = \"test\"\n[case.only]\n").default_case(), "only");
  EXPECT_EQ(read("slow", {}, replaced(kText, "default_case = \"slow\"\n", "")),
            "FILE: default_case: is missing");
}

// A table without keys would be ignored.
TEST_F(ConfigTest, RefusesAnEmptyTableInATable) {
  EXPECT_EQ(read("slow", {}, std::string(kText) + "[motion.limits]\n"),
            "FILE:17: motion.limits: the table is empty");
}

TEST_F(ConfigTest, FileIsBelowCaseIsBelowSet) {
  ASSERT_EQ(read("very-1.5", {}), "");
  EXPECT_EQ(settings_.speed, 1.5);
  ASSERT_EQ(read("very-1.5", {"motion.speed_m_s=7", "motion.speed_m_s=8"}), "");
  EXPECT_EQ(settings_.speed, 8.0);
}

TEST_F(ConfigTest, SetTakesTomlAndBareWords) {
  ASSERT_EQ(read("slow", {"run.name=plain", "motion.color=red", "motion.gains=[3, 4]",
                          "motion.speed_m_s=1e-2", "run.seed=0x10"}),
            "");
  EXPECT_EQ(settings_.name, "plain");
  EXPECT_EQ(settings_.color, Color::red);
  EXPECT_EQ(settings_.gains, (std::vector<double>{3, 4}));
  EXPECT_EQ(settings_.speed, 0.01);
  EXPECT_EQ(settings_.seed, 16U);
  ASSERT_EQ(read("slow", {"run.name=\"quoted\"", "motion.color='blue'"}), "");
  EXPECT_EQ(settings_.name, "quoted");
}

TEST_F(ConfigTest, MessagesNamePlaceAndReason) {
  for (const auto& row : testing::rows_of("ConfigSets")) {
    EXPECT_EQ(read("slow", {row.at(0)}), "--set: " + row.at(1));
  }
  EXPECT_EQ(read("slow", {"motion.speed_m_s=1\nrun.seed=2"}),
            "--set: motion.speed_m_s: must be a number, is \"1\\nrun.seed=2\"");
  EXPECT_EQ(read("slo", {}), "--case: FILE has no case \"slo\" (did you mean slow?)");
}

TEST_F(ConfigTest, AnElementIsSetAlone) {
  ASSERT_EQ(
      read("slow", {"motion.gains[2]=7", "motion.poles[1][2]=-9", "motion.poles[2]=[-4, -5]"}), "");
  EXPECT_EQ(settings_.gains, (std::vector<double>{1, 7}));
  EXPECT_EQ(settings_.poles, (std::vector<std::vector<double>>{{-1, -9}, {-4, -5}}));
  // The printed configuration, which identifies a run, has the whole array.
  const std::string printed = settings_.fields().print("test", "slow");
  ASSERT_EQ(read("slow", {"motion.gains=[1, 7]", "motion.poles=[[-1, -9], [-4, -5]]"}), "");
  EXPECT_EQ(settings_.fields().print("test", "slow"), printed);
  // Assignments have priority over the case and the reading.
  ASSERT_EQ(
      read("slow", {"motion.gains[1]=3"},
           "reading = \"one\"\n" + std::string(kText) + "[readings.one]\nmotion.gains = [8, 9]\n"),
      "");
  EXPECT_EQ(settings_.gains, (std::vector<double>{3, 9}));
  const Config config = file().config("slow", {"motion.gains[1]=3"});
  EXPECT_TRUE(config.find("motion.gains")->is_set());
  EXPECT_TRUE(config.find("motion.gains")->is_chosen);
}

TEST_F(ConfigTest, SaysWhichElementIsWrong) {
  for (const char* element : {"[0]", "[01]", "[-1]", "[+1]", "[ 1]", "[x]", "[]", "[", "[1", "[1]2",
                              "[1],[2]", "[99999999999999999999999]"}) {
    const std::string key = "motion.gains" + std::string(element);
    const std::string what = read("slow", {key + "=1"});
    EXPECT_TRUE(what.starts_with("--set: " + key + ": elements are counted from 1: motion.gains"))
        << what;
  }
  const auto together = [&](const std::vector<std::string>& sets) {
    return complaint_of([&] { file().config("slow", sets); });
  };
  EXPECT_EQ(together({"motion.gains=[1, 2]", "motion.gains[1]=3"}),
            "--set: motion.gains[1]: motion.gains is given too: give the array, or elements of it");
  EXPECT_EQ(
      together({"motion.poles[1][1]=3", "run.seed=1", "motion.poles[1]=[1, 2]"}),
      "--set: motion.poles[1]: motion.poles[1][1] is given too: give the array, or elements of "
      "it");
  EXPECT_EQ(together({"motion.gains[1]=3", "motion.gains[2]=3", "motion.gains[1]=4"}), "");
}

TEST_F(ConfigTest, KeepsTheFileAsItWasRead) {
  const ScenarioFile scenario = file();
  std::ofstream(path_, std::ios::app) << "# edited\n";
  EXPECT_EQ(scenario.text(), kText);
}

// A text of the file is replaced by another one. Keys that the chosen case overrides are checked
// too.
TEST_F(ConfigTest, NamesTheFilesLineWhicheverCaseRuns) {
  for (const auto& row : testing::rows_of("ConfigFiles")) {
    EXPECT_EQ(read_run(row.at(0), replaced(kText, row.at(1), row.at(2))), row.at(3));
  }
  EXPECT_EQ(read("slow", {}, std::string(kText).substr(0, 60)).substr(0, 7), "FILE:4:");
  EXPECT_EQ(read("slow", {}, "scenario = \"other\"\n"),
            "FILE:1: scenario: is \"other\", not \"test\"");
  EXPECT_EQ(read("slow", {}, "scenario = \"test\"\ndefault_case = \"slow\"\n"),
            "FILE:2: default_case: there is no [case.slow]");
  EXPECT_EQ(read("slow", {}, ""), "FILE: scenario: is missing");
  EXPECT_REFUSED(ScenarioFile("/no/such/file.toml", "test"));
  EXPECT_REFUSED(ScenarioFile("/", "test"));
}

TEST_F(ConfigTest, ReadingsAreCheckedToo) {
  const std::string head = "reading = \"one\"\n" + std::string(kText);
  const std::string one = "[readings.one]\nmotion.steps = 4\n";
  EXPECT_EQ(read_run("slow", head + one), "");
  EXPECT_EQ(settings_.steps, 4);
  EXPECT_EQ(read_run("slow", head + one + "[readings.two]\nmotion.steps = \"x\"\n"),
            "FILE:21: motion.steps: must be a whole number, is \"x\"");
  EXPECT_EQ(read_run("slow", head + "reading = \"tow\"\n" + one + "[readings.two]\n"),
            "FILE:18: reading: there is no [readings.tow] (did you mean two?)");
  EXPECT_EQ(read_run("slow", head + one + "reading = \"one\"\n"), "FILE:20: reading: unknown key");
  EXPECT_EQ(read_run("slow", head + "[readings.\"a/b\"]\n").substr(0, 22),
            "FILE:18: readings.a/b:");
}

TEST_F(ConfigTest, ACasesNameIsAFoldersName) {
  const auto complaint = [&](const std::string& name) {
    return read_run("slow", kText + ("[case." + name + "]\n"));
  };
  EXPECT_EQ(complaint("\"A-z_0.9+x\""), "");
  for (const char* name :
       {"../../escaped", "/tmp/x", "a b", "", ".", "..", "a\\u0000b", "ä", "a\\nb"}) {
    const std::string what = complaint('"' + std::string(name) + '"');
    EXPECT_TRUE(what.starts_with("FILE:17: case.")) << what;
    EXPECT_TRUE(has(what, "a name is made of"));
  }
  EXPECT_EQ(complaint("all"), "FILE:17: case.all: means all of them");
}

TEST_F(ConfigTest, AKeyGivenTwiceIsRefused) {
  EXPECT_EQ(read_run("slow", "\"motion.steps\" = 5\n" + std::string(kText)),
            "FILE:1: motion.steps: is given twice");
}

TEST_F(ConfigTest, RefusesTomlThatWouldCrashTheParser) {
  constexpr int kDeep = 100000;
  const std::string key = repeated("a.", kDeep) + "a";
  const std::string arrays = repeated("[", kDeep);
  const std::string tables = repeated("{a=", kDeep);
  const auto with = [&](const std::string& line) { return read_run("slow", line + "\n" + kText); };
  EXPECT_EQ(with(key + " = 1"), "FILE:1: has a key of too many parts");
  EXPECT_EQ(with("[" + key + "]"), "FILE:1: has a key of too many parts");
  EXPECT_EQ(with("\n\"]\" = { " + key + " = 1 }"), "FILE:2: has a key of too many parts");
  EXPECT_EQ(with("x = " + arrays), "FILE:1: is nested too deeply");
  EXPECT_EQ(with("x = " + tables), "FILE:1: is nested too deeply");
  EXPECT_EQ(with("x = \"\"\"\n\"]\"\"\" # '\ny = " + arrays), "FILE:3: is nested too deeply");
  EXPECT_EQ(with(std::string(5U << 20U, ' ')), "FILE:1: is longer than 4 MiB");
  EXPECT_TRUE(with("x = \"\xff\"").starts_with("FILE:1: is not TOML:"));
  EXPECT_TRUE(with(std::string("x = \"\0\"", 7)).starts_with("FILE:1: "));
  EXPECT_EQ(with(std::string(1000, 'x') + " = 1"),
            "FILE:1: " + std::string(40, 'x') + "...: is no key");

  EXPECT_EQ(with("\"a\\u0000b\" = 1"), "FILE:1: a?b: is no key");

  EXPECT_EQ(read("slow", {"motion.gains=" + arrays}), "--set: motion.gains: is nested too deeply");
  EXPECT_EQ(read("slow", {"motion.gains=" + tables}), "--set: motion.gains: is nested too deeply");
  EXPECT_EQ(read("slow", {"motion.gains={" + key + "=1}"}),
            "--set: motion.gains: has a key of too many parts");
  // A path with many dots has no nesting.
  EXPECT_EQ(read("slow", {"run.name=" + repeated("../", 40) + "arm.xml"}), "");
  EXPECT_EQ(read("slow", {key + "=1"}), "--set: " + repeated("a.", 20) + "...: is no key");
  EXPECT_EQ(read("slow", {"a\nb=1"}), "--set: a?b: is no key");

  // Brackets in a text are no nesting.
  EXPECT_EQ(read("slow", {"run.name=\"" + repeated("[{.", 100) + "\""}), "");
  EXPECT_EQ(with("# " + repeated("[{.", 1000)), "");
  EXPECT_EQ(read("slow", {"motion.gains=[" + repeated("1.5, ", 1000) + "]"}), "");
}

TEST_F(ConfigTest, ShotListsHaveTheSameGuard) {
  std::ofstream(path_) << repeated("a.", 100000) << "a = 1\n";
  EXPECT_REFUSED(shot_list(path_.string()));
}

TEST_F(ConfigTest, SaysWhichKeysHaveNoEffect) {
  Fields fields = settings_.fields();
  fields.only_for({"motion.speed_m_s", "motion.steps"}, "motion.color", {"red"});
  fields.only_with({"motion.steps"}, "run.seed");
  const ScenarioFile scenario = file();
  const auto unused = [&](const std::vector<std::string>& sets) {
    const Config config = scenario.config("very-1.5", sets);
    fields.read(config);
    std::string text;
    for (const UnusedKey& key : fields.unused()) {
      text += (config.find(key.key)->is_chosen ? "* " : "") + key.key + ": " + key.reason + "\n";
    }
    return text;
  };
  EXPECT_EQ(unused({}),
            "* motion.speed_m_s: has an effect only where motion.color is red\n"
            "motion.steps: has an effect only where motion.color is red\n");
  EXPECT_EQ(unused({"motion.color=red"}), "");
  EXPECT_EQ(unused({"motion.color=red", "run.seed=0", "motion.steps=1"}),
            "* motion.steps: has an effect only where run.seed is not 0\n");
  EXPECT_THROW(fields.only_for({"motion.sped_m_s"}, "motion.color", {"red"}), std::logic_error);
}

TEST_F(ConfigTest, PrintsAFileThatReadsTheSame) {
  ASSERT_EQ(read("very-1.5", {"motion.speed_m_s=0.1", "motion.gains=[1e-300, 3]"}), "");
  const std::string printed = settings_.fields().print("test", "very-1.5");
  Settings again;
  const ScenarioFile copy = file(printed);
  EXPECT_EQ(copy.cases(), (std::vector<std::string>{"very-1.5"}));
  again.fields().read(copy.config(copy.default_case()));
  EXPECT_EQ(again.fields().print("test", "very-1.5"), printed);
  EXPECT_EQ(again.speed, 0.1);
  EXPECT_EQ(again.gains, settings_.gains);
  EXPECT_EQ(again.name, settings_.name);
  EXPECT_EQ(again.poles, settings_.poles);
}

TEST_F(ConfigTest, AKeyMayBeLeftOutWithItsLine) {
  const std::string text = kText + std::string("motion.limit = 3\n");  // in the case `another`
  EXPECT_EQ(read_run("another", text), "");
  EXPECT_EQ(settings_.limit, 3.0);
  EXPECT_EQ(read_run("slow", text), "");
  EXPECT_FALSE(settings_.limit);
  EXPECT_TRUE(lacks(settings_.fields().print("test", "slow"), "limit"));
}

TEST(DidYouMean, SuggestsOnlySimilarNames) {
  const std::vector<std::string> names = {"proposed-2N", "hpfc-2N", "drac-5N"};
  EXPECT_EQ(did_you_mean("propsed-2N", names), " (did you mean proposed-2N?)");
  EXPECT_EQ(did_you_mean("hpfc2N", names), " (did you mean hpfc-2N?)");
  EXPECT_EQ(did_you_mean("something else", names), "");
}

TEST(PrintedValues, AreThoseOfTheThesis) {
  const auto printed = printed_references().of_case;
  const auto values = printed("arm_wall_contact", "proposed-2N");
  ASSERT_EQ(values.size(), 3U);
  for (const PublishedValue& value : values) {
    if (value.metric == "peak_force_filtered_N") {
      EXPECT_EQ(value.number, 5.0152);
      EXPECT_EQ(value.agrees(5.0152 * 0.91).text, "reproduced");
      EXPECT_EQ(value.agrees(5.0152 * 1.34).text, "near");
      EXPECT_EQ(value.agrees(5.0152 * 1.36).text, "not reproduced");
      EXPECT_EQ(value.agrees(NAN).text, "not measured");
    }
    if (value.metric == "mean_force_error_N") {
      EXPECT_EQ(value.number, 0.0032);
      EXPECT_EQ(value.agrees(0.0041).text, "reproduced");
      EXPECT_EQ(value.agrees(0.0).text, "near");
      EXPECT_EQ(value.agrees(-0.0049).text, "not reproduced");
    }
  }
  EXPECT_EQ(printed("arm_wall_contact", "tuned-5N").size(), 2U);
  EXPECT_TRUE(printed("arm_push", "proposed-link1").empty());
}

// A duration of "100" means 100 s.
TEST(Config, WholeNumbersAreNumbersToo) {
  Config config("test.toml", {});
  config.set("a.whole=100");
  config.set("a.real=0.5");
  config.set("a.text=fast");
  config.set("a.flag=true");
  EXPECT_EQ(config.number("a.whole"), 100.0);
  EXPECT_EQ(config.number("a.real"), 0.5);
  for (const char* key : {"a.text", "a.flag", "a.missing"}) EXPECT_FALSE(config.number(key)) << key;
}

enum class Colour { red, green };
const Names<Colour> kColours = {{"red", Colour::red}, {"green", Colour::green}};

constexpr const char* kTables = R"(name = ""
count = 1.5
[wall]
place = [1, "two"]
speed = -1
colour = "gren"
[wall.part]
)";

TEST(TomlEntry, MessagesNamePlaceAndReason) {
  const toml::table tables = toml::parse(kTables, std::string_view("a.toml"));
  struct Row {
    std::function<void(const TomlEntry& root)> read;
    std::string message;
  };
  const std::vector<Row> rows = {
      {[](const auto& e) { (void)e["name"].text(); }, "a.toml:1: name: must be a text, is empty"},
      {[](const auto& e) { (void)e["nam"].text(); }, "a.toml: nam: is missing"},
      {[](const auto& e) { (void)e["count"].text(); }, "a.toml:2: count: must be a text"},
      {[](const auto& e) { (void)e["count"].whole(1, 9); },
       "a.toml:2: count: must be a whole number of 1 to 9"},
      {[](const auto& e) { (void)e["count"]["x"]; }, "a.toml:2: count: must be a table"},
      {[](const auto& e) { (void)e["count"].elements(); }, "a.toml:2: count: must be an array"},
      {[](const auto& e) { (void)e["wall"]["width"].number(); },
       "a.toml:3: wall.width: is missing"},
      {[](const auto& e) { (void)e["door"]["width"].number(); }, "a.toml: door.width: is missing"},
      {[](const auto& e) { (void)e["name"].text_or_nothing(); },
       "a.toml:1: name: must be a text, is empty"},
      {[](const auto& e) { (void)e["count"].text_or_empty(); }, "a.toml:2: count: must be a text"},
      {[](const auto& e) { (void)e["wall"]["place"].elements()[1].number(); },
       "a.toml:4: wall.place: must be a number"},
      {[](const auto& e) { (void)e["wall"]["place"].texts(); },
       "a.toml:4: wall.place: must be a text"},
      {[](const auto& e) { (void)e["wall"]["speed"].number(positive()); },
       "a.toml:5: wall.speed: must be positive, is -1"},
      {[](const auto& e) { (void)e["wall"]["colour"].choice(kColours); },
       "a.toml:6: wall.colour: must be one of red, green, is \"gren\" (did you mean green?)"},
      {[](const auto& e) { (void)e["wall"]["part"].written(); },
       "a.toml:7: wall.part: must be a number, a text, true, false or an array of these"},
      {[](const auto& e) {
         e["wall"].allow({"place", "speed", "color", "part"});
       },
       "a.toml:6: wall.colour: unknown key (did you mean color?)"}};
  for (const Row& row : rows) {
    EXPECT_EQ(complaint_of([&] { row.read(TomlEntry(tables, "a.toml")); }), row.message);
  }
}

TEST(TomlEntry, ReadsInTheOrderOfTheFileAndAcceptsAMissingEntry) {
  const toml::table tables = toml::parse(kTables, std::string_view("a.toml"));
  const TomlEntry root(tables, "a.toml");
  std::vector<std::string> keys;
  for (const auto& [key, entry] : root["wall"].entries()) keys.push_back(key);
  EXPECT_EQ(keys, (std::vector<std::string>{"place", "speed", "colour", "part"}));
  EXPECT_EQ(root["wall"]["place"].written(), "[1, \"two\"]");
  EXPECT_FALSE(root["door"]["width"]);
  EXPECT_TRUE(root["door"].entries().empty());
  EXPECT_TRUE(root["door"]["width"].texts().empty());
  EXPECT_EQ(root["door"].text_or_nothing(), "");
  EXPECT_EQ(root["name"].text_or_empty(), "");
  EXPECT_EQ(root["door"].number_or_nothing(), std::nullopt);
}

}  // namespace breakwater::config_test
