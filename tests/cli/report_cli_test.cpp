
#include <csignal>
#include <nlohmann/json.hpp>
#include <sstream>

#include <breakwater/record/file_hash.h>
#include <breakwater/study/shards.h>
#include "cli/program.h"
#include "environment.h"
#include "support.h"

namespace breakwater {
namespace {
namespace fs = std::filesystem;

using testing::ProgramResult;

// Two runs with logs, a table row, and many small runs.
const char* const kExperiments = R"(
[form.motor]
panels = [{ title = "disturbance", signals = ["d_hat_Nm"], once = ["d_true_Nm"] }]

[[section]]
id = "4.3.2"
group = "motor"
title = "Behind an encoder"
text = "A few."
docs = "explanation/methods/disturbance-kalman-filters.md"

runs = [
  { name = "one-kfd", scenario = "motor_estimation", case = "kfd", sets = ["control.period_s=1e-3", "encoder.bits=12"] },
  { name = "one-fakfd-0998", scenario = "motor_estimation", case = "fakfd-0998", sets = ["control.period_s=1e-3", "encoder.bits=12"] },
  { name = "many", scenario = "motor_estimation", case = "vfakfd", sets = ["noise.std_rad=0.01", "run.duration_s=15"], seeds = [20, 20] },
]
figures = [{ n = "4.34", title = "Two", form = "motor", runs = [["one-kfd", "KFD"], ["one-fakfd-0998", "FAKFD"]] }]

[[section.table]]
title = "A part of Table 4.8"
columns = ["KFD", "FAKFD"]
cells = [
  { row = "12 bits", column = "KFD", printed = "motor_estimation.table_4_8.Ts_1e-3.n12[2]", run = "one-kfd", metric = "rmse_velocity_rad_s" },
  { row = "12 bits", column = "FAKFD", printed = "motor_estimation.table_4_8.Ts_1e-3.n12[5]", run = "one-fakfd-0998", metric = "rmse_velocity_rad_s" },
]

[[section.table]]
title = "Many"
columns = ["measured"]
cells = [{ row = "velocity", says = "is small", below = 1.0, run = "many", metric = "rmse_velocity_rad_s" }]
)";

class Reports : public testing::ProgramTest {
 protected:
  Reports() { write("tiny.toml", kExperiments); }

