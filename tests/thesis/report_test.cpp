// What reports are made of: verdicts, measurements, tables, pages.
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <limits>
#include <nlohmann/json.hpp>
#include <regex>
#include <set>
#include <stdexcept>

#include <breakwater/experiment/runner.h>
#include <breakwater/experiment/saved_run.h>
#include <breakwater/pages/compare.h>
#include <breakwater/pages/html_page.h>
#include <breakwater/pages/latex.h>
#include <breakwater/pages/page_chart.h>
#include <breakwater/pictures/finished_run.h>
#include <breakwater/pictures/page_data.h>
#include <breakwater/record/csv.h>
#include <breakwater/thesis/experiments.h>
#include <breakwater/thesis/reproduction.h>
#include <breakwater/thesis/thesis_report.h>
#include "catalogue.h"
#include "support.h"

namespace breakwater {
namespace {

constexpr double kNever = std::numeric_limits<double>::infinity();

Experiments own_experiments(Effort effort = Effort::quick) {
  return read_experiments(testing::source_file("data/experiments.toml"), effort);
}

TEST(Verdict, NumbersHaveTwoBands) {
  Standard standard;
  standard.reproduced.relative = 0.05;
  standard.within.relative = 0.25;
  const PrintedResult printed{2.0, ""};
  EXPECT_EQ(judge(2.09, printed, standard), Verdict::reproduced);
  EXPECT_EQ(judge(2.11, printed, standard), Verdict::within_class);
  EXPECT_EQ(judge(1.51, printed, standard), Verdict::within_class);
  EXPECT_EQ(judge(1.49, printed, standard), Verdict::not_reproduced);
  EXPECT_EQ(judge(NAN, printed, standard), Verdict::not_measured);
  EXPECT_EQ(judge(kNever, printed, standard), Verdict::not_reproduced);
}

TEST(Verdict, WhatRoundsToThePrintedDigitsIsReproduced) {
  const PrintedResults& printed = printed_results();
  const auto half_unit = [&](const char* path) { return printed.find(path).value().half_unit; };
  EXPECT_DOUBLE_EQ(half_unit("motor_estimation.table_4_8.Ts_1e-2.n48[5]"), 0.05);     // 66.0
  EXPECT_DOUBLE_EQ(half_unit("motor_estimation.table_4_8.Ts_1e-2.n48[3]"), 0.5e-15);  // 1.00e-13
  EXPECT_DOUBLE_EQ(half_unit("cart_estimation.table_4_5.gamma_1_02.response_s"), 0.5);
  EXPECT_EQ(printed.find("motor_estimation.table_4_8.Ts_1e-2.n48[5]")->text(), "66.0");

  Standard standard;
  standard.reproduced.relative = 0.2;
  standard.within.relative = 0.5;
  const PrintedResult one_digit{0.01, "0.01", 0.005};
  EXPECT_EQ(judge(0.0149, one_digit, standard), Verdict::reproduced);
  EXPECT_EQ(judge(0.0051, one_digit, standard), Verdict::reproduced);
  EXPECT_EQ(judge(0.0151, one_digit, standard), Verdict::not_reproduced);
  const PrintedResult three_digits{0.0100, "0.0100", 0.00005};
  EXPECT_EQ(judge(0.0149, three_digits, standard), Verdict::within_class);
  // "461 s at least" asks for no number about 461.
  Standard at_least;
  at_least.reproduced.above = 1000.0;
  at_least.within.above = 500.0;
  EXPECT_EQ(judge(461.2, {461.0, "461", 0.5}, at_least), Verdict::not_reproduced);
}

TEST(Verdict, WordsAreDeserved) {
  const PrintedResults& printed = printed_results();
  const std::string path = "cart_estimation.table_4_4.ramp.first";
  const PrintedResult result = printed.find(path).value();
  EXPECT_EQ(result.word, "P");
  EXPECT_EQ(judge(0.049, result, printed.standard(path)), Verdict::reproduced);
  EXPECT_EQ(judge(0.051, result, printed.standard(path)), Verdict::not_reproduced);
  // A high sine is ignored: following it would be wrong.
  const std::string high = "cart_estimation.table_4_4.high_sine.first";
  EXPECT_EQ(judge(1.0, *printed.find(high), printed.standard(high)), Verdict::reproduced);
  EXPECT_EQ(judge(0.02, *printed.find(high), printed.standard(high)), Verdict::not_reproduced);
}

TEST(Verdict, NeverIsAnAnswer) {
  const PrintedResults& printed = printed_results();
  const std::string path = "cart_estimation.table_4_7.step.conventional";
  EXPECT_EQ(judge(kNever, *printed.find(path), printed.standard(path)), Verdict::reproduced);
  EXPECT_EQ(judge(5.0, *printed.find(path), printed.standard(path)), Verdict::not_reproduced);
}

// Every number of a page goes through here: what is measured decides, and nothing else.
TEST(Verdict, FlipsWithTheMeasuredValue) {
  CellSpec cell;
  cell.quantity.run = "any";
  cell.quantity.metric = "free_motion_time_s";
  cell.printed = "arm_wall_contact.force_2N.proposed.free_motion_time_s";
  const auto verdict = [&](std::vector<double> values) {
    Measured measured;
    for (const double value : values) {
      Measurement one;
      one.values["free_motion_time_s"] = value;
      measured["any"].push_back(one);
    }
    return judge_cell(cell, measured, printed_results()).verdict;
  };
  EXPECT_EQ(verdict({0.528}), Verdict::reproduced);
  EXPECT_EQ(verdict({0.560}), Verdict::within_class);
  EXPECT_EQ(verdict({0.700}), Verdict::not_reproduced);
  EXPECT_EQ(verdict({0.1, 0.528, 0.9}), Verdict::reproduced) << "the median decides";
  EXPECT_EQ(verdict({0.1, 0.2, 0.528}), Verdict::not_reproduced);
}

TEST(Verdict, AFailedRunIsNoSuccess) {
  CellSpec cell;
  cell.quantity.run = "any";
  cell.quantity.metric = "converged";
  cell.if_failed = 0.0;
  cell.printed = "quadrotor_waves.converges.ukf_second";
  Measured measured;
  measured["any"].resize(1);
  measured["any"][0].failed = true;
  EXPECT_EQ(judge_cell(cell, measured, printed_results()).verdict, Verdict::not_reproduced);
  cell.printed = "quadrotor_waves.converges.ekf_second";
  EXPECT_EQ(judge_cell(cell, measured, printed_results()).verdict, Verdict::reproduced);
}

TEST(Verdict, AFailedRunHoldsNothingUnlessTheCellSaysWhat) {
  CellSpec cell;
  cell.quantity.run = "any";
  cell.quantity.metric = "max_speed_m_s";
  cell.if_failed = std::numeric_limits<double>::quiet_NaN();
  cell.says = "breaks the limit";
  cell.holds.above = 1.0;
  Measured measured;
  measured["any"].resize(3);
  for (Measurement& run : measured["any"]) run.values["max_speed_m_s"] = 1.2;
  EXPECT_EQ(judge_cell(cell, measured, printed_results()).verdict, Verdict::reproduced);
  measured["any"][1].failed = true;
  EXPECT_EQ(judge_cell(cell, measured, printed_results()).verdict, Verdict::not_reproduced);
  EXPECT_EQ(judge_cell(cell, measured, printed_results()).measured, "1 of 3 runs fail");
  // The same where it is what others are divided by.
  measured["any"][1].failed = false;
  cell.over = Quantity{"other", cell.quantity.metric};
  measured["other"].resize(1);
  measured["other"][0].failed = true;
  EXPECT_EQ(judge_cell(cell, measured, printed_results()).verdict, Verdict::not_reproduced);
}

TEST(Verdict, AnAbsentMetricIsNotMeasuredUnlessTheCellSaysThatItMeansNever) {
  CellSpec cell;
  cell.quantity.run = "any";
  cell.quantity.metric = "setling_time_s";
  cell.says = "never settles";
  cell.holds.above = 1.0;
  Measured measured;
  measured["any"].resize(1);
  measured["any"][0].values["settling_time_s"] = 0.1;
  const Judged misspelt = judge_cell(cell, measured, printed_results());
  EXPECT_EQ(misspelt.verdict, Verdict::not_measured);
  EXPECT_EQ(misspelt.measured, "not measured");
  EXPECT_EQ(misspelt.numbers, 0U);
  cell.absent_is_never = true;
  EXPECT_EQ(judge_cell(cell, measured, printed_results()).verdict, Verdict::not_measured)
      << "no other run has it, so nothing says that it is a metric at all";
  measured["any"][0].absent.insert("setling_time_s");
  EXPECT_EQ(judge_cell(cell, measured, printed_results()).verdict, Verdict::reproduced);
  EXPECT_EQ(judge_cell(cell, measured, printed_results()).measured, "never");
  // What is there and no number is not measured, whatever absence means.
  measured["any"][0].values["setling_time_s"] = NAN;
  EXPECT_EQ(judge_cell(cell, measured, printed_results()).verdict, Verdict::not_measured);
}

TEST(Verdict, OneRunWithoutTheMetricLeavesTheCellNotMeasured) {
  CellSpec cell;
  cell.quantity.run = "any";
  cell.quantity.metric = "converged";
  cell.printed = "quadrotor_waves.converges.ukf_second";
  for (const bool is_share : {false, true}) {
    cell.is_share = is_share;
    Measured measured;
    measured["any"].resize(3);
    for (std::size_t i = 0; i < 2; ++i) measured["any"][i].values["converged"] = 1.0;
    const Judged judged = judge_cell(cell, measured, printed_results());
    EXPECT_EQ(judged.verdict, Verdict::not_measured);
    EXPECT_EQ(judged.numbers, 2U);
  }
}

TEST(Verdict, APartOfNothingIsNotMeasured) {
  CellSpec cell;
  cell.quantity = {"any", "peak_N"};
  cell.over = Quantity{"other", "peak_N"};
  cell.absent_is_never = true;
  cell.says = "any number at all";
  cell.holds.above = -1e300;
  Measured measured;
  measured["any"].resize(1);
  measured["any"][0].values["peak_N"] = 1.0;
  measured["other"].resize(1);
  Measurement& other = measured["other"][0];
  const auto verdict = [&] { return judge_cell(cell, measured, printed_results()).verdict; };
  for (const double nothing : {0.0, -0.0, double(NAN), kNever}) {
    other.values["peak_N"] = nothing;
    EXPECT_EQ(verdict(), Verdict::not_measured) << nothing;
  }
  other.values.clear();
  other.absent.insert("peak_N");
  EXPECT_EQ(verdict(), Verdict::not_measured) << "a part of never";
  other.values["peak_N"] = 2.0;
  EXPECT_EQ(verdict(), Verdict::reproduced);
}

TEST(Verdict, OverAnotherMetricOfTheSameRunIsThePartOfEachRun) {
  CellSpec cell;
  cell.quantity = {"any", "|error_N|"};
  cell.over = Quantity{"any", "error_of_zero_N"};
  cell.divisor = 2.0;
  cell.says = "a part";
  cell.holds.above = 1.0;
  Measured measured;
  measured["any"].resize(3);
  const std::vector<std::pair<double, double>> errors = {{-6.0, 1.0}, {8.0, 2.0}, {10.0, 10.0}};
  for (std::size_t i = 0; i < 3; ++i) {
    measured["any"][i].values = {{"error_N", errors[i].first},
                                 {"error_of_zero_N", errors[i].second}};
  }
  EXPECT_EQ(values_of(cell, measured), (std::vector<double>{3.0, 2.0, 0.5}));
  EXPECT_EQ(judge_cell(cell, measured, printed_results()).median, 2.0);
  // Of another run: all over its median.
  measured["other"] = measured["any"];
  cell.over->run = "other";
  EXPECT_EQ(values_of(cell, measured), (std::vector<double>{1.5, 2.0, 2.5}));
}

TEST(Verdict, WhatIsShownHasNone) {
  CellSpec cell;
  cell.quantity = {"any", "peak_N"};
  cell.shows = "not claimed";
  Measured measured;
  measured["any"].resize(1);
  measured["any"][0].values["peak_N"] = 3.0;
  const Judged judged = judge_cell(cell, measured, printed_results());
  EXPECT_EQ(judged.measured, "3");
  EXPECT_EQ(verdict_word(judged, cell, false), "shown");
}

TEST(Verdict, WhatHoldsByConstructionIsVacuousAndAHypothesisIsCalledSo) {
  CellSpec cell;
  cell.quantity = {"any", "peak_N"};
  cell.says = "small";
  cell.holds.below = 2.0;
  Measured measured;
  measured["any"].resize(1);
  double& peak = measured["any"][0].values["peak_N"];
  const auto word_and_reason = [&](double value) {
    peak = value;
    const Judged judged = judge_cell(cell, measured, printed_results());
    return verdict_word(judged, cell, false) + ", " + reason_of(judged, cell, {});
  };
  cell.why = "too hard";
  cell.vacuous = "nothing moves";
  EXPECT_EQ(word_and_reason(1.0), "vacuous, nothing moves");
  EXPECT_EQ(word_and_reason(3.0), "not reproduced, too hard") << "so it was no construction";
  cell.vacuous = "";
  cell.hypothesis = "if it were soft";
  EXPECT_EQ(word_and_reason(1.0), "hypothesis: reproduced, if it were soft");
  EXPECT_EQ(word_and_reason(3.0), "hypothesis: not reproduced, if it were soft");
}

TEST(Verdict, SixOfTenDoNotConverge) {
  CellSpec cell;
  cell.quantity.run = "any";
  cell.quantity.metric = "converged";
  cell.is_share = true;
  cell.printed = "quadrotor_waves.converges.ukf_second";
  Measured measured;
  measured["any"].resize(10);
  for (Measurement& run : measured["any"]) run.values["converged"] = 1.0;
  EXPECT_EQ(judge_cell(cell, measured, printed_results()).verdict, Verdict::reproduced);
  for (std::size_t i = 0; i < 4; ++i) measured["any"][i].values["converged"] = 0.0;
  EXPECT_EQ(judge_cell(cell, measured, printed_results()).verdict, Verdict::not_reproduced);
}

TEST(Median, IsInTheMiddle) {
  EXPECT_EQ(median({3.0, 1.0, 2.0}), 2.0);
  EXPECT_EQ(median({4.0, 1.0, 2.0, 3.0}), 2.5);
  EXPECT_EQ(median({1.0, kNever, kNever}), kNever);
}

TEST(Measurement, IsWhatTheShardKept) {
  const auto folder = testing::temporary_path("shards");
  const testing::Removed removed(folder);
  std::filesystem::create_directories(folder);
  {
    Shard shard(folder);
    PointResult result;
    result.key = "complete";
    result.metrics = {{"max d_hat_Nm", NAN}, {"a_m", kNever}, {"b_m", 1.0}};
    shard.add(result);
    result.key = "failed";
    result.status = PointStatus::failed;
    result.reason = "at 3 s: diverged";
    result.metrics.clear();
    shard.add(result);
  }
  const auto results = results_by_key(folder);
  const Measurement complete = measurement_of(results.at("complete"));
  EXPECT_FALSE(complete.failed);
  // The run has them, but they are no finite numbers: not measured, and not absent.
  EXPECT_TRUE(std::isnan(complete.values.at("max d_hat_Nm")));
  EXPECT_TRUE(std::isnan(complete.values.at("a_m")));
  EXPECT_EQ(complete.values.at("b_m"), 1.0);
  const Measurement failed = measurement_of(results.at("failed"));
  EXPECT_TRUE(failed.failed);
  EXPECT_EQ(failed.failure, "at 3 s: diverged");
  EXPECT_TRUE(failed.values.empty());
}

TEST(Experiments, HaveEveryTableAndNinetyFigures) {
  const Experiments experiments = own_experiments();
  std::set<std::string> cells;
  std::set<std::string> figures;
  for (const SectionSpec& section : experiments.sections) {
    for (const TableSpec& table : section.tables) {
      for (const auto& row : table.cells) {
        for (const auto& cell : row) {
          if (cell) cells.insert(cell->printed);
        }
      }
    }
    for (const FigureSpec& figure : section.figures) {
      figures.insert(figure.number.substr(0, figure.number.find(' ')));
    }
  }
  EXPECT_GE(figures.size(), 119U);
  for (const char* path :
       {"offset_free.table_2_5.general_mpc.tracking", "cart_estimation.table_4_4.sine.second",
        "cart_estimation.table_4_5.gamma_1_00.response_s_at_least",
        "cart_estimation.table_4_7.sine.second_order_gamma",
        "motor_estimation.table_4_8.Ts_1e-2.n48[6]", "motor_estimation.table_4_9.variance_1e-4[6]",
        "quadrotor_waves.converges.ekf_none", "arm_wall_contact.force_5N.drac.mean_force_error_N",
        "arm_wall_contact.tuned.force_5N.peak_force_N"}) {
    EXPECT_TRUE(cells.contains(path)) << path;
  }
  // Every printed number and verdict is judged somewhere, 56 + 14 of the motor, 6 of the quadrotor,
  // 12 + 8 + 12 and 5 of the cart, 18 + 5 of the arm, but for two that are misprints.
  cells.erase("");
  EXPECT_EQ(cells.size(), 134U);
  for (const char* misprint :
       {"motor_estimation.table_4_8.Ts_1e-2.n48[0]", "motor_estimation.table_4_8.Ts_1e-3.n48[0]"}) {
    EXPECT_FALSE(cells.contains(misprint)) << misprint;
  }
}

// Entries are named there as "2.4.3.2: which".
TEST(Experiments, TheTablesOfClaimsNameEverySectionAndNoOther) {
  std::set<std::string> sections;
  for (const SectionSpec& section : own_experiments().sections) sections.insert(section.id);
  std::set<std::string> named;
  const std::regex row(R"(^[234][0-9.]*,.+,"?(none|as |the |beside: |Tables? |[0-9.]+: ).*$)");
  const std::regex place(R"((,"?|; )([234](\.[0-9])+): )");
  const std::filesystem::path tables = testing::source_file("docs/reference/thesis-claims");
  int rows = 0;
  for (const auto& table : std::filesystem::directory_iterator(tables)) {
    std::ifstream claims(table.path());
    std::string line;
    std::getline(claims, line);
    EXPECT_EQ(line, "section,claim,entry") << table.path();
    while (std::getline(claims, line)) {
      ++rows;
      EXPECT_TRUE(std::regex_match(line, row)) << table.path() << ": " << line;
      for (std::sregex_iterator match(line.begin(), line.end(), place), end; match != end;
           ++match) {
        named.insert((*match)[2]);
      }
    }
  }
  EXPECT_GT(rows, 120);
  EXPECT_EQ(named, sections);
}

TEST(Experiments, EveryCellOfOursIsSettled) {
  const Experiments experiments = own_experiments(Effort::full);
  for (const SectionSpec& section : experiments.sections) {
    EXPECT_FALSE(section.docs.empty());
    EXPECT_TRUE(std::filesystem::exists(testing::source_file("docs/" + section.docs)));
    for (const TableSpec& table : section.tables) {
      for (const auto& row : table.cells) {
        for (const auto& cell : row) {
          if (!cell) continue;
          if (!cell->printed.empty()) {
            EXPECT_NO_THROW(printed_results().standard(cell->printed)) << cell->printed;
          } else if (!cell->says.empty()) {
            EXPECT_TRUE(cell->holds.above || cell->holds.below) << cell->says;
          }
        }
      }
    }
  }
}

TEST(Experiments, MistakesAreSaidWithTheirLine) {
  const auto file = testing::temporary_path("experiments.toml");
  const testing::Removed removed(file);
  const auto message = [&](const std::string& text) -> std::string {
    std::ofstream(file) << text;
    try {
      read_experiments(file.string(), Effort::quick);
    } catch (const std::invalid_argument& error) {
      return error.what();
    }
    return "";
  };
  const std::string section = "[[section]]\nid = \"1\"\ngroup = \"arm\"\ntitle = \"t\"\n";
  EXPECT_EQ(message(section), "");
  EXPECT_NE(message(section + "colour = 1\n").find(":5: section.colour: unknown key"),
            std::string::npos);
  EXPECT_NE(message(section + "[[section.run]]\nname = \"{k}\"\n").find("there is no {k}"),
            std::string::npos);
  EXPECT_NE(message("[[section]\n").find(":1: "), std::string::npos);
  EXPECT_NE(message(section + "video = \"none\"\n").find("there is no run none"),
            std::string::npos);
  EXPECT_NE(message(section + "docs = \"nowhere.md\"\n")
                .find(":5: section.docs: there is no page docs/nowhere.md"),
            std::string::npos);
  EXPECT_NE(message("titel = \"t\"\n").find(":1: titel: unknown key (did you mean title?)"),
            std::string::npos);
  EXPECT_NE(message(section + "[[hero]]\nfigure = \"9\"\ncaption = \"c\"\n")
                .find(":5: there is no panel 0 of a figure 9"),
            std::string::npos);
  const std::string run = section +
                          "[[section.run]]\nname = \"x\"\nscenario = \"arm_push\"\n"
                          "case = \"c\"\n";
  const std::string spread = "spread = { key = \"k\", count = [1, 1], width = \"wide\" }\n";
  EXPECT_NE(message(run + spread).find(":9: section.run.spread.width: \"wide\" is no number"),
            std::string::npos);
  // A cell is made of the table's `cell` (line 11), its column (12) and its row (14); its own table
  // stands in the row.
  const auto of_cell = [&](const std::string& row) {
    return message(run +
                   "[[section.table]]\ntitle = \"t\"\ncell = { run = \"x\", below = 1.0 }\n"
                   "columns = [{ title = \"c\", key = \"k\", metric = \"m\" }]\n"
                   "rows = [\n  { title = \"r\", " +
                   row + " },\n]\n");
  };
  EXPECT_EQ(of_cell("says = \"s\""), "");
  EXPECT_EQ(of_cell("says = \"s\", absent = \"never\""), "");
  for (const auto& [row, part] : std::vector<std::pair<std::string, std::string>>{
           {"run = \"x\"",
            ":14: section.table.rows: a cell has either `printed`, `says` or `shows`"},
           {"says = \"s\", shows = \"t\"",
            ":14: section.table.rows: a cell has either `printed`, `says` or `shows`"},
           {"says = \"s\", vacuous = \"v\", hypothesis = \"h\"",
            ":14: section.table.rows: `vacuous` is neither"},
           {"shows = \"s\", vacuous = \"v\"",
            ":14: section.table.rows: `vacuous` is neither what `shows`"},
           {"says = \"s\", run = \"y\"", ":14: there is no run y (did you mean x?)"},
           {"says = \"s\", over = \"y\"", ":14: there is no run y"},
           {"says = \"s\", metric = \"{q}\"",
            ":14: section.table.rows.metric: \"{q}\": there is no {q}"},
           {"says = \"s\", divisor = 0", ":14: section.table.rows.divisor: must not be zero"},
           {"says = \"s\", divisor = \"a\"", ":14: section.table.rows.divisor: must be a number"},
           {"says = \"s\", statistic = \"shares\"",
            ":14: section.table.rows.statistic: \"shares\" must be"},
           {"says = \"s\", absent = \"nevr\"",
            ":14: section.table.rows.absent: \"nevr\" must be never"},
           {"says = \"s\", k = { below = \"a\" }",
            ":14: section.table.rows.k.below: must be a number"},
           {"says = \"s\", belwo = 2.0",
            ":14: section.table.rows.belwo: unknown key (did you mean below?)"},
           {"says = \"s\", k = { absnet = \"never\" }",
            ":14: section.table.rows.k.absnet: unknown key (did you mean absent?)"},
           {"printed = \"nowhere\"", ":14: nothing is printed at nowhere"}}) {
    EXPECT_NE(of_cell(row).find(part), std::string::npos) << of_cell(row);
  }
  EXPECT_EQ(message("x = 1").find(file.string() + ":1: "), 0U);
  std::filesystem::remove(file);
  EXPECT_THROW(read_experiments(file.string(), Effort::quick), std::invalid_argument);
}

TEST(Experiments, OnlyOursAreTheThesis) {
  EXPECT_FALSE(own_experiments().is_own);
  const auto file = testing::temporary_path("mine.toml");
  const testing::Removed removed(file);
  std::ofstream(file) << "title = \"Mine\"\n";
  const Experiments mine = read_experiments(file.string(), Effort::quick);
  EXPECT_TRUE(mine.is_own);
  EXPECT_EQ(mine.title, "Mine");
}

TEST(Score, SaysHeldOfWhatIsNotTheThesis) {
  Score score;
  EXPECT_EQ(score.text(), "0 reproduced, 0 within the class, 0 not reproduced");
  score.holds = 2;
  EXPECT_EQ(score.text(), "2 held, 0 did not hold");
  score.reproduced = 1;
  score.not_measured = 3;
  EXPECT_EQ(score.text(),
            "1 reproduced, 0 within the class, 0 not reproduced, 2 held, "
            "0 did not hold, 3 not measured");
  score.vacuous = 4;
  EXPECT_EQ(score.beside(), "4 vacuous");
  score.hypotheses = 6;
  score.hypotheses_hold = 5;
  EXPECT_TRUE(
      score.text().ends_with(", 3 not measured; beside them 4 vacuous, 5 of 6 hypotheses hold"))
      << score.text();
}

// A short run in a folder, to be damaged.
class DamagedRun : public ::testing::Test {
 protected:
  void SetUp() override {
    const std::string scenario = "motor_estimation";
    std::vector<PreparedRun> runs;
    runs.push_back(testing::prepare(scenario, testing::scenario_file(scenario).default_case(),
                                    {"run.duration_s=0.1"}));
    execute_runs(runs, {folder_}, {.csv = false, .quiet = true, .stop = nullptr});
    manifest_ = nlohmann::json::parse(std::ifstream(folder_ / "manifest.json"));
    metrics_ = nlohmann::json::parse(std::ifstream(folder_ / "metrics.json"));
  }

