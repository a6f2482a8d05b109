// Any quadratic program: a result satisfies the KKT conditions or has an honest status.
#include <breakwater/linear/qp.h>
#include "linear/hard_qp.h"
#include "linear/known_qp.h"

namespace breakwater::qp_property_test {

using testing::HardQp;
using testing::Random;

constexpr int kMostSweeps = 300;

// A program of any condition that has a solution, or with a bound too many, or with one input that
// is wrong.
HardQp any_program(Random& random) {
  HardQp qp = testing::hard_feasible_qp(random);
  const auto any_of = [&random](Eigen::Index size) {
    return static_cast<Eigen::Index>(random.uniform(0.0, static_cast<double>(size)));
  };
  QpInput& input = qp.input;
  const Eigen::Index row = any_of(input.lower.size());
  const double change = random.uniform(0.0, 1.0);
  const double sign = random.uniform(-1.0, 1.0) < 0.0 ? -1.0 : 1.0;
  if (change < 0.2) {
    input.lower(row) = input.upper(row) + random.uniform(-1.0, 1.0);
  } else if (change < 0.3) {
    input.softness(row) = std::pow(10.0, random.uniform(-6.0, 2.0));
  } else if (change < 0.4) {
    input.g(any_of(input.g.size())) =
        random.uniform(0.0, 1.0) < 0.5 ? std::nan("") : sign * kNoBound;
  } else if (change < 0.45) {
    input.upper(row) = random.uniform(0.0, 1.0) < 0.5 ? std::nan("") : -kNoBound;
  } else if (change < 0.5) {
    input.softness(row) = random.uniform(0.0, 1.0) < 0.5 ? -1.0 : kNoBound;
  } else if (change < 0.6) {
    input.g *= std::pow(10.0, random.uniform(-12.0, 12.0));
  }
  return qp;
}

bool is_valid(const QpInput& input) {
  return input.g.allFinite() && (input.lower.array() < kNoBound).all() &&
         (input.upper.array() > -kNoBound).all() && (input.softness.array() >= 0.0).all() &&
         (input.softness.array() < kNoBound).all();
}

class QpProperty : public ::testing::TestWithParam<QpSolverKind> {};
INSTANTIATE_TEST_SUITE_P(Solvers, QpProperty,
                         ::testing::Values(QpSolverKind::hildreth, QpSolverKind::active_set),
                         [](const auto& solver) {
                           return solver.param == QpSolverKind::hildreth ? "hildreth"
                                                                         : "active_set";
                         });

TEST_P(QpProperty, AResultIsOptimalOrSaysThatItIsNot) {
  const int count = testing::property_count(2000);
  Random random(11);
  int statuses[5] = {};
  double largest = 0.0;
  for (int k = 0; k < count; ++k) {
    const auto [model, input] = any_program(random);
    QpSolution s(input.g.size(), input.lower.size());
    make_qp_solver(GetParam(), model, kMostSweeps)->solve(input, s);
    ++statuses[static_cast<int>(s.status)];
    ASSERT_EQ(s.status == QpStatus::not_finite, !is_valid(input)) << k;
    ASSERT_TRUE(s.z.allFinite() && s.mu.allFinite()) << k;
    if (s.status == QpStatus::not_finite) continue;
    if (s.status == QpStatus::infeasible) {
      if ((input.lower.array() > input.upper.array()).any()) continue;
      ASSERT_LE(testing::certificate_error(model, input, s.mu), 1e-5) << k;
      continue;
    }
    // The residual that is reported is the error, whatever the status.
    const double error = testing::optimality_error(model, input, s);
    const double rounding = 1e-12 * (1.0 + s.z.lpNorm<Eigen::Infinity>() *
                                               std::max(model.H.lpNorm<Eigen::Infinity>(),
                                                        model.Omega.lpNorm<Eigen::Infinity>()));
    ASSERT_NEAR(s.kkt_residual, error, rounding + 1e-9 * error) << k;
    if (s.status != QpStatus::solved || GetParam() == QpSolverKind::hildreth) continue;
    ASSERT_LE(error, 1.01 * kQpSolvedBelow + rounding) << k;
    largest = std::max(largest, error);
  }
  std::printf(
      "%d programs: %d solved, %d at the cap, %d infeasible, %d not finite, %d inaccurate, "
      "largest error %.1e\n",
      count, statuses[0], statuses[1], statuses[2], statuses[3], statuses[4], largest);
  // Hildreth's method seldom ends within the sweeps on these conditions.
  EXPECT_GT(statuses[0], GetParam() == QpSolverKind::hildreth ? count / 20 : count / 4);
  EXPECT_GT(statuses[3], count / 20);
}

TEST(HardQpProperty, FeasibleProgramsAreSolved) {
  testing::expect_hard_feasible_qps_are_solved(testing::property_count(4000));
}

TEST(HardQpProperty, InfeasibleProgramsAreProven) {
  testing::expect_hard_infeasible_qps_are_proven(testing::property_count(4000));
}

// In any units. No wrong point is solved, and the active-set solver solves nearly all.
TEST_P(QpProperty, AKnownSolutionIsFoundInAnyUnits) {
  const int count = testing::property_count(3400);
  Random random(12);
  int unsolved[testing::kKnownQpFamilies.size()] = {};
  double largest = 0.0;
  for (int k = 0; k < count; ++k) {
    const std::size_t family = static_cast<std::size_t>(k) % testing::kKnownQpFamilies.size();
    const auto qp = testing::in_other_units(random, testing::known_qp(random, family));
    QpSolution s(qp.z.size(), qp.input.lower.size());
    make_qp_solver(GetParam(), qp.model, kMostSweeps)->solve(qp.input, s);
    const QpStatus right = qp.is_feasible ? QpStatus::solved : QpStatus::infeasible;
    unsolved[family] += s.status != right ? 1 : 0;
    if (s.status != QpStatus::solved) continue;
    const double error = testing::known_error(qp, s.z);
    ASSERT_TRUE(qp.is_feasible) << k << ": " << testing::kKnownQpFamilies[family];
    ASSERT_LE(error, 1e-4) << k << ": " << testing::kKnownQpFamilies[family];
    largest = std::max(largest, error);
  }
  std::printf("%d programs, largest error %.1e; without the right status:\n", count, largest);
  for (std::size_t i = 0; i < testing::kKnownQpFamilies.size(); ++i) {
    std::printf("%6d %s\n", unsolved[i], testing::kKnownQpFamilies[i]);
    if (GetParam() == QpSolverKind::active_set) {
      EXPECT_LE(unsolved[i], 1e-3 * count) << testing::kKnownQpFamilies[i];
    }
  }
}

}  // namespace breakwater::qp_property_test
