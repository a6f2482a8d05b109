#include <breakwater/linear/hildreth.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

namespace breakwater {
namespace {

constexpr double kTolerance = 1e-8;  // largest move of a multiplier, relative to the gradient
constexpr double kDiverged = 1.5;    // a larger excess() may be divergence

}  // namespace

HildrethQp::HildrethQp(const QpModel& model, int max_sweeps)
    : factors_(model),
      max_sweeps_(max_sweeps),
      lambda_upper_(Eigen::VectorXd::Zero(factors_.rows())),
      lambda_lower_(lambda_upper_),
      values_free_(lambda_upper_),
      values_(lambda_upper_),
      z_free_(Eigen::VectorXd::Zero(factors_.variables())),
      gradient_(z_free_) {
  if (max_sweeps < 1) throw std::invalid_argument("Hildreth: needs a cap of at least 1 sweep");
}

void HildrethQp::reset() {
  lambda_upper_.setZero();
  lambda_lower_.setZero();
}

void HildrethQp::solve(const QpInput& input, QpSolution& solution) {
  solution.iterations = 0;
  solution.status = QpFactors::examine(input);
  if (solution.status == QpStatus::not_finite) {
    reset();
    solution.set_not_finite();
    return;
  }
  const bool empty = solution.status == QpStatus::infeasible;
  Eigen::Index unmet = -1;  // a row of zeros that no z satisfies
  for (Eigen::Index i = 0; i < factors_.rows(); ++i) {
    if (factors_.size(i) > 0.0 || input.softness(i) > 0.0) continue;
    if (input.lower(i) > 0.0 || input.upper(i) < 0.0) unmet = i;
  }
  // An infinite bound has no multiplier.
  lambda_upper_ =
      (input.upper.array() < std::numeric_limits<double>::infinity()).select(lambda_upper_, 0.0);
  lambda_lower_ =
      (input.lower.array() > -std::numeric_limits<double>::infinity()).select(lambda_lower_, 0.0);
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
    solution.set_overflowed(empty ? QpStatus::infeasible : QpStatus::inaccurate);
    return;
  }
  if (solution.status == QpStatus::iteration_cap) {
    // The multipliers diverge: the next problem starts without them.
    const double excess = this->excess(input, solution.mu);
    if (!(excess <= kDiverged) && !(excess < halfway)) reset();
  }
  if (empty || unmet >= 0) solution.status = QpStatus::infeasible;
  if (empty || unmet < 0) return;
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
