// breakwater reproduce, report and compare as a user calls them.
#include <gtest/gtest.h>

#include <algorithm>
#include <csignal>
#include <fstream>
#include <nlohmann/json.hpp>
#include <set>
#include <sstream>

#include <breakwater/record/file_hash.h>
#include <breakwater/study/shards.h>
#include "cli/program.h"
#include "support.h"

namespace breakwater {
namespace {
namespace fs = std::filesystem;

using testing::ProgramResult;
using testing::run_program;
using testing::text_of;

// Two runs with logs, a row of a table, and many small runs.
const char* const kExperiments = R"(
[form.motor]
panels = [{ title = "disturbance", signals = ["d_hat_Nm"], once = ["d_true_Nm"] }]

[[section]]
id = "4.3.2"
group = "motor"
title = "Behind an encoder"
text = "A few."
docs = "explanation/methods/disturbance-kalman-filters.md"

[[section.run]]
name = "one-{k}"
scenario = "motor_estimation"
case = "{k}"
sets = ["control.period_s=1e-3", "encoder.bits=12"]
for = [{ k = "kfd" }, { k = "fakfd-0998" }]

[[section.run]]
name = "many"
scenario = "motor_estimation"
case = "vfakfd"
sets = ["noise.std_rad=0.01", "run.duration_s=15"]
seeds = [20, 20]

[[section.table]]
title = "A part of Table 4.8"
columns = [{ title = "KFD", k = "kfd", i = 2 }, { title = "FAKFD", k = "fakfd-0998", i = 5 }]
rows = [{ title = "12 bits" }]
cell = { run = "one-{k}", metric = "rmse_velocity_rad_s", printed = "motor_estimation.table_4_8.Ts_1e-3.n12[{i}]" }

[[section.table]]
title = "Many"
columns = [{ title = "measured" }]
rows = [{ title = "velocity", says = "is small", run = "many", metric = "rmse_velocity_rad_s", below = 1.0 }]

[[section.figures]]
form = "motor"
list = [{ n = "4.34", title = "Two", runs = [["one-kfd", "KFD"], ["one-fakfd-0998", "FAKFD"]] }]
)";

int lines_of(const std::string& text) {
  return static_cast<int>(std::count(text.begin(), text.end(), '\n'));
}

class Reports : public ::testing::Test {
 protected:
  void SetUp() override {
    fs::create_directories(folder_);
    std::ofstream(folder_ / "tiny.toml") << kExperiments;
  }
  void TearDown() override { fs::remove_all(folder_); }

  ProgramResult breakwater(std::vector<std::string> arguments, double kill_after_s = 0.0) {
    arguments.insert(arguments.begin(), "breakwater");
    return run_program(arguments, folder_, kill_after_s, SIGKILL);
  }
  ProgramResult reproduce(const std::string& out, double kill_after_s = 0.0) {
    return breakwater({"reproduce", "--experiments", "tiny.toml", "--out", out}, kill_after_s);
  }
  // A run in folder_/NAME.
  void make_run(const std::string& scenario, const std::string& name,
                std::vector<std::string> options = {}) {
    options.insert(options.begin(), {scenario, "--quiet", "--out", name});
    run_program(options, folder_);
  }
  // Its shards, one behind the other, and how many results are in them.
  std::string shards(const std::string& out) const {
    std::string text;
    for (const auto& entry : fs::directory_iterator(folder_ / out / "shards")) {
      text += text_of(entry.path());
    }
    return text;
  }
  int results(const std::string& out) const {
    std::istringstream text(shards(out));
    int count = 0;
    for (std::string line; std::getline(text, line);) {
      if (line.find("\tpoint\t") != std::string::npos) ++count;
    }
    return count;
  }
  // One line on stderr that has `part`, and exit status 2.
  void expect_refused(const std::vector<std::string>& arguments, const std::string& part) {
    const ProgramResult result = breakwater(arguments);
    EXPECT_EQ(result.status, 2) << result.out << result.err;
    EXPECT_EQ(lines_of(result.err), 1) << result.err;
    EXPECT_NE(result.err.find(part), std::string::npos) << result.err;
  }

