#include <breakwater/linear/qp.h>

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include <breakwater/linear/active_set.h>
#include <breakwater/linear/riccati.h>
#include <breakwater/math/refuse_unless.h>

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

constexpr double kTolerance = 1e-8;  // largest move of a multiplier, relative to the gradient
constexpr double kDiverged = 1.5;    // a larger excess() may be divergence

}  // namespace

void QpSolution::set_nothing(QpStatus why) {
  status = why;
  iterations = 0;
  z.setZero();
  mu.setZero();
  kkt_residual = kNoBound;
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
  refuse_unless(n != 0 && model.H.cols() == n && model.Omega.cols() == n,
                "quadratic program: H must be n×n and Omega m×n");
  refuse_unless(model.Omega.allFinite(), "quadratic program: Omega must be finite");
  refuse_unless(is_positive_definite(model.H),
                "quadratic program: H must be symmetric positive definite");
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

void QpSolver::solve(const QpInput& input, QpSolution& solution) {
  const auto lower = input.lower.array(), upper = input.upper.array();
  const auto softness = input.softness.array();
  // Comparisons with NaN are false.
  const bool is_finite = (input.g.array().abs() < kNoBound).all() && (lower < kNoBound).all() &&
                         (upper > -kNoBound).all() && (softness >= 0.0).all() &&
                         (softness < kNoBound).all();
  solution.iterations = 0;
  if (is_finite) return find(input, !(lower <= upper).all(), solution);
  reset();
  solution.set_nothing(QpStatus::not_finite);
}

std::unique_ptr<QpSolver> make_qp_solver(QpSolverKind kind, const QpModel& model, int max_sweeps) {
  refuse_unless(max_sweeps >= 1, "quadratic program: the cap must be positive");
  if (kind == QpSolverKind::hildreth) return std::make_unique<HildrethQp>(model, max_sweeps);
  const auto size = static_cast<int>(model.H.rows() + model.Omega.rows());
  return std::make_unique<ActiveSetQp>(model, 100 + kChangesPerRow * size);
}

HildrethQp::HildrethQp(const QpModel& model, int max_sweeps)
    : QpSolver(model),
      max_sweeps_(max_sweeps),
      lambda_upper_(Eigen::VectorXd::Zero(factors_.rows())),
      lambda_lower_(lambda_upper_),
      values_free_(lambda_upper_),
      values_(lambda_upper_),
      z_free_(Eigen::VectorXd::Zero(factors_.variables())),
      gradient_(z_free_) {}

void HildrethQp::reset() {
  lambda_upper_.setZero();
  lambda_lower_.setZero();
}

void HildrethQp::find(const QpInput& input, bool is_empty, QpSolution& solution) {
  Eigen::Index unmet = -1;  // a row of zeros that no z satisfies
  for (Eigen::Index i = 0; i < factors_.rows(); ++i) {
    if (factors_.size(i) > 0.0 || input.softness(i) > 0.0) continue;
    if (input.lower(i) > 0.0 || input.upper(i) < 0.0) unmet = i;
  }
  // An infinite bound has no multiplier.
  lambda_upper_ = (input.upper.array() < kNoBound).select(lambda_upper_, 0.0);
  lambda_lower_ = (input.lower.array() > -kNoBound).select(lambda_lower_, 0.0);
  z_free_.noalias() = -factors_.H_inverse * input.g;
  solution.mu = lambda_upper_ - lambda_lower_;
  values_free_.noalias() = factors_.columns * z_free_;
  values_ = values_free_;
  values_.noalias() -= factors_.gram * solution.mu;

  solution.status = QpStatus::iteration_cap;
  const double slope = input.g.cwiseQuotient(factors_.root).lpNorm<Eigen::Infinity>();
  double halfway = 0.0;  // excess after half of the sweeps
  while (solution.iterations < max_sweeps_) {
    if (solution.iterations > 0 && solution.iterations == max_sweeps_ / 2) {
      solution.mu = lambda_upper_ - lambda_lower_;
      halfway = excess(input, solution.mu);
    }
    ++solution.iterations;
    const double moved = sweep(input);
    solution.mu = lambda_upper_ - lambda_lower_;
    const double gamma =
        std::max(slope, solution.mu.cwiseProduct(factors_.size).lpNorm<Eigen::Infinity>());
    if (!(moved <= kTolerance * gamma) && solution.iterations < max_sweeps_) continue;
    place(input, solution);
    if (solution.kkt_residual <= kQpSolvedBelow) {
      solution.status = QpStatus::solved;
      break;
    }
  }
  if (!(solution.z.allFinite() && solution.mu.allFinite())) {
    reset();
    return solution.set_nothing(is_empty ? QpStatus::infeasible : QpStatus::inaccurate);
  }
  if (solution.status == QpStatus::iteration_cap) {
    // The multipliers diverge: the next problem starts without them.
    const double excess = this->excess(input, solution.mu);
    if (!(excess <= kDiverged) && !(excess < halfway)) reset();
  }
  if (is_empty || unmet >= 0) solution.status = QpStatus::infeasible;
  if (is_empty || unmet < 0) return;
  solution.mu.setZero();
  solution.mu(unmet) = input.upper(unmet) < 0.0 ? 1.0 : -1.0;
}

// Computes z, its rows and the residual from the multipliers.
void HildrethQp::place(const QpInput& input, QpSolution& solution) {
  solution.z = z_free_;
  solution.z.noalias() -= factors_.step * solution.mu;
  values_.noalias() = factors_.columns * solution.z;
  solution.kkt_residual = kkt_residual(factors_.model, input, solution, values_, gradient_);
}

// The dual objective of c λ is c λᵀd − ½ c² λᵀPλ, where d has the violations of z_free. Its maximum
// is at c = λᵀd/λᵀPλ, which this function returns. If the sweeps converge, c falls to 1. It starts
// far above 1 if rows nearly oppose each other. If no z satisfies the rows, λ grows without a
// change of z, and c grows too.
double HildrethQp::excess(const QpInput& input, const Eigen::VectorXd& mu) const {
  double gain = 0.0;       // λᵀd
  double curvature = 0.0;  // λᵀPλ
  for (Eigen::Index i = 0; i < mu.size(); ++i) {
    const double above = lambda_upper_(i);
    const double below = lambda_lower_(i);
    if (above > 0.0) gain += above * (values_free_(i) - input.upper(i));
    if (below > 0.0) gain += below * (input.lower(i) - values_free_(i));
    curvature += mu(i) * (values_free_(i) - values_(i));
    curvature += input.softness(i) * (above * above + below * below);
  }
  return gain <= kDiverged * curvature ? 1.0 : gain / curvature;
}

double HildrethQp::sweep(const QpInput& input) {
  double largest = 0.0;
  for (Eigen::Index i = 0; i < factors_.rows(); ++i) {
    largest = std::max(largest, move(i, lambda_upper_(i), 1.0, values_(i) - input.upper(i), input));
    largest =
        std::max(largest, move(i, lambda_lower_(i), -1.0, input.lower(i) - values_(i), input));
  }
  return largest;
}

// Updates the multiplier of one side of a row. Returns the size of its move, times the row's size.
double HildrethQp::move(Eigen::Index row, double& multiplier, double sign, double violation,
                        const QpInput& input) {
  if (multiplier == 0.0 && violation <= 0.0) return 0.0;
  const double soft = input.softness(row);
  const double diagonal = factors_.gram(row, row) + soft;
  if (diagonal <= 0.0) return 0.0;  // a row of zeros: no multiplier affects it
  const double moved = std::max(-multiplier, (violation - soft * multiplier) / diagonal);
  if (moved == 0.0) return 0.0;
  multiplier += moved;
  values_.noalias() -= (sign * moved) * factors_.gram.col(row);
  return std::abs(moved) * factors_.size(row);
}

}  // namespace breakwater