  // What each of those who read runs says; "" if nothing is wrong for it. Anything else than
  // std::invalid_argument would be called a defect.
  std::vector<std::string> complaints() const {
    std::vector<std::string> all;
    const auto listen = [&](auto&& open) {
      try {
        open();
        all.emplace_back();
      } catch (const std::invalid_argument& error) {
        all.emplace_back(error.what());
        EXPECT_EQ(all.back().find('\n'), std::string::npos) << all.back();
      }
    };
    listen([&] { const SavedRun run(folder_); });
    listen([&] { const FinishedRun run(testing::catalogue(), folder_); });
    return all;
  }

  const std::filesystem::path folder_ = testing::temporary_path("damaged");
  const testing::Removed removed_{folder_};
  nlohmann::json manifest_;
  nlohmann::json metrics_;
};

TEST_F(DamagedRun, EveryValueOfTheManifestMayBeWrong) {
  const std::set<std::string> needed = {"scenario", "case", "seed", "status"};
  const std::set<std::string> read = {"scenario", "case",   "seed",      "status",
                                      "program",  "models", "state_hash"};
  ASSERT_EQ(complaints(), std::vector<std::string>(2));
  ASSERT_EQ(manifest_["models"].size(), 1U);
  EXPECT_EQ(manifest_["models"]["models/motor.xml"].get<std::string>().size(), 16U);
  EXPECT_EQ(manifest_["program"].get<std::string>().size(), 16U);
  std::vector<std::string> keys;
  for (const auto& [key, value] : manifest_.items()) keys.push_back(key);
  for (const std::string& key : keys) {
    const auto refused = [&](const nlohmann::json& manifest, bool is_wrong) {
      std::ofstream(folder_ / "manifest.json") << manifest;
      for (const std::string& complaint : complaints()) {
        EXPECT_TRUE(!is_wrong || complaint.find("manifest.json: ") != std::string::npos)
            << key << " = " << manifest.value(key, nlohmann::json("missing")) << ": " << complaint;
      }
    };
    for (const char* wrong : {"null", "-1.5", "true", "\"\"", "[]", "{\"a\":{}}", "1e300"}) {
      nlohmann::json manifest = manifest_;
      manifest[key] = nlohmann::json::parse(wrong);
      const bool is_typed = manifest[key].type() != manifest_[key].type();
      refused(manifest, read.contains(key) && key != "state_hash" && is_typed);
    }
    nlohmann::json manifest = manifest_;
    manifest.erase(key);
    refused(manifest, needed.contains(key) || key == "state_hash");
  }
  for (const char* whole : {"", "{", "[]", "null", "{\"scenario\": 1, \"state_hash\": 2}"}) {
    std::ofstream(folder_ / "manifest.json") << whole;
    for (const std::string& complaint : complaints()) EXPECT_NE(complaint, "") << whole;
  }
  // A failed run says when and why.
  manifest_["status"] = "failed";
  std::ofstream(folder_ / "manifest.json") << manifest_;
  EXPECT_NE(complaints()[0].find("time_s: is missing"), std::string::npos);
  manifest_["time_s"] = "soon";
  manifest_["reason"] = "x";
  std::ofstream(folder_ / "manifest.json") << manifest_;
  EXPECT_NE(complaints()[0].find("time_s: must be a number"), std::string::npos);
  manifest_["time_s"] = 1.0;
  std::ofstream(folder_ / "manifest.json") << manifest_;
  EXPECT_EQ(complaints()[0], "");
}

TEST_F(DamagedRun, EveryValueOfTheMetricsMayBeWrong) {
  ASSERT_FALSE(metrics_.empty());
  for (const auto& [key, value] : metrics_.items()) {
    for (const char* wrong : {"true", "\"1\"", "[]", "{}"}) {
      nlohmann::json metrics = metrics_;
      metrics[key] = nlohmann::json::parse(wrong);
      std::ofstream(folder_ / "metrics.json") << metrics;
      EXPECT_NE(complaints()[0].find("metrics.json: " + key + ": must be a number"),
                std::string::npos)
          << complaints()[0];
    }
    nlohmann::json metrics = metrics_;
    metrics[key] = nullptr;
    std::ofstream(folder_ / "metrics.json") << metrics;
    EXPECT_EQ(complaints()[0], "");
    EXPECT_FALSE(SavedRun(folder_).metric(key));
    metrics.erase(key);
    std::ofstream(folder_ / "metrics.json") << metrics;
    EXPECT_EQ(complaints()[0], "");
  }
  for (const char* whole : {"", "{", "[1]", "3", "{\"a\": 1e999}"}) {
    std::ofstream(folder_ / "metrics.json") << whole;
    EXPECT_NE(complaints()[0].find("metrics.json: is no object of numbers"), std::string::npos);
  }
  std::filesystem::remove(folder_ / "metrics.json");
  EXPECT_NE(complaints()[0].find("it has no metrics.json"), std::string::npos);
}

TEST(SavedRun, UnitsAreTheEndsOfNames) {
  EXPECT_EQ(unit_of("rmse_velocity_rad_s"), "rad/s");
  EXPECT_EQ(unit_of("max_speed_m_s"), "m/s");
  EXPECT_EQ(unit_of("free_motion_time_s"), "s");
  EXPECT_EQ(unit_of("contact_impulse_Ns"), "N s");
  EXPECT_EQ(unit_of("bounce_count"), "");
}

TEST(Latex, HasNoCharacterOfItsOwn) {
  EXPECT_EQ(latex_escaped("peak_force 50 % {a} $x$ #1 & ~^\\"),
            "peak\\_force 50 \\% \\{a\\} \\$x\\$ \\#1 \\& "
            "\\textasciitilde{}\\textasciicircum{}\\textbackslash{}");
  EXPECT_EQ(latex_number(6.0461749), "6.046");
  EXPECT_EQ(latex_number(-3.2e-5), "$-3.2 \\times 10^{-5}$");
  EXPECT_EQ(latex_table({{"a", "b"}, {"1", "2"}}),
            "% needs \\usepackage{booktabs}\n\\begin{tabular}{lr}\n\\toprule\na & b \\\\\n"
            "\\midrule\n1 & 2 \\\\\n\\bottomrule\n\\end{tabular}\n");
}

TEST(Csv, QuotesWhatNeedsIt) {
  EXPECT_EQ(csv_line({"a", "b,c", "d\"e", ""}), "a,\"b,c\",\"d\"\"e\",\n");
}

TEST(Base64, IsThatOfRfc4648) {
  for (const auto& [plain, coded] : std::vector<std::pair<std::string, std::string>>{
           {"", ""}, {"f", "Zg=="}, {"fo", "Zm8="}, {"foo", "Zm9v"}, {"foobar", "Zm9vYmFy"}}) {
    EXPECT_EQ(base64(plain.data(), plain.size()), coded);
  }
}

TEST(Page, EscapesWhatComesFromRuns) {
  kainjow::mustache::data page;
  page.set("title", "<script>alert(1)</script> & co");
  page.set("scenario", "\"quoted\" <b>");
  PageChart chart;
  chart.id = "one";
  chart.group = "all";
  chart.title = "x</script><script>alert(2)</script>";
  chart.series.push_back({"a<b", "N", "\"", {{0.0, 1.0}, {1.0, 2.0}}});
  kainjow::mustache::data charts(kainjow::mustache::data::type::list);
  charts << chart_data(chart);
  page.set("charts", charts);
  const std::string html = html_page("compare", page);
  EXPECT_EQ(html.find("<script>alert"), std::string::npos);
  EXPECT_NE(html.find("&lt;script&gt;alert(1)&lt;/script&gt; &amp; co"), std::string::npos);
  EXPECT_NE(html.find("\\u003c/script>"), std::string::npos);
  EXPECT_NE(html.find("default-src 'none'"), std::string::npos);
}

TEST(Numbers, OfPagesAreShortAndCountsAreWhole) {
  for (const auto& [value, text] :
       std::vector<std::pair<double, std::string>>{{1460.0, "1460"},
                                                   {20000.0, "20000"},
                                                   {0.0, "0"},
                                                   {-3.0, "-3"},
                                                   {1234.5678, "1235"},
                                                   {0.0123456, "0.0123"},
                                                   {12.3456, "12.3"},
                                                   {1.23456e-5, "1.23e-05"},
                                                   {1.23456e6 + 0.5, "1.23e+06"},
                                                   {3e8, "3.00e+08"}}) {
    EXPECT_EQ(format_number(value), text);
  }
}

TEST(Differences, AreSharesMultiplesOrDifferences) {
  EXPECT_EQ(difference_in_words(2.0, 2.0), "=");
  EXPECT_EQ(difference_in_words(1.041, 1.0), "+4.1 %");
  EXPECT_EQ(difference_in_words(-1.5, -1.0), "-50.0 %");
  EXPECT_EQ(difference_in_words(0.01, 1.0), "-99.0 %");
  EXPECT_EQ(difference_in_words(2.99, 1.0), "+199.0 %");
  EXPECT_EQ(difference_in_words(7.996, 1.0), "×8.0");
  EXPECT_EQ(difference_in_words(-4.0, -1.0), "×4.0");
  EXPECT_EQ(difference_in_words(0.0444, 0.0004), "+0.044");
  EXPECT_EQ(difference_in_words(-1.0, 2.0), "-3");
  EXPECT_EQ(difference_in_words(0.25, 0.0), "+0.25");
}

}  // namespace
}  // namespace breakwater
