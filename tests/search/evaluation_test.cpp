#include <breakwater/search/tuner.h>

#include <gtest/gtest.h>

#include <pagmo/utils/multi_objective.hpp>

#include <breakwater/config/toml_file.h>

namespace breakwater::evaluation_test {
namespace {

Tuning tuning() {
  Tuning tuning;
  tuning.objectives = {{.metric = "t", .goal = Goal::min, .over = Over::median},
                       {.metric = "g", .goal = Goal::max, .over = Over::worst}};
  tuning.constraints = {{.metric = "b", .max = 2.0, .over = Over::worst}};
  return tuning;
}

PointResult run(double t, double g, double b) {
  PointResult result;
  result.metrics = {{"t", t}, {"g", g}, {"b", b}};
  return result;
}

TEST(Evaluation, GathersManyRuns) {
  EXPECT_EQ(gathered({3, 1, 2, 9}, Over::median, true), 2.5);
  EXPECT_EQ(gathered({3, 1, 2, 10}, Over::mean, true), 4.0);
  EXPECT_EQ(gathered({1, 2}, Over::q90, true), 1.9);
  EXPECT_EQ(gathered({1, 2}, Over::q90, false), 1.1);
  EXPECT_EQ(gathered({3, 1, 2}, Over::worst, true), 3.0);
  EXPECT_EQ(gathered({3, 1, 2}, Over::worst, false), 1.0);
  const Evaluation one = evaluate(tuning(), {run(1, 5, 0), run(3, 4, 2), run(2, 6, 1)}, false);
  EXPECT_TRUE(one.is_feasible());
  EXPECT_EQ(fitness(tuning(), one, 7), (std::vector<double>{2.0, -4.0}));
}

TEST(Evaluation, RanksFeasibleAboveViolatedAboveFailed) {
  const Evaluation good = evaluate(tuning(), {run(1e9, -1e9, 2)}, false);
  const Evaluation bad = evaluate(tuning(), {run(0, 1, 2.1)}, false);
  const Evaluation worse = evaluate(tuning(), {run(0, 1, 50)}, false);
  PointResult failure = run(0, 1, 0);
  failure.status = PointStatus::failed;
  const Evaluation failed = evaluate(tuning(), {run(0, 1, 0), failure}, false);
  PointResult without = run(0, 1, 0);
  without.metrics.pop_back();
  const Evaluation lacking = evaluate(tuning(), {without}, false);
  EXPECT_FALSE(bad.is_feasible());
  EXPECT_EQ(failed.failures, 1U);
  EXPECT_EQ(lacking.failures, 1U);
  const std::vector<std::vector<double>> in_order = {
      fitness(tuning(), good, 0), fitness(tuning(), bad, 1), fitness(tuning(), worse, 2),
      fitness(tuning(), failed, 3), fitness(tuning(), lacking, 4)};
  for (std::size_t i = 1; i < in_order.size(); ++i) {
    EXPECT_TRUE(pagmo::pareto_dominance(in_order[i - 1], in_order[i])) << i;
  }
  // No two are equal.
  EXPECT_TRUE(pagmo::pareto_dominance(fitness(tuning(), failed, 3), fitness(tuning(), failed, 4)));
}

TEST(Evaluation, FreshRunsHaveIntervals) {
  std::vector<PointResult> runs;
  for (int i = 0; i < 50; ++i) runs.push_back(run(i, i, 0));
  const Evaluation one = evaluate(tuning(), runs, true);
  ASSERT_TRUE(one.objectives[0].interval);
  EXPECT_EQ(one.objectives[0].interval->lower, 17.0);  // ranks 18 and 33 of 50
  EXPECT_EQ(one.objectives[0].interval->upper, 32.0);
  EXPECT_FALSE(one.objectives[1].interval);
}

TEST(Evaluation, WorldsAreAllCombinations) {
  Worlds worlds;
  worlds.seeds = {5, 6};
  worlds.keys = {{.key = "a", .values = {"1", "2"}}, {.key = "b", .values = {"3"}}};
  ASSERT_EQ(worlds.size(), 4U);
  EXPECT_EQ(worlds.sets(1), (std::vector<std::string>{"a=1", "b=3", "run.seed=6"}));
  EXPECT_EQ(worlds.sets(2), (std::vector<std::string>{"a=2", "b=3", "run.seed=5"}));
  EXPECT_EQ(Worlds().size(), 1U);
}

TEST(Evaluation, AFileRoundTrips) {
  const std::string text = R"toml(
scenario = "s"
budget = 80
population = 40
seeds = { first = 1, count = 3 }
[set]
"run.duration_s" = 3.0
[for_each."a-0.5N"]
"k.one" = { log_uniform = [1, 10] }
[for_each.b]
"k.two" = [1, 2]
[world]
"w.x" = "lin(0,1,3)"
[objective]
t = { goal = "min", over = "q90", reference = 4 }
g = { goal = "max" }
[constraint]
b = { max = 1 }
[validate]
seeds = [9]
world.w.x = [0.5]
)toml";
  const auto parsed = [](const std::string& toml) {
    return toml::parse(toml, std::string("t.toml"));
  };
  const Tuning first = read_tuning(parsed(text), "t.toml");
  EXPECT_EQ(read_tuning(parsed(first.print()), "t.toml").print(), first.print());
  EXPECT_EQ(first.worlds.size(), 9U);
  EXPECT_EQ(first.cases[0].name, "a-0.5N");
  EXPECT_EQ(first.validation->sets(0), (std::vector<std::string>{"w.x=0.5", "run.seed=9"}));
}

}  // namespace
}  // namespace breakwater::evaluation_test
