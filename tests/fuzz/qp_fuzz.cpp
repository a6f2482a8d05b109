// A quadratic program with any H, g, Ω and bounds, solved a few times in sequence. A solution that
// the active-set solver calls solved satisfies the KKT conditions, and no result has a value that
// is not finite.
#include <algorithm>
#include <cmath>
#include <stdexcept>

#include <breakwater/linear/qp.h>
#include "fuzz/input.h"

namespace breakwater {
namespace {

constexpr int kMostVariables = 4;
constexpr int kMostRows = 6;

void solve(fuzz::Input& input, QpSolverKind kind, const QpModel& model) {
  const auto solver = make_qp_solver(kind, model, 200);
  const Eigen::Index n = model.H.rows();
  const Eigen::Index m = model.Omega.rows();
  QpSolution solution(n, m);
  Eigen::VectorXd gradient(n);
  for (int repeat = 0; repeat < 3; ++repeat) {
    QpInput problem(n, m);
    problem.g = input.vector(n);
    for (Eigen::Index i = 0; i < m; ++i) {
      const int bounds = input.whole(3);
      if (bounds != 0) problem.lower(i) = input.number();
      if (bounds != 1) problem.upper(i) = bounds == 3 ? problem.lower(i) : input.number();
      if (input.whole(7) == 0) problem.softness(i) = std::abs(input.number());
    }
    solver->solve(problem, solution);
    fuzz::require(solution.z.allFinite(), "z is finite");
    fuzz::require(solution.mu.allFinite(), "the multipliers are finite");
    if (kind != QpSolverKind::active_set || solution.status != QpStatus::solved) continue;
    const double largest = solution.z.lpNorm<Eigen::Infinity>();
    // Products overflow.
    if (std::max(largest, solution.mu.lpNorm<Eigen::Infinity>()) > 1e140) continue;
    const Eigen::VectorXd values = model.Omega * solution.z;
    // Other sums of Ω z and H z differ from those of the solver.
    const Eigen::VectorXd root = model.H.diagonal().cwiseSqrt();
    const double reach = solution.z.cwiseProduct(root).lpNorm<Eigen::Infinity>();
    const double slope = problem.g.cwiseQuotient(root).lpNorm<Eigen::Infinity>();
    const double rounding = 1e-12 * (1.0 + reach / bound_scale(model, problem) + reach / slope);
    fuzz::require(kkt_residual(model, problem, solution, values, gradient) <=
                      1.01 * kQpSolvedBelow + rounding,
                  "solved means optimal");
  }
}

}  // namespace
}  // namespace breakwater

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace breakwater;
  fuzz::count("qp");
  fuzz::Input input(data, size);
  const auto kind = input.whole(1) == 0 ? QpSolverKind::hildreth : QpSolverKind::active_set;
  const int n = 1 + input.whole(kMostVariables - 1);
  const int m = input.whole(kMostRows);
  QpModel model;
  model.H = input.weight(n);
  model.Omega = input.matrix(m, n);
  try {
    solve(input, kind, model);
  } catch (const std::invalid_argument&) {
    // refused
  }
  return 0;
}