  ProgramResult reproduce(const std::string& out, const testing::Moment& when = nullptr) {
    return run("breakwater reproduce --experiments tiny.toml --out " + out, when, SIGKILL);
  }
  // Makes a run of the motor in folder NAME.
  void motor(const std::string& name, const std::string& options) {
    ran("motor_estimation --quiet --out '" + name + "' " + options);
  }
};

TEST_F(Reports, AKilledReproductionContinuesToTheSamePage) {
  const ProgramResult whole = done(reproduce("whole"));
  EXPECT_TRUE(
      has(whole.out, "2 reproduced, 0 within the class, 0 not reproduced, 1 held, 0 did not hold"));
  EXPECT_TRUE(has(whole.out, "report: whole/report.html"));
  const std::string page = read("whole/report.html");
  EXPECT_TRUE(has(page, "Permission is hereby granted")) << "dygraphs' licence";

  std::size_t kills = 0;
  for (const std::size_t count : {1, 6, 12}) {
    kills += reproduce("killed", has_results("killed", count)).status == 128 + SIGKILL ? 1 : 0;
  }
  EXPECT_GE(kills, 1U);
  const std::size_t before = results_in_shards("killed").size();
  done(reproduce("killed"));
  EXPECT_GT(before, 0U);
  EXPECT_EQ(read("killed/report.html"), read("whole/report.html"));
  // No run occurs twice.
  EXPECT_EQ(results_by_key(folder_ / "killed/shards").size(), 22U);
  EXPECT_LE(results_in_shards("killed").size(), 22 + 2 * kills)
      << "only what was cut off may be repeated";
  // No incomplete file remains.
  for (const auto& entry : fs::directory_iterator(folder_ / "killed/runs")) {
    EXPECT_TRUE(fs::exists(entry.path() / "manifest.json")) << entry.path();
  }

  EXPECT_TRUE(has(reproduce("killed").err, "22 runs, 22 of them there already"));
}

TEST_F(Reports, AnAlteredMeasurementFlipsItsVerdict) {
  done(reproduce("out"));
  EXPECT_TRUE(lacks(read("out/report.html"), "class=\"verdict off\""));
  const std::string hash = state_hash("out/runs/one-kfd");
  std::vector<std::string> lines = results_in_shards("out");
  std::erase_if(lines, [&](const std::string& line) { return !has(line, hash); });
  const std::string name = "\trmse_velocity_rad_s=";
  std::string altered_line = lines.at(0).substr(17);
  const std::size_t value = altered_line.find(name) + name.size();
  altered_line.replace(value, altered_line.find('\t', value) - value, "0.9");
  write("out/shards/later.shard", text_hash(altered_line) + '\t' + altered_line + '\n');
  EXPECT_TRUE(
      has(reproduce("out").out, "1 reproduced, 0 within the class, 1 not reproduced, 1 held"));
  EXPECT_TRUE(has(read("out/report.html"), "class=\"verdict off\""));
}

// Statements about one short run with a log, one for each of `rows`.
std::string statements(const std::vector<std::string>& rows, const std::string& sets = "") {
  std::string text = R"(
[form.motor]
panels = [{ title = "velocity", signals = ["velocity_true_rad_s"] }]
[[section]]
id = "1"
group = "motor"
title = "Mine"
figures = [{ n = "1", title = "One", form = "motor", run = "one" }]
runs = [{ name = "one", scenario = "motor_estimation", case = "kfd", )";
  text += "sets = [\"run.duration_s=2\", \"metrics.from_s=1\", \"metrics.to_s=2\"" + sets +
          "] }]\n[[section.table]]\ntitle = \"Statements\"\ncolumns = [\"one\"]\ncells = [\n";
  int number = 0;
  for (const std::string& row : rows) {
    text += "  { row = \"" + std::to_string(++number) + "\", says = \"so\", run = \"one\", " + row +
            " },\n";
  }
  return text + "]\n";
}

TEST_F(Reports, OwnStatementsHoldOrDoNotHoldOrAreNotMeasured) {
  write("tiny.toml",
        "title = \"My motor\"\n" +
            statements(
                {"metric = \"rmse_velocity_rad_s\", below = 1e3",
                 "metric = \"rmse_velocity_rad_s\", above = 1e3",
                 // 2 s with a step at 1 s are too short for the KFD to settle, so there is no time.
                 "metric = \"disturbance_settling_time_s\", absent = \"never\", above = 0.0",
                 "metric = \"rmse_velocity_rad_s\", over = \"one\", above = 1.0"}));
  const ProgramResult result = done(reproduce("out"));
  EXPECT_TRUE(has(result.out, "2 held, 1 did not hold, 1 not measured\n"));
  EXPECT_TRUE(lacks(result.out, "reproduced,"));
  const std::string html = read("out/report.html");
  EXPECT_TRUE(has(html, "<h1>My motor</h1>"));
  EXPECT_TRUE(lacks(html, "The thesis, reproduced"));
  EXPECT_TRUE(has(html, ">holds<", ">does not hold<", "class=\"verdict unknown\""));
  EXPECT_TRUE(lacks(html, ">reproduced<"));
}

TEST_F(Reports, ShowsCellsWithoutVerdictAndReasonsOfFailures) {
  write("tiny.toml",
        statements(
            {"metric = \"rmse_velocity_rad_s\", below = 0.0, why = \"since it is, \\\"truly\\\"\"",
             "metric = \"rmse_velocity_rad_s\", over_metric = \"rmse_raw_velocity_rad_s\", above "
             "= 0.0",
             "metric = \"rmse_velocity_rad_s\", below = 1e3, vacuous = \"it stands\"",
             "metric = \"rmse_velocity_rad_s\", below = 1e3, reading = \"it is lighter\"",
             "metric = \"rmse_velocity_rad_s\", below = 0.0, reading = \"it is lighter\"",
             "metric = \"rmse_velocity_rad_s\", above = 1e-9, reading = \"it moves\""}) +
            R"(
[[section.table]]
title = "beside"
columns = ["c"]
cells = [{ row = "r", shows = "what is not claimed", run = "one", metric = "peak_position_rad" }]
note = "Two gains for one cell."
)");
  const ProgramResult result = done(reproduce("out"));
  EXPECT_TRUE(has(result.out, "1 held, 1 did not hold; beside them 1 vacuous\n",
                  "did not hold:\n  1, 1: ", ", so (holds if below 0)\n"));
  const std::string html = read("out/report.html");
  EXPECT_TRUE(has(html, "since it is, &quot;truly&quot;", "what is not claimed",
                  "beside the rest, not judged", "among them: 1 vacuous, which hold by",
                  "2 results.", "Two gains for one cell."));

  const std::string list = read("out/verdicts.csv");
  EXPECT_EQ(lines("out/verdicts.csv").size(), 8U) << list;
  EXPECT_TRUE(list.starts_with("section,table,row,column,run,metric,")) << list;
  EXPECT_TRUE(has(list, "does not hold,,\"since it is, \"\"truly\"\"\"",
                  ",one,rmse_velocity_rad_s,one,rmse_raw_velocity_rad_s,",
                  ",what is not claimed,,shown,", ",vacuous,,it stands\n",
                  ",other reading: does not hold,,it is lighter\n",
                  ",other reading: holds,,it moves\n"));
}

TEST_F(Reports, AnUnknownMetricIsAnErrorOfTheList) {
  const std::string misspelt =
      "metric: no run of motor_estimation has rmse_velocty_rad_s (did you mean "
      "rmse_velocity_rad_s?)";
  for (const auto& [metric, line] :
       Refusals{{"rmse_velocty_rad_s", misspelt}, {"|rmse_velocty_rad_s|", misspelt}}) {
    write("tiny.toml", statements({"metric = \"rmse_velocity_rad_s\", below = 1e3",
                                   "metric = \"" + metric + "\", above = 0.0"}));
    const ProgramResult result = reproduce("out --quiet");
    EXPECT_EQ(result.status, 2);
    // The last row before the closing line of the list.
    EXPECT_EQ(result.err,
              "tiny.toml:" + std::to_string(lines("tiny.toml").size() - 1) + ": " + line + "\n");
    EXPECT_FALSE(fs::exists(folder_ / "out/report.html"));
  }
}

TEST_F(Reports, ResultsOfDifferentModelsAreNotMixed) {
  const std::string own = testing::text_of(testing::source_file("models/motor.xml"));
  write("motor.xml", own);
  write("tiny.toml",
        statements({"metric = \"peak_position_rad\", below = 1e3"}, ", \"model.mjcf=motor.xml\""));
  const auto state = [&] { return state_hash("out/runs/one"); };
  done(reproduce("out"));
  const std::string page = read("out/report.html");
  const std::string first = state();

  write("motor.xml", testing::replaced(own, "0.6 0.6 1", "0.9 0.9 1.5"));
  done(reproduce("out"));
  EXPECT_NE(read("out/report.html"), page);
  EXPECT_NE(state(), first);

  write("motor.xml", own);
  done(reproduce("out"));
  EXPECT_EQ(state(), first) << "the folder is of the model that gave the numbers";
  EXPECT_EQ(read("out/report.html"), page);
  EXPECT_EQ(results_in_shards("out").size(), 3U) << "two models, and the figure's run again";

  // Included files are part of the model.
  write("motor.xml",
        testing::replaced(own, "<worldbody>", "<include file=\"more.xml\"/><worldbody>"));
  write("more.xml", "<mujoco><option gravity=\"0 0 0\"/></mujoco>");
  done(reproduce("out"));
  EXPECT_TRUE(has(reproduce("out").err, "1 runs, 1 of them there already"));
  write("more.xml", "<mujoco><option gravity=\"0 0 -1\"/></mujoco>");
  EXPECT_TRUE(has(reproduce("out").err, "1 runs, 0 of them there already"));
}

TEST_F(Reports, FiguresSayWhichPackagesAreMissing) {
  motor("kfd", "--case kfd --duration 6");
  // Without Python, and with a Python that lacks the packages.
  write("bare", "#!/bin/sh\nexec /usr/bin/python3 -S -E \"$@\"\n");
  fs::permissions(folder_ / "bare", fs::perms::owner_all);
  for (const auto& [python, line] :
       Refusals{{"/nowhere/python3",
                 "figures (python3-matplotlib): /nowhere/python3 cannot be called "
                 "(No such file or directory)"},
                {folder_ / "bare",
                 "figures.py: matplotlib is missing: apt-get install python3-matplotlib"}}) {
    const testing::Environment asked("BREAKWATER_PYTHON", python);
    expect_refused("breakwater compare kfd kfd --signal d_hat_Nm --pdf", line);
  }
}

TEST_F(Reports, AFailedRunHasOne) {
  motor("kfd", "--case kfd --duration 6");
  EXPECT_EQ(run("motor_estimation --quiet --duration 6 --set fault.sensor=angle fault.at_s=2 "
                "--out failed")
                .status,
            3);
  ran("breakwater report failed kfd --out page");
  EXPECT_TRUE(has(read("page/report.html"), "This run failed at 2"));
}

TEST_F(Reports, DiffFindsTheFirstSampleThatDiffers) {
  motor("a", "--duration 6");
  motor("again", "--duration 6");
  motor("noisy", "--duration 6 --set noise.std_rad=1e-4");
  motor("longer", "--set run.duration_s=6.001");
  motor("mdob", "--duration 6 --case mdob");
  EXPECT_EQ(run("motor_estimation --quiet --out failed --duration 6 --set fault.sensor=angle "
                "fault.at_s=2")
                .status,
            3);
  ran("cart_position --quiet --duration 0.1 --out cart");
  struct Row {
    const char* runs;
    int status;
    std::string first_line;  // first line of the output
    std::string also;
  };
  const std::vector<Row> rows = {
      {"a again", 0, "", ""},
      {"a noisy", 1, "control/applied_Nm at 0 s: 0 and ", "\nnoise.std_rad: 0 and 0.0001\n"},
      {"a noisy --quiet", 1, "", ""},
      {"a longer", 1, "control: 6001 and 6002 rows\n", "\nrun.duration_s: 6 and 6.001\n"},
      {"a mdob", 1, "control/", "\nonly a has the signals: control/innovation control/lambda\n"},
      {"mdob a", 1, "control/", "\ncontrol/poles_discrete_re: 2 and 3 columns\n"},
      {"a failed", 1, "control: 6001 and 2000 rows\n",
       "\nresult: complete and failed at 2 s (sensor angle is not finite)\n"},
      {"a cart", 1, "scenario: motor_estimation and cart_position\n", ""}};
  for (const Row& row : rows) {
    const ProgramResult result = run("breakwater diff " + std::string(row.runs));
    EXPECT_EQ(result.status, row.status) << row.runs << result.err;
    EXPECT_TRUE(result.out.starts_with(row.first_line)) << row.runs << '\n' << result.out;
    EXPECT_TRUE(has(result.out, row.also)) << row.runs << '\n' << result.out;
    if (row.first_line.empty()) {
      EXPECT_EQ(result.out, "") << row.runs;
    }
  }
}

TEST_F(Reports, LabelsOfRunsHaveTheKeysInWhichTheyDiffer) {
  motor("a", "--case kfd --duration 6");
  motor("b", "--case kfd --duration 6 --set run.seed=7");
  motor("c", "--case mdob --duration 6");
  EXPECT_TRUE(has(ran("breakwater compare a b --out page").out, "kfd, run.seed=7"));
  const std::string html = read("page/compare.html");
  EXPECT_TRUE(has(html, "run.seed</th><td>1</td><td>7</td>", "class=\"replay\""));
  // A report names the changed keys. It has no column for missing reference values.
  ran("breakwater report b --out page --no-replay");
  const std::string report = read("page/report.html");
  EXPECT_TRUE(has(report, "run.seed</th><td>7</td>"));
  EXPECT_TRUE(lacks(report, ">thesis ", "class=\"replay\""));
  // The shot list's key charts come first; what is true and estimated angle are in one of them.
  EXPECT_TRUE(has(report, "Chart of Angle [rad] over time; true from"));
  EXPECT_LT(report.find("Chart of Angle [rad]"), report.find("All metrics</h3>"));
  // A signal that only one run has.
  ran("breakwater compare a c --signal innovation --out page --no-replay --svg");
  EXPECT_TRUE(has(read("page/compare.html"), "mdob: –"));
}

// A metric of its own is no other plant.
TEST_F(Reports, ReportOfAPlantWithItsOwnMetricNamesTheChangedKeys) {
  ran("breakwater run plant --duration 1 --out own --set run.seed=7 "
      "metric.own.of=elbow_position_true_rad metric.own.kind=peak");
  ran("breakwater report own --out page --no-replay");
  EXPECT_TRUE(has(read("page/report.html"), "run.seed</th><td>7</td>"));
}

// Six seeds of two cases: the row agrees with metrics.json, pair by pair. If all six have the same
// sign, the probability is 2/64.
TEST_F(Reports, CompareOfSetsOfRunsIsPairedBySeed) {
  std::string words =
      "breakwater compare --paired --metric rmse_velocity_rad_s --goal rmse_velocity_rad_s=min "
      "--out compared";
  std::vector<double> differences;
  for (int seed = 1; seed <= 6; ++seed) {
    double values[2];
    int i = 0;
    for (const std::string name : {"kfd", "stf"}) {
      const std::string folder = name + std::to_string(seed);
      motor(folder, "--case " + name + " --seed " + std::to_string(seed) +
                        " --duration 11 --set noise.std_rad=0.01");
      words += " " + folder;
      values[i++] = json(folder + "/metrics.json").at("rmse_velocity_rad_s");
    }
    differences.push_back(values[1] - values[0]);
    ASSERT_LT(differences.back(), 0.0);
  }
  std::sort(differences.begin(), differences.end());
  EXPECT_TRUE(has(ran(words).out, "better"));
  const auto row = [&](std::size_t line) {
    std::vector<std::string> cells;
    std::istringstream stream(lines("compared/comparison.csv").at(line));
    for (std::string cell; std::getline(stream, cell, ',');) cells.push_back(cell);
    return cells;
  };
  const std::vector<std::string> names = row(0), cells = row(1);
  const auto cell = [&](const std::string& name) {
    const auto found = std::find(names.begin(), names.end(), name);
    return cells.at(static_cast<std::size_t>(found - names.begin()));
  };
  EXPECT_EQ(cell("candidate") + cell("reference") + cell("pairs"), "stfkfd6");
  std::vector<double> averages;
  for (std::size_t i = 0; i < differences.size(); ++i) {
    for (std::size_t j = i; j < differences.size(); ++j) {
      averages.push_back(0.5 * (differences[i] + differences[j]));
    }
  }
  EXPECT_DOUBLE_EQ(std::stod(cell("difference")), testing::median(averages));
  EXPECT_DOUBLE_EQ(std::stod(cell("p")), 2.0 / 64.0);
  EXPECT_EQ(cell("verdict"), "better");

  // In the reverse order it is worse. A seed that one case lacks makes no pair.
  ran(testing::replaced(words, " kfd6", "") + " --baseline stf");
  const std::string reversed = read("compared/comparison.csv");
  EXPECT_TRUE(lacks(reversed, "kfd,stf,6"));
  EXPECT_TRUE(has(reversed, "kfd,stf,5"));
  expect_refusals("breakwater compare --paired ",
                  {{"kfd1 kfd2", "--paired: all runs are of one case: there is nothing to compare"},
                   {"kfd1 stf2", "--paired: no seed is common to all cases"},
                   {"kfd1 stf1 --baseline st", "--baseline: st: no run has it (did you mean stf?)"},
                   {"kfd1 stf1 --goal rmse_velocity=min", "--goal: rmse_velocity: no run has it"},
                   {"kfd1 kfd1 stf1", "kfd1: kfd with seed 1 is there twice"}});

  // Other test conditions are named, within a case and between the cases.
  const std::string usual = " --seed 7 --set noise.std_rad=0.01 --case ";
  motor("kfd7", usual + "kfd --duration 12");
  motor("stf7", usual + "stf --duration 11");
  const std::string pair = "breakwater compare --paired kfd1 stf1 kfd7 stf7 --quiet";
  EXPECT_EQ(ran(pair).err,
            "compare: --paired: the runs differ in more than case and seed: run.duration_s (11; "
            "12)\n");
  EXPECT_EQ(ran("breakwater compare --paired kfd7 stf7 --quiet").err, ran(pair).err);
}

TEST_F(Reports, ThingsAreCalledWhatTheyAre) {
  EXPECT_TRUE(
      has(ran("motor_estimation --case stf --set observer.name=kfd --duration 0.3 --out tuned").out,
          "motor_estimation stf with kfd: 0.3 s simulated"));
  ran("breakwater report tuned --out made/rep.html --no-replay");
  EXPECT_TRUE(fs::is_regular_file(folder_ / "made/rep.html"));
  EXPECT_TRUE(has(ran("breakwater list --parts").out,
                  "\n  kelvin_voigt_clipped    spring and damper",
                  "\n  tracking_differentiator Han's"));
}

// Folder names are plain text: not mathematics for matplotlib, not a formula for a spreadsheet.
TEST_F(Reports, CompareTreatsFolderNamesAsText) {
  for (const char* name : {"$\\bad{$", "=cmd|calc"}) motor(name, "--case kfd");
  const ProgramResult result =
      ran("breakwater compare $\\bad{$ =cmd|calc --out both --csv --svg --signal d_hat_Nm "
          "--no-replay --quiet");
  EXPECT_EQ(result.err, "");
  EXPECT_TRUE(fs::exists(folder_ / "both/compare.svg"));
  // A file of settings in the working folder changes no figure.
  const std::string figure = read("both/compare.svg");
  write("matplotlibrc", "axes.facecolor: red\naxes.titlesize: 40\n");
  ran("breakwater compare $\\bad{$ =cmd|calc --out both --svg --signal d_hat_Nm --no-replay "
      "--quiet");
  EXPECT_EQ(read("both/compare.svg"), figure);
  const std::string csv = read("both/compare.csv");
  EXPECT_TRUE(csv.starts_with("metric,unit,$\\bad{$,'=cmd|calc,'=cmd|calc minus $\\bad{$\n"))
      << csv.substr(0, csv.find('\n'));
}

TEST_F(Reports, AMetricNamedLikeAFormulaIsRefused) {
  for (const char* name : {"a", "b"}) motor(name, "--case kfd");
  write("b/metrics.json", R"({"=cmd|calc": 1.0})");
  expect_refused("breakwater compare a b --csv",
                 "b/metrics.json: a metric cannot be named \"=cmd|calc\": a name is letters from A "
                 "to Z or a to z, digits and _");
}

TEST_F(Reports, CompareWritesTablesAndFigures) {
  for (const std::string name : {"kfd", "dkf"}) motor(name, "--case " + name);
  const ProgramResult result =
      ran("breakwater compare kfd dkf --out both --csv --latex --svg --pdf --signal d_hat_Nm "
          "--metric rmse_velocity_rad_s");
  EXPECT_TRUE(has(result.out, "rmse_velocity_rad_s", "-98."));
  EXPECT_TRUE(has(read("both/compare.html"), "RMSE of velocity is smallest for dkf (",
                  " and largest for kfd (", " % vs kfd"));
  EXPECT_EQ(lines("both/compare.csv").size(), 2U);
  EXPECT_TRUE(has(read("both/compare.tex"), "RMSE of velocity [rad/s] &"));
  const std::string svg = read("both/compare.svg");
  EXPECT_TRUE(has(svg, "<svg"));
  EXPECT_TRUE(lacks(svg, "<text")) << "letters are outlines";
  const std::string pdf = read("both/compare.pdf");
  EXPECT_TRUE(pdf.starts_with("%PDF"));
  EXPECT_TRUE(has(pdf, "/FontFile2")) << "the font is in it, as TrueType";
  EXPECT_TRUE(lacks(pdf, "/Type3"));
  const std::string html = read("both/compare.html");
  EXPECT_TRUE(has(html, "signal-1"));
  EXPECT_TRUE(lacks(html, "signal-2"));
}

}  // namespace
}  // namespace breakwater