  fs::path folder_ = testing::temporary_path("reports");
};

TEST_F(Reports, AKilledReproductionGoesOnAndGivesTheSamePage) {
  const ProgramResult whole = reproduce("whole");
  ASSERT_EQ(whole.status, 0) << whole.err;
  EXPECT_NE(
      whole.out.find("2 reproduced, 0 within the class, 0 not reproduced, 1 held, 0 did not hold"),
      std::string::npos)
      << whole.out;
  EXPECT_NE(whole.out.find("report: whole/report.html"), std::string::npos);
  const std::string page = text_of(folder_ / "whole/report.html");
  EXPECT_NE(page.find("Permission is hereby granted"), std::string::npos) << "dygraphs' licence";

  std::size_t kills = 0;
  for (const double part : {0.25, 0.4, 0.6}) {
    kills += reproduce("killed", part * whole.seconds).status == 128 + SIGKILL ? 1 : 0;
  }
  EXPECT_GE(kills, 1U);
  const int done = results("killed");
  const ProgramResult resumed = reproduce("killed");
  ASSERT_EQ(resumed.status, 0) << resumed.err;
  EXPECT_GT(done, 0);
  EXPECT_EQ(text_of(folder_ / "killed/report.html"), text_of(folder_ / "whole/report.html"));
  // No run stands there twice.
  EXPECT_EQ(results_by_key(folder_ / "killed/shards").size(), 22U);
  EXPECT_LE(results("killed"), 22 + static_cast<int>(kills) * 2)
      << "only what was cut off may be repeated";
  // Nothing half-written is left.
  for (const auto& entry : fs::directory_iterator(folder_ / "killed/runs")) {
    EXPECT_TRUE(fs::exists(entry.path() / "manifest.json")) << entry.path();
  }

  const ProgramResult again = reproduce("killed");
  EXPECT_NE(again.err.find("22 runs, 22 of them there already"), std::string::npos) << again.err;
}

TEST_F(Reports, AnAlteredMeasurementFlipsItsVerdict) {
  ASSERT_EQ(reproduce("out").status, 0);
  EXPECT_EQ(text_of(folder_ / "out/report.html").find("class=\"verdict off\""), std::string::npos);
  const auto manifest = nlohmann::json::parse(text_of(folder_ / "out/runs/one-kfd/manifest.json"));
  const auto altered_line = [&] {
    std::istringstream text(shards("out"));
    for (std::string line; std::getline(text, line);) {
      if (line.find(manifest["state_hash"]) == std::string::npos) continue;
      const std::string name = "\trmse_velocity_rad_s=";
      const std::size_t value = line.find(name) + name.size();
      return line.replace(value, line.find('\t', value) - value, "0.9").substr(17);
    }
    return std::string();
  }();
  std::ofstream(folder_ / "out/shards/later.shard")
      << text_hash(altered_line) << '\t' << altered_line << '\n';
  const ProgramResult altered = reproduce("out");
  EXPECT_NE(altered.out.find("1 reproduced, 0 within the class, 1 not reproduced, 1 held"),
            std::string::npos)
      << altered.out;
  EXPECT_NE(text_of(folder_ / "out/report.html").find("class=\"verdict off\""), std::string::npos);
}

// One short run with a log, and a row for each of `rows`: what is said of its numbers.
std::string statements(const std::vector<std::string>& rows, const std::string& sets = "") {
  std::string text = R"(
[form.motor]
panels = [{ title = "velocity", signals = ["velocity_true_rad_s"] }]
[[section]]
id = "1"
group = "motor"
title = "Mine"
[[section.run]]
name = "one"
scenario = "motor_estimation"
case = "kfd"
sets = ["run.duration_s=2", "metrics.from_s=1", "metrics.to_s=2")";
  text += sets + "]\n[[section.figures]]\nform = \"motor\"\n" +
          "list = [{ n = \"1\", title = \"One\", run = \"one\" }]\n" +
          "[[section.table]]\ntitle = \"Statements\"\ncolumns = [{ title = \"one\" }]\n" +
          "cell = { run = \"one\" }\nrows = [\n";
  for (const std::string& row : rows)
    text += "  { title = \"row\", says = \"so\", " + row + " },\n";
  return text + "]\n";
}

TEST_F(Reports, StatementsOfOnesOwnHoldOrDoNotAndWhatIsNotMeasuredIsNoSuccess) {
  std::ofstream(folder_ / "tiny.toml")
      << "title = \"My motor\"\n"
      << statements({"metric = \"rmse_velocity_rad_s\", below = 1e3",
                     "metric = \"rmse_velocity_rad_s\", above = 1e3",
                     // Of 2 s, 1 s after a step, the KFD has not settled: nothing to say how long.
                     "metric = \"disturbance_settling_time_s\", absent = \"never\", above = 0.0",
                     "metric = \"rmse_velocity_rad_s\", over = \"one\", above = 1.0"});
  const ProgramResult result = reproduce("out");
  ASSERT_EQ(result.status, 0) << result.err;
  EXPECT_NE(result.out.find("2 held, 1 did not hold, 1 not measured\n"), std::string::npos)
      << result.out;
  EXPECT_EQ(result.out.find("reproduced,"), std::string::npos) << result.out;
  const std::string html = text_of(folder_ / "out/report.html");
  EXPECT_NE(html.find("<h1>My motor</h1>"), std::string::npos);
  EXPECT_EQ(html.find("The thesis, reproduced"), std::string::npos);
  EXPECT_NE(html.find(">holds<"), std::string::npos);
  EXPECT_NE(html.find(">does not hold<"), std::string::npos);
  EXPECT_NE(html.find("class=\"verdict unknown\""), std::string::npos);
  EXPECT_EQ(html.find(">reproduced<"), std::string::npos);
}

TEST_F(Reports, ShowsBesideTheRestAndSaysWhyACellDoesNotComeOut) {
  std::ofstream(folder_ / "tiny.toml")
      << statements(
             {"metric = \"rmse_velocity_rad_s\", below = 0.0, why = \"since it is, \\\"truly\\\"\"",
              "metric = \"rmse_velocity_rad_s\", over_metric = \"rmse_raw_velocity_rad_s\", above "
              "= 0.0",
              "metric = \"rmse_velocity_rad_s\", below = 1e3, vacuous = \"it stands\"",
              "metric = \"rmse_velocity_rad_s\", below = 1e3, hypothesis = \"it is lighter\"",
              "metric = \"rmse_velocity_rad_s\", below = 0.0, hypothesis = \"it is lighter\""}) +
             "\n[[section.table]]\ntitle = \"beside\"\ncolumns = [{ title = \"c\" }]\nrows = [{ "
             "title = "
             "\"r\", shows = \"what is not claimed\", run = \"one\", metric = "
             "\"peak_position_rad\" }]\nnote = \"Two gains for one cell.\"\n";
  const ProgramResult result = reproduce("out");
  ASSERT_EQ(result.status, 0) << result.err;
  EXPECT_NE(result.out.find("1 held, 1 did not hold; beside them 1 vacuous, "
                            "1 of 2 hypotheses hold\n"),
            std::string::npos)
      << result.out;
  const std::string html = text_of(folder_ / "out/report.html");
  EXPECT_NE(html.find("since it is, &quot;truly&quot;"), std::string::npos);
  EXPECT_NE(html.find("what is not claimed"), std::string::npos);
  EXPECT_NE(html.find("beside the rest, not judged"), std::string::npos);
  EXPECT_NE(html.find("among them: 1 vacuous, 1 of 2 hypotheses hold."), std::string::npos);
  EXPECT_NE(html.find("Of 2 results."), std::string::npos);
  EXPECT_NE(html.find("Two gains for one cell."), std::string::npos);

  const std::string list = text_of(folder_ / "out/verdicts.csv");
  EXPECT_EQ(lines_of(list), 7) << list;
  EXPECT_EQ(list.find("section,table,row,column,run,metric,"), 0U) << list;
  EXPECT_NE(list.find("does not hold,\"since it is, \"\"truly\"\"\""), std::string::npos) << list;
  EXPECT_NE(list.find(",one,rmse_velocity_rad_s,one,rmse_raw_velocity_rad_s,"), std::string::npos);
  EXPECT_NE(list.find(",what is not claimed,,shown,"), std::string::npos) << list;
  EXPECT_NE(list.find(",vacuous,it stands\n"), std::string::npos) << list;
  EXPECT_NE(list.find(",hypothesis: does not hold,it is lighter\n"), std::string::npos) << list;
}

TEST_F(Reports, AMetricThatNoRunHasIsAnErrorOfTheList) {
  const auto refuse = [&](const std::string& row, const std::string& message) {
    const std::string text = statements({"metric = \"rmse_velocity_rad_s\", below = 1e3", row});
    std::ofstream(folder_ / "tiny.toml") << text;
    // The last row but for the line that closes the list.
    const std::string place = "tiny.toml:" + std::to_string(lines_of(text) - 1) + ": ";
    expect_refused({"reproduce", "--experiments", "tiny.toml", "--out", "out", "--quiet"},
                   place + message);
    EXPECT_FALSE(fs::exists(folder_ / "out/report.html"));
  };
  refuse("metric = \"rmse_velocty_rad_s\", above = 0.0",
         "metric: no run of motor_estimation has rmse_velocty_rad_s (did you mean "
         "rmse_velocity_rad_s?)");
  refuse("metric = \"|rmse_velocty_rad_s|\", above = 0.0",
         "metric: no run of motor_estimation has rmse_velocty_rad_s (did you mean");
  refuse("metric = \"max d_hat_N\", above = 0.0",
         "metric: run one has no signal d_hat_N (did you mean d_hat_Nm?)");
}

TEST_F(Reports, AnEditedModelNeverStandsBesideTheNumbersOfAnother) {
  const fs::path model = folder_ / "motor.xml";
  fs::copy(testing::source_file("models/motor.xml"), model);
  const std::string own = text_of(model);
  std::ofstream(folder_ / "tiny.toml")
      << statements({"metric = \"peak_position_rad\", below = 1e3"}, ", \"model.mjcf=motor.xml\"");
  const auto state = [&] {
    const auto manifest = nlohmann::json::parse(text_of(folder_ / "out/runs/one/manifest.json"));
    return manifest["state_hash"].get<std::string>();
  };
  ASSERT_EQ(reproduce("out").status, 0);
  const std::string page = text_of(folder_ / "out/report.html");
  const std::string first = state();

  std::string heavier = own;
  heavier.replace(heavier.find("0.6 0.6 1"), 9, "0.9 0.9 1.5");
  std::ofstream(model) << heavier;
  ASSERT_EQ(reproduce("out").status, 0);
  EXPECT_NE(text_of(folder_ / "out/report.html"), page);
  EXPECT_NE(state(), first);

  std::ofstream(model) << own;
  ASSERT_EQ(reproduce("out").status, 0);
  EXPECT_EQ(state(), first) << "the folder is of the model that gave the numbers";
  EXPECT_EQ(text_of(folder_ / "out/report.html"), page);
  EXPECT_EQ(results("out"), 3) << "two models, and the figure's run again";

  // What the model includes is a part of it.
  std::string with_include = own;
  with_include.insert(with_include.find("<worldbody>"), "<include file=\"more.xml\"/>");
  std::ofstream(model) << with_include;
  std::ofstream(folder_ / "more.xml") << "<mujoco><option gravity=\"0 0 0\"/></mujoco>";
  ASSERT_EQ(reproduce("out").status, 0);
  EXPECT_NE(reproduce("out").err.find("1 runs, 1 of them there already"), std::string::npos);
  std::ofstream(folder_ / "more.xml") << "<mujoco><option gravity=\"0 0 -1\"/></mujoco>";
  EXPECT_NE(reproduce("out").err.find("1 runs, 0 of them there already"), std::string::npos);
}

TEST_F(Reports, ReproduceRefusesNonsense) {
  expect_refused({"reproduce", "--only", "boat"}, "--only boat: must be all, arm, cart, motor");
  expect_refused({"reproduce", "--experiments", "nowhere.toml"}, "nowhere.toml");
  fs::create_directories(folder_ / "mine");
  std::ofstream(folder_ / "mine/letter.txt") << "dear";
  expect_refused({"reproduce", "--out", "mine"}, "holds something that is not a reproduction");
  // A study of `sweep` has shards too.
  fs::create_directories(folder_ / "study/shards");
  std::ofstream(folder_ / "study/study.toml") << "scenario = \"arm_push\"\n";
  expect_refused({"reproduce", "--out", "study"}, "holds something that is not a reproduction");
}

TEST_F(Reports, CompareTellsWhatIsWrong) {
  make_run("motor_estimation", "kfd", {"--case", "kfd", "--duration", "6"});
  make_run("arm_push", "push", {"--duration", "0.2"});
  make_run("motor_estimation", "failed",
           {"--duration", "6", "--set", "fault.sensor=angle", "fault.at_s=2"});
  fs::create_directories(folder_ / "empty");
  fs::copy(folder_ / "kfd", folder_ / "half");
  fs::remove(folder_ / "half/log.h5");

  expect_refused({"compare", "kfd"}, "give two runs or more");
  expect_refused({"compare", "kfd", "nowhere"}, "there is no such folder");
  expect_refused({"compare", "kfd", "empty"}, "is not the folder of a finished run");
  expect_refused({"compare", "kfd", "half"},
                 "the run is incomplete: it has no log.h5; run it again");
  expect_refused({"compare", "kfd", "push"}, "compare runs of one scenario");
  expect_refused({"compare", "kfd", "failed"}, "failed at 2");
  expect_refused({"compare", "kfd", "kfd", "--metric", "rmse_velocity"}, "no run has it");
  expect_refused({"compare", "kfd", "kfd", "--signal", "d_hat_N"}, "did you mean d_hat_Nm?");
  expect_refused({"compare", "kfd", "kfd", "--svg"}, "say which signals with --signal");
  expect_refused({"report", "empty"}, "is not the folder of a finished run");
  setenv("BREAKWATER_PYTHON", "/nowhere/python3", 1);
  expect_refused({"compare", "kfd", "kfd", "--signal", "d_hat_Nm", "--pdf"}, "python3-matplotlib");
  // A Python that lacks the packages.
  std::ofstream(folder_ / "bare") << "#!/bin/sh\nexec /usr/bin/python3 -S -E \"$@\"\n";
  fs::permissions(folder_ / "bare", fs::perms::owner_all);
  setenv("BREAKWATER_PYTHON", (folder_ / "bare").c_str(), 1);
  expect_refused({"compare", "kfd", "kfd", "--signal", "d_hat_Nm", "--pdf"},
                 "apt-get install python3-h5py python3-matplotlib");
  unsetenv("BREAKWATER_PYTHON");
  EXPECT_FALSE(fs::exists(folder_ / "compare.pdf"));

  // A failed run can be looked at.
  EXPECT_EQ(breakwater({"report", "failed", "kfd", "--out", "page"}).status, 0);
  EXPECT_NE(text_of(folder_ / "page/report.html").find("This run failed at 2"), std::string::npos);
}

TEST_F(Reports, RunsAreToldApartByTheKeysInWhichTheyDiffer) {
  make_run("motor_estimation", "a", {"--case", "kfd", "--duration", "6"});
  make_run("motor_estimation", "b", {"--case", "kfd", "--duration", "6", "--set", "run.seed=7"});
  make_run("motor_estimation", "c", {"--case", "mdob", "--duration", "6"});
  const ProgramResult result = breakwater({"compare", "a", "b", "--out", "page"});
  ASSERT_EQ(result.status, 0) << result.err;
  EXPECT_NE(result.out.find("kfd, run.seed=7"), std::string::npos) << result.out;
  const std::string html = text_of(folder_ / "page/compare.html");
  EXPECT_NE(html.find("<code>run.seed</code></th><td>1</td><td>7</td>"), std::string::npos);
  EXPECT_NE(html.find("class=\"replay\""), std::string::npos);
  // A report says what is not as in the case, and has no column for a thesis that says nothing.
  ASSERT_EQ(breakwater({"report", "b", "--out", "page", "--no-replay"}).status, 0);
  const std::string report = text_of(folder_ / "page/report.html");
  EXPECT_NE(report.find("<code>run.seed</code></th><td>7</td>"), std::string::npos);
  EXPECT_EQ(report.find(">thesis</th>"), std::string::npos);
  EXPECT_EQ(report.find("class=\"replay\""), std::string::npos);
  // What is true, measured and estimated of the angle is one chart.
  const std::size_t chart = report.find("position [rad]");
  ASSERT_NE(chart, std::string::npos);
  EXPECT_NE(report.find("position_true_rad", chart), std::string::npos);
  // A signal of one run alone.
  const ProgramResult lacking = breakwater(
      {"compare", "a", "c", "--signal", "innovation", "--out", "page", "--no-replay", "--svg"});
  ASSERT_EQ(lacking.status, 0) << lacking.err;
  EXPECT_NE(text_of(folder_ / "page/compare.html").find("mdob: –"), std::string::npos);
  expect_refused({"compare", "a", "b", "--from", "3", "--to", "2"}, "must rise");
}

// Six seeds of two cases: the row is what their metrics.json say, pair by pair, and all six of one
// sign have a probability of 2/64.
TEST_F(Reports, CompareOfSetsOfRunsIsPairedBySeed) {
  std::vector<std::string> words = {
      "compare", "--paired", "--metric", "rmse_velocity_rad_s", "--goal", "rmse_velocity_rad_s=min",
      "--out",   "compared"};
  std::vector<double> differences;
  for (int seed = 1; seed <= 6; ++seed) {
    double values[2];
    int i = 0;
    for (const std::string name : {"kfd", "stf"}) {
      const std::string folder = name + std::to_string(seed);
      make_run("motor_estimation", folder,
               {"--case", name, "--seed", std::to_string(seed), "--duration", "11", "--set",
                "noise.std_rad=0.01"});
      words.push_back(folder);
      values[i++] = nlohmann::json::parse(text_of(folder_ / folder / "metrics.json"))
                        .at("rmse_velocity_rad_s");
    }
    differences.push_back(values[1] - values[0]);
    ASSERT_LT(differences.back(), 0.0);
  }
  std::sort(differences.begin(), differences.end());
  ProgramResult result = breakwater(words);
  ASSERT_EQ(result.status, 0) << result.err;
  EXPECT_NE(result.out.find("better"), std::string::npos) << result.out;
  std::istringstream table(text_of(folder_ / "compared/comparison.csv"));
  const auto row = [&table] {
    std::string line;
    std::getline(table, line);
    std::vector<std::string> cells;
    std::istringstream stream(line);
    for (std::string cell; std::getline(stream, cell, ',');) cells.push_back(cell);
    return cells;
  };
  const std::vector<std::string> names = row(), cells = row();
  const auto cell = [&](const std::string& name) {
    const auto found = std::find(names.begin(), names.end(), name);
    return cells.at(static_cast<std::size_t>(found - names.begin()));
  };
  EXPECT_EQ(cell("candidate") + cell("reference") + cell("pairs"), "stfkfd6");
  EXPECT_DOUBLE_EQ(std::stod(cell("difference")), 0.5 * (differences[2] + differences[3]));
  EXPECT_DOUBLE_EQ(std::stod(cell("p")), 2.0 / 64.0);
  EXPECT_EQ(cell("verdict"), "better");

  // The other way round it is worse; a seed that one case lacks makes no pair.
  words.insert(words.end(), {"--baseline", "stf"});
  words.erase(std::find(words.begin(), words.end(), "kfd6"));
  result = breakwater(words);
  ASSERT_EQ(result.status, 0) << result.err;
  EXPECT_EQ(text_of(folder_ / "compared/comparison.csv").find("kfd,stf,6"), std::string::npos);
  EXPECT_NE(text_of(folder_ / "compared/comparison.csv").find("kfd,stf,5"), std::string::npos);

  expect_refused({"compare", "--paired", "kfd1", "kfd2"},
                 "all runs are of one case: there is nothing to compare");
  expect_refused({"compare", "--paired", "kfd1", "stf2"}, "no seed is common to all cases");
  expect_refused({"compare", "--paired", "kfd1", "stf1", "--baseline", "st"},
                 "--baseline: st: no run has it (did you mean stf?)");
  expect_refused({"compare", "--paired", "kfd1", "stf1", "--goal", "rmse_velocity=min"},
                 "--goal: rmse_velocity: no run has it");
  expect_refused({"compare", "--paired", "kfd1", "kfd1", "stf1"}, "is there twice");
}

// Folder names are what they are: no mathematics of matplotlib's, no formula of a spreadsheet's.
TEST_F(Reports, CompareTakesAnyFolderNameForText) {
  make_run("motor_estimation", "$\\bad{$", {"--case", "kfd"});
  make_run("motor_estimation", "=cmd|calc", {"--case", "kfd"});
  const ProgramResult result =
      breakwater({"compare", "$\\bad{$", "=cmd|calc", "--out", "both", "--csv", "--svg", "--signal",
                  "d_hat_Nm", "--no-replay", "--quiet"});
  EXPECT_EQ(result.status, 0);
  EXPECT_EQ(result.err, "");
  EXPECT_TRUE(fs::exists(folder_ / "both/compare.svg"));
  const std::string csv = text_of(folder_ / "both/compare.csv");
  EXPECT_TRUE(csv.starts_with("metric,unit,$\\bad{$,'=cmd|calc,'=cmd|calc minus $\\bad{$\n"))
      << csv.substr(0, csv.find('\n'));
}

TEST_F(Reports, AMetricThatIsNamedAsAFormulaIsRefused) {
  for (const char* name : {"a", "b"}) make_run("motor_estimation", name, {"--case", "kfd"});
  std::ofstream(folder_ / "b/metrics.json") << R"({"=cmd|calc": 1.0})";
  const ProgramResult result = breakwater({"compare", "a", "b", "--csv"});
  EXPECT_EQ(result.status, 2);
  EXPECT_EQ(result.err,
            "b/metrics.json: a metric cannot be named \"=cmd|calc\": a name is letters from A to Z "
            "or a to z, digits and _\n");
}

TEST_F(Reports, CompareWritesTablesAndFigures) {
  for (const char* name : {"kfd", "dkf"}) make_run("motor_estimation", name, {"--case", name});
  const ProgramResult result =
      breakwater({"compare", "kfd", "dkf", "--out", "both", "--csv", "--latex", "--svg", "--pdf",
                  "--signal", "d_hat_Nm", "--metric", "rmse_velocity_rad_s"});
  ASSERT_EQ(result.status, 0) << result.err;
  EXPECT_NE(result.out.find("rmse_velocity_rad_s"), std::string::npos);
  EXPECT_NE(result.out.find("-98."), std::string::npos) << result.out;
  EXPECT_EQ(lines_of(text_of(folder_ / "both/compare.csv")), 2);
  EXPECT_NE(text_of(folder_ / "both/compare.tex").find("RMSE velocity [rad/s] &"),
            std::string::npos);
  const std::string svg = text_of(folder_ / "both/compare.svg");
  EXPECT_NE(svg.find("<svg"), std::string::npos);
  EXPECT_EQ(svg.find("<text"), std::string::npos) << "letters are outlines";
  const std::string pdf = text_of(folder_ / "both/compare.pdf");
  EXPECT_TRUE(pdf.starts_with("%PDF"));
  EXPECT_NE(pdf.find("/FontFile2"), std::string::npos) << "the font is in it, as TrueType";
  EXPECT_EQ(pdf.find("/Type3"), std::string::npos);
  const std::string html = text_of(folder_ / "both/compare.html");
  EXPECT_NE(html.find("signal-1"), std::string::npos);
  EXPECT_EQ(html.find("signal-2"), std::string::npos);
}

}  // namespace
}  // namespace breakwater
