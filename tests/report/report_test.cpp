// What reports are made of: verdicts, measurements, tables, pages.
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <limits>
#include <set>
#include <stdexcept>

#include "report/experiments.h"
#include "report/html_page.h"
#include "report/latex.h"
#include "report/measurements.h"
#include "report/page_chart.h"
#include "report/reproduction.h"
#include "report/saved_run.h"
#include "report/thesis_report.h"
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
  EXPECT_EQ(judge(NAN, printed, standard), Verdict::not_reproduced);
  EXPECT_EQ(judge(kNever, printed, standard), Verdict::not_reproduced);
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
  cell.run = "any";
  cell.metric = "free_motion_time_s";
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
  cell.run = "any";
  cell.metric = "converged";
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
  cell.run = "any";
  cell.metric = "max_speed_m_s";
  cell.if_failed = std::numeric_limits<double>::quiet_NaN();
  cell.says = "breaks the limit";
  cell.holds.above = 1.0;
  Measured measured;
  measured["any"].resize(3);
  for (Measurement& run : measured["any"]) run.values["max_speed_m_s"] = 1.2;
  EXPECT_EQ(judge_cell(cell, measured, printed_results()).verdict, Verdict::reproduced);
  measured["any"][1].failed = true;
  EXPECT_EQ(judge_cell(cell, measured, printed_results()).verdict, Verdict::not_reproduced);
  // Nor does a part of what is infinite, or of nothing.
  measured["any"][1].failed = false;
  cell.over = "other";
  cell.holds.above.reset();
  cell.holds.below = 1.0;
  measured["other"].resize(1);
  EXPECT_EQ(judge_cell(cell, measured, printed_results()).verdict, Verdict::not_reproduced);
  measured["other"][0].values["max_speed_m_s"] = 0.0;
  EXPECT_EQ(judge_cell(cell, measured, printed_results()).verdict, Verdict::not_reproduced);
}

TEST(Verdict, SixOfTenDoNotConverge) {
  CellSpec cell;
  cell.run = "any";
  cell.metric = "converged";
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

TEST(Measurements, SurviveALineThatWasCutOff) {
  const auto file = testing::temporary_path("measurements.jsonl");
  const testing::Removed removed(file);
  Measurement one;
  one.values["a"] = 0.1;
  {
    Measurements measurements(file);
    measurements.add("first", "run", one);
  }
  std::ofstream(file, std::ios::app) << R"({"key":"second","run":"x","val)";
  one.values["a"] = 0.3;
  {
    Measurements measurements(file);
    EXPECT_EQ(measurements.find("first")->values.at("a"), 0.1);
    EXPECT_FALSE(measurements.find("second"));
    measurements.add("third", "run", one);
  }
  const Measurements measurements(file);
  EXPECT_EQ(measurements.find("third")->values.at("a"), 0.3);
  EXPECT_FALSE(measurements.find("second"));
}

TEST(Measurements, KeysTellConfigurationsApart) {
  EXPECT_NE(fingerprint({"a", "b"}), fingerprint({"ab", ""}));
  EXPECT_NE(fingerprint({"a", "b"}), fingerprint({"a", "c"}));
  EXPECT_EQ(fingerprint({"a", "b"}), fingerprint({"a", "b"}));
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
  // Every printed number and verdict is judged somewhere: 56 + 14 of the motor, 6 of the
  // quadrotor, 12 + 8 + 12 and 5 of the cart, 18 + 5 of the arm.
  cells.erase("");
  EXPECT_EQ(cells.size(), 136U);
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
          } else {
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
  const std::string section = "[[section]]\nid = \"1\"\nplant = \"arm\"\ntitle = \"t\"\n";
  EXPECT_EQ(message(section), "");
  EXPECT_NE(message(section + "colour = 1\n").find(":5: there is no key colour"),
            std::string::npos);
  EXPECT_NE(message(section + "[[section.run]]\nname = \"{k}\"\n").find("there is no {k}"),
            std::string::npos);
  EXPECT_NE(message("[[section]\n").find(":1: "), std::string::npos);
  EXPECT_NE(message(section + "video = \"none\"\n").find("there is no run none"),
            std::string::npos);
  EXPECT_NE(message(section + "[[section.table]]\ntitle = \"t\"\ncolumns = [{ title = \"c\" }]\n"
                              "rows = [{ title = \"r\", run = \"x\", metric = \"m\" }]\n")
                .find("either `printed` or `says`"),
            std::string::npos);
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

}  // namespace
}  // namespace breakwater
