#include <breakwater/linear/orthogonal_active_set.h>

#include <Eigen/Jacobi>
#include <algorithm>
#include <cmath>

namespace breakwater {
namespace {

constexpr double kDoubtfulSign = 1e-10;  // multiplier with the wrong sign, in the units of g
constexpr double kDependent = 1e-11;  // smaller relative rest: the row depends on the working set
constexpr int kCorrections = 2;       // with true residuals

}  // namespace

OrthogonalActiveSet::OrthogonalActiveSet(const QpFactors& factors, int max_changes)
    : factors_(factors), max_changes_(max_changes) {
  const Eigen::Index n = factors.variables();
  const Eigen::Index m = factors.rows();
  active_.reserve(static_cast<std::size_t>(m));
  is_active_.resize(static_cast<std::size_t>(m));
  Q_.resize(n + m, m);
  R_.resize(m, m);
  c_.setZero(n + m);
  shares_ = direction_ = correction_ = values_ = proof_ = Eigen::VectorXd::Zero(m);
  residual_ = Eigen::VectorXd::Zero(n);
}

void OrthogonalActiveSet::solve(const QpInput& input, QpSolution& solution) {
  const Eigen::Index n = factors_.variables();
  const bool has_soft = (input.softness.array() != 0.0).any();
  depth_ = has_soft ? n + factors_.rows() : n;
  active_.clear();
  std::fill(is_active_.begin(), is_active_.end(), false);
  changes_left_ = max_changes_;
  solution.z.setZero();
  solution.mu.setZero();
  correct(input, solution);
  solution.status = search(input, solution);
  values_.noalias() = factors_.model.Omega * solution.z;
  for (Eigen::Index j = 0; j < active_count(); ++j) {
    double& mu = solution.mu(active(j).row);
    if (active(j).side * mu < 0.0) mu = 0.0;
  }
  solution.kkt_residual = kkt_residual(factors_.model, input, solution, values_, residual_);
  if (solution.status == QpStatus::infeasible) solution.mu = proof_;
  if (solution.status == QpStatus::solved && !(solution.kkt_residual <= kQpSolvedBelow)) {
    solution.status = QpStatus::inaccurate;
  }
}

QpStatus OrthogonalActiveSet::search(const QpInput& input, QpSolution& solution) {
  const double slope = input.g.cwiseQuotient(factors_.root).lpNorm<Eigen::Infinity>();
  const double bound = bound_scale(factors_.model, input);
  for (;;) {
    // After a correction, a multiplier near 0 may have the other sign.
    for (Eigen::Index j = active_count() - 1; j >= 0; --j) {
      const Eigen::Index own = active(j).row;
      if (active(j).side * solution.mu(own) * size(input, own) >= -kDoubtfulSign * slope) continue;
      if (changes_left_-- == 0) return QpStatus::iteration_cap;
      ++solution.iterations;
      remove(j, solution);
      correct(input, solution);
      j = active_count();
    }
    values_.noalias() = factors_.model.Omega * solution.z;
    const double reach =
        std::min(solution.z.cwiseProduct(factors_.root).lpNorm<Eigen::Infinity>(), bound);
    const Active row =
        worst_violation(input, kQpViolation * std::max(reach, kQpGradientShare * slope));
    if (row.row < 0) return QpStatus::solved;
    const QpStatus status = drive_to_bound(input, row, solution);
    if (status != QpStatus::solved) return status;
  }
}

// The largest violation in the metric of H⁻¹.
OrthogonalActiveSet::Active OrthogonalActiveSet::worst_violation(const QpInput& input,
                                                                 double tolerance) const {
  Active worst{-1, 0.0};
  double most = 0.0;
  for (Eigen::Index i = 0; i < values_.size(); ++i) {
    if (is_active_[static_cast<std::size_t>(i)]) continue;
    const double above = values_(i) - input.upper(i);
    const double below = input.lower(i) - values_(i);
    const double beyond = std::max(above, below) - tolerance * size(input, i);
    if (!(beyond > 0.0)) continue;
    const double length = std::sqrt(factors_.gram(i, i) + input.softness(i));
    const double score = length > 0.0 ? beyond / length : kNoBound;
    if (score > most) {
      most = score;
      worst = {i, above > below ? 1.0 : -1.0};
    }
  }
  return worst;
}

QpStatus OrthogonalActiveSet::drive_to_bound(const QpInput& input, Active row,
                                             QpSolution& solution) {
  const Eigen::Index n = factors_.variables();
  const double sign = row.side;
  const double own = std::sqrt(factors_.gram(row.row, row.row) + input.softness(row.row));
  double& multiplier = solution.mu(row.row);
  for (;;) {
    if (changes_left_-- == 0) return QpStatus::iteration_cap;
    ++solution.iterations;
    const double value =
        factors_.model.Omega.row(row.row).dot(solution.z) - input.softness(row.row) * multiplier;
    const double amount = sign > 0.0 ? value - input.upper(row.row) : input.lower(row.row) - value;
    double length = compare(input, row.row);
    if (length <= kDependent * own || (depth_ == n && active_count() == n)) length = 0.0;
    if (length == 0.0 && is_proof(input, row)) return QpStatus::infeasible;
    double step = length > 0.0 ? std::max(amount, 0.0) / (length * length) : kNoBound;
    Eigen::Index blocking = -1;
    for (Eigen::Index j = 0; j < active_count(); ++j) {
      const double falls = active(j).side * sign * direction_(j);
      if (falls <= 0.0) continue;
      const double reach = std::max(active(j).side * solution.mu(active(j).row), 0.0);
      if (reach < step * falls) {
        step = reach / falls;
        blocking = j;
      }
    }
    if (std::isinf(step)) return QpStatus::inaccurate;
    for (Eigen::Index j = 0; j < active_count(); ++j) {
      solution.mu(active(j).row) -= sign * step * direction_(j);
    }
    multiplier += sign * step;
    if (blocking < 0) {
      if (input.lower(row.row) == input.upper(row.row)) row.side = 0.0;
      add(row, length);
      correct(input, solution);
      return QpStatus::solved;
    }
    remove(blocking, solution);
    correct(input, solution);
  }
}

// Finds the combination of active rows that is nearest to an inactive row. Returns the rest's
// length.
double OrthogonalActiveSet::compare(const QpInput& input, Eigen::Index row) {
  const Eigen::Index n = factors_.variables();
  const Eigen::Index k = active_count();
  const auto& Omega = factors_.model.Omega;
  auto c = c_.head(depth_);
  shares_.head(k).setZero();
  direction_.head(k).setZero();
  for (int pass = 0; pass <= kCorrections; ++pass) {
    residual_ = Omega.row(row).transpose();
    c.tail(depth_ - n).setZero();
    for (Eigen::Index j = 0; j < k; ++j) {
      const Eigen::Index other = active(j).row;
      residual_ -= direction_(j) * Omega.row(other).transpose();
      if (depth_ > n) c(n + other) = -direction_(j) * std::sqrt(input.softness(other));
    }
    if (depth_ > n) c(n + row) = std::sqrt(input.softness(row));
    factors_.L.triangularView<Eigen::Lower>().solveInPlace(residual_);
    c.head(n) = residual_;
    auto correction = correction_.head(k);
    correction.noalias() = basis().transpose() * c;
    c.noalias() -= basis() * correction;
    shares_.head(k) += correction;
    triangle().triangularView<Eigen::Upper>().solveInPlace(correction);
    direction_.head(k) += correction;
  }
  return c.norm();
}

// Whether the row and the working set contradict each other.
bool OrthogonalActiveSet::is_proof(const QpInput& input, Active row) {
  proof_.setZero();
  proof_(row.row) = row.side;
  for (Eigen::Index j = 0; j < active_count(); ++j) {
    const double y = -row.side * direction_(j);
    if (active(j).side * y >= 0.0) proof_(active(j).row) = y;
  }
  return infeasibility_margin(factors_.model, input, proof_) >= kInfeasibleFrom;
}

// Adds the row of the last compare().
void OrthogonalActiveSet::add(Active row, double length) {
  const Eigen::Index k = active_count();
  Q_.col(k).head(depth_) = c_.head(depth_) / length;
  R_.col(k).head(k) = shares_.head(k);
  R_(k, k) = length;
  active_.push_back(row);
  is_active_[static_cast<std::size_t>(row.row)] = true;
}

void OrthogonalActiveSet::remove(Eigen::Index position, QpSolution& solution) {
  const Eigen::Index k = active_count();
  solution.mu(active(position).row) = 0.0;
  is_active_[static_cast<std::size_t>(active(position).row)] = false;
  active_.erase(active_.begin() + position);
  for (Eigen::Index j = position; j + 1 < k; ++j) R_.col(j).head(j + 2) = R_.col(j + 1).head(j + 2);
  for (Eigen::Index j = position; j + 1 < k; ++j) {
    Eigen::JacobiRotation<double> rotation;
    rotation.makeGivens(R_(j, j), R_(j + 1, j));
    R_.block(0, j, k, k - 1 - j).applyOnTheLeft(j, j + 1, rotation.adjoint());
    Q_.topRows(depth_).applyOnTheRight(j, j + 1, rotation);
  }
}

// Corrects z and the multipliers for the working set.
void OrthogonalActiveSet::correct(const QpInput& input, QpSolution& solution) {
  const Eigen::Index n = factors_.variables();
  const Eigen::Index k = active_count();
  const auto& model = factors_.model;
  auto y = correction_.head(k);
  for (int pass = 0; pass < kCorrections; ++pass) {
    for (Eigen::Index j = 0; j < k; ++j) {
      const auto [row, side] = active(j);
      y(j) = (side >= 0.0 ? input.upper(row) : input.lower(row)) -
             model.Omega.row(row).dot(solution.z) + input.softness(row) * solution.mu(row);
    }
    triangle().transpose().triangularView<Eigen::Lower>().solveInPlace(y);
    residual_ = input.g;
    residual_.noalias() += model.H * solution.z;
    residual_.noalias() += model.Omega.transpose() * solution.mu;
    factors_.L.triangularView<Eigen::Lower>().solveInPlace(residual_);
    y.noalias() += basis().topRows(n).transpose() * residual_;
    residual_.noalias() -= basis().topRows(n) * y;
    factors_.L.triangularView<Eigen::Lower>().transpose().solveInPlace(residual_);
    solution.z -= residual_;
    triangle().triangularView<Eigen::Upper>().solveInPlace(y);
    for (Eigen::Index j = 0; j < k; ++j) solution.mu(active(j).row) -= y(j);
  }
}

}  // namespace breakwater
