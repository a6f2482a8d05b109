// Quadratic programs: the input and the output of all solvers, and Hildreth's solver.
#pragma once

#include <Eigen/Core>
#include <limits>
#include <memory>

#include <breakwater/linear/horizon.h>
#include <breakwater/math/interface.h>

namespace breakwater {

inline constexpr double kNoBound = std::numeric_limits<double>::infinity();

/// A problem with n variables and m rows:
///     minimise ½ zᵀ H z + gᵀ z   subject to   lower ≤ Ω z ≤ upper.
/// A solver factors H and Ω once. They are constant in linear predictive control, and g and the
/// bounds change at every sample.
struct QpModel {
  using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

  Eigen::MatrixXd H;  ///< n×n, symmetric positive definite
  RowMajor Omega;     ///< m×n; a row has two bounds, so Ω ΔU ≤ ω of the thesis has 2 m rows
  /// Products with H and Ω, for predictive control. A solver may use them.
  std::shared_ptr<HorizonSweeps> sweeps = nullptr;
};

/// The part of the problem that changes from solve to solve.
struct QpInput {
  Eigen::VectorXd g;      ///< n
  Eigen::VectorXd lower;  ///< m; −∞: no bound
  Eigen::VectorXd upper;  ///< m; +∞: no bound
  /// m, ≥ 0. 0: a hard row. s > 0: the bound of the row moves by s·μ, where μ is its multiplier.
  /// This costs ½ s μ²: a quadratic penalty of weight 1/s on the violation.
  Eigen::VectorXd softness;

  /// All zeros, without bounds.
  QpInput(Eigen::Index n, Eigen::Index m)
      : g(Eigen::VectorXd::Zero(n)),
        lower(Eigen::VectorXd::Constant(m, -kNoBound)),
        upper(Eigen::VectorXd::Constant(m, kNoBound)),
        softness(Eigen::VectorXd::Zero(m)) {}
};

enum class QpStatus {
  solved,         ///< with a KKT residual of at most kQpSolvedBelow
  iteration_cap,  ///< reached the limit of iterations: z may violate rows
  infeasible,     ///< proven: no z satisfies all rows; z violates some
  not_finite,     ///< an input is NaN or an invalid infinity; z is 0
  inaccurate      ///< rounding prevents both a solution and a proof of infeasibility; z is near,
                  ///< or 0 if its numbers are too large
};

struct QpSolution {
  Eigen::VectorXd z;  ///< n
  /// m, multipliers: > 0 at an upper, < 0 at a lower bound, 0 between. If the status is
  /// `infeasible`: its certificate y for infeasibility_margin(), or none if a lower bound is above
  /// its upper bound.
  Eigen::VectorXd mu;
  QpStatus status = QpStatus::not_finite;
  int iterations = 0;
  double kkt_residual = 0.0;  ///< kkt_residual() of z and the multipliers

  QpSolution(Eigen::Index n, Eigen::Index m)
      : z(Eigen::VectorXd::Zero(n)), mu(Eigen::VectorXd::Zero(m)) {}

  /// The result where there are no numbers: an input is not finite, or they are too large.
  void set_nothing(QpStatus why);
};

/// The error of a solution in the program's own units: other units of z, of a row or of the cost do
/// not change it. z_j counts in 1/√H_jj. Row i counts in its size s_i, the largest of
/// |Ω_ij|/√H_jj and √softness_i. With
///     γ = max(|g_j|/√H_jj, s_i |μ_i|),   β = max |finite bound_i|/s_i   and
///     ζ = max(min(max |z_j| √H_jj, β), 1e-9 γ)
/// it is the largest of |H z + g + Ωᵀ μ|_j/(√H_jj γ), the violations of the rows/(s_i ζ), and
/// |μ_i|·(distance from its bound)/(γ ζ). 0 means optimal. Infinite if a value is not
/// finite or a multiplier belongs to an infinite bound. `values` is Ω z, `gradient` (n) is work
/// space. Allocates nothing.
double kkt_residual(const QpModel& model, const QpInput& input, const QpSolution& solution,
                    const Eigen::VectorXd& values, Eigen::VectorXd& gradient);

/// The share of γ in ζ: the scale of z where z is 0 but for rounding.
inline constexpr double kQpGradientShare = 1e-9;
/// Largest KKT residual that a solver reports as solved.
inline constexpr double kQpSolvedBelow = 1e-8;
/// Violation of a row that the active-set solver allows, relative to s_i ζ.
inline constexpr double kQpViolation = 5e-9;

/// The scale β of kkt_residual(). Allocates nothing.
double bound_scale(const QpModel& model, const QpInput& input);

/// The margin by which y (m) proves infeasibility (Farkas). No z satisfies the rows if Ωᵀ y = 0 and
///     gap = −Σ (y_i > 0 ? upper_i : lower_i) y_i > 0.
/// With rounding Ωᵀ y is only nearly 0. In the units of kkt_residual(), no z with |z|∞ < gap/‖Ωᵀ
/// y‖₁ satisfies the rows. The margin is this limit divided by the largest |bound_i|/s_i with y_i ≠
/// 0, and at least by 1e-9 ‖g‖∞. Rounding errors of these sums reduce it. 0: y proves nothing.
/// Allocates nothing.
double infeasibility_margin(const QpModel& model, const QpInput& input, const Eigen::VectorXd& y);

/// Smallest infeasibility_margin() of a certificate.
inline constexpr double kInfeasibleFrom = 1e5;

/// A model and the constants that all solvers derive from it.
struct QpFactors {
  QpModel model;
  Eigen::MatrixXd columns;    ///< Ω by columns: faster products for small n
  Eigen::MatrixXd H_inverse;  ///< n×n
  Eigen::MatrixXd step;       ///< H⁻¹ Ωᵀ, n×m: response of z to the multipliers
  Eigen::MatrixXd gram;       ///< Ω H⁻¹ Ωᵀ, m×m: response of the rows
  Eigen::MatrixXd L;          ///< lower triangular, H = L Lᵀ; zeros above the diagonal
  Eigen::VectorXd root;       ///< √H_jj, n
  Eigen::VectorXd size;       ///< the size of each row without softness, m

