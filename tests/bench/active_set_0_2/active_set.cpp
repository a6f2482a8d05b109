#include "active_set.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace breakwater::v0_2 {
namespace {

constexpr double kViolation = 5e-9;          // what a row may be violated by, in its own unit
constexpr double kDoubtfulViolation = 1e-6;  // below: may be rounding of what is held
constexpr double kWrongSign = 1e-11;         // of a multiplier, relative to max(1, ‖g‖∞)
constexpr double kRefineAbove = 1e-10;       // KKT residual
constexpr double kSolvedBelow = 1e-8;        // KKT residual
constexpr int kMostRefinements = 3;
// Of a row's squared length in the metric of H⁻¹, what is left of it after the working set:
constexpr double kDoubtfulPivot = 1e-6;    // below: computed again, with less cancellation
constexpr double kDependentPivot = 1e-10;  // below: the row depends on the working set

}  // namespace

ActiveSetQp::ActiveSetQp(const QpModel& model, int max_changes)
    : factors_(model), max_changes_(max_changes) {
  if (max_changes < 1) {
    throw std::invalid_argument("active set: needs a cap of at least 1 change");
  }
  const Eigen::Index n = factors_.variables();
  const Eigen::Index m = factors_.rows();
  working_set_.reserve(static_cast<std::size_t>(m));
  previous_.reserve(static_cast<std::size_t>(m));
  is_active_.assign(static_cast<std::size_t>(m), 0);
  at_upper_.assign(static_cast<std::size_t>(m), 0);
  softness_.setZero(m);
  factor_.setZero(m, m);
  mu_ = half_ = direction_ = correction_ = values_ = Eigen::VectorXd::Zero(m);
  z_free_ = gradient_ = residual_ = Eigen::VectorXd::Zero(n);
}

void ActiveSetQp::reset() {
  for (const Eigen::Index row : working_set_) is_active_[static_cast<std::size_t>(row)] = 0;
  working_set_.clear();
}

void ActiveSetQp::solve(const QpInput& input, QpSolution& solution) {
  solution.iterations = 0;
  solution.status = QpFactors::examine(input);
  if (solution.status == QpStatus::not_finite) {
    reset();
    solution.set_not_finite();
    return;
  }
  const bool empty = solution.status == QpStatus::infeasible;  // a lower bound above its upper one
  if (empty) reset();
  take_over(input);
  const bool warm = active() > 0;
  attempt(input, solution);
  if (empty) solution.status = QpStatus::infeasible;
  // What goes wrong from a warm start may have gone wrong because of it.
  if (warm && solution.status != QpStatus::solved) {
    reset();
    attempt(input, solution);
  }
  if (solution.status != QpStatus::solved) reset();
}

// From the working set as it is.
void ActiveSetQp::attempt(const QpInput& input, QpSolution& solution) {
  z_free_.noalias() = -factors_.H_inverse * input.g;
  changes_left_ = max_changes_;
  solution.status = search(input, solution);
  finish(input, solution);
  if (solution.status == QpStatus::solved && !(solution.kkt_residual <= kSolvedBelow)) {
    solution.status = QpStatus::iteration_cap;
  }
}

// Makes the last working set one of this problem.
void ActiveSetQp::take_over(const QpInput& input) {
  for (Eigen::Index j = active() - 1; j >= 0; --j) {
    const Eigen::Index row = working_set_[static_cast<std::size_t>(j)];
    if (std::isinf(side(row) > 0.0 ? input.upper(row) : input.lower(row))) remove(j);
  }
  if (softness_ != input.softness) {
    softness_ = input.softness;
    refactor();
  }
}

// Factors the working set anew, without the rows that depend on others.
void ActiveSetQp::refactor() {
  previous_.assign(working_set_.begin(), working_set_.end());
  reset();
  for (const Eigen::Index row : previous_) {
    const double pivot = pivot_towards(row);
    if (pivot > 0.0) add(row, side(row) > 0.0, pivot);
  }
}

QpStatus ActiveSetQp::search(const QpInput& input, QpSolution& solution) {
  make_dual_feasible(input);
  for (;;) {
    place(solution);
    Violation violation = worst_violation(input);
    if (violation.row >= 0 && violation.amount < kDoubtfulViolation) {
      hold_bounds(input);
      place(solution);
      violation = worst_violation(input);
    }
    if (violation.row < 0) return QpStatus::solved;
    const QpStatus status = drive_to_bound(input, violation, solution);
    if (status != QpStatus::solved) {
      place(solution);
      return status;
    }
  }
}

void ActiveSetQp::make_dual_feasible(const QpInput& input) {
  const double wrong = kWrongSign * std::max(1.0, input.g.lpNorm<Eigen::Infinity>());
  for (;;) {
    solve_multipliers(input);
    Eigen::Index worst = -1;
    double most = wrong;
    for (Eigen::Index j = 0; j < active(); ++j) {
      const double against = -side(working_set_[static_cast<std::size_t>(j)]) * mu_(j);
      if (against > most) {
        most = against;
        worst = j;
      }
    }
    if (worst < 0) return;
    remove(worst);
  }
}

