// report.html of a study: the numbers of its charts, its size, and hostile names.
#include <fmt/format.h>
#include <regex>

#include <breakwater/config/toml_text.h>
#include <breakwater/experiment/saved_run.h>
#include <breakwater/pages/study_report.h>
#include "catalogue.h"
#include "tables.h"

namespace breakwater::study_report_test {

namespace fs = std::filesystem;

std::uint64_t scattered(std::uint64_t number) {
  return std::mt19937_64(number)();
}

VariedKey list_of(const std::string& key, const std::vector<double>& values) {
  VariedKey varied;
  varied.key = key;
  varied.written = "[…]";
  for (const double value : values) varied.values.push_back(toml_number(value));
  return varied;
}

VariedKey uniform(const std::string& key, double a, double b) {
  VariedKey varied;
  varied.key = key;
  varied.distribution = Distribution(DistributionKind::uniform, a, b);
  varied.written = "{ uniform = […] }";
  return varied;
}

std::vector<double> range(double first, double last, int count) {
  std::vector<double> values;
  for (int i = 0; i < count; ++i) values.push_back(first + (last - first) * i / (count - 1));
  return values;
}

Study make_study(std::vector<VariedKey> vary, std::vector<std::string> cases, std::size_t seeds) {
  Study study;
  study.scenario = "motor_estimation";
  study.vary = std::move(vary);
  study.cases = std::move(cases);
  for (std::size_t i = 0; i < seeds; ++i) study.seeds.push_back(i + 1);
  return study;
}

// The folder of a study. `run` makes the result of each point.
class Folder {
 public:
  Folder(const std::string& name, Study study)
      : path_(name), folder_(path_, kSweep), plan_(std::move(study)) {
    fs::create_directories(folder_.shards());
  }

  template <typename Run>
  void fill(Run run) {
    Shard shard(folder_.shards());
    for (std::size_t number = 0; number < plan_.size(); ++number) {
      PointResult result;
      result.number = number;
      result.key = fmt::format("{:016x}", scattered(number));
      result.cost_s = 0.5;
      run(plan_.point(number), result);
      shard.add(result);
    }
  }
  const Plan& plan() const { return plan_; }
  ShardIndex index() const { return {folder_.shards(), plan_.size()}; }
  StudyNumbers numbers() const { return study_numbers(plan_, index()); }
  std::string page() const {
    write_study_report(testing::catalogue(), plan_, index(), numbers(), folder_,
                       compare_study(plan_, numbers()), rank_study(plan_, numbers()));
    return testing::text_of(folder_.path() / "report.html");
  }
  fs::path path() const { return folder_.path(); }

