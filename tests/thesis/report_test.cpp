#include <nlohmann/json.hpp>

#include <breakwater/config/unit_of.h>
#include <breakwater/experiment/runner.h>
#include <breakwater/experiment/saved_run.h>
#include <breakwater/pages/compare.h>
#include <breakwater/pages/html_page.h>
#include <breakwater/pages/page_chart.h>
#include <breakwater/pictures/replay_data.h>
#include <breakwater/record/text_outputs.h>
#include <breakwater/thesis/experiments.h>
#include <breakwater/thesis/reproduction.h>
#include <breakwater/thesis/thesis_report.h>
#include "catalogue.h"
#include "tables.h"

namespace breakwater::report_test {

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
  EXPECT_EQ(judge(kInfinity, printed, standard), Verdict::not_reproduced);
}

TEST(Verdict, AValueThatRoundsToThePrintedDigitsIsReproduced) {
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
  // "461 s at least" has no upper bound.
  Standard at_least;
  at_least.reproduced.above = 1000.0;
  at_least.within.above = 500.0;
  EXPECT_EQ(judge(461.2, {461.0, "461", 0.5}, at_least), Verdict::not_reproduced);
}

// A cell with a printed number, or with a bound as its statement, and with these options.
CellSpec cell_of(const std::vector<std::string>& words) {
  CellSpec cell;
  cell.quantity = {"any", "m"};
  const std::map<std::string, std::function<void()>> options = {
      {"over",
       [&] {
         cell.over = Quantity{"other", "m"};
       }},
      {"zero_if_failed", [&] { cell.if_failed = 0.0; }},
      {"absent_is_never", [&] { cell.absent_is_never = true; }},
      {"share", [&] { cell.is_share = true; }},
      {"shows", [&] { cell.shows = "not claimed"; }},
      {"why", [&] { cell.why = "too hard"; }},
      {"vacuous", [&] { cell.vacuous = "nothing moves"; }},
      {"without", [&] { cell.without = "other"; }},
      {"reading", [&] { cell.reading = "if it were soft"; }}};
  for (const std::string& word : words) {
    if (const auto option = options.find(word); option != options.end()) {
      option->second();
    } else if (word[0] == '>' || word[0] == '<') {
      cell.says = "so";
      (word[0] == '>' ? cell.holds.above : cell.holds.below) = std::stod(word.substr(1));
    } else {
      cell.printed = word;
    }
  }
  return cell;
}

// Runs with these values of the metric.
std::vector<PointResult> runs_of(const std::vector<std::string>& words) {
  std::vector<PointResult> runs;
  for (const std::string& word : words) {
    PointResult& run = runs.emplace_back();
    if (word == "failed") run.status = PointStatus::failed;
    if (word == "failed" || word == "absent") continue;
    run.metrics = {{"m", std::stod(word)}};
  }
  return runs;
}

// Every number of a page is judged here. Only the measured values matter.
TEST(Verdict, IsThatOfItsRow) {
  for (const auto& row : testing::rows_of("Verdicts")) {
    const CellSpec cell = cell_of(testing::words_in(row.at(0)));
    Measured measured = {{"any", runs_of(testing::words_in(row.at(1)))}};
    if (!row.at(2).empty()) measured["other"] = runs_of(testing::words_in(row.at(2)));
    const Judged judged = judge_cell(cell, measured, printed_results());
    const std::string reason = reason_of(judged, cell);
    const std::string place = row.at(0) + " | " + row.at(1) + " | " + row.at(2);
    const std::string word = JudgedCell{"", "", cell, judged}.word();
    EXPECT_EQ(word + (reason.empty() ? "" : ", ") + reason, row.at(3)) << place;
    if (row.size() > 4) {
      EXPECT_EQ(judged.measured, row.at(4)) << place;
    }
    if (row.size() > 5) {
      EXPECT_EQ(judged.numbers, std::stoul(row.at(5))) << place;
    }
  }
}