// S μ = Ω_W z_free − β_W.
void ActiveSetQp::solve_multipliers(const QpInput& input) {
  for (Eigen::Index j = 0; j < active(); ++j) {
    const Eigen::Index row = working_set_[static_cast<std::size_t>(j)];
    const double bound = side(row) > 0.0 ? input.upper(row) : input.lower(row);
    mu_(j) = factors_.model.Omega.row(row).dot(z_free_) - bound;
  }
  factor_solve(mu_);
}

// z and the rows' values from the multipliers.
void ActiveSetQp::place(QpSolution& solution) {
  solution.z = z_free_;
  for (Eigen::Index j = 0; j < active(); ++j) {
    solution.z -= mu_(j) * factors_.step.col(working_set_[static_cast<std::size_t>(j)]);
  }
  values_.noalias() = factors_.columns * solution.z;
}

ActiveSetQp::Violation ActiveSetQp::worst_violation(const QpInput& input) const {
  Violation worst;
  double most = 0.0;
  for (Eigen::Index i = 0; i < values_.size(); ++i) {
    const double above = values_(i) - input.upper(i);
    const double below = input.lower(i) - values_(i);
    const double amount = std::max(above, below);
    if (amount <= kViolation || is_active_[static_cast<std::size_t>(i)] != 0) continue;
    const double length = std::sqrt(factors_.gram(i, i) + input.softness(i));
    if (amount > most * length) {
      most = length > 0.0 ? amount / length : kNoBound;
      worst = {i, amount, above > below};
    }
  }
  return worst;
}

QpStatus ActiveSetQp::drive_to_bound(const QpInput& input, Violation violation,
                                     QpSolution& solution) {
  const double sign = violation.upper ? 1.0 : -1.0;
  double multiplier = 0.0;  // of the row, times its sign
  for (;;) {
    if (changes_left_ == 0) return QpStatus::iteration_cap;
    --changes_left_;
    ++solution.iterations;
    const double pivot = pivot_towards(violation.row);
    const double whole_step = pivot > 0.0 ? violation.amount / pivot : kNoBound;
    double step = whole_step;
    Eigen::Index blocking = -1;
    for (Eigen::Index j = 0; j < active(); ++j) {
      const double own_side = side(working_set_[static_cast<std::size_t>(j)]);
      const double falls = own_side * sign * direction_(j);
      if (falls <= 0.0) continue;
      const double reach = std::max(own_side * mu_(j), 0.0) / falls;
      if (reach < step) {
        step = reach;
        blocking = j;
      }
    }
    if (std::isinf(step)) return QpStatus::infeasible;
    mu_.head(active()) -= (sign * step) * direction_.head(active());
    multiplier += step;
    if (blocking < 0) {
      mu_(active()) = sign * multiplier;
      add(violation.row, violation.upper, pivot);
      // Afresh, so that rounding does not add up from step to step.
      solve_multipliers(input);
      return QpStatus::solved;
    }
    violation.amount -= step * pivot;
    for (Eigen::Index j = blocking; j + 1 < active(); ++j) mu_(j) = mu_(j + 1);
    remove(blocking);
  }
}

// Fills half_ and direction_ for a row outside of the working set, and returns what is left of its
// squared length: 0 if it depends on the working set.
double ActiveSetQp::pivot_towards(Eigen::Index row) {
  const auto gram = factors_.gram.col(row);
  const double own = gram(row) + softness_(row);
  for (Eigen::Index j = 0; j < active(); ++j) {
    half_(j) = gram(working_set_[static_cast<std::size_t>(j)]);
  }
  forward_solve(half_);
  direction_.head(active()) = half_.head(active());
  backward_solve(direction_);
  double pivot = own - half_.head(active()).squaredNorm();
  if (pivot > kDoubtfulPivot * own) return pivot;

  // Corrected seminormal equations: the residual itself, made orthogonal twice.
  for (int pass = 0;; ++pass) {
    residual_ = factors_.model.Omega.row(row).transpose();
    for (Eigen::Index j = 0; j < active(); ++j) {
      const Eigen::Index other = working_set_[static_cast<std::size_t>(j)];
      residual_ -= direction_(j) * factors_.model.Omega.row(other).transpose();
    }
    gradient_.noalias() = factors_.H_inverse * residual_;
    pivot = residual_.dot(gradient_) + softness_(row);
    for (Eigen::Index j = 0; j < active(); ++j) {
      const Eigen::Index other = working_set_[static_cast<std::size_t>(j)];
      pivot += softness_(other) * direction_(j) * direction_(j);
      correction_(j) =
          factors_.model.Omega.row(other).dot(gradient_) - softness_(other) * direction_(j);
    }
    if (pass == 2) break;
    factor_solve(correction_);
    direction_.head(active()) += correction_.head(active());
  }
  return pivot > kDependentPivot * own ? pivot : 0.0;
}

