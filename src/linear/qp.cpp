#include "linear/qp.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <utility>

#include "linear/active_set.h"
#include "linear/hildreth.h"
#include "linear/riccati.h"

namespace breakwater {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

}  // namespace

QpInput::QpInput(Eigen::Index n, Eigen::Index m)
    : g(Eigen::VectorXd::Zero(n)),
      lower(Eigen::VectorXd::Constant(m, -kInfinity)),
      upper(Eigen::VectorXd::Constant(m, kInfinity)),
      softness(Eigen::VectorXd::Zero(m)) {}

QpSolution::QpSolution(Eigen::Index n, Eigen::Index m)
    : z(Eigen::VectorXd::Zero(n)), mu(Eigen::VectorXd::Zero(m)) {}

double kkt_residual(const QpModel& model, const QpInput& input, const QpSolution& solution,
                    Eigen::VectorXd& gradient) {
  const double scale =
      std::max({1.0, input.g.lpNorm<Eigen::Infinity>(), solution.mu.lpNorm<Eigen::Infinity>()});
  gradient = input.g;
  gradient.noalias() += model.H * solution.z;
  double residual = 0.0;
  for (Eigen::Index i = 0; i < model.Omega.rows(); ++i) {
    const double mu = solution.mu(i);
    const double value = model.Omega.row(i).dot(solution.z) - input.softness(i) * mu;
    if (!std::isfinite(value)) return kInfinity;
    residual = std::max({residual, value - input.upper(i), input.lower(i) - value});
    if (mu != 0.0) {
      const double slack = mu > 0.0 ? input.upper(i) - value : value - input.lower(i);
      residual = std::max(residual, std::abs(mu * slack) / scale);
      gradient += mu * model.Omega.row(i).transpose();
    }
  }
  if (!gradient.allFinite()) return kInfinity;
  return std::max(residual, gradient.lpNorm<Eigen::Infinity>() / scale);
}

QpFactors::QpFactors(QpModel qp) : model(std::move(qp)) {
  const Eigen::Index n = model.H.rows();
  if (n == 0 || model.H.cols() != n || model.Omega.cols() != n) {
    throw std::invalid_argument("quadratic program: H must be n×n and Omega m×n");
  }
  if (!model.Omega.allFinite()) {
    throw std::invalid_argument("quadratic program: Omega must be finite");
  }
  if (!is_positive_definite(model.H)) {
    throw std::invalid_argument("quadratic program: H must be symmetric positive definite");
  }
  const Eigen::LLT<Eigen::MatrixXd> llt(model.H);
  const Eigen::MatrixXd inverse = llt.solve(Eigen::MatrixXd::Identity(n, n));
  H_inverse = 0.5 * (inverse + inverse.transpose());
  step = llt.solve(model.Omega.transpose());
  // As the square of L⁻¹ Ωᵀ it is symmetric, and its diagonal is not negative.
  const Eigen::MatrixXd half = llt.matrixL().solve(model.Omega.transpose());
  gram = half.transpose() * half;
}

QpStatus QpFactors::examine(const QpInput& input) {
  // x − x is 0 unless x is infinite or NaN.
  if (!input.g.allFinite() || !input.softness.allFinite() ||
      !(input.softness.array() >= 0.0).all()) {
    return QpStatus::not_finite;
  }
  if (!(input.lower.array() < kInfinity).all() || !(input.upper.array() > -kInfinity).all()) {
    return QpStatus::not_finite;
  }
  return (input.lower.array() <= input.upper.array()).all() ? QpStatus::solved
                                                            : QpStatus::infeasible;
}

std::unique_ptr<QpSolver> make_qp_solver(QpSolverKind kind, const QpModel& model,
                                         int max_iterations) {
  if (kind == QpSolverKind::hildreth) return std::make_unique<HildrethQp>(model, max_iterations);
  return std::make_unique<ActiveSetQp>(model, max_iterations);
}

}  // namespace breakwater
