// A study before it runs: values, points, and what is compared.
#include <fmt/format.h>

#include <breakwater/config/config.h>
#include <breakwater/record/file_hash.h>
#include <breakwater/study/plan.h>
#include <breakwater/study/results.h>
#include <breakwater/study/study.h>
#include <breakwater/study/study_folder.h>
#include <breakwater/study/study_reader.h>
#include <breakwater/study/sweep.h>
#include "support.h"
#include "tables.h"

namespace breakwater::plan_test {

Study study(Method method) {
  Study study;
  study.scenario = "any";
  study.cases = {"a", "b"};
  study.method = method;
  study.vary = {{.key = "from", .values = {"1", "3", "5"}},
                {.key = "to", .values = {"2", "4", "6"}}};
  return study;
}

std::set<std::vector<std::string>> probed(const Plan& plan) {
  std::set<std::vector<std::string>> values;
  for (const StudyPoint& probe : plan.probes()) values.insert(probe.values);
  return values;
}

// A value in a list may be valid only with its neighbours: 3 … 4, but not 3 … 2.
TEST(Plan, ProbesOfAListAreItsSamples) {
  const std::set<std::vector<std::string>> samples = {{"1", "2"}, {"3", "4"}, {"5", "6"}};
  const Plan list(study(Method::list));
  EXPECT_EQ(probed(list), samples);
  EXPECT_EQ(list.probes().size(), 2U + 2U);  // each case and each further sample
}

TEST(Plan, ProbesOfAGridHaveEachValueOnce) {
  const std::set<std::vector<std::string>> around_the_first = {
      {"1", "2"}, {"3", "2"}, {"5", "2"}, {"1", "4"}, {"1", "6"}};
  EXPECT_EQ(probed(Plan(study(Method::grid))), around_the_first);
}

bool are_same(const StudyPoint& a, const StudyPoint& b) {
  return a.sample == b.sample && a.candidate == b.candidate && a.seed == b.seed &&
         a.values == b.values && a.sets == b.sets;
}

Study any_study(testing::Random& random) {
  const auto whole = [&](double least, double most) {
    return static_cast<std::size_t>(std::floor(random.uniform(least, most + 1.0)));
  };
  Study study;
  study.scenario = "any";
  study.method = static_cast<Method>(whole(0, 5));
  study.sampling_seed = whole(0, 1e6);
  study.samples = whole(1, 40);
  const bool is_listed = study.method == Method::grid || study.method == Method::list;
  const std::size_t values = whole(1, 5);
  for (std::size_t k = whole(1, 4); k > 0; --k) {
    VariedKey key{.key = "key" + std::to_string(k)};
    if (is_listed || (study.method != Method::saltelli && whole(0, 1) == 0)) {
      for (std::size_t i = 0; i < values; ++i) key.values.push_back(std::to_string(i));
    } else {
      key.distribution.emplace(DistributionKind::uniform, 0.0, random.uniform(1.0, 9.0));
    }
    study.vary.push_back(key);
  }
  for (std::size_t k = whole(1, 3); k > 0; --k) study.cases.push_back("case" + std::to_string(k));
  if (whole(0, 1) == 0) study.compare = {{.key = "c", .values = {"1", "2"}}};
  for (std::size_t k = whole(0, 3); k > 0; --k) study.seeds.push_back(k);
  return study;
}

// In any order, and in a plan of its own as another process has it.
TEST(PlanProperty, PointsDoNotDependOnTheirOrder) {
  const int count = testing::property_count(2000);
  testing::Random random(403);
  int points = 0, studies = 0;
  for (; points < count; ++studies) {
    const Study study = any_study(random);
    const Plan plan(study);
    std::vector<StudyPoint> in_order;
    for (std::size_t i = 0; i < plan.size(); ++i) in_order.push_back(plan.point(i));
    std::vector<std::size_t> order(plan.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::shuffle(order.begin(), order.end(), std::mt19937(static_cast<unsigned>(studies)));
    const Plan other(study);
    for (const std::size_t i : order) {
      ASSERT_TRUE(are_same(other.point(i), in_order[i])) << studies << ": " << i;
      ++points;
    }
  }
  std::printf("%d points of %d studies\n", points, studies);
}

TEST(Points, AreSortedWithoutRepetition) {
  EXPECT_EQ(parse_points("7,2-4,3", 8), (std::vector<std::size_t>{2, 3, 4, 7}));
  EXPECT_EQ(print_points({2, 3, 4, 7}), "2-4,7");
  for (const char* text : {"", "8", "4-2", "1,", "1-", "x"}) {
    EXPECT_THROW(parse_points(text, 8), std::invalid_argument) << text;
  }
}

using Values = std::vector<double>;

TEST(ValueList, HasTheNumbersOfTwelveDigits) {
  EXPECT_EQ(value_list("lin(0.06,0.12,4)"), (Values{0.06, 0.08, 0.1, 0.12}));
  EXPECT_EQ(value_list(" lin( -1 , 1, 5 ) "), (Values{-1.0, -0.5, 0.0, 0.5, 1.0}));
  EXPECT_EQ(value_list("lin(0,1,11)"),
            (Values{0.0, 0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.9, 1.0}));
  EXPECT_EQ(value_list("log(1e-3,1e3,7)"), (Values{1e-3, 1e-2, 1e-1, 1.0, 1e1, 1e2, 1e3}));
  EXPECT_EQ(value_list("log(500,8000,5)"), (Values{500, 1000, 2000, 4000, 8000}));
  EXPECT_EQ(value_list("lin(0.1,0.3,2)"), (Values{0.1, 0.3}));
}

TEST(ValueList, KeepsAllDigitsOfOtherNumbers) {
  EXPECT_EQ(value_list("lin(0,1,4)"), (Values{0.0, 1.0 / 3.0, 2.0 / 3.0, 1.0}));
  const Values values = value_list("log(1,2,13)");  // semitones
  for (int i = 0; i <= 12; ++i) {
    EXPECT_NEAR(values[i], std::exp2(i / 12.0), 4e-16 * values[i]) << i;
  }
}

TEST(ValueList, EndsAreExactAndValuesGoUp) {
  for (const std::string rule : {"lin(0.1,0.7,1000)", "log(0.1,0.7,1000)", "lin(-3.3,1e9,77)"}) {
    const Values values = value_list(rule);
    EXPECT_EQ(values.front(), rule[4] == '-' ? -3.3 : 0.1);
    EXPECT_EQ(values.back(), rule[4] == '-' ? 1e9 : 0.7);
    for (std::size_t i = 1; i < values.size(); ++i) EXPECT_LT(values[i - 1], values[i]) << rule;
  }
}

TEST(ValueList, RefusesInvalidArguments) {
  for (const auto& row : testing::rows_of("ValueLists")) {
    for (const std::string& text : testing::forms_of(row.at(0))) {
      EXPECT_EQ(complaint_of([&] { value_list(text); }), '"' + text + "\" " + row.at(1));
    }
  }
}

TEST(ValueList, IsDistinguishedFromOtherTexts) {
  EXPECT_TRUE(is_value_list("lin(0,1,3)"));
  EXPECT_TRUE(is_value_list("  log (0,"));
  EXPECT_FALSE(is_value_list("linear"));
  EXPECT_FALSE(is_value_list("hpfc"));
}

TEST(OptionParts, AnEscapedQuoteDoesNotEndAText) {
  using Parts = std::vector<std::string>;
  EXPECT_EQ(option_parts(R"("a\",b", c)"), (Parts{R"("a\",b")", "c"}));
  EXPECT_EQ(option_parts(R"("a\\",b)"), (Parts{R"("a\\")", "b"}));
  EXPECT_EQ(option_parts(R"('a\',b)"), (Parts{R"('a\')", "b"})) << "there it is a character";
}

// An ineffective key, an effective one, and effective seeds: two of eight samples differ.
Plan plan(bool are_seeds_worlds = false) {
  Study study;
  study.scenario = "any";
  study.cases = {"a", "b"};
  study.vary = {{.key = "idle", .values = {"1", "2", "3", "4"}},
                {.key = "busy", .values = {"10", "20"}}};
  study.seeds = {1, 2, 3};
  study.metrics = {"y"};
  study.are_seeds_worlds = are_seeds_worlds;
  return Plan(study);
}

using Choice = std::function<bool(const StudyPoint&)>;

// The results of all points except `missing`. Case b crashes at `crashes`, with this state hash.
PairedResults results_of(const Plan& plan, const Choice& crashes, const Choice& missing,
                         const char* hash = "") {
  const testing::TemporaryPath folder{"study_comparison"};
  std::filesystem::create_directories(folder);
  {
    Shard shard(folder);
    for (std::size_t number = 0; number < plan.size(); ++number) {
      const StudyPoint point = plan.point(number);
      if (missing(point)) continue;
      PointResult result;
      result.number = number;
      result.key = std::to_string(number);
      if (point.candidate == 1 && crashes(point)) {
        result.status = PointStatus::crashed;
        result.reason = "signal 6";
        result.state_hash = hash;
      } else {
        const double y = std::stod(point.values[1]) + static_cast<double>(*point.seed);
        result.state_hash = fmt::format("{:016x}", static_cast<int>(y));
        result.metrics = {{"y", static_cast<double>(point.candidate) + y}};
      }
      shard.add(result);
    }
  }
  return paired_results(plan, study_numbers(plan, ShardIndex(folder, plan.size())));
}

bool never(const StudyPoint&) {
  return false;
}

// A crash leaves no hash, and a failure in the first step that of any condition. Other runs must
// show whether two values of a key give the same run.
TEST(StudyComparison, ACrashMakesNoBlockOfAKeyWithoutEffect) {
  struct Row {
    const char* crashes;
    Choice where;
    std::size_t blocks_of_b, blocks;
  };
  for (const Row& row : {
           Row{"never", never, 2, 2},
           Row{"at a seed", [](const auto& point) { return point.seed == 2; }, 2, 2},
           Row{"at a value", [](const auto& point) { return point.values[1] == "10"; }, 2, 2},
           // Nothing shows that a key has no effect.
           Row{"always", [](const auto&) { return true; }, 8, 8},
           // The key is effective here, and nobody knows which crashed runs are equal.
           Row{"at some values", [](const auto& point) { return point.values[0] >= "3"; }, 6, 6},
       }) {
    for (const char* hash : {"", "0123456789abcdef"}) {
      const CandidateComparison comparison =
          compare_candidates(results_of(plan(), row.where, never, hash));
      EXPECT_EQ(comparison.reached, (std::vector<std::size_t>{2, row.blocks_of_b})) << row.crashes;
      EXPECT_EQ(comparison.blocks, row.blocks) << row.crashes;
    }
  }
}

// A sample with a missing run would look different from its repeats.
TEST(StudyComparison, AHalfFinishedSampleMakesNoBlock) {
  const Choice missing = [](const StudyPoint& point) {
    return point.values == std::vector<std::string>{"4", "20"} && point.seed == 3;
  };
  const PairedResults results = results_of(plan(), never, missing);
  EXPECT_EQ(results.samples.size(), 7 * 3);
  EXPECT_EQ(compare_candidates(results).blocks, 2U);
  // If each seed is a block, the finished seeds count.
  const PairedResults of_seeds = results_of(plan(true), never, missing);
  EXPECT_EQ(of_seeds.samples.size(), 8 * 3 - 1);
  EXPECT_EQ(compare_candidates(of_seeds).blocks, 6U);
}

TEST(StudyFolder, TwoStudiesCannotBeginInIt) {
  const testing::TemporaryPath folder{"study_folder"};
  const ScenarioFile file(testing::source_file("tests/study/ishigami/ishigami.toml"), "ishigami");
  const StudyFolder study(folder, kSweep);
  study.make("a = 1\n", file);
  EXPECT_TRUE(has(testing::text_of(folder / "study.toml"), file_hash(file.file())));
  EXPECT_NO_THROW(study.make("a = 1\n", file));  // as another process at the same time
  EXPECT_THROW(study.make("a = 2\n", file), std::invalid_argument);
  study.make_anew("a = 2\n", file);
  EXPECT_TRUE(has(testing::text_of(folder / "study.toml"), "a = 2\n"));
}

}  // namespace breakwater::plan_test
