#include <breakwater/linear/active_set.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <stdexcept>
#include <vector>

#include <breakwater/linear/horizon.h>
#include <breakwater/linear/ldl_factor.h>
#include <breakwater/linear/orthogonal_active_set.h>
#include <breakwater/linear/row_scan.h>

namespace breakwater {
namespace {

constexpr double kDoubtfulViolation = 1e-6;  // below: may be rounding of the active rows,
constexpr double kActiveShare = 1e-3;        // if their error is at least this share of it
constexpr double kWrongSign = 1e-11;  // multiplier with the wrong sign, relative to max(1, ‖g‖∞)
constexpr double kRefineAbove = 1e-10;  // KKT residual
constexpr int kMostRefinements = 3;
// Share of a row's squared length, in the metric of H⁻¹, that is orthogonal to the working set:
constexpr double kDoubtfulPivot = 1e-6;    // below: computed again, with less cancellation
constexpr double kDependentPivot = 1e-10;  // below: the row depends on the working set
constexpr Eigen::Index kLongHorizon = 24;  // from this number of variables on, sweeps are faster

template <typename Vector>
bool is_finite(const Vector& x) {
  return (x.array() - x.array()).sum() == 0.0;  // ∞ − ∞ and every sum with NaN are NaN
}

// The solver for N variables (Eigen::Dynamic: any number).
template <int N>
class Core final : public ActiveSetQp::Core {
 public:
  Core(const QpModel& model, int max_changes);

  void solve(const QpInput& input, QpSolution& solution) override;
  void reset() override;
  const QpModel& model() const override { return factors_.model; }
  void set_matrices(const Eigen::MatrixXd& H, const QpModel::RowMajor& Omega) override;

 private:
  using Vector = Eigen::Matrix<double, N, 1>;
  using Square = Eigen::Matrix<double, N, N>;
  using Wide = Eigen::Matrix<double, N, Eigen::Dynamic>;

  struct Violation {
    Eigen::Index row = -1;  // −1: none
    double amount = 0.0;
    bool upper = false;
  };

  // A row of the working set.
  struct Active {
    Eigen::Index row;
    double side;    // 1: at its upper bound, −1: at its lower
    double length;  // squared, in the metric of H⁻¹
  };

  Eigen::Index active_count() const { return factor_.size(); }
  const Active& active(Eigen::Index j) const { return active_[static_cast<std::size_t>(j)]; }
  static double bound(const QpInput& input, const Active& row) {
    return row.side > 0.0 ? input.upper(row.row) : input.lower(row.row);
  }
  double softness(Eigen::Index row) const { return has_soft_ ? softness_(row) : 0.0; }
  // Entry of Ω H⁻¹ Ωᵀ for two rows.
  double gram(Eigen::Index i, Eigen::Index j) const {
    if constexpr (N == Eigen::Dynamic) return factors_.gram(i, j);
    return rows_.col(i).dot(step_.col(j));
  }

  void derive();
  QpStatus examine(const QpInput& input);
  void take_over(const QpInput& input);
  void attempt(const QpInput& input, QpSolution& solution);
  void weigh(Eigen::Index row);
  void refactor();
  QpStatus search(const QpInput& input, QpSolution& solution);
  void make_dual_feasible(const QpInput& input);
  void place(const QpInput& input, QpSolution& solution);
  void scan(const QpInput& input, const QpSolution& solution);
  void rows_of(const Eigen::VectorXd& z, Eigen::VectorXd& values);
  Violation worst_violation(const QpInput& input) const;
  QpStatus drive_to_bound(Violation violation, QpSolution& solution);
  double active_error(const QpInput& input) const;
  double pivot_towards(Eigen::Index row);
  double pivot_with_less_cancellation(Eigen::Index row, double own);
  void hold_bounds(const QpInput& input);
  void refine(const QpInput& input, QpSolution& solution);
  void finish(const QpInput& input, QpSolution& solution);
  void measure(const QpInput& input, QpSolution& solution);
  void set_multipliers(QpSolution& solution) const;
  void set_gradient(const QpInput& input, const QpSolution& solution);
  void add(Eigen::Index row, double side, double pivot);
  void remove(Eigen::Index position);