 private:
  testing::TemporaryPath path_;
  StudyFolder folder_;
  Plan plan_;
};

double number_of(const std::string& text) {
  return std::stod(text);
}

void fail(PointResult& result, const std::string& reason) {
  result.status = PointStatus::failed;
  result.reason = reason;
}

// Eleven seeds: the 10 % quantile is the 2nd value, 25 % lies between the 3rd and the 4th, 50 % is
// the 6th, 90 % the 10th.
TEST(QuantileBands, AreTheOrderStatistics) {
  Folder folder("bands", make_study({list_of("a.b", {1, 2, 4}), list_of("c.d", {7, 9})},
                                    {"idob", "stf"}, 11));
  testing::Random random;
  std::map<std::tuple<std::size_t, double, double>, std::vector<double>> expected;
  folder.fill([&](const StudyPoint& point, PointResult& result) {
    const double a = number_of(point.values[0]), c = number_of(point.values[1]);
    std::vector<double>& values = expected[{point.candidate, a, c}];
    if (a == 4 && *point.seed < 3) return fail(result, "too stiff");
    if (a == 2 && *point.seed == 11) {
      result.metrics = {{"other_1", 1.0}};
      return;
    }
    values.push_back(random.uniform(-1.0, 1.0));
    result.metrics = {{"y_m", values.back()}};
  });
  const ShardIndex index = folder.index();
  StudyNumbers numbers = folder.numbers();
  put_first({"absent_m", "other_1"}, numbers);
  ASSERT_EQ(numbers.metrics, (std::vector<std::string>{"other_1", "y_m"}));
  const KeyGroups a = group_values(numbers.keys[0], 10), c = group_values(numbers.keys[1], 10);
  EXPECT_EQ(a.labels, (std::vector<std::string>{"1", "2", "4"}));
  const std::vector<double>& column = numbers.columns.at("y_m");
  const std::vector<RunGroup> all = grouped(numbers, column, 12, [&](const StudyRun& run) {
    return (run.candidate * 3 + a.of_sample[run.sample]) * 2 + c.of_sample[run.sample];
  });
  for (std::size_t g = 0; g < 12; ++g) {
    const RunGroup& group = all[g];
    const double of_a = a.centre[g / 2 % 3];
    std::vector<double> values = expected[{g / 6, of_a, c.centre[g % 2]}];
    std::sort(values.begin(), values.end());
    EXPECT_EQ(group.runs, 11U);
    EXPECT_EQ(group.failed, of_a == 4 ? 2U : 0U);
    EXPECT_EQ(values.size(), of_a == 1 ? 11U : of_a == 2 ? 10U : 9U);
    ASSERT_EQ(group.values, values);
    for (std::size_t i = 0; i < values.size(); ++i) {
      EXPECT_EQ(index.read(group.points[i]).metrics.at(0).second, values[i]);
    }
    EXPECT_DOUBLE_EQ(group.at(0.5), testing::median(values));
    if (of_a != 1) continue;
    EXPECT_DOUBLE_EQ(group.at(0.1), values[1]);
    EXPECT_DOUBLE_EQ(group.at(0.25), 0.5 * (values[2] + values[3]));
    EXPECT_DOUBLE_EQ(group.at(0.9), values[9]);
  }
}

// The metrics that the study names come first. The caption names bands and crosses only if there
// are some.
TEST(StudyReport, BeginsWithTheMetricThatTheStudyNames) {
  for (const bool is_named : {false, true}) {
    Study study = make_study({list_of("a.b", {1, 2, 4})}, {"idob"}, is_named ? 1 : 2);
    if (is_named) study.metrics = {"y_m"};
    Folder folder(is_named ? "named" : "flat", study);
    folder.fill([&](const StudyPoint& point, PointResult& result) {
      const double flat = static_cast<double>(*point.seed);
      if (!is_named && *point.seed == 1 && number_of(point.values[0]) == 4)
        return fail(result, "lost");
      result.metrics = {{"x_m", flat}, {"y_m", flat + number_of(point.values[0])}};
    });
    const std::string page = folder.page();
    const std::size_t x = page.find("<h2>x_m</h2>"), y = page.find("<h2>y_m</h2>");
    EXPECT_EQ(y < x, is_named);
    EXPECT_EQ(bool(has(page, "The band has the runs", "A cross: ")), !is_named);
    EXPECT_EQ(bool(lacks(page, "The band has the runs", "A cross: ")), is_named);
  }
}

// The page and comparison.csv agree on the pairs.
TEST(StudyReport, NamesTheBetterCandidate) {
  Study study = make_study({}, {"idob", "stf", "kfd"}, 12);
  study.goals = {{"y_m", Goal::min}};
  study.metrics = {"y_m"};
  Folder folder("paired", study);
  testing::Random random;
  folder.fill([&](const StudyPoint& point, PointResult& result) {
    if (point.candidate == 2 && *point.seed == 3) return fail(result, "lost");
    result.metrics = {{"y_m", static_cast<double>(*point.seed) +
                                  (point.candidate == 1 ? 5.0 : random.uniform(0.0, 1.0))}};
  });
  const std::string page = folder.page();
  const auto comparison = compare_study(folder.plan(), folder.numbers());
  ASSERT_TRUE(comparison);
  EXPECT_TRUE(has(page, "Paired, in the same worlds"));
  for (const PairComparison& one : comparison->metrics) {
    const std::string begin = fmt::format(
        "<tr><th scope=\"row\">{}</th><td>{}</td><td>{}</td><td>{}", one.metric,
        comparison->candidates[one.candidate], comparison->candidates[one.reference], one.blocks);
    const std::size_t at = page.find(begin);
    ASSERT_NE(at, std::string::npos) << begin;
    const std::string row = page.substr(at, page.find("</tr>", at) - at);
    EXPECT_TRUE(row.ends_with(fmt::format("<td>{}</td>", name_of(one.verdict)))) << row;
  }
  EXPECT_EQ(comparison->metrics[0].verdict, ComparisonVerdict::worse);  // stf compared with idob
  EXPECT_TRUE(has(page, "<td>11 *</td>"));                              // kfd failed in one
  EXPECT_TRUE(
      has(page, "is not “equal”", "<p class=\"finding\">No difference in y_m is shown between "));
}

TEST(QuantileBands, ManyValuesAreGroupedWithTheirNeighbours) {
  StudyKey key;
  key.name = "k";
  testing::Random random;
  for (int i = 0; i < 1000; ++i) key.values.push_back(std::pow(10.0, random.uniform(0.0, 3.0)));
  const KeyGroups groups = group_values(key, 8);
  ASSERT_EQ(groups.size(), 8U);
  EXPECT_TRUE(groups.is_binned);
  EXPECT_TRUE(groups.is_log);
  std::vector<std::vector<double>> members(8);
  for (std::size_t i = 0; i < 1000; ++i) members[groups.of_sample[i]].push_back(key.values[i]);
  double below = 0.0;
  for (std::size_t g = 0; g < 8; ++g) {
    EXPECT_EQ(members[g].size(), 125U);
    EXPECT_GT(*std::min_element(members[g].begin(), members[g].end()), below);
    below = *std::max_element(members[g].begin(), members[g].end());
    EXPECT_DOUBLE_EQ(groups.centre[g], testing::median(members[g]));
  }
  key.values = range(0.0, 10.0, 11);
  EXPECT_FALSE(group_values(key, 11).is_log);
  EXPECT_EQ(group_values(key, 11).centre, key.values);
}

TEST(StudyNumbers, FailuresThatDifferInANumberAreOneKind) {
  Folder folder("kinds", make_study({list_of("a", range(0.0, 1.0, 40))}, {"idob", "stf"}, 10));
  std::size_t failed = 0;
  folder.fill([&](const StudyPoint& point, PointResult& result) {
    if (point.candidate == 1 && number_of(point.values[0]) > 0.75) {
      ++failed;
      return fail(result, fmt::format("at {} s: diverged", 0.1 * static_cast<double>(failed)));
    }
    result.metrics = {{"y", 1.0}};
  });
  const StudyNumbers numbers = folder.numbers();
  ASSERT_EQ(numbers.failures.size(), 1U);
  const FailureKind& kind = numbers.failures.front();
  EXPECT_EQ(kind.runs, failed);
  EXPECT_EQ(kind.reason, "at 0.1 s: diverged");
  EXPECT_EQ(kind.of_candidate, (std::vector<std::size_t>{0, failed}));
}

// y = Σ a_i x_i of uniform x_i: S_i = T_i = a_i²/Σ a². Runs fail if x_1 < 0.25, so only x_1
// matters.
TEST(StudyIndices, MatchALinearOutputAndItsFailures) {
  Study study =
      make_study({uniform("x.a", 0, 1), uniform("x.b", 0, 1), uniform("x.c", 0, 1)}, {"idob"}, 2);
  study.method = Method::saltelli;
  study.samples = 4096;
  Folder folder("indices", study);
  folder.fill([&](const StudyPoint& point, PointResult& result) {
    const double a = number_of(point.values[0]);
    const double noise = *point.seed == 1 ? 0.5 : -0.5;  // the mean over seeds removes it
    result.metrics = {
        {"y", 3.0 * a + 2.0 * number_of(point.values[1]) + number_of(point.values[2]) + noise}};
    if (a < 0.25) fail(result, "low");
  });
  StudyNumbers numbers = folder.numbers();
  const std::vector<ResultRow> all = study_indices(numbers, {"idob"});
  ASSERT_EQ(all.size(), 6U);
  EXPECT_EQ(all[3].at("output"), kFailedOutput);
  const double failed[] = {1.0, 0.0, 0.0}, linear[] = {9.0 / 14.0, 4.0 / 14.0, 1.0 / 14.0};
  for (int k = 0; k < 3; ++k) {
    for (const char* index : {"total", "first_order"}) {
      EXPECT_NEAR(number_of(all[k].at(index)), linear[k], 0.02);
      EXPECT_NEAR(number_of(all[3 + k].at(index)), failed[k], 1e-3);
    }
  }
  const std::string text = csv_table(all);
  EXPECT_EQ(std::count(text.begin(), text.end(), '\n'), 1 + 2 * 3);
  EXPECT_TRUE(has(text, "\nidob,failed,x.b,0,"));
}

// log(0.1,1000,n) has values of ten digits. They stay if fewer digits would make them equal.
TEST(StudyGroups, LabelsAreAsShortAsTheirValuesAllow) {
  StudyKey key;
  key.values = {0.3437543855, 281.1706626, 20000.0, 123456.0, 0.015};
  EXPECT_EQ(group_values(key, 10).labels,
            (std::vector<std::string>{"0.015", "0.3438", "281.2", "20000", "123456"}));
  key.values = {1.00000001, 1.00000002, 2.0};
  EXPECT_EQ(group_values(key, 10).labels,
            (std::vector<std::string>{"1.00000001", "1.00000002", "2"}));
}

// Studies of any shape with 36 metrics and 1e5 points.
class LargeStudy : public ::testing::TestWithParam<const char*> {};

TEST_P(LargeStudy, HasAPageOfLessThan2MB) {
  const std::string shape = GetParam();
  if (shape == "lhs" && std::getenv("BREAKWATER_SHAPES") == nullptr) {
    GTEST_SKIP() << "runs in the study large_studies";
  }
  Study study;
  if (shape == "grid") {
    study = make_study({list_of("a.first", range(1, 2, 40)), list_of("a.second", range(0, 1, 40))},
                       {"idob", "stf", "mdob"}, 20);
  } else {
    std::vector<VariedKey> drawn;
    for (const char* key : {"a", "b", "c", "d", "e", "f"}) {
      drawn.push_back(uniform("plant." + std::string(key), 0.5, 2.0));
    }
    study = make_study(drawn, {"idob", "stf", "mdob"}, 1);
    study.method = shape == "saltelli" ? Method::saltelli : Method::latin_hypercube;
    study.samples = shape == "saltelli" ? 4096 : 33333;
  }
  Folder folder("large_" + shape, study);
  ASSERT_GT(folder.plan().size(), 95'000U);
  std::uint64_t state = 1;
  folder.fill([&](const StudyPoint& point, PointResult& result) {
    const double a = number_of(point.values[0]), b = number_of(point.values[1]);
    state = scattered(state);
    if (state % 50 == 0) return fail(result, fmt::format("at {} s: diverged", state % 100));
    for (int m = 0; m < 36; ++m) {
      result.metrics.emplace_back(fmt::format("metric_of_some_length_{}_rad_s", m),
                                  a * m + b * b + 1e-3 * static_cast<double>(state % 1000));
    }
  });
  const std::string page = folder.page();
  RecordProperty("bytes", static_cast<int>(page.size()));
  EXPECT_LT(page.size(), 2'000'000U);
  EXPECT_GT(page.size(), 300'000U);
  EXPECT_TRUE(has(page, "id=\"metric-24\"")) << "most have charts";
}

INSTANTIATE_TEST_SUITE_P(Shapes, LargeStudy, ::testing::Values("grid", "lhs", "saltelli"),
                         [](const auto& shape) { return std::string(shape.param); });

TEST(StudyReport, HostileNamesStayText) {
  const std::string bad = "\"'></script><script>alert(1)</script><img src=x>{{title}}";
  Study study = make_study({list_of("a<b>", {1, 2})}, {"idob"}, 2);
  VariedKey text;
  text.key = "k\"'&<i>";
  text.values = {toml_string(bad), toml_string("fine")};
  text.written = "[" + text.values[0] + "]";
  study.vary.push_back(text);
  study.compare.push_back(text);
  for (const Method method : {Method::grid, Method::list}) {
    study.method = method;
    Folder folder("hostile'\"<b>", study);
    folder.fill([&](const StudyPoint& point, PointResult& result) {
      if (point.sample == 1) return fail(result, bad);
      result.metrics = {{bad, number_of(point.values[0])}, {"plain", 1.0}};
    });
    const std::string page = folder.page();
    for (const char* tag : {"<img", "<b>idob", "<i>\"", "<script>alert", "a<b>"}) {
      EXPECT_TRUE(lacks(page, tag)) << tag;
    }
    // The page's data with its scripts, and two more.
    const std::regex script("</script>");
    EXPECT_EQ(std::distance(std::sregex_iterator(page.begin(), page.end(), script), {}), 3);
    EXPECT_TRUE(has(page, "&lt;img src"));
    EXPECT_EQ(folder.page(), page) << "the same results give the same bytes";
  }
}

TEST(StudyReport, AnEmptyStudyHasAPage) {
  Folder folder("nothing", make_study({list_of("a", {1, 2})}, {"idob"}, 1));
  EXPECT_TRUE(has(folder.page(), "not yet run"));
  folder.fill([](const StudyPoint&, PointResult& result) { fail(result, ""); });
  EXPECT_TRUE(has(folder.page(), "Failed runs"));
}

}  // namespace breakwater::study_report_test