void ActiveSetQp::finish(const QpInput& input, QpSolution& solution) {
  const auto measure = [&] {
    solution.mu.setZero();
    for (Eigen::Index j = 0; j < active(); ++j) {
      const Eigen::Index row = working_set_[static_cast<std::size_t>(j)];
      // A multiplier of the wrong sign by rounding is none.
      if (side(row) * mu_(j) > 0.0) solution.mu(row) = mu_(j);
    }
    solution.kkt_residual = v0_2::kkt_residual(factors_.model, input, solution, values_, gradient_);
  };
  measure();
  if (solution.status != QpStatus::solved) return;
  for (int i = 0; i < kMostRefinements && solution.kkt_residual > kRefineAbove; ++i) {
    refine(input, solution);
    measure();
  }
}

// Corrects the multipliers by what the working set's rows are off their bounds.
void ActiveSetQp::hold_bounds(const QpInput& input) {
  for (Eigen::Index j = 0; j < active(); ++j) {
    const Eigen::Index row = working_set_[static_cast<std::size_t>(j)];
    const double bound = side(row) > 0.0 ? input.upper(row) : input.lower(row);
    correction_(j) = values_(row) - input.softness(row) * mu_(j) - bound;
  }
  factor_solve(correction_);
  mu_.head(active()) += correction_.head(active());
}

void ActiveSetQp::refine(const QpInput& input, QpSolution& solution) {
  hold_bounds(input);
  // z as it must be for these multipliers, by the true gradient.
  gradient_ = input.g;
  gradient_.noalias() += factors_.model.H * solution.z;
  for (Eigen::Index j = 0; j < active(); ++j) {
    const Eigen::Index row = working_set_[static_cast<std::size_t>(j)];
    gradient_ += mu_(j) * factors_.model.Omega.row(row).transpose();
  }
  solution.z.noalias() -= factors_.H_inverse * gradient_;
  values_.noalias() = factors_.columns * solution.z;
}

void ActiveSetQp::factor_solve(Eigen::VectorXd& x) const {
  forward_solve(x);
  backward_solve(x);
}

// x ← L⁻¹ x.
void ActiveSetQp::forward_solve(Eigen::VectorXd& x) const {
  const Eigen::Index k = active();
  for (Eigen::Index j = 0; j < k; ++j) {
    x(j) /= factor_(j, j);
    const Eigen::Index below = k - j - 1;
    x.segment(j + 1, below) -= x(j) * factor_.col(j).segment(j + 1, below);
  }
}

// x ← L⁻ᵀ x.
void ActiveSetQp::backward_solve(Eigen::VectorXd& x) const {
  const Eigen::Index k = active();
  for (Eigen::Index j = k - 1; j >= 0; --j) {
    const Eigen::Index below = k - j - 1;
    x(j) -= factor_.col(j).segment(j + 1, below).dot(x.segment(j + 1, below));
    x(j) /= factor_(j, j);
  }
}

// The row that pivot_towards() was last asked for joins the working set.
void ActiveSetQp::add(Eigen::Index row, bool upper, double pivot) {
  const Eigen::Index k = active();
  factor_.row(k).head(k) = half_.head(k).transpose();
  factor_(k, k) = std::sqrt(pivot);
  working_set_.push_back(row);
  is_active_[static_cast<std::size_t>(row)] = 1;
  at_upper_[static_cast<std::size_t>(row)] = upper ? 1 : 0;
}

// Row `position` of L goes; Givens rotations of columns make what is left triangular again.
void ActiveSetQp::remove(Eigen::Index position) {
  const Eigen::Index last = active() - 1;
  const auto at = static_cast<std::size_t>(position);
  is_active_[static_cast<std::size_t>(working_set_[at])] = 0;
  working_set_.erase(working_set_.begin() + position);
  for (Eigen::Index j = 0; j <= last; ++j) {
    const Eigen::Index first = std::max(position, j - 1);
    for (Eigen::Index i = first; i < last; ++i) factor_(i, j) = factor_(i + 1, j);
  }
  for (Eigen::Index j = position; j < last; ++j) {
    const double a = factor_(j, j);
    const double b = factor_(j, j + 1);
    const double r = std::hypot(a, b);
    const double c = a / r;
    const double s = b / r;
    for (Eigen::Index i = j; i < last; ++i) {
      const double left = factor_(i, j);
      const double right = factor_(i, j + 1);
      factor_(i, j) = c * left + s * right;
      factor_(i, j + 1) = c * right - s * left;
    }
  }
}

}  // namespace breakwater::v0_2
