#include <breakwater/linear/active_set.h>

#include <algorithm>
#include <cmath>
#include <iterator>

#include <breakwater/linear/horizon.h>
#include <breakwater/linear/small_products.h>
#include <breakwater/math/refuse_unless.h>

namespace breakwater {
namespace {

// The scales are those of kkt_residual().
constexpr double kActiveShare = 1e-3;   // share of a violation
constexpr double kWrongSign = 1e-11;    // multiplier with the wrong sign, relative to g
constexpr double kRefineAbove = 1e-10;  // KKT residual
constexpr int kMostRefinements = 3;
// Share of a row's squared length, in the metric of H⁻¹, that is orthogonal to the working set:
constexpr double kDoubtfulPivot = 1e-6;    // below: computed again, with less cancellation
constexpr double kDependentPivot = 1e-10;  // below: the row depends on the working set
// In the careful attempt:
constexpr double kDoubtfulSign = 1e-10;    // multiplier with the wrong sign, relative to g
constexpr int kCorrections = 2;            // after each change of the working set
constexpr Eigen::Index kLongHorizon = 24;  // from this number of variables on, sweeps are faster

// The largest |a_i b_i|.
double largest_product(const Eigen::VectorXd& a, const Eigen::VectorXd& b) {
  return a.cwiseProduct(b).lpNorm<Eigen::Infinity>();
}

// a/b, where no error is no share of nothing.
double share_of(double a, double b) {
  return a > 0.0 ? a / b : 0.0;
}

// Computes Ω z from N columns (N < 0: `values` already has it). All arrays have m entries, and
// columns the length `stride`.
template <int N>
RowScan scan_rows(const double* columns, Eigen::Index stride, const double* z, Eigen::Index m,
                  const double* lower, const double* upper, const double* share,
                  const double* weight, double tolerance, double* values, double* scores) {
  RowScan scan;
  for (Eigen::Index i = 0; i < m; ++i) {
    double value = values[i];
    if constexpr (N >= 0) {
      value = columns[i] * z[0];
      for (int j = 1; j < N; ++j) value += columns[j * stride + i] * z[j];
      values[i] = value;
    }
    const double beyond = std::max(value - upper[i], lower[i] - value) * share[i];
    const double score = (beyond - tolerance) * weight[i];
    scores[i] = score;
    scan.violation = std::max(scan.violation, beyond);
    scan.worst_score = std::max(scan.worst_score, score);
  }
  return scan;
}

// The largest |share_i bound_i| of the finite bounds.
double largest_bound(const Eigen::VectorXd& bounds, const Eigen::VectorXd& share) {
  const auto is_finite = bounds.array().abs() < kNoBound;
  return is_finite.select(bounds.cwiseProduct(share), 0.0).lpNorm<Eigen::Infinity>();
}

}  // namespace

// Products for one number of variables.
struct ActiveSetQp::Small {
  double (*dot)(const double* a, const double* b);
  void (*multiply)(const double* M, const double* x, double* y);
  // products_j = x · column of the j-th active row
  void (*dots)(const double* columns, const std::vector<Active>& rows, const double* x,
               double* products);
  // z = from − Σ mu_j · column of the j-th active row
  void (*move)(const double* from, const double* columns, const std::vector<Active>& rows,
               const double* mu, double* z);
  decltype(&scan_rows<1>) scan;

  template <int n>
  static void dots_of(const double* columns, const std::vector<Active>& rows, const double* x,
                      double* products) {
    for (const Active& row : rows) *products++ = breakwater::dot<n>(columns + n * row.row, x);
  }

  template <int n>
  static void move_of(const double* from, const double* columns, const std::vector<Active>& rows,
                      const double* mu, double* z) {
    double sum[n];  // in registers
    for (int i = 0; i < n; ++i) sum[i] = from[i];
    for (const Active& row : rows) {
      for (int i = 0; i < n; ++i) sum[i] -= *mu * columns[n * row.row + i];
      ++mu;
    }
    for (int i = 0; i < n; ++i) z[i] = sum[i];
  }

  template <int n>
  static constexpr Small of() {
    return {breakwater::dot<n>, breakwater::multiply<n>, dots_of<n>, move_of<n>, scan_rows<n>};
  }

