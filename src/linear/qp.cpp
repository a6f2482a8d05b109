#include <breakwater/linear/qp.h>

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <utility>

#include <breakwater/linear/active_set.h>
#include <breakwater/linear/hildreth.h>
#include <breakwater/linear/riccati.h>

namespace breakwater {
namespace {

constexpr int kChangesPerRow = 20;  // far more changes than any problem needs

}  // namespace

QpInput::QpInput(Eigen::Index n, Eigen::Index m)
    : g(Eigen::VectorXd::Zero(n)),
      lower(Eigen::VectorXd::Constant(m, -kNoBound)),
      upper(Eigen::VectorXd::Constant(m, kNoBound)),
      softness(Eigen::VectorXd::Zero(m)) {}

QpSolution::QpSolution(Eigen::Index n, Eigen::Index m)
    : z(Eigen::VectorXd::Zero(n)), mu(Eigen::VectorXd::Zero(m)) {}

void QpSolution::set_not_finite() {
  status = QpStatus::not_finite;
  iterations = 0;
  z.setZero();
  mu.setZero();
  kkt_residual = std::numeric_limits<double>::infinity();
}

void QpSolution::set_overflowed(QpStatus status_now) {
  set_not_finite();
  status = status_now;
}

double kkt_residual(const QpModel& model, const QpInput& input, const QpSolution& solution,
                    const Eigen::VectorXd& values, Eigen::VectorXd& gradient) {
  const double scale =
      std::max({1.0, input.g.lpNorm<Eigen::Infinity>(), solution.mu.lpNorm<Eigen::Infinity>()});
  gradient = input.g;
  gradient.noalias() += model.H * solution.z;
  double residual = 0.0;
  bool is_finite = true;
  for (Eigen::Index i = 0; i < values.size(); ++i) {
    const double mu = solution.mu(i);
    const double value = values(i) - input.softness(i) * mu;
    const double above = value - input.upper(i);
    const double below = input.lower(i) - value;
    is_finite &= std::abs(value) < kNoBound;
    residual = std::max(residual, std::max(above, below));
    if (mu == 0.0) continue;
    residual = std::max(residual, std::abs(mu * (mu > 0.0 ? above : below)) / scale);
    gradient += mu * model.Omega.row(i).transpose();
  }
  if (!is_finite || !gradient.allFinite()) return kNoBound;
  return std::max(residual, gradient.lpNorm<Eigen::Infinity>() / scale);
}

double infeasibility_margin(const QpModel& model, const QpInput& input, const Eigen::VectorXd& y) {
  // Relative rounding error of a sum with this number of terms.
  const double rounding =
      static_cast<double>((y.array() != 0.0).count() + 2) * std::numeric_limits<double>::epsilon();
  double gap = 0.0;
  double tilt = 0.0;   // ‖Ωᵀ y‖₁
  double reach = 1.0;  // distance of the bounds from 0
  for (Eigen::Index i = 0; i < y.size(); ++i) {
    if (y(i) == 0.0) continue;
    if (input.softness(i) > 0.0) return 0.0;
    const double bound = y(i) > 0.0 ? input.upper(i) : input.lower(i);
    gap -= y(i) * bound + rounding * std::abs(y(i) * bound);
    const double size = model.Omega.row(i).lpNorm<Eigen::Infinity>();
    if (size > 0.0) reach = std::max(reach, std::abs(bound) / size);
  }
  if (!(gap > 0.0)) return 0.0;
  for (Eigen::Index j = 0; j < model.Omega.cols(); ++j) {
    double sum = 0.0;
    for (Eigen::Index i = 0; i < y.size(); ++i) {
      sum += y(i) * model.Omega(i, j);
      tilt += rounding * std::abs(y(i) * model.Omega(i, j));
    }
    tilt += std::abs(sum);
  }
  return gap / (tilt * reach);
}

QpFactors::QpFactors(QpModel qp) : model(std::move(qp)) {
  const Eigen::Index n = model.H.rows();
  if (n == 0 || model.H.cols() != n || model.Omega.cols() != n) {
    throw std::invalid_argument("quadratic program: H must be n×n and Omega m×n");
  }
  if (model.horizon && (static_cast<Eigen::Index>(model.horizon->rows.size()) != rows() ||
                        model.horizon->control_steps * model.horizon->B.cols() != n)) {
    throw std::invalid_argument(
        "quadratic program: the horizon must have the rows of Omega and the "
        "variables of H");
  }
  if (!model.Omega.allFinite()) {
    throw std::invalid_argument("quadratic program: Omega must be finite");
  }
  if (!is_positive_definite(model.H)) {
    throw std::invalid_argument("quadratic program: H must be symmetric positive definite");
  }
  factor();
}

void QpFactors::factor() {
  columns = model.Omega;
  L = model.H;
  const Eigen::LLT<Eigen::Ref<Eigen::MatrixXd>> llt(L);
  H_inverse.setIdentity(variables(), variables());
  llt.solveInPlace(H_inverse);
  for (Eigen::Index i = 0; i < variables(); ++i) {
    for (Eigen::Index j = 0; j < i; ++j) {
      H_inverse(i, j) = H_inverse(j, i) = 0.5 * (H_inverse(i, j) + H_inverse(j, i));
      L(j, i) = 0.0;
    }
  }
  gram.resize(rows(), rows());
  step = model.Omega.transpose();
  if (rows() == 0) return;
  llt.solveInPlace(step);
  // As a square of L⁻¹ Ωᵀ, it is symmetric with a non-negative diagonal.
  half_ = model.Omega.transpose();
  L.triangularView<Eigen::Lower>().solveInPlace(half_);
  gram.noalias() = half_.transpose() * half_;
}

QpStatus QpFactors::examine(const QpInput& input) {
  bool is_finite = true;
  bool is_possible = true;
  for (Eigen::Index j = 0; j < input.g.size(); ++j) is_finite &= std::abs(input.g(j)) < kNoBound;
  for (Eigen::Index i = 0; i < input.lower.size(); ++i) {
    // Comparisons with NaN are false.
    is_finite &= input.lower(i) < kNoBound;
    is_finite &= input.upper(i) > -kNoBound;
    is_finite &= input.softness(i) >= 0.0;
    is_finite &= input.softness(i) < kNoBound;
    is_possible &= input.lower(i) <= input.upper(i);
  }
  if (!is_finite) return QpStatus::not_finite;
  return is_possible ? QpStatus::solved : QpStatus::infeasible;
}

std::unique_ptr<QpSolver> make_qp_solver(QpSolverKind kind, const QpModel& model, int max_sweeps) {
  if (kind == QpSolverKind::hildreth) return std::make_unique<HildrethQp>(model, max_sweeps);
  if (max_sweeps < 1) throw std::invalid_argument("quadratic program: the cap must be positive");
  const auto size = static_cast<int>(model.H.rows() + model.Omega.rows());
  return std::make_unique<ActiveSetQp>(model, 100 + kChangesPerRow * size);
}

}  // namespace breakwater
