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

// The size of a row: its largest entry for variables in units of 1/√H_jj.
double size_of(const QpModel& model, Eigen::Index row) {
  double size = 0.0;
  for (Eigen::Index j = 0; j < model.H.rows(); ++j) {
    size = std::max(size, std::abs(model.Omega(row, j)) / std::sqrt(model.H(j, j)));
  }
  return size;
}

double size_of(const QpModel& model, const QpInput& input, Eigen::Index row) {
  return std::max(size_of(model, row), std::sqrt(input.softness(row)));
}

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
  double gamma = 0.0;
  double zeta = 0.0;
  for (Eigen::Index j = 0; j < input.g.size(); ++j) {
    const double root = std::sqrt(model.H(j, j));
    gamma = std::max(gamma, std::abs(input.g(j)) / root);
    zeta = std::max(zeta, std::abs(solution.z(j)) * root);
  }
  for (Eigen::Index i = 0; i < values.size(); ++i) {
    if (solution.mu(i) == 0.0) continue;
    gamma = std::max(gamma, size_of(model, input, i) * std::abs(solution.mu(i)));
  }
  zeta = std::max(std::min(zeta, bound_scale(model, input)), kQpGradientShare * gamma);
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
    if (const double violation = std::max(above, below); violation > 0.0) {
      residual = std::max(residual, violation / size_of(model, input, i) / zeta);
    }
    if (mu == 0.0) continue;
    const double slack = std::abs(mu > 0.0 ? above : below);
    if (slack > 0.0) residual = std::max(residual, std::abs(mu) / gamma * (slack / zeta));
    for (Eigen::Index j = 0; j < gradient.size(); ++j) gradient(j) += mu * model.Omega(i, j);
  }
  if (!is_finite || !gradient.allFinite()) return kNoBound;
  for (Eigen::Index j = 0; j < gradient.size(); ++j) {
    if (gradient(j) == 0.0) continue;
    residual = std::max(residual, std::abs(gradient(j)) / std::sqrt(model.H(j, j)) / gamma);
  }
  return residual;
}

double bound_scale(const QpModel& model, const QpInput& input) {
  double scale = 0.0;
  for (Eigen::Index i = 0; i < input.lower.size(); ++i) {
    const double size = size_of(model, input, i);
    for (const double bound : {std::abs(input.lower(i)), std::abs(input.upper(i))}) {
      if (size > 0.0 && bound < kNoBound) scale = std::max(scale, bound / size);
    }
  }
  return scale;
}

double infeasibility_margin(const QpModel& model, const QpInput& input, const Eigen::VectorXd& y) {
  // Relative rounding error of a sum with this number of terms.
  const double rounding =
      static_cast<double>((y.array() != 0.0).count() + 2) * std::numeric_limits<double>::epsilon();
  double gap = 0.0;
  double tilt = 0.0;   // ‖Ωᵀ y‖₁
  double reach = 0.0;  // distance of the bounds from 0
  for (Eigen::Index j = 0; j < input.g.size(); ++j) {
    reach = std::max(reach, kQpGradientShare * std::abs(input.g(j)) / std::sqrt(model.H(j, j)));
  }
  for (Eigen::Index i = 0; i < y.size(); ++i) {
    if (y(i) == 0.0) continue;
    if (input.softness(i) > 0.0) return 0.0;
    const double bound = y(i) > 0.0 ? input.upper(i) : input.lower(i);
    gap -= y(i) * bound + rounding * std::abs(y(i) * bound);
    const double size = size_of(model, i);
    if (size > 0.0) reach = std::max(reach, std::abs(bound) / size);
  }
  if (!(gap > 0.0)) return 0.0;
  for (Eigen::Index j = 0; j < model.Omega.cols(); ++j) {
    double sum = 0.0;
    double error = 0.0;
    for (Eigen::Index i = 0; i < y.size(); ++i) {
      sum += y(i) * model.Omega(i, j);
      error += rounding * std::abs(y(i) * model.Omega(i, j));
    }
    tilt += (std::abs(sum) + error) / std::sqrt(model.H(j, j));
  }
  return tilt > 0.0 ? gap / tilt / reach : kNoBound;
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
  root = model.H.diagonal().cwiseSqrt();
  size.resize(rows());
  for (Eigen::Index i = 0; i < rows(); ++i) size(i) = size_of(model, i);
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