TEST(Verdict, ARatioOfMetricsOfOneRunIsComputedPerRun) {
  CellSpec cell = cell_of({">1"});
  cell.quantity.metric = "|error_N|";
  cell.over = Quantity{"any", "error_of_zero_N"};
  cell.divisor = 2.0;
  Measured measured;
  for (const auto& [error_N, of_zero_N] : {std::pair(-6.0, 1.0), {8.0, 2.0}, {10.0, 10.0}}) {
    measured["any"].emplace_back().metrics = {{"error_N", error_N}, {"error_of_zero_N", of_zero_N}};
  }
  EXPECT_EQ(values_of(cell, measured), (std::vector<double>{3.0, 2.0, 0.5}));
  EXPECT_EQ(judge_cell(cell, measured, printed_results()).median, 2.0);
  // Relative to another run: all values divided by its median.
  measured["other"] = measured["any"];
  cell.over->run = "other";
  EXPECT_EQ(values_of(cell, measured), (std::vector<double>{1.5, 2.0, 2.5}));
}

TEST(Median, IsTheMiddleValue) {
  EXPECT_EQ(median({3.0, 1.0, 2.0}), 2.0);
  EXPECT_EQ(median({4.0, 1.0, 2.0, 3.0}), 2.5);
  EXPECT_EQ(median({1.0, kInfinity, kInfinity}), kInfinity);
}

TEST(Experiments, OnlyTheShippedListIsThatOfTheThesis) {
  const std::string shipped = testing::source_file("data/experiments.toml");
  EXPECT_FALSE(read_experiments(shipped, Effort::quick).is_own);
  const testing::TemporaryPath file{"mine.toml", "title = \"Mine\"\n"};
  const Experiments mine = read_experiments(file.string(), Effort::quick);
  EXPECT_TRUE(mine.is_own);
  EXPECT_EQ(mine.title, "Mine");
}

// Cells of section 1 with a verdict, of a statement or of a printed word.
std::vector<JudgedCell> cells_of(int count, Verdict verdict, const std::string& says,
                                 const std::string& cause = "", bool is_own = false) {
  JudgedCell one{"1", "", {}, {}, is_own};
  (says.empty() ? one.cell.printed : one.cell.says) = says.empty() ? "printed" : says;
  one.cell.cause = cause;
  one.judged.verdict = verdict;
  return std::vector<JudgedCell>(static_cast<std::size_t>(count), one);
}

void add(std::vector<JudgedCell>& cells, const std::vector<JudgedCell>& more,
         bool is_vacuous = false) {
  for (JudgedCell one : more) {
    if (is_vacuous) one.judged.verdict = Verdict::vacuous;
    cells.push_back(one);
  }
}

TEST(Score, CountsStatementsOfOtherListsAsHeld) {
  std::vector<JudgedCell> cells;
  EXPECT_EQ(score_text(cells), "0 reproduced, 0 within the class, 0 not reproduced");
  add(cells, cells_of(2, Verdict::reproduced, "so", "", true));
  EXPECT_EQ(score_text(cells), "2 held, 0 did not hold");
  add(cells, cells_of(1, Verdict::reproduced, "", "", true));
  add(cells, cells_of(3, Verdict::not_measured, "so", "", true));
  EXPECT_EQ(score_text(cells),
            "1 reproduced, 0 within the class, 0 not reproduced, 2 held, "
            "0 did not hold, 3 not measured");
  add(cells, cells_of(4, Verdict::reproduced, "so", "", true), true);
  EXPECT_TRUE(score_text(cells).ends_with(", 3 not measured; beside them 4 vacuous"))
      << score_text(cells);
  cells.back().cell.reading = "softer";  // counts nowhere
  cells.back().judged.verdict = Verdict::reproduced;
  EXPECT_TRUE(score_text(cells).ends_with(", 3 not measured; beside them 3 vacuous"));
}