  // nullptr: too many variables.
  static const Small* of(Eigen::Index n) {
    static constexpr Small kSmall[] = {of<1>(), of<2>(), of<3>(), of<4>(), of<5>(), of<6>()};
    return n <= Eigen::Index{std::size(kSmall)} ? &kSmall[n - 1] : nullptr;
  }
};

ActiveSetQp::ActiveSetQp(const QpModel& model, int max_changes)
    : QpSolver(model),
      small_(Small::of(factors_.variables())),
      max_changes_(max_changes),
      factor_(factors_.rows()),
      orthogonal_(factors_) {
  refuse_unless(max_changes >= 1, "active set: needs a cap of at least 1 change");
  const Eigen::Index n = factors_.variables();
  const Eigen::Index m = factors_.rows();
  derive();
  active_.reserve(static_cast<std::size_t>(m));
  previous_.reserve(static_cast<std::size_t>(m));
  softness_.setZero(m);
  size_ = share_ = free_weight_ = weight_ = softness_;
  weigh_all();
  if (n >= kLongHorizon) sweeps_ = model.sweeps;
  values_free_.setZero(m);
  mu_ = target_ = half_ = direction_ = correction_ = values_ = scores_ = Eigen::VectorXd::Zero(m);
  z_free_.setZero(n);
  gradient_ = residual_ = room_ = z_free_;
  proof_.setZero(m);
}

void ActiveSetQp::derive() {
  inverse_root_ = factors_.root.cwiseInverse();
  largest_row_ = 0.0;
  for (Eigen::Index i = 0; i < factors_.rows(); ++i) {
    largest_row_ = std::max(largest_row_, factors_.model.Omega.row(i).cwiseAbs().sum());
  }
}

void ActiveSetQp::set_matrices(const Eigen::MatrixXd& H, const QpModel::RowMajor& Omega) {
  const QpModel& model = factors_.model;
  refuse_unless(!model.sweeps && H.rows() == model.H.rows() && H.cols() == model.H.cols() &&
                    Omega.rows() == model.Omega.rows() && Omega.cols() == model.Omega.cols(),
                "active set: new matrices must have the sizes of the old ones, without a horizon");
  factors_.model.H = H;
  factors_.model.Omega = Omega;
  factors_.factor();
  derive();
  refactor();
}

// The sizes of the rows and the weights of their violations. A row of zeros has a share that makes
// every violation large, because no z satisfies it.
void ActiveSetQp::weigh_all() {
  constexpr double kOfNothing = 1e150;
  for (Eigen::Index i = 0; i < size_.size(); ++i) {
    size_(i) = std::max(factors_.size(i), std::sqrt(softness(i)));
    share_(i) = size_(i) > 0.0 ? 1.0 / size_(i) : kOfNothing;
    free_weight_(i) = length(i) > 0.0 ? size_(i) / std::sqrt(length(i)) : 1.0;
  }
  weight_ = free_weight_;
}

void ActiveSetQp::reset() {
  for (const Active& row : active_) weight_(row.row) = free_weight_(row.row);
  active_.clear();
  factor_.clear();
}

void ActiveSetQp::find(const QpInput& input, bool is_empty, QpSolution& solution) {
  if (is_empty) reset();
  take_over(input);
  const bool warm = active_count() > 0;
  attempt(input, solution);
  if (is_empty) solution.status = QpStatus::infeasible;
  // The warm start may be the reason for a failure.
  if (warm && solution.status != QpStatus::solved) {
    reset();
    attempt(input, solution);
  }
  if (solution.status == QpStatus::solved) return;
  if (!is_empty && !(solution.status == QpStatus::infeasible && is_proven(input))) {
    reset();
    is_careful_ = true;
    orthogonal_.clear(softness_);
    attempt(input, solution);
    is_careful_ = false;
  }
  reset();
  if (is_empty) solution.mu.setZero();
  if (solution.status == QpStatus::infeasible && !is_empty) solution.mu = proof_;
  if (!(solution.z.allFinite() && solution.mu.allFinite())) {
    solution.set_nothing(solution.status);
  }
}

// Whether proof_ is a certificate.
bool ActiveSetQp::is_proven(const QpInput& input) const {
  return infeasibility_margin(factors_.model, input, proof_) >= kInfeasibleFrom;
}

// Solves from the present working set.
void ActiveSetQp::attempt(const QpInput& input, QpSolution& solution) {
  room_ = -input.g;
  multiply(factors_.H_inverse, room_, z_free_);
  changes_left_ = max_changes_;
  solution.status = search(input, solution);
  finish(input, solution);
  if (solution.status == QpStatus::solved && !(solution.kkt_residual <= kQpSolvedBelow)) {
    solution.status = QpStatus::inaccurate;
  }
}

// Removes active rows that have no bound now, and adopts a new softness. Computes the scales.
void ActiveSetQp::take_over(const QpInput& input) {
  for (Eigen::Index j = active_count() - 1; j >= 0; --j) {
    if (std::isinf(bound(input, active(j)))) remove(j);
  }
  if (softness_ != input.softness) {
    softness_ = input.softness;
    has_soft_ = (softness_.array() != 0.0).any();
    refactor();
  }
  slope_ = largest_product(input.g, inverse_root_);
  bound_ = std::max(largest_bound(input.lower, share_), largest_bound(input.upper, share_));
}

// Factors the working set anew, and drops the rows that depend on others. Weighs all rows anew.
void ActiveSetQp::refactor() {
  previous_.assign(active_.begin(), active_.end());
  reset();
  for (const Active& row : previous_) {
    const double pivot = pivot_towards(row.row);
    if (pivot > 0.0) add(row.row, row.side, pivot);
  }
  weigh_all();
  for (const Active& row : active_) weight_(row.row) = 0.0;
}

QpStatus ActiveSetQp::search(const QpInput& input, QpSolution& solution) {
  make_dual_feasible(input);
  if (is_careful_) place(input, solution);
  for (;;) {
    is_careful_ ? settle(input, solution) : place(input, solution);
    Violation violation = worst_violation(input);
    // The violation may be an error of the active rows.
    if (violation.row >= 0 && !is_careful_ &&
        active_error(input) > kActiveShare * share_(violation.row) * violation.amount) {
      hold_bounds(input, solution);
      violation = worst_violation(input);
    }
    if (violation.row < 0) return QpStatus::solved;
    const QpStatus status = drive_to_bound(input, violation, solution);
    if (status != QpStatus::solved) {
      if (!is_careful_) place(input, solution);
      return status;
    }
  }
}

// Solves S μ = Ω_W z_free − β_W, and removes rows while a multiplier has the wrong sign.
void ActiveSetQp::make_dual_feasible(const QpInput& input) {
  const double wrong = kWrongSign * slope_;
  if (small_ != nullptr) {
    small_->dots(row_data(0), active_, z_free_.data(), target_.data());
  } else if (active_count() > 0) {
    rows_of(z_free_, values_free_);
    for (Eigen::Index j = 0; j < active_count(); ++j) target_(j) = values_free_(active(j).row);
  }
  for (Eigen::Index j = 0; j < active_count(); ++j) target_(j) -= bound(input, active(j));
  for (;;) {
    const Eigen::Index k = active_count();
    for (Eigen::Index j = 0; j < k; ++j) mu_(j) = target_(j);
    factor_.solve(mu_.data());
    Eigen::Index worst = -1;
    double most = 0.0;
    for (Eigen::Index j = 0; j < k; ++j) {
      const double against = -active(j).side * mu_(j);
      if (against > most && size_(active(j).row) * against > wrong) {
        most = against;
        worst = j;
      }
    }
    if (worst < 0) return;
    for (Eigen::Index j = worst; j + 1 < k; ++j) target_(j) = target_(j + 1);
    remove(worst);
  }
}

// Computes z and the rows' values from the multipliers.
void ActiveSetQp::place(const QpInput& input, QpSolution& solution) {
  move(z_free_, mu_, solution.z);
  scan(input, solution);
}

// z = from − H⁻¹ Ω_Wᵀ mu.
void ActiveSetQp::move(const Eigen::VectorXd& from, const Eigen::VectorXd& mu,
                       Eigen::VectorXd& z) const {
  if (small_ != nullptr) {
    small_->move(from.data(), factors_.step.data(), active_, mu.data(), z.data());
    return;
  }
  z = from;
  for (Eigen::Index j = 0; j < active_count(); ++j) z -= mu(j) * factors_.step.col(active(j).row);
}

void ActiveSetQp::scan(const QpInput& input, const QpSolution& solution) {
  if (small_ == nullptr) rows_of(solution.z, values_);
  reach_ = std::min(largest_product(solution.z, factors_.root), bound_);
  const auto scan = small_ != nullptr ? small_->scan : scan_rows<-1>;
  scan_ = scan(factors_.columns.data(), factors_.columns.outerStride(), solution.z.data(),
               values_.size(), input.lower.data(), input.upper.data(), share_.data(),
               weight_.data(), tolerance(), values_.data(), scores_.data());
}

// y = M x.
void ActiveSetQp::multiply(const Eigen::MatrixXd& M, const Eigen::VectorXd& x,
                           Eigen::VectorXd& y) const {
  if (small_ != nullptr) {
    small_->multiply(M.data(), x.data(), y.data());
  } else {
    y.noalias() = M * x;
  }
}

// values = Ω z.
void ActiveSetQp::rows_of(const Eigen::VectorXd& z, Eigen::VectorXd& values) {
  if (sweeps_ && !is_careful_) {
    sweeps_->rows(z, values);
  } else {
    values.noalias() = factors_.columns * z;
  }
}

ActiveSetQp::Violation ActiveSetQp::worst_violation(const QpInput& input) const {
  if (!(scan_.worst_score > 0.0)) return {};
  Eigen::Index row = 0;
  while (scores_(row) != scan_.worst_score) ++row;
  const double above = values_(row) - input.upper(row);
  const double below = input.lower(row) - values_(row);
  return {row, std::max(above, below), above > below};
}

// The largest error of an active row at its bound, relative to its size.
double ActiveSetQp::active_error(const QpInput& input) const {
  double error = 0.0;
  for (Eigen::Index j = 0; j < active_count(); ++j) {
    error = std::max(error, share_(active(j).row) * std::abs(error_at(input, j)));
  }
  return error;
}

QpStatus ActiveSetQp::drive_to_bound(const QpInput& input, Violation violation,
                                     QpSolution& solution) {
  const double sign = violation.upper ? 1.0 : -1.0;
  double multiplier = 0.0;  // multiplier of the violated row, times its sign
  for (;;) {
    if (changes_left_ == 0) return QpStatus::iteration_cap;
    --changes_left_;
    ++solution.iterations;
    const double pivot = pivot_towards(violation.row);
    double step = pivot > 0.0 ? violation.amount / pivot : kNoBound;
    const Eigen::Index k = active_count();
    Eigen::Index blocking = -1;
    for (Eigen::Index j = 0; j < k; ++j) {
      const double own_side = active(j).side;
      const double falls = own_side * sign * direction_(j);
      if (falls <= 0.0) continue;
      const double reach = std::max(own_side * mu_(j), 0.0);
      if (reach < step * falls) {
        step = reach / falls;
        blocking = j;
      }
    }
    if (pivot <= 0.0 && (is_careful_ || blocking < 0)) {
      set_proof(violation.row, sign);
      if (!is_careful_ || is_proven(input)) return QpStatus::infeasible;
      if (blocking < 0) return QpStatus::inaccurate;
    }
    for (Eigen::Index j = 0; j < k; ++j) mu_(j) -= sign * step * direction_(j);
    multiplier += step;
    if (blocking < 0) {
      mu_(k) = sign * multiplier;
      add(violation.row, sign, pivot);
      if (is_careful_ && input.lower(violation.row) == input.upper(violation.row)) {
        active_.back().side = 0.0;
      }
      return QpStatus::solved;
    }
    violation.amount -= step * pivot;
    remove(blocking);
    if (is_careful_) violation.amount = what_is_left(input, violation, multiplier, solution);
  }
}

// Sets proof_ to the violated row and its combination of active rows with the right signs.
void ActiveSetQp::set_proof(Eigen::Index row, double sign) {
  proof_.setZero();
  proof_(row) = sign;
  for (Eigen::Index j = 0; j < active_count(); ++j) {
    const double y = -sign * direction_(j);
    if (active(j).side * y >= 0.0) proof_(active(j).row) = y;
  }
}

// Corrects z and the multipliers on the way of a row to its bound. Returns its violation.
double ActiveSetQp::what_is_left(const QpInput& input, const Violation& violation,
                                 double multiplier, QpSolution& solution) {
  const double sign = violation.upper ? 1.0 : -1.0;
  entering_ = violation.row;
  entering_mu_ = sign * multiplier;
  correct(input, solution);
  entering_ = -1;
  const double value = values_(violation.row) - softness(violation.row) * entering_mu_;
  const double bound = (violation.upper ? input.upper : input.lower)(violation.row);
  return std::max(0.0, sign * (value - bound));
}

// Computes half_ and direction_ for an inactive row. Returns its squared length orthogonal to the
// working set; 0: the row depends on the working set.
double ActiveSetQp::pivot_towards(Eigen::Index row) {
  if (is_careful_) return orthogonal_.compare(row, direction_);
  const Eigen::Index k = active_count();
  const double own = length(row);
  if (small_ != nullptr) {
    small_->dots(factors_.step.data(), active_, row_data(row), half_.data());
  } else {
    for (Eigen::Index j = 0; j < k; ++j) half_(j) = factors_.gram(row, active(j).row);
  }
  bool is_doubtful = false;
  for (Eigen::Index j = 0; j < k; ++j) {
    is_doubtful |= factor_.pivot(j) <= kDoubtfulPivot * active(j).length;
  }
  double pivot = own - factor_.forward_solve(half_.data());
  for (Eigen::Index j = 0; j < k; ++j) direction_(j) = half_(j);
  factor_.backward_solve(direction_.data());
  // n independent active rows span the whole space.
  if (!has_soft_ && k == factors_.variables() && !is_doubtful) return 0.0;
  return pivot > kDoubtfulPivot * own ? pivot : pivot_with_less_cancellation(row, own);
}

// Corrected seminormal equations: the residual itself, orthogonalised twice.
double ActiveSetQp::pivot_with_less_cancellation(Eigen::Index row, double own) {
  const auto& Omega = factors_.model.Omega;
  double pivot = 0.0;
  for (int pass = 0;; ++pass) {
    residual_ = Omega.row(row).transpose();
    for (Eigen::Index j = 0; j < active_count(); ++j) {
      residual_ -= direction_(j) * Omega.row(active(j).row).transpose();
    }
    multiply(factors_.H_inverse, residual_, gradient_);
    if (small_ != nullptr) {
      pivot = small_->dot(residual_.data(), gradient_.data()) + softness(row);
      small_->dots(row_data(0), active_, gradient_.data(), correction_.data());
    } else {
      pivot = residual_.dot(gradient_) + softness(row);
      for (Eigen::Index j = 0; j < active_count(); ++j) {
        correction_(j) = Omega.row(active(j).row).transpose().dot(gradient_);
      }
    }
    for (Eigen::Index j = 0; j < active_count(); ++j) {
      const double soft = softness(active(j).row);
      pivot += soft * direction_(j) * direction_(j);
      correction_(j) -= soft * direction_(j);
    }
    if (pass == 2) break;
    factor_.solve(correction_.data());
    direction_.head(active_count()) += correction_.head(active_count());
  }
  return pivot > kDependentPivot * own ? pivot : 0.0;
}

// Removes rows while a multiplier has the wrong sign after a correction.
void ActiveSetQp::settle(const QpInput& input, QpSolution& solution) {
  for (;;) {
    correct(input, solution);
    Eigen::Index wrong = active_count() - 1;
    for (; wrong >= 0; --wrong) {
      const Active& row = active(wrong);
      if (row.side * mu_(wrong) * size_(row.row) < -kDoubtfulSign * slope_) break;
    }
    if (wrong < 0 || changes_left_ == 0) return;
    --changes_left_;
    ++solution.iterations;
    remove(wrong);
  }
}

// Corrects z and the multipliers by true residuals.
void ActiveSetQp::correct(const QpInput& input, QpSolution& solution) {
  for (int pass = 0; pass < kCorrections; ++pass) {
    solution.mu.setZero();
    for (Eigen::Index j = 0; j < active_count(); ++j) solution.mu(active(j).row) = mu_(j);
    set_gradient(input, solution);
    if (entering_ >= 0) {
      gradient_ += entering_mu_ * factors_.model.Omega.row(entering_).transpose();
    }
    for (Eigen::Index j = 0; j < active_count(); ++j) correction_(j) = -error_at(input, j);
    orthogonal_.correct(gradient_, correction_);
    solution.z -= gradient_;
    mu_.head(active_count()) -= correction_.head(active_count());
    scan(input, solution);
  }
}

void ActiveSetQp::finish(const QpInput& input, QpSolution& solution) {
  if (is_careful_) {
    for (Eigen::Index j = 0; j < active_count(); ++j) {
      Active& row = active_[static_cast<std::size_t>(j)];
      if (row.side == 0.0) row.side = mu_(j) < 0.0 ? -1.0 : 1.0;
    }
  }
  measure(input, solution);
  if (solution.status != QpStatus::solved || is_careful_) return;
  // Refinement does not change the violation of inactive rows.
  for (int i = 0; i < kMostRefinements && solution.kkt_residual > kRefineAbove &&
                  (is_tilted_ || active_error(input) > kRefineAbove * zeta_);
       ++i) {
    refine(input, solution);
    measure(input, solution);
  }
}

// Computes kkt_residual() with less work: the last scan has the violations, and only active rows
// have multipliers.
void ActiveSetQp::measure(const QpInput& input, QpSolution& solution) {
  set_multipliers(solution);
  set_gradient(input, solution);
  double gamma = slope_;
  double slack = 0.0;  // the largest product with a multiplier
  for (Eigen::Index j = 0; j < active_count(); ++j) {
    const double mu = solution.mu(active(j).row);
    gamma = std::max(gamma, size_(active(j).row) * std::abs(mu));
    slack = std::max(slack, std::abs(mu * (values_(active(j).row) - bound(input, active(j)))));
  }
  zeta_ = std::max(reach_, kQpGradientShare * gamma);
  const double largest_value = largest_row_ * solution.z.lpNorm<Eigen::Infinity>();
  if (has_soft_ || is_careful_ || !gradient_.allFinite() || !(largest_value < kNoBound)) {
    solution.kkt_residual = kkt_residual(factors_.model, input, solution, values_, room_);
    is_tilted_ = true;
    return;
  }
  const double tilt = std::max(share_of(largest_product(gradient_, inverse_root_), gamma),
                               share_of(share_of(slack, gamma), zeta_));
  is_tilted_ = tilt > kRefineAbove;
  solution.kkt_residual = std::max(tilt, share_of(scan_.violation, zeta_));
}

void ActiveSetQp::set_multipliers(QpSolution& solution) const {
  solution.mu.setZero();
  for (Eigen::Index j = 0; j < active_count(); ++j) {
    // A multiplier with the wrong sign is due to rounding and counts as 0.
    if (active(j).side * mu_(j) > 0.0) solution.mu(active(j).row) = mu_(j);
  }
}

// H z + g + Ωᵀ μ.
void ActiveSetQp::set_gradient(const QpInput& input, const QpSolution& solution) {
  if (sweeps_ && !is_careful_) {
    sweeps_->gradient(solution.z, solution.mu, gradient_);
    gradient_ += input.g;
    return;
  }
  multiply(factors_.model.H, solution.z, gradient_);
  gradient_ += input.g;
  for (const Active& active : active_) {
    const double* row = row_data(active.row);
    const double mu = solution.mu(active.row);
    for (Eigen::Index i = 0; i < gradient_.size(); ++i) gradient_(i) += mu * row[i];
  }
}

// Corrects the multipliers, and z with them, by the errors of the active rows. This leaves the
// gradient as it is.
void ActiveSetQp::hold_bounds(const QpInput& input, QpSolution& solution) {
  for (Eigen::Index j = 0; j < active_count(); ++j) correction_(j) = error_at(input, j);
  factor_.solve(correction_.data());
  mu_.head(active_count()) += correction_.head(active_count());
  move(solution.z, correction_, solution.z);
  scan(input, solution);
}

void ActiveSetQp::refine(const QpInput& input, QpSolution& solution) {
  // Newton step of z for these multipliers, with the true gradient.
  set_multipliers(solution);
  set_gradient(input, solution);
  multiply(factors_.H_inverse, gradient_, room_);
  solution.z -= room_;
  scan(input, solution);
  hold_bounds(input, solution);
}

// Adds the row of the last pivot_towards() to the working set.
void ActiveSetQp::add(Eigen::Index row, double side, double pivot) {
  if (is_careful_) {
    orthogonal_.add(row);
  } else {
    factor_.add(half_.data(), pivot);
  }
  active_.push_back({row, side, length(row)});
  weight_(row) = 0.0;
}

// Removes a row with its multiplier.
void ActiveSetQp::remove(Eigen::Index position) {
  for (Eigen::Index j = position; j + 1 < active_count(); ++j) mu_(j) = mu_(j + 1);
  weight_(active(position).row) = free_weight_(active(position).row);
  active_.erase(active_.begin() + position);
  if (is_careful_) {
    orthogonal_.remove(position);
  } else {
    factor_.remove(position);
  }
}

}  // namespace breakwater
