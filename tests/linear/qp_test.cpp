// The active-set solver, where Python cannot look: tests/python/linear_test.py has the rest.
#include <breakwater/linear/active_set.h>
#include "linear/random_qp.h"

namespace breakwater::qp_test {

using testing::kQpSizes;
using testing::QpSize;
using testing::Random;
using testing::random_feasible_input;
using testing::random_qp_model;

// minimise ½|z|² − z·(1, 1), z ≤ (½, 2).
QpModel unit_model() {
  return {Eigen::MatrixXd::Identity(2, 2), Eigen::MatrixXd::Identity(2, 2)};
}

// z_1 ≤ 0 and z_1 + tilt z_2 ≥ by. A z_2 of `by`/tilt or more satisfies both.
TEST(Infeasibility, TheMarginIsTheSmallestViolation) {
  struct Case {
    const char* name;
    double tilt, by, softness, y_1, y_2, least, most;
  };
  for (const Case& c : {Case{"contradict each other", 0.0, 1.0, 0.0, 1.0, -1.0, 1e14, 1e16},
                        Case{"by little", 0.0, 1e-6, 0.0, 1.0, -1.0, 1e14, 1e16},
                        Case{"in other units", 0.0, 1e9, 0.0, 1.0, -1.0, 1e14, 1e16},
                        Case{"meet far away", 1e-3, 1.0, 0.0, 1.0, -1.0, 999.0, 1000.0},
                        Case{"are satisfied", 0.0, -1.0, 0.0, 1.0, -1.0, 0.0, 0.0},
                        Case{"not this combination", 0.0, 1.0, 0.0, 1.0, -0.5, 0.0, 1.0},
                        Case{"one row alone", 0.0, 1.0, 0.0, 0.0, -1.0, 0.0, 1.0},
                        Case{"a side without a bound", 0.0, 1.0, 0.0, -1.0, 1.0, 0.0, 0.0},
                        Case{"gives way", 0.0, 1.0, 0.1, 1.0, -1.0, 0.0, 0.0},
                        Case{"nothing", 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 0.0}}) {
    QpModel model = unit_model();
    model.Omega << 1.0, 0.0, 1.0, c.tilt;
    QpInput input(2, 2);
    input.upper(0) = 0.0;
    input.lower(1) = c.by;
    input.softness(0) = c.softness;
    const double margin = infeasibility_margin(model, input, Eigen::Vector2d(c.y_1, c.y_2));
    EXPECT_GE(margin, c.least) << c.name;
    EXPECT_LE(margin, c.most) << c.name;
  }
}

TEST(ActiveSet, NewMatricesAreANewProblem) {
  Random random(38);
  for (int i = 0; i < 200; ++i) {
    const QpSize size = kQpSizes[i % 2];
    const QpModel first = random_qp_model(random, size), second = random_qp_model(random, size);
    ActiveSetQp changed(first, 1000), fresh(second, 1000);
    QpSolution solution(size.variables, size.rows), expected = solution;
    changed.solve(random_feasible_input(random, first), solution);
    const QpInput input = random_feasible_input(random, second);
    changed.set_matrices(second.H, second.Omega);
    changed.solve(input, solution);
    fresh.solve(input, expected);
    ASSERT_EQ(solution.status, QpStatus::solved) << i;
    const Eigen::VectorXd pull = second.Omega.transpose() * solution.mu;
    ASSERT_LE((second.H * solution.z + input.g + pull).norm(),
              1e-7 * (input.g.norm() + pull.norm()));
    ASSERT_LT((solution.z - expected.z).cwiseAbs().maxCoeff(), 1e-6) << i;
  }
  ActiveSetQp solver(unit_model(), 10);
  EXPECT_THROW(solver.set_matrices(Eigen::MatrixXd::Identity(3, 3), unit_model().Omega),
               std::invalid_argument);
}

// A restart has the full number of iterations and its own answer.
TEST(ActiveSet, AColdRetryHasItsOwnBudget) {
  Random random;
  int retried = 0;
  for (int k = 0; k < 2000; ++k) {
    const QpSize& size = kQpSizes[k % 3];
    const QpModel model = random_qp_model(random, size);
    const QpInput first = random_feasible_input(random, model);
    const QpInput second = random_feasible_input(random, model);
    QpSolution before(size.variables, size.rows), cold = before, warm = before, capped = before;
    ActiveSetQp unlimited(model, 10000);
    unlimited.solve(first, before);
    unlimited.solve(second, warm);
    ActiveSetQp(model, 10000).solve(second, cold);
    const int cap = std::max({before.iterations, cold.iterations, 1});
    if (warm.iterations <= cap) continue;
    ++retried;
    ActiveSetQp solver(model, cap);
    solver.solve(first, capped);
    ASSERT_EQ(capped.status, QpStatus::solved) << k;
    solver.solve(second, capped);
    EXPECT_EQ(capped.status, QpStatus::solved) << k;
    EXPECT_EQ(capped.z, cold.z) << k;
    EXPECT_EQ(capped.iterations, cap + cold.iterations) << k << ": of both attempts";
  }
  EXPECT_GT(retried, 20);
}

// If both attempts reach the limit, the result is the last point of the second one.
TEST(ActiveSet, TwoFailuresDoNotGiveTheUnconstrainedMinimum) {
  Random random;
  int capped = 0;
  for (int k = 0; k < 1000; ++k) {
    const QpModel model = random_qp_model(random, kQpSizes[2]);
    QpSolution solution(3, 106), cold = solution;
    ActiveSetQp solver(model, 2);
    solver.solve(random_feasible_input(random, model), solution);
    const bool was_solved = solution.status == QpStatus::solved;
    const QpInput input = random_feasible_input(random, model);
    solver.solve(input, solution);
    ActiveSetQp(model, 2).solve(input, cold);
    if (!was_solved || cold.status != QpStatus::iteration_cap) continue;
    if (solution.status != QpStatus::iteration_cap) continue;
    ++capped;
    EXPECT_EQ(solution.z, cold.z) << k;
    EXPECT_GT((model.H * solution.z + input.g).norm(), 1e-6) << k;
  }
  EXPECT_GT(capped, 3);
}

}  // namespace breakwater::qp_test
