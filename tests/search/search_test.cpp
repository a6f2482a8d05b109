// Searches, and the evaluation of their candidates.
#include <pagmo/problem.hpp>
#include <pagmo/problems/dtlz.hpp>
#include <pagmo/problems/zdt.hpp>
#include <pagmo/utils/hypervolume.hpp>
#include <pagmo/utils/multi_objective.hpp>

#include <breakwater/config/toml_file.h>
#include <breakwater/search/search.h>
#include <breakwater/search/tuner.h>
#include "support.h"

namespace breakwater::search_test {

struct Asked {
  Vectors u, answers;
  std::size_t largest_batch = 0;
};

Asked run(const SearchSettings& settings,
          const std::function<std::vector<double>(const std::vector<double>&)>& f) {
  Asked asked;
  search(settings, [&](const Vectors& points) {
    Vectors answers;
    for (const auto& u : points) {
      for (const double one : u) EXPECT_TRUE(one > 0.0 && one < 1.0);
      answers.push_back(f(u));
      asked.u.push_back(u);
      asked.answers.push_back(answers.back());
    }
    asked.largest_batch = std::max(asked.largest_batch, points.size());
    return answers;
  });
  return asked;
}

Vectors front_points(const Asked& asked) {
  Vectors front;
  for (const std::size_t i : front_of(asked.answers)) front.push_back(asked.answers[i]);
  return front;
}

// Points that are not below the reference have no volume.
double volume_below(Vectors front, const std::vector<double>& reference) {
  std::erase_if(
      front, [&](const auto& point) { return !std::ranges::equal(point, reference, std::less()); });
  return pagmo::hypervolume(front, true).compute(reference);
}

// Front: f₂ = 1 − √f₁. Volume below (1, 1): 2/3.
TEST(Search, FindsTheFrontOfZDT1) {
  const pagmo::problem zdt1{pagmo::zdt(1, 10)};
  for (const auto& [algorithm, least] :
       {std::pair(SearchAlgorithm::nsga2, 0.65), std::pair(SearchAlgorithm::nspso, 0.60)}) {
    const Asked asked = run({.algorithm = algorithm, .dimension = 10, .budget = 8000, .seed = 4},
                            [&](const auto& u) { return zdt1.fitness(u); });
    EXPECT_EQ(asked.answers.size(), 8000U);
    EXPECT_EQ(asked.largest_batch, 40U);
    const double volume = volume_below(front_points(asked), {1.0, 1.0});
    EXPECT_GT(volume, least);
    EXPECT_LT(volume, 2.0 / 3.0);
  }
}

// Front: the part of the unit sphere with positive coordinates. Volume below (1, 1, 1): 1 − π/6.
TEST(Search, FindsTheFrontOfDTLZ2) {
  const pagmo::problem dtlz2{pagmo::dtlz(2, 7, 3)};
  const Asked asked = run({.dimension = 7, .objectives = 3, .budget = 6000, .population = 60},
                          [&](const auto& u) { return dtlz2.fitness(u); });
  const Vectors front = front_points(asked);
  const double volume = volume_below(front, {1.0, 1.0, 1.0});
  EXPECT_GT(volume, 0.42);
  EXPECT_LT(volume, 1.0 - std::numbers::pi / 6.0);
  for (const auto& point : front) {
    EXPECT_GE(std::hypot(point[0], point[1], point[2]), 1.0 - 1e-12);
  }
}

TEST(Search, FrontsMatchPagmo) {
  testing::Random random;
  for (const std::size_t objectives : {2, 3, 4}) {
    Vectors points;
    for (int i = 0; i < 300; ++i) {
      std::vector<double> point;
      for (std::size_t k = 0; k < objectives; ++k) {
        point.push_back(std::round(20.0 * random.uniform(0.0, 1.0)) / 20.0);  // ties
      }
      points.push_back(point);
    }
    const auto sorted = std::get<0>(pagmo::fast_non_dominated_sorting(points));
    std::set<std::vector<double>> theirs, ours;
    for (const auto i : sorted.front()) theirs.insert(points[i]);
    for (const auto i : front_of(points)) EXPECT_TRUE(ours.insert(points[i]).second);
    EXPECT_EQ(ours, theirs);
  }
  EXPECT_EQ(evenly_spaced(5, 3), (std::vector<std::size_t>{0, 2, 4}));
  EXPECT_EQ(evenly_spaced(2, 3), (std::vector<std::size_t>{0, 1}));
}

TEST(Search, FindsAMinimum) {
  const auto f = [](const std::vector<double>& u) {
    const double x = 4.0 * u[0] - 2.0, y = 4.0 * u[1] - 2.0;
    return std::vector<double>{std::pow(1.0 - x, 2) + 10.0 * std::pow(y - x * x, 2)};
  };
  for (const auto& [algorithm, population] :
       {std::pair(SearchAlgorithm::cmaes, 10), std::pair(SearchAlgorithm::bobyqa, 1)}) {
    const Asked asked = run({.algorithm = algorithm,
                             .dimension = 2,
                             .objectives = 1,
                             .budget = 600,
                             .population = static_cast<std::size_t>(population)},
                            f);
    EXPECT_LE(asked.answers.size(), 600U);
    EXPECT_LT(std::min_element(asked.answers.begin(), asked.answers.end())->front(), 1e-6);
  }
}

// A resumed tuning replays the answers, so equal answers must lead to equal points.
TEST(Search, RepeatsItsPointsAndKeepsToItsBudget) {
  const auto f = [](const std::vector<double>& u) {
    if (u[0] > 0.7) return std::vector<double>{1e13 * (1.0 + u[1]), 1e13 * (1.0 + u[1])};
    return std::vector<double>{u[0], 1.0 - u[0] + u[1]};
  };
  for (const auto& [name, algorithm] : search_algorithms()) {
    SearchSettings settings{
        .algorithm = algorithm, .dimension = 3, .budget = 107, .population = 16};
    auto g = std::function<std::vector<double>(const std::vector<double>&)>(f);
    if (!has_several_objectives(algorithm)) {
      settings.objectives = 1;
      g = [&](const auto& u) { return std::vector<double>{f(u)[1]}; };
    }
    const Asked asked = run(settings, g);
    EXPECT_EQ(asked.u, run(settings, g).u) << name;
    EXPECT_LE(asked.u.size(), used_budget(settings)) << name;
    if (algorithm != SearchAlgorithm::bobyqa) {
      EXPECT_EQ(asked.u.size(), used_budget(settings)) << name;
    }
    settings.seed = 2;
    EXPECT_EQ(asked.u == run(settings, g).u, algorithm == SearchAlgorithm::bobyqa) << name;
  }
}

TEST(Search, PassesExceptionsOn) {
  struct Stop {};
  for (const auto& [name, algorithm] : search_algorithms()) {
    const std::size_t objectives = has_several_objectives(algorithm) ? 2 : 1;
    int calls = 0;
    const auto evaluate = [&](const Vectors& points) -> Vectors {
      if (++calls == 2) throw Stop();
      return Vectors(points.size(), std::vector<double>(objectives, 1.0));
    };
    EXPECT_THROW(
        search({.algorithm = algorithm, .dimension = 2, .objectives = objectives}, evaluate), Stop)
        << name;
  }
}

TEST(Search, RefusesInvalidSettings) {
  using enum SearchAlgorithm;
  EXPECT_NE(objection({.algorithm = nsga2, .objectives = 1}), "");
  EXPECT_NE(objection({.algorithm = cmaes, .objectives = 2}), "");
  EXPECT_NE(objection({.algorithm = bobyqa, .dimension = 1, .objectives = 1}), "");
  EXPECT_NE(objection({.algorithm = nsga2, .population = 42}), "");
  EXPECT_NE(objection({.algorithm = nspso, .budget = 79, .population = 40}), "");
  EXPECT_NE(objection({.dimension = 0}), "");
  EXPECT_EQ(objection({.algorithm = nspso, .budget = 80, .population = 40}), "");
  EXPECT_THROW(search({.objectives = 1}, nullptr), std::invalid_argument);
}

Tuning tuning() {
  Tuning tuning;
  tuning.objectives = {{.metric = "t", .goal = Goal::min, .over = Over::median},
                       {.metric = "g", .goal = Goal::max, .over = Over::worst}};
  tuning.constraints = {{{.metric = "b", .max = 2.0}, Over::worst}};
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
  const Plan worlds =
      worlds_of({5, 6}, {{.key = "a", .values = {"1", "2"}}, {.key = "b", .values = {"3"}}}, false);
  ASSERT_EQ(worlds.size(), 4U);
  EXPECT_EQ(worlds.point(1).sets, (std::vector<std::string>{"a=1", "b=3", "run.seed=6"}));
  EXPECT_EQ(worlds.point(2).sets, (std::vector<std::string>{"a=2", "b=3", "run.seed=5"}));
  EXPECT_EQ(Tuning().worlds.size(), 1U);
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
t = { goal = "min", over = "q90" }
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
  EXPECT_EQ(first.validation->point(0).sets, (std::vector<std::string>{"w.x=0.5", "run.seed=9"}));
}

}  // namespace breakwater::search_test