  QpFactors factors_;
  Square H_;
  Square H_inverse_;
  Wide rows_;                 // Ωᵀ
  Wide step_;                 // H⁻¹ Ωᵀ
  Eigen::VectorXd length_;    // squared length of each row in the metric of H⁻¹
  double largest_row_ = 0.0;  // ‖Ω‖∞
  int max_changes_;
  int changes_left_ = 0;  // in this attempt

  // nullptr unless the problem has a long Horizon.
  std::unique_ptr<HorizonSweeps> sweeps_;

  LdlFactor factor_;  // factor of S
  std::vector<Active> active_;
  std::vector<Active> previous_;  // work space of refactor()
  Eigen::VectorXd weight_;    // 1/length of each inactive row in the metric of H⁻¹; 0: active
  Eigen::VectorXd softness_;  // softness in the present factor
  bool is_softness_known_ = true;  // the input has the same softness
  bool has_soft_ = false;
  bool is_tilted_ = false;  // the residual is not only due to violated rows

  // Their size is that of the largest working set. Only the first active_count() entries
  // are used.
  Eigen::VectorXd mu_;         // multipliers of the working set
  Eigen::VectorXd target_;     // S μ
  Eigen::VectorXd half_;       // D⁻¹ L⁻¹ s, with the column s of a row in the Gram matrix
  Eigen::VectorXd direction_;  // S⁻¹ s: the response of the working set's multipliers
  Eigen::VectorXd correction_;

