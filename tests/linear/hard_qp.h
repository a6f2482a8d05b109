// Ill-conditioned quadratic programs with dependent constraints.
#pragma once

#include <cstdio>

#include "linear/random_qp.h"

namespace breakwater::testing {

/// Solves `count` feasible programs. None may be reported as infeasible, at most 0.3 % may be
/// unsolved, and every solution must be right.
inline void expect_hard_feasible_qps_are_solved(int count) {
  Random random(301);
  int without = 0;
  double largest = 0.0;
  for (int k = 0; k < count; ++k) {
    const auto [model, input] = hard_feasible_qp(random);
    QpSolution solution(model.H.rows(), model.Omega.rows());
    make_qp_solver(QpSolverKind::active_set, model, 1)->solve(input, solution);
    ASSERT_NE(solution.status, QpStatus::infeasible) << k;
    ASSERT_NE(solution.status, QpStatus::not_finite) << k;
    if (solution.status != QpStatus::solved) {
      ++without;
      continue;
    }
    const double error = optimality_error(model, input, solution);
    ASSERT_LE(error, 1e-8) << k;
    largest = std::max(largest, error);
  }
  std::printf("%d feasible programs: %d without a solution, largest residual %.1e\n", count,
              without, largest);
  EXPECT_LE(without, 0.003 * count);
}

/// 1/infeasibility_margin() from the definition, with higher precision and without its rounding:
/// 0 is a certificate, ∞ is none.
inline double certificate_error(const QpModel& model, const QpInput& input,
                                const Eigen::VectorXd& y) {
  const Eigen::VectorXd root = model.H.diagonal().cwiseSqrt();
  long double gap = 0.0L;
  long double reach = kQpGradientShare * input.g.cwiseQuotient(root).lpNorm<Eigen::Infinity>();
  for (Eigen::Index i = 0; i < y.size(); ++i) {
    if (y(i) == 0.0) continue;
    const long double bound = y(i) > 0.0 ? input.upper(i) : input.lower(i);
    gap -= static_cast<long double>(y(i)) * bound;
    const double size =
        model.Omega.row(i).transpose().cwiseQuotient(root).lpNorm<Eigen::Infinity>();
    if (size > 0.0) reach = std::max(reach, std::abs(bound) / size);
  }
  const Eigen::Matrix<long double, Eigen::Dynamic, 1> tilt =
      (model.Omega.cast<long double>().transpose() * y.cast<long double>())
          .cwiseQuotient(root.cast<long double>());
  return gap > 0.0L ? static_cast<double>(reach * tilt.lpNorm<1>() / gap) : kNoBound;
}

/// Solves `count` infeasible programs. None may be solved. All but one in 1e4 must be reported as
/// infeasible with a certificate; rounding hides a few. With the last constraint softened all must
/// be solved.
inline void expect_hard_infeasible_qps_are_proven(int count) {
  Random random(302);
  int without = 0, unproven = 0;
  double largest = 0.0;
  for (int k = 0; k < count; ++k) {
    auto [model, input] = hard_infeasible_qp(random);
    QpSolution solution(model.H.rows(), model.Omega.rows());
    const auto solver = make_qp_solver(QpSolverKind::active_set, model, 1);
    solver->solve(input, solution);
    ASSERT_NE(solution.status, QpStatus::solved) << k;
    if (solution.status != QpStatus::infeasible) {
      ++unproven;
    } else {
      const double error = certificate_error(model, input, solution.mu);
      ASSERT_LE(error, 1e-5) << k;
      largest = std::max(largest, error);
    }
    input.softness(model.Omega.rows() - 1) = 0.1;
    solver->solve(input, solution);
    ASSERT_NE(solution.status, QpStatus::infeasible) << k;
    if (solution.status != QpStatus::solved) {
      ++without;
    } else {
      ASSERT_LE(optimality_error(model, input, solution), 1e-8) << k;
    }
  }
  std::printf(
      "%d infeasible programs: %d without a certificate, largest error of one %.1e; softened, %d "
      "without a solution\n",
      count, unproven, largest, without);
  EXPECT_LE(unproven, 1e-4 * count);
  EXPECT_LE(without, 0.003 * count);
}

}  // namespace breakwater::testing
