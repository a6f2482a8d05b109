// The two quadratic programming solvers against optimality conditions and each other.
#include <breakwater/linear/qp.h>

#include <Eigen/LU>

#include <breakwater/linear/active_set.h>
#include "linear/random_qp.h"
#include "python.h"

namespace breakwater::qp_test {

using testing::kQpSizes;
using testing::make_infeasible;
using testing::optimality_error;
using testing::QpSize;
using testing::Random;
using testing::random_feasible_input;
using testing::random_qp_model;

// minimise ½|z|² − z·(1, 1), z ≤ (½, 2).
QpModel unit_model() {
  return {Eigen::MatrixXd::Identity(2, 2), Eigen::MatrixXd::Identity(2, 2)};
}

class BothSolvers : public ::testing::TestWithParam<QpSolverKind> {
 protected:
  static std::unique_ptr<QpSolver> make(const QpModel& model, int cap = 10000) {
    return make_qp_solver(GetParam(), model, cap);
  }
};
INSTANTIATE_TEST_SUITE_P(Qp, BothSolvers,
                         ::testing::Values(QpSolverKind::hildreth, QpSolverKind::active_set),
                         [](const auto& solver) {
                           return solver.param == QpSolverKind::hildreth ? "hildreth"
                                                                         : "active_set";
                         });

TEST_P(BothSolvers, SolveByHand) {
  const auto solver = make(unit_model());
  QpInput input(2, 2);
  input.g << -1.0, -1.0;
  input.upper << 0.5, 2.0;
  QpSolution solution(2, 2);
  solver->solve(input, solution);
  EXPECT_EQ(solution.status, QpStatus::solved);
  EXPECT_NEAR(solution.z(0), 0.5, 1e-12);
  EXPECT_NEAR(solution.z(1), 1.0, 1e-12);
  EXPECT_NEAR(solution.mu(0), 0.5, 1e-12);
  EXPECT_EQ(solution.mu(1), 0.0);
  EXPECT_LT(solution.kkt_residual, 1e-12);

  // The other side of a constraint has a multiplier with the opposite sign.
  input.lower << 1.5, -kInfinity;
  input.upper << 2.0, kInfinity;
  solver->solve(input, solution);
  EXPECT_NEAR(solution.z(0), 1.5, 1e-12);
  EXPECT_NEAR(solution.mu(0), -0.5, 1e-12);
}

TEST_P(BothSolvers, WithoutActiveConstraintsTheyTakeTheNewtonStep) {
  Random random;
  for (const Eigen::Index rows : {30, 0}) {
    QpModel model = random_qp_model(random, kQpSizes[0]);
    model.Omega = model.Omega.topRows(rows).eval();
    const auto solver = make(model);
    QpInput input(5, rows);
    QpSolution solution(5, rows);
    for (int i = 0; i < 2; ++i) {
      input.g = random.vector(5);
      solver->solve(input, solution);
      EXPECT_EQ(solution.status, QpStatus::solved);
      EXPECT_LT((model.H * solution.z + input.g).norm(), 1e-12);
      EXPECT_EQ(solution.mu.norm(), 0.0);
    }
  }
}

TEST_P(BothSolvers, NanIsNeverSolved) {
  Random random;
  const QpModel model = random_qp_model(random, kQpSizes[0]);
  const QpInput good = random_feasible_input(random, model);
  const auto solver = make(model);
  QpSolution solution(5, 30);
  const auto expect_refused = [&](const QpInput& bad) {
    solver->solve(good, solution);  // warm
    solver->solve(bad, solution);
    EXPECT_EQ(solution.status, QpStatus::not_finite);
    EXPECT_EQ(solution.z.norm(), 0.0);
    EXPECT_EQ(solution.kkt_residual, kInfinity);
  };
  for (const double bad : {kNaN, kInfinity, -kInfinity}) {
    for (Eigen::Index i = 0; i < 5; ++i) {
      QpInput input = good;
      input.g(i) = bad;
      expect_refused(input);
    }
  }
  for (const auto& [member, bad] :
       {std::pair(&QpInput::lower, kNaN), std::pair(&QpInput::lower, kInfinity),
        std::pair(&QpInput::upper, kNaN), std::pair(&QpInput::upper, -kInfinity),
        std::pair(&QpInput::softness, kNaN), std::pair(&QpInput::softness, -1.0)}) {
    for (Eigen::Index i = 0; i < 30; ++i) {
      QpInput input = good;
      (input.*member)(i) = bad;
      expect_refused(input);
    }
  }
  solver->solve(good, solution);
  EXPECT_NE(solution.status, QpStatus::not_finite) << "must recover";
}

TEST_P(BothSolvers, CrossedBoundsAreInfeasible) {
  const auto solver = make(unit_model());
  QpInput input(2, 2);
  input.lower << 1.0, 0.0;
  input.upper << 0.5, 1.0;
  QpSolution solution(2, 2);
  solver->solve(input, solution);
  EXPECT_EQ(solution.status, QpStatus::infeasible);
  EXPECT_GT(solution.kkt_residual, 0.1);
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

TEST_P(BothSolvers, RefuseInvalidProblems) {
  const Eigen::MatrixXd eye = Eigen::MatrixXd::Identity(2, 2);
  EXPECT_THROW(make({-eye, eye}), std::invalid_argument);
  EXPECT_THROW(make({Eigen::MatrixXd::Zero(2, 2), eye}), std::invalid_argument);
  EXPECT_THROW(make({eye, Eigen::MatrixXd::Identity(3, 3)}), std::invalid_argument);
  EXPECT_THROW(make({Eigen::MatrixXd(), Eigen::MatrixXd()}), std::invalid_argument);
  EXPECT_THROW(make({kNaN * eye, eye}), std::invalid_argument);
  EXPECT_THROW(make({eye, kNaN * eye}), std::invalid_argument);
  EXPECT_THROW(make({eye + Eigen::MatrixXd::Ones(2, 2).triangularView<Eigen::Upper>() * eye, eye}),
               std::invalid_argument)
      << "not symmetric";
  EXPECT_THROW(make({eye, eye}, 0), std::invalid_argument);
}

TEST_P(BothSolvers, SoftRowIsAQuadraticPenalty) {
  // minimise ½ z² + ½ v²/s with v = z − 1 ≥ 0 as a soft constraint: at z = 0 it is violated.
  QpModel model{Eigen::MatrixXd::Identity(1, 1), Eigen::MatrixXd::Identity(1, 1)};
  const auto solver = make(model);
  QpInput input(1, 1);
  input.lower << 1.0;
  QpSolution solution(1, 1);
  for (const double softness : {0.0, 0.25, 4.0}) {
    input.softness << softness;
    solver->solve(input, solution);
    EXPECT_EQ(solution.status, QpStatus::solved);
    EXPECT_NEAR(solution.z(0), 1.0 / (1.0 + softness), 1e-9) << softness;
  }
}

// Two constraints that nearly contradict each other make coordinate ascent slow.
QpModel slow_model() {
  QpModel model{Eigen::MatrixXd::Identity(2, 2), QpModel::RowMajor(2, 2)};
  model.Omega << 1.0, 0.05, -1.0, 0.05;
  return model;
}

TEST(Hildreth, TheIterationLimitIsReportedAndItsAnswerViolatesConstraints) {
  const QpModel model = slow_model();
  QpInput input(2, 2);
  input.g << -1.0, -1.0;
  input.upper << -1.0, 0.9;
  HildrethQp hildreth(model, 3);
  QpSolution solution(2, 2);
  hildreth.solve(input, solution);
  EXPECT_EQ(solution.status, QpStatus::iteration_cap);
  EXPECT_EQ(solution.iterations, 3);
  EXPECT_GT((model.Omega * solution.z - input.upper).maxCoeff(), 1e-3);
  EXPECT_GT(solution.kkt_residual, 1e-3);

  ActiveSetQp exact(model, 100);
  exact.solve(input, solution);
  EXPECT_EQ(solution.status, QpStatus::solved);
  EXPECT_LT(solution.kkt_residual, 1e-12);
}

// The textbook algorithm: it computes every residual anew, starts cold, and uses one-sided
// constraints.
Eigen::VectorXd textbook_hildreth(const QpModel& model, const QpInput& input, int sweeps) {
  const Eigen::Index m = model.Omega.rows();
  QpModel::RowMajor sides(2 * m, model.H.rows());
  Eigen::VectorXd bound(2 * m);
  for (Eigen::Index i = 0; i < m; ++i) {
    sides.row(2 * i) = model.Omega.row(i);
    sides.row(2 * i + 1) = -model.Omega.row(i);
    bound(2 * i) = input.upper(i);
    bound(2 * i + 1) = -input.lower(i);
  }
  const Eigen::MatrixXd H_inverse = model.H.inverse();
  const Eigen::MatrixXd P = sides * H_inverse * sides.transpose();
  const Eigen::VectorXd d = bound + sides * H_inverse * input.g;
  Eigen::VectorXd lambda = Eigen::VectorXd::Zero(2 * m);
  for (int k = 0; k < sweeps; ++k) {
    for (Eigen::Index i = 0; i < 2 * m; ++i) {
      const double w = P.row(i).dot(lambda) - P(i, i) * lambda(i) + d(i);
      lambda(i) = std::max(0.0, -w / P(i, i));
    }
  }
  return -H_inverse * (input.g + sides.transpose() * lambda);
}

// The multipliers of an infeasible problem grow without bound. The next solve must not start with
// them.
TEST(Hildreth, StartsColdAfterAnInfeasibleProblem) {
  QpModel model{Eigen::MatrixXd::Identity(2, 2), QpModel::RowMajor(2, 2)};
  model.Omega << 1.0, 0.0, -1.0, 0.0;
  QpInput feasible(2, 2);
  feasible.g << -1.0, 0.0;
  feasible.upper << 0.5, 0.6;
  QpInput infeasible = feasible;
  infeasible.upper << -10.0, -10.0;
  QpSolution cold(2, 2), solution(2, 2);
  HildrethQp(model, 40).solve(feasible, cold);
  ASSERT_EQ(cold.status, QpStatus::solved);
  HildrethQp hildreth(model, 40);
  hildreth.solve(infeasible, solution);
  ASSERT_NE(solution.status, QpStatus::solved);
  ASSERT_GT(solution.mu.cwiseAbs().maxCoeff(), 100.0);
  hildreth.solve(feasible, solution);
  EXPECT_EQ(solution.status, QpStatus::solved);
  EXPECT_EQ(solution.iterations, cold.iterations);
  EXPECT_EQ(solution.z, cold.z);
}

TEST(Hildreth, GoesOnAfterACappedColdStart) {
  QpInput input(2, 2);
  input.g << -1.0, -1.0;
  input.upper << -0.5, 0.51;
  for (const int cap : {1, 3, 40}) {
    HildrethQp hildreth(slow_model(), cap);
    QpSolution solution(2, 2), whole(2, 2);
    hildreth.solve(input, solution);
    ASSERT_EQ(solution.status, QpStatus::iteration_cap) << cap;
    for (int solves = 2; solves <= 5; ++solves) {
      hildreth.solve(input, solution);
      HildrethQp(slow_model(), solves * cap).solve(input, whole);
      EXPECT_NEAR((solution.z - whole.z).norm(), 0.0, 1e-9) << cap << " " << solves;
    }
  }
}

// Nearly opposite constraints: both multipliers must grow together, from small values.
TEST(Hildreth, GoesOnWhereMultipliersGrowTogether) {
  for (const double second : {0.1, 0.05, 0.005}) {  // violation at z_free = (1, 1)
    const double first = std::max(second, 0.01);
    QpInput input(2, 2);
    input.g << -1.0, -1.0;
    input.upper << 1.05 - first, -0.95 - second;
    for (const int cap : {10, 40, 60}) {
      HildrethQp hildreth(slow_model(), cap);
      QpSolution solution(2, 2);
      int solves = 0;
      do {
        hildreth.solve(input, solution);
      } while (solution.status == QpStatus::iteration_cap && ++solves < 2000);
      EXPECT_EQ(solution.status, QpStatus::solved) << second << " " << cap;
    }
  }
}

// For any number of sweeps and any previous multipliers.
TEST(Hildreth, MultipliersStaySmallAfterInfeasibleProblems) {
  Random random;
  for (int k = 0; k < 12; ++k) {
    QpModel model = random_qp_model(random, kQpSizes[k % 3]);
    QpInput feasible = random_feasible_input(random, model);
    QpInput infeasible = feasible;
    make_infeasible(random, model, infeasible, 10.0);
    const Eigen::Index last = model.Omega.rows() - 1;
    feasible.lower(last) = -kInfinity;
    feasible.upper(last) = kInfinity;
    for (const int cap : {1, 5, 40}) {
      HildrethQp hildreth(model, cap);
      QpSolution solution(model.H.rows(), model.Omega.rows());
      const auto largest_after = [&](int solves) {
        double largest = 0.0;
        for (int i = 0; i < solves; ++i) {
          hildreth.solve(infeasible, solution);
          EXPECT_NE(solution.status, QpStatus::solved);
          largest = std::max(largest, solution.mu.lpNorm<Eigen::Infinity>());
        }
        return largest;
      };
      hildreth.solve(feasible, solution);
      const double before = solution.mu.lpNorm<Eigen::Infinity>();
      const double soon = largest_after(4000 / cap);
      EXPECT_LE(largest_after(8000 / cap), 1.5 * std::max(before, soon)) << k << " cap " << cap;
    }
  }
}

TEST(Hildreth, IncrementalResidualsAreTheTextbooksAlgorithm) {
  Random random;
  for (int k = 0; k < 50; ++k) {
    const QpModel model = random_qp_model(random, kQpSizes[k % 3]);
    const QpInput input = random_feasible_input(random, model);
    QpSolution solution(model.H.rows(), model.Omega.rows());
    HildrethQp hildreth(model, 7);
    hildreth.solve(input, solution);
    if (solution.status != QpStatus::iteration_cap) continue;
    const Eigen::VectorXd expected = textbook_hildreth(model, input, 7);
    EXPECT_LT((solution.z - expected).norm(), 1e-9 * (1.0 + expected.norm())) << k;
  }
}

// Solves feasible problems to 1e-8, cold and along a slowly changing sequence.
void solve_random_problems(const QpSize& size, int models, int inputs, unsigned seed) {
  Random random(seed);
  int changes = 0;
  for (int k = 0; k < models; ++k) {
    const QpModel model = random_qp_model(random, size);
    ActiveSetQp solver(model, 10000);
    QpInput input = random_feasible_input(random, model);
    QpSolution solution(size.variables, size.rows);
    for (int i = 0; i < inputs; ++i) {
      solver.solve(input, solution);
      ASSERT_EQ(solution.status, QpStatus::solved) << k << " " << i;
      ASSERT_LE(solution.kkt_residual, 1e-8) << k << " " << i;
      ASSERT_LE(optimality_error(model, input, solution), 1e-8) << k << " " << i;
      changes += solution.iterations;
      solver.solve(input, solution);
      ASSERT_EQ(solution.iterations, 0) << "already at the solution";
      if (i % 8 == 7) {
        input = random_feasible_input(random, model);
      } else {
        input.g += 0.1 * random.vector(size.variables, input.g.cwiseAbs().maxCoeff());
      }
    }
  }
  EXPECT_GT(changes, models * inputs / 4) << "the constraints hardly mattered";
}

TEST(ActiveSet, SolvesAHundredThousandRandomProblems) {
  solve_random_problems(kQpSizes[0], 660, 50, 101);
  solve_random_problems(kQpSizes[1], 660, 50, 102);
  solve_random_problems(kQpSizes[2], 660, 50, 103);
  solve_random_problems(kQpSizes[3], 20, 50, 104);
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
    ASSERT_LT(optimality_error(second, input, solution), 1e-7) << i;
    ASSERT_LT((solution.z - expected.z).cwiseAbs().maxCoeff(), 1e-6) << i;
  }
  ActiveSetQp solver(unit_model(), 10);
  EXPECT_THROW(solver.set_matrices(Eigen::MatrixXd::Identity(3, 3), unit_model().Omega),
               std::invalid_argument);
}

// Two equations contradict each other by less than the rounding error of their sums.
TEST(ActiveSet, RoundingDoesNotExhaustTheIterations) {
  QpModel model = unit_model();
  model.Omega << 0.3, 0.7, 0.3, 0.7;
  QpInput input(2, 2);
  input.lower.setConstant(1e12 / 3.0);
  input.lower(1) += 1e-4;
  input.upper = input.lower;
  QpSolution solution(2, 2);
  ActiveSetQp(model, 100).solve(input, solution);
  EXPECT_EQ(solution.status, QpStatus::solved) << "the contradiction is below rounding";
  EXPECT_LT(solution.kkt_residual, 1e-14);
  EXPECT_LT((model.Omega * solution.z - input.upper).cwiseAbs().maxCoeff(), 1e-3);
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

// Interior-point solutions are less accurate: they agree within their own residual.
TEST(ActiveSet, AgreesWithCvxopt) {
  Random random(11);
  std::ostringstream problems;
  problems.precision(17);
  std::vector<QpModel> models;
  std::vector<QpInput> inputs;
  std::vector<Eigen::VectorXd> ours;
  for (int k = 0; k < 1000; ++k) {
    const QpSize& size = k % 100 == 99 ? kQpSizes[3] : kQpSizes[k % 3];
    const QpModel model = random_qp_model(random, size);
    QpInput input = random_feasible_input(random, model);
    // It cannot start if a constraint has no interior.
    for (Eigen::Index i = 0; i < size.rows; ++i) {
      if (input.upper(i) - input.lower(i) < 1e-3) input.upper(i) += 1e-3;
    }
    problems << size.variables << ' ' << size.rows << '\n'
             << model.H << '\n'
             << model.Omega << '\n'
             << input.g << '\n'
             << input.lower << '\n'
             << input.upper << '\n';
    QpSolution solution(size.variables, size.rows);
    ActiveSetQp(model, 10000).solve(input, solution);
    ASSERT_EQ(solution.status, QpStatus::solved) << k;
    models.push_back(model);
    inputs.push_back(input);
    ours.push_back(solution.z);
  }
  const std::vector<double> theirs = testing::run_python("linear/cvxopt_qp.py", problems.str());
  std::size_t at = 0;
  for (std::size_t k = 0; k < ours.size(); ++k) {
    const auto n = static_cast<std::size_t>(ours[k].size());
    ASSERT_LE(at + n, theirs.size());
    const Eigen::VectorXd z = Eigen::Map<const Eigen::VectorXd>(theirs.data() + at, ours[k].size());
    at += n;
    EXPECT_LT((ours[k] - z).norm(), 1e-5 * (1.0 + z.norm())) << k;
    const auto cost = [&](const Eigen::VectorXd& x) {
      return 0.5 * x.dot(models[k].H * x) + inputs[k].g.dot(x);
    };
    EXPECT_NEAR(cost(ours[k]), cost(z), 1e-6 * (1.0 + std::abs(cost(z)))) << k;
  }
  EXPECT_EQ(at, theirs.size());
}

}  // namespace breakwater::qp_test