  double g_norm_ = 0.0;     // ‖g‖∞
  Vector z_free_;           // −H⁻¹ g
  Eigen::VectorXd values_;  // Ω z
  Eigen::VectorXd scores_;  // weighted violations of the rows
  RowScan scan_;
  Eigen::VectorXd values_free_;  // Ω z_free
  Vector gradient_;
  Vector residual_;
  Eigen::VectorXd room_;   // n
  Eigen::VectorXd proof_;  // m: certificate of infeasibility
  OrthogonalActiveSet second_;
};

template <int N>
Core<N>::Core(const QpModel& model, int max_changes)
    : factors_(model),
      max_changes_(max_changes),
      factor_(factors_.rows()),
      second_(factors_, max_changes) {
  const Eigen::Index n = factors_.variables();
  const Eigen::Index m = factors_.rows();
  derive();
  active_.reserve(static_cast<std::size_t>(m));
  previous_.reserve(static_cast<std::size_t>(m));
  softness_.setZero(m);
  weight_.setZero(m);
  for (Eigen::Index i = 0; i < m; ++i) weigh(i);
  if (N == Eigen::Dynamic && factors_.model.horizon && n >= kLongHorizon) {
    sweeps_ = make_horizon_sweeps(*factors_.model.horizon);
  }
  values_free_.setZero(m);
  mu_ = target_ = half_ = direction_ = correction_ = values_ = scores_ = Eigen::VectorXd::Zero(m);
  z_free_.setZero(n);
  gradient_ = residual_ = z_free_;
  room_.setZero(n);
  proof_.setZero(m);
}

// Copies the constants of the factors.
template <int N>
void Core<N>::derive() {
  H_ = factors_.model.H;
  H_inverse_ = factors_.H_inverse;
  rows_ = factors_.model.Omega.transpose();
  step_ = factors_.step;
  length_ = factors_.gram.diagonal();
  largest_row_ = 0.0;
  for (Eigen::Index i = 0; i < factors_.rows(); ++i) {
    largest_row_ = std::max(largest_row_, factors_.model.Omega.row(i).cwiseAbs().sum());
  }
}

template <int N>
void Core<N>::set_matrices(const Eigen::MatrixXd& H, const QpModel::RowMajor& Omega) {
  const QpModel& model = factors_.model;
  if (model.horizon || H.rows() != model.H.rows() || H.cols() != model.H.cols() ||
      Omega.rows() != model.Omega.rows() || Omega.cols() != model.Omega.cols()) {
    throw std::invalid_argument(
        "active set: new matrices must have the sizes of the old ones, without a horizon");
  }
  factors_.model.H = H;
  factors_.model.Omega = Omega;
  factors_.factor();
  derive();
  refactor();
}

// The weight of a violation. A row of zeros has the largest weight, because no z satisfies it.
template <int N>
void Core<N>::weigh(Eigen::Index row) {
  constexpr double kOfNothing = 1e150;
  const double length = length_(row) + softness(row);
  weight_(row) = length > 0.0 ? 1.0 / std::sqrt(length) : kOfNothing;
}

template <int N>
void Core<N>::reset() {
  for (const Active& row : active_) weigh(row.row);
  active_.clear();
  factor_.clear();
}

template <int N>
void Core<N>::solve(const QpInput& input, QpSolution& solution) {
  solution.iterations = 0;
  solution.status = examine(input);
  if (solution.status == QpStatus::not_finite) {
    reset();
    solution.set_not_finite();
    return;
  }
  const bool empty = solution.status == QpStatus::infeasible;  // a lower bound above its upper one
  if (empty) reset();
  take_over(input);
  const bool warm = active_count() > 0;
  attempt(input, solution);
  if (empty) solution.status = QpStatus::infeasible;
  // The warm start may be the reason for a failure.
  if (warm && solution.status != QpStatus::solved) {
    reset();
    attempt(input, solution);
  }
  if (solution.status == QpStatus::solved) return;
  reset();
  if (empty) {
    solution.mu.setZero();
  } else if (solution.status == QpStatus::infeasible &&
             infeasibility_margin(factors_.model, input, proof_) >= kInfeasibleFrom) {
    solution.mu = proof_;
  } else {
    second_.solve(input, solution);
  }
  if (!(solution.z.allFinite() && solution.mu.allFinite())) {
    solution.set_overflowed(solution.status);
  }
}

// Like QpFactors::examine(), which only runs if this finds a possible error.
template <int N>
QpStatus Core<N>::examine(const QpInput& input) {
  g_norm_ = input.g.template lpNorm<Eigen::Infinity>();
  is_softness_known_ =
      softness_.size() == 0 ||
      std::memcmp(softness_.data(), input.softness.data(),
                  static_cast<std::size_t>(softness_.size()) * sizeof(double)) == 0;
  if (is_softness_known_ && is_finite(input.g) && are_bounds(input.lower, input.upper)) {
    return QpStatus::solved;
  }
  return QpFactors::examine(input);
}

// Solves from the present working set.
template <int N>
void Core<N>::attempt(const QpInput& input, QpSolution& solution) {
  z_free_.noalias() = -H_inverse_ * input.g;
  changes_left_ = max_changes_;
  solution.status = search(input, solution);
  finish(input, solution);
  if (solution.status == QpStatus::solved && !(solution.kkt_residual <= kQpSolvedBelow)) {
    solution.status = QpStatus::inaccurate;
  }
}

// Removes active rows that have no bound now, and adopts a new softness.
template <int N>
void Core<N>::take_over(const QpInput& input) {
  for (Eigen::Index j = active_count() - 1; j >= 0; --j) {
    if (std::isinf(bound(input, active(j)))) remove(j);
  }
  if (is_softness_known_) return;
  softness_ = input.softness;
  has_soft_ = (softness_.array() != 0.0).any();
  refactor();
}

// Factors the working set anew, and drops the rows that depend on others. Weighs all rows anew.
template <int N>
void Core<N>::refactor() {
  previous_.assign(active_.begin(), active_.end());
  reset();
  for (const Active& row : previous_) {
    const double pivot = pivot_towards(row.row);
    if (pivot > 0.0) add(row.row, row.side, pivot);
  }
  for (Eigen::Index i = 0; i < softness_.size(); ++i) weigh(i);
  for (const Active& row : active_) weight_(row.row) = 0.0;
}

template <int N>
QpStatus Core<N>::search(const QpInput& input, QpSolution& solution) {
  make_dual_feasible(input);
  for (;;) {
    place(input, solution);
    Violation violation = worst_violation(input);
    if (violation.row >= 0 && violation.amount < kDoubtfulViolation &&
        active_error(input) > kActiveShare * violation.amount) {
      hold_bounds(input);
      place(input, solution);
      violation = worst_violation(input);
    }
    if (violation.row < 0) return QpStatus::solved;
    const QpStatus status = drive_to_bound(violation, solution);
    if (status != QpStatus::solved) {
      place(input, solution);
      return status;
    }
  }
}

// Solves S μ = Ω_W z_free − β_W, and removes rows while a multiplier has the wrong sign.
template <int N>
void Core<N>::make_dual_feasible(const QpInput& input) {
  const double wrong = kWrongSign * std::max(1.0, g_norm_);
  if constexpr (N == Eigen::Dynamic) {
    if (active_count() > 0) rows_of(z_free_, values_free_);
  }
  for (Eigen::Index j = 0; j < active_count(); ++j) {
    const Eigen::Index row = active(j).row;
    if constexpr (N == Eigen::Dynamic) {
      target_(j) = values_free_(row) - bound(input, active(j));
    } else {
      target_(j) = rows_.col(row).dot(z_free_) - bound(input, active(j));
    }
  }
  for (;;) {
    const Eigen::Index k = active_count();
    for (Eigen::Index j = 0; j < k; ++j) mu_(j) = target_(j);
    factor_.solve(mu_.data());
    Eigen::Index worst = -1;
    double most = wrong;
    for (Eigen::Index j = 0; j < k; ++j) {
      const double against = -active(j).side * mu_(j);
      if (against > most) {
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
template <int N>
void Core<N>::place(const QpInput& input, QpSolution& solution) {
  Eigen::Map<Vector> z(solution.z.data(), solution.z.size());
  if constexpr (N == Eigen::Dynamic) {
    z = z_free_;
    for (Eigen::Index j = 0; j < active_count(); ++j) z -= mu_(j) * step_.col(active(j).row);
  } else {
    Vector sum = z_free_;  // in registers
    for (Eigen::Index j = 0; j < active_count(); ++j) sum -= mu_(j) * step_.col(active(j).row);
    z = sum;
  }
  scan(input, solution);
}

template <int N>
void Core<N>::scan(const QpInput& input, const QpSolution& solution) {
  if constexpr (N == Eigen::Dynamic) rows_of(solution.z, values_);
  scan_ = scan_rows<N>(factors_.columns.data(), factors_.columns.outerStride(), solution.z.data(),
                       values_.size(), input.lower.data(), input.upper.data(), weight_.data(),
                       kQpViolation, values_.data(), scores_.data());
}

// values = Ω z.
template <int N>
void Core<N>::rows_of(const Eigen::VectorXd& z, Eigen::VectorXd& values) {
  if (sweeps_) {
    sweeps_->rows(z, values);
  } else {
    values.noalias() = factors_.columns * z;
  }
}

template <int N>
typename Core<N>::Violation Core<N>::worst_violation(const QpInput& input) const {
  if (!(scan_.worst_score > 0.0)) return {};
  Eigen::Index row = 0;
  while (scores_(row) != scan_.worst_score) ++row;
  const double above = values_(row) - input.upper(row);
  const double below = input.lower(row) - values_(row);
  return {row, std::max(above, below), above > below};
}

// The largest error of an active row at its bound.
template <int N>
double Core<N>::active_error(const QpInput& input) const {
  double error = 0.0;
  for (Eigen::Index j = 0; j < active_count(); ++j) {
    const double value = values_(active(j).row) - softness(active(j).row) * mu_(j);
    error = std::max(error, std::abs(value - bound(input, active(j))));
  }
  return error;
}

template <int N>
QpStatus Core<N>::drive_to_bound(Violation violation, QpSolution& solution) {
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
    if (std::isinf(step)) {
      proof_.setZero();
      proof_(violation.row) = sign;
      for (Eigen::Index j = 0; j < k; ++j) proof_(active(j).row) = -sign * direction_(j);
      return QpStatus::infeasible;
    }
    for (Eigen::Index j = 0; j < k; ++j) mu_(j) -= sign * step * direction_(j);
    multiplier += step;
    if (blocking < 0) {
      mu_(k) = sign * multiplier;
      add(violation.row, sign, pivot);
      return QpStatus::solved;
    }
    violation.amount -= step * pivot;
    for (Eigen::Index j = blocking; j + 1 < k; ++j) mu_(j) = mu_(j + 1);
    remove(blocking);
  }
}

// Computes half_ and direction_ for an inactive row. Returns its squared length orthogonal to the
// working set; 0: the row depends on the working set.
template <int N>
double Core<N>::pivot_towards(Eigen::Index row) {
  const Eigen::Index k = active_count();
  const double own = length_(row) + softness(row);
  bool is_doubtful = false;
  for (Eigen::Index j = 0; j < k; ++j) {
    const Active& other = active(j);
    half_(j) = gram(row, other.row);
    is_doubtful |= factor_.pivot(j) <= kDoubtfulPivot * other.length;
  }
  double pivot = own - factor_.forward_solve(half_.data());
  for (Eigen::Index j = 0; j < k; ++j) direction_(j) = half_(j);
  factor_.backward_solve(direction_.data());
  // n independent active rows span the whole space.
  if (!has_soft_ && k == rows_.rows() && !is_doubtful) return 0.0;
  return pivot > kDoubtfulPivot * own ? pivot : pivot_with_less_cancellation(row, own);
}

// Corrected seminormal equations: the residual itself, orthogonalised twice.
template <int N>
double Core<N>::pivot_with_less_cancellation(Eigen::Index row, double own) {
  double pivot = 0.0;
  for (int pass = 0;; ++pass) {
    residual_ = rows_.col(row);
    for (Eigen::Index j = 0; j < active_count(); ++j)
      residual_ -= direction_(j) * rows_.col(active(j).row);
    gradient_.noalias() = H_inverse_ * residual_;
    pivot = residual_.dot(gradient_) + softness(row);
    for (Eigen::Index j = 0; j < active_count(); ++j) {
      const Eigen::Index other = active(j).row;
      pivot += softness(other) * direction_(j) * direction_(j);
      correction_(j) = rows_.col(other).dot(gradient_) - softness(other) * direction_(j);
    }
    if (pass == 2) break;
    factor_.solve(correction_.data());
    direction_.head(active_count()) += correction_.head(active_count());
  }
  return pivot > kDependentPivot * own ? pivot : 0.0;
}

template <int N>
void Core<N>::finish(const QpInput& input, QpSolution& solution) {
  measure(input, solution);
  if (solution.status != QpStatus::solved) return;
  // Refinement does not change the violation of inactive rows.
  for (int i = 0; i < kMostRefinements && solution.kkt_residual > kRefineAbove &&
                  (is_tilted_ || active_error(input) > kRefineAbove);
       ++i) {
    refine(input, solution);
    measure(input, solution);
  }
}

// Computes kkt_residual() with less work: the last scan has the violations, and only active rows
// have multipliers.
template <int N>
void Core<N>::measure(const QpInput& input, QpSolution& solution) {
  set_multipliers(solution);
  set_gradient(input, solution);
  double scale = std::max(1.0, g_norm_);
  double slack = 0.0;  // the largest product with a multiplier
  for (Eigen::Index j = 0; j < active_count(); ++j) {
    const double mu = solution.mu(active(j).row);
    scale = std::max(scale, std::abs(mu));
    slack = std::max(slack, std::abs(mu * (values_(active(j).row) - bound(input, active(j)))));
  }
  const double largest_value = largest_row_ * solution.z.template lpNorm<Eigen::Infinity>();
  if (has_soft_ || !is_finite(gradient_) || !(largest_value < kNoBound)) {
    solution.kkt_residual = kkt_residual(factors_.model, input, solution, values_, room_);
    is_tilted_ = true;
    return;
  }
  const double tilt = std::max(gradient_.template lpNorm<Eigen::Infinity>(), slack) / scale;
  is_tilted_ = tilt > kRefineAbove;
  solution.kkt_residual = std::max(tilt, scan_.violation);
}

template <int N>
void Core<N>::set_multipliers(QpSolution& solution) const {
  solution.mu.setZero();
  for (Eigen::Index j = 0; j < active_count(); ++j) {
    // A multiplier with the wrong sign is due to rounding and counts as 0.
    if (active(j).side * mu_(j) > 0.0) solution.mu(active(j).row) = mu_(j);
  }
}

// H z + g + Ωᵀ μ.
template <int N>
void Core<N>::set_gradient(const QpInput& input, const QpSolution& solution) {
  if constexpr (N == Eigen::Dynamic) {
    if (sweeps_) {
      sweeps_->gradient(solution.z, solution.mu, gradient_);
      gradient_ += input.g;
      return;
    }
  }
  gradient_.noalias() = H_ * Eigen::Map<const Vector>(solution.z.data(), solution.z.size());
  gradient_ += input.g;
  for (Eigen::Index j = 0; j < active_count(); ++j) {
    gradient_ += solution.mu(active(j).row) * rows_.col(active(j).row);
  }
}

// Corrects the multipliers by the errors of the active rows.
template <int N>
void Core<N>::hold_bounds(const QpInput& input) {
  for (Eigen::Index j = 0; j < active_count(); ++j) {
    const Eigen::Index row = active(j).row;
    correction_(j) = values_(row) - softness(row) * mu_(j) - bound(input, active(j));
  }
  factor_.solve(correction_.data());
  mu_.head(active_count()) += correction_.head(active_count());
}

template <int N>
void Core<N>::refine(const QpInput& input, QpSolution& solution) {
  hold_bounds(input);
  // Newton step of z for these multipliers, with the true gradient.
  Eigen::Map<Vector> z(solution.z.data(), solution.z.size());
  set_multipliers(solution);
  set_gradient(input, solution);
  z.noalias() -= H_inverse_ * gradient_;
  scan(input, solution);
}

// Adds the row of the last pivot_towards() to the working set.
template <int N>
void Core<N>::add(Eigen::Index row, double side, double pivot) {
  factor_.add(half_.data(), pivot);
  active_.push_back({row, side, length_(row) + softness(row)});
  weight_(row) = 0.0;
}

template <int N>
void Core<N>::remove(Eigen::Index position) {
  weigh(active(position).row);
  active_.erase(active_.begin() + position);
  factor_.remove(position);
}

std::unique_ptr<ActiveSetQp::Core> make_core(const QpModel& model, int max_changes) {
  switch (model.H.rows()) {
    case 1:
      return std::make_unique<Core<1>>(model, max_changes);
    case 2:
      return std::make_unique<Core<2>>(model, max_changes);
    case 3:
      return std::make_unique<Core<3>>(model, max_changes);
    case 4:
      return std::make_unique<Core<4>>(model, max_changes);
    case 5:
      return std::make_unique<Core<5>>(model, max_changes);
    case 6:
      return std::make_unique<Core<6>>(model, max_changes);
    default:
      return std::make_unique<Core<Eigen::Dynamic>>(model, max_changes);
  }
}

}  // namespace

ActiveSetQp::ActiveSetQp(const QpModel& model, int max_changes) {
  if (max_changes < 1) {
    throw std::invalid_argument("active set: needs a cap of at least 1 change");
  }
  solver_ = make_core(model, max_changes);
}

}  // namespace breakwater