TEST(Score, TheHeadlineCountsDifferentStatements) {
  std::vector<JudgedCell> cells;
  EXPECT_TRUE(headline(cells).empty());
  add(cells, cells_of(2, Verdict::reproduced, ""));
  add(cells, cells_of(1, Verdict::within_class, ""));
  add(cells, cells_of(1, Verdict::not_reproduced, "", "thesis"));
  cells[0].judged.deviation = 0.01;
  cells[2].judged.deviation = 0.2;
  cells[3].judged.deviation = NAN;
  add(cells, cells_of(1, Verdict::reproduced, ""), true);
  add(cells, cells_of(2, Verdict::reproduced, "fast"));
  add(cells, cells_of(1, Verdict::reproduced, "fast"), true);
  add(cells, cells_of(1, Verdict::reproduced, "soft"));
  add(cells, cells_of(2, Verdict::not_reproduced, "soft", "ours"));
  add(cells, cells_of(1, Verdict::not_reproduced, "exact", "thesis"));
  add(cells, cells_of(1, Verdict::reproduced, "free"), true);
  EXPECT_EQ(headline(cells),
            (std::vector<std::string>{
                "printed results: 2 of 5 reproduced, 1 within their class, 1 not, 1 vacuous",
                "printed numbers: 1 of 3 within 5 %, 2 within 25 %",
                "different statements (6 cells): 1 of 3 hold in all cells, 1 in some, 1 in none",
                "causes of what is not: ours 2, thesis 2"}));
}

TEST(Experiments, AReadingAddsItsSettingsToTheRunsOfItsPattern) {
  const std::string list =
      "readings = [{ name = \"soft\", runs = \"wall-*\", sets = [\"k=1\"], why = \"w\" }, "
      "{ name = \"hard\", runs = \"wall-b\", sets = [\"k=2\"] }]\n[[section]]\nid = \"1\"\n"
      "group = \"arm\"\ntitle = \"t\"\nruns = [\n";
  const auto run = [](const std::string& name) {
    return "{ name = \"" + name + "\", scenario = \"s\", case = \"c\", sets = [\"k=0\"] },\n";
  };
  const testing::TemporaryPath file{"mine.toml",
                                    list + run("wall-a") + run("wall-b") + run("push") + "]\n"};
  const auto sets = [&](const std::vector<std::string>& readings) {
    const Experiments mine = read_experiments(file.string(), Effort::quick, readings);
    std::vector<std::string> last;
    for (const auto& [name, spec] : mine.runs) last.push_back(spec.sets.back());
    return last;  // push, wall-a, wall-b
  };
  using Sets = std::vector<std::string>;
  EXPECT_EQ(sets({}), (Sets{"k=0", "k=0", "k=0"}));
  EXPECT_EQ(sets({"soft"}), (Sets{"k=0", "k=1", "k=1"}));
  EXPECT_EQ(sets({"soft", "hard"}), (Sets{"k=0", "k=1", "k=2"}));
  EXPECT_EQ(complaint_of([&] { sets({"softer"}); }),
            "--reading softer: there is no such reading (did you mean soft?); " + file.string() +
                " has them");
}

TEST(SavedRun, IsReadToItsEndIfAnotherRunReplacesIt) {
  const testing::TemporaryPath folder{"replaced"};
  const std::string scenario = "motor_estimation";
  std::vector<PreparedRun> runs;
  runs.push_back(testing::prepare(scenario, testing::scenario_file(scenario).default_case(),
                                  {"run.duration_s=0.1"}));
  execute_runs(runs, {folder}, {.csv = false, .quiet = true, .stop = nullptr});
  const SavedRun run(folder);
  const std::size_t rows = run.signals().front().rows;
  std::filesystem::remove_all(folder);
  for (const LogEntry& entry : run.signals()) {
    EXPECT_EQ(run.dataset(entry.group + "/" + entry.name).rows, rows) << entry.name;
  }
}