  /// Throws std::invalid_argument as make_qp_solver() does.
  explicit QpFactors(QpModel qp);

  /// Computes the constants from model.H and model.Omega. Allocates nothing after the first call.
  void factor();

  Eigen::Index variables() const { return model.H.rows(); }
  Eigen::Index rows() const { return model.Omega.rows(); }

 private:
  Eigen::MatrixXd half_;  // L⁻¹ Ωᵀ, n×m
};

/// A solver of quadratic programs. It starts from its last solution.
class QpSolver : public Interface {
 public:
  /// Solves one problem. The vectors must have the model's sizes. Allocates nothing.
  void solve(const QpInput& input, QpSolution& solution);

  /// Forgets the last solution: the next solve has no warm start.
  virtual void reset() = 0;

  const QpModel& model() const { return factors_.model; }

 protected:
  /// Throws std::invalid_argument as make_qp_solver() does.
  explicit QpSolver(const QpModel& model) : factors_(model) {}

  /// Solves a problem of finite numbers. `is_empty`: a lower bound is above its upper bound.
  virtual void find(const QpInput& input, bool is_empty, QpSolution& solution) = 0;

  QpFactors factors_;
};

enum class QpSolverKind { hildreth, active_set };

/// Makes a solver. `max_sweeps` is the limit of Hildreth's method. The active-set solver has its
/// own limit, which only a defect can reach. Throws std::invalid_argument if H is not symmetric
/// positive definite, shapes do not fit, or the limit is not positive.
std::unique_ptr<QpSolver> make_qp_solver(QpSolverKind kind, const QpModel& model, int max_sweeps);

/// The thesis' solver (2.3.4, 2.3.7). Each sweep sets the multiplier of each row to the value that
/// satisfies this row alone,
///     λ_i ← max(0, λ_i + (Ω_i z − ω_i)/(Ω_i H⁻¹ Ω_iᵀ)),
/// until the KKT residual is at most 1e-8 or the number of sweeps reaches its limit. At the limit,
/// z is the approximation so far and violates rows, as the status says. An infeasible problem has
/// no fixed point and also ends there.
///
/// The solver starts from the last multipliers unless they diverge, as those of an infeasible
/// problem do (docs/explanation/methods/quadratic-programs.md).
///
/// Source: C. Hildreth, Naval Res. Logist. Q. 4 (1957) 79–85; L. Wang, Model Predictive Control
/// System Design and Implementation Using MATLAB (2009), 2.4.4.
class HildrethQp final : public QpSolver {
 public:
  /// `max_sweeps` > 0. Throws std::invalid_argument as make_qp_solver() does.
  HildrethQp(const QpModel& model, int max_sweeps);

  void reset() override;

 private:
  void find(const QpInput& input, bool is_empty, QpSolution& solution) override;
  void place(const QpInput& input, QpSolution& solution);
  double sweep(const QpInput& input);
  double excess(const QpInput& input, const Eigen::VectorXd& mu) const;
  double move(Eigen::Index row, double& multiplier, double sign, double violation,
              const QpInput& input);

  int max_sweeps_;
  Eigen::VectorXd lambda_upper_;
  Eigen::VectorXd lambda_lower_;
  Eigen::VectorXd values_free_;  // Ω z_free
  Eigen::VectorXd values_;       // Ω z
  Eigen::VectorXd z_free_;       // −H⁻¹ g
  Eigen::VectorXd gradient_;
};

}  // namespace breakwater