TEST(SavedRun, UnitsComeFromTheEndsOfNames) {
  for (const auto& row : testing::rows_of("Units")) EXPECT_EQ(unit_of(row.at(0)), row.at(1));
}

TEST(Csv, QuotesCellsThatNeedIt) {
  EXPECT_EQ(csv_line({"a", "b,c", "d\"e", ""}), "a,\"b,c\",\"d\"\"e\",\n");
}

TEST(Base64, MatchesRfc4648) {
  for (const auto& row : testing::rows_of("Base64")) {
    EXPECT_EQ(base64(row.at(0).data(), row.at(0).size()), row.at(1));
  }
}

TEST(Page, EscapesTextsOfRuns) {
  PageChart chart;
  chart.id = "one";
  chart.group = "all";
  chart.title = "x</script><script>alert(2)</script>";
  chart.series.push_back({"a<b", "N", "\"", {{0.0, 1.0}, {1.0, 2.0}}});
  auto blocks = PageData::array();
  add_block(blocks, "about", "\"quoted\" <b>");
  add_block(blocks, "figures", PageData::array({figure_of(chart)}));
  const std::string html =
      html_page("compare", {{"title", "<script>alert(1)</script> & co"},
                            {"sections", PageData::array({{{"id", "one"}, {"blocks", blocks}}})}});
  EXPECT_TRUE(lacks(html, "<script>alert"));
  EXPECT_TRUE(has(html, "&lt;script&gt;alert(1)&lt;/script&gt; &amp; co", "default-src 'none'"));
}

TEST(PrintedReferences, SayHowFarANumberIsFromThePrint) {
  const auto values = printed_references().of_case("arm_wall_contact", "proposed-2N");
  const auto peak = std::find_if(values.begin(), values.end(), [](const PublishedValue& one) {
    return one.metric == "peak_force_filtered_N";
  });
  ASSERT_NE(peak, values.end());
  for (const auto& [factor, text, deviation, verdict] :
       {std::tuple(1.01, "reproduced", "+1.0 %", "reproduced ("),
        std::tuple(0.8, "near", "-20.0 %", "within the class ("),
        std::tuple(1.6, "not reproduced", "+60.0 %", "not reproduced (")}) {
    const Agreement agreement = peak->agrees(factor * peak->number);
    EXPECT_EQ(agreement.text, text);
    EXPECT_EQ(peak->deviation(factor * peak->number), deviation);
    EXPECT_TRUE(agreement.rule.starts_with(verdict)) << agreement.rule;
  }
}

TEST(Differences, AreOfOneKindInARow) {
  using Values = std::vector<std::optional<double>>;
  using Words = std::vector<std::string>;
  for (const auto& [values, words] : {
           std::pair(Values{2.0, 2.0, 2.082}, Words{"same", "same", "+4.1 %"}),
           std::pair(Values{-1.0, -1.5, -2.99}, Words{"same", "-50.0 %", "-199.0 %"}),
           std::pair(Values{1.0, 0.01, 1.0 + 1e-9}, Words{"same", "-99.0 %", "+0.0 %"}),
           std::pair(Values{1.0, 7.996, 0.5}, Words{"same", "×8.00", "×0.50"}),
           std::pair(Values{0.0004, 0.0444, 0.0005}, Words{"same", "+0.044", "+0.0001"}),
           std::pair(Values{2.0, -1.0, 2.1}, Words{"same", "-3", "+0.1"}),
           std::pair(Values{0.0, 0.25, 0.0}, Words{"same", "+0.25", "same"}),
           std::pair(Values{1.0, std::nullopt}, Words{"same", "-"}),
           std::pair(Values{std::nullopt, 1.0}, Words{"-", "-"}),
       }) {
    EXPECT_EQ(differences_in_words(values), words);
  }
}

}  // namespace breakwater::report_test
