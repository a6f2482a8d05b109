// Quadratic programs: what every solver is given and gives back.
#pragma once

#include <Eigen/Core>
#include <limits>
#include <memory>
#include <optional>

#include <breakwater/linear/horizon.h>

namespace breakwater {

inline constexpr double kNoBound = std::numeric_limits<double>::infinity();

/// The problem, of n variables and m rows:
///     minimise ½ zᵀ H z + gᵀ z   subject to   lower ≤ Ω z ≤ upper.
/// H and Ω stay, as in linear predictive control, where g and the bounds change at every sample:
/// a solver factors them once.
struct QpModel {
  using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

  Eigen::MatrixXd H;  ///< n×n, symmetric positive definite
  RowMajor Omega;     ///< m×n; a row has two sides, so Ω ΔU ≤ ω of the thesis has 2 m rows
  /// What H and Ω are made of, where they are those of predictive control: a solver may use it.
  std::optional<Horizon> horizon = std::nullopt;
};

/// What changes from solve to solve.
struct QpInput {
  Eigen::VectorXd g;      ///< n
  Eigen::VectorXd lower;  ///< m; −∞ where there is no bound
  Eigen::VectorXd upper;  ///< m; +∞ where there is none
  /// m, ≥ 0. 0: a hard row. s > 0: the row may give way by s·μ, which costs ½ s μ² (a quadratic
  /// penalty of weight 1/s on its violation), where μ is its multiplier.
  Eigen::VectorXd softness;

  /// All zeros, and no bounds.
  QpInput(Eigen::Index n, Eigen::Index m);
};

enum class QpStatus {
  solved,         ///< by the solver's own measure; kkt_residual says how well
  iteration_cap,  ///< gave up at the cap on iterations: z may violate rows
  infeasible,     ///< no z satisfies all rows, which is proven; z violates some
  not_finite,     ///< an input is NaN, or infinite where it may not be; z is 0
  inaccurate      ///< rounding hides both a solution and a proof that there is none: z is near
};

struct QpSolution {
  Eigen::VectorXd z;  ///< n
  /// m, multipliers: > 0 at an upper, < 0 at a lower bound, 0 between. Where the active-set solver
  /// says infeasible: its certificate y of infeasibility_margin(), or 0 where a row's own bounds
  /// cross.
  Eigen::VectorXd mu;
  QpStatus status = QpStatus::not_finite;
  int iterations = 0;
  double kkt_residual = 0.0;  ///< of z and the multipliers, by kkt_residual()

  QpSolution(Eigen::Index n, Eigen::Index m);

  /// Nothing, of an input that is not finite.
  void set_not_finite();
};

/// The largest of: ‖H z + g + Ωᵀ μ‖∞/γ; what z violates any row by; and |μ_i|·(distance from the
/// bound that its sign means)/γ. γ = max(1, ‖g‖∞, ‖μ‖∞). 0 means optimal. Infinite if anything is
/// not finite or a multiplier's bound is infinite. `values` is Ω z, `gradient` room to work in (n);
/// allocates nothing.
double kkt_residual(const QpModel& model, const QpInput& input, const QpSolution& solution,
                    const Eigen::VectorXd& values, Eigen::VectorXd& gradient);

/// The active-set solver calls solved what has at most this KKT residual,
inline constexpr double kQpSolvedBelow = 1e-8;
/// and lets a row be violated by so much, in its own unit.
inline constexpr double kQpViolation = 5e-9;

/// The margin by which y (m) proves that there is no solution: by Farkas' lemma no z satisfies the
/// rows if Ωᵀ y = 0 and
///     gap = −Σ (y_i > 0 ? upper_i : lower_i) y_i > 0.
/// In numbers Ωᵀ y is nearly 0, and no z with |z|∞ < gap/‖Ωᵀ y‖₁ does. Returned is this limit over
/// the largest of 1 and |bound_i|/‖Ω_i‖∞ of the rows that y takes, with every rounding of these
/// sums counted against it; 0 where y proves nothing. Allocates nothing.
double infeasibility_margin(const QpModel& model, const QpInput& input, const Eigen::VectorXd& y);

/// A certificate has at least this infeasibility_margin().
inline constexpr double kInfeasibleFrom = 1e5;

/// A solver remembers its last solution and starts from it.
class QpSolver {
 public:
  QpSolver() = default;
  QpSolver(const QpSolver&) = delete;
  QpSolver& operator=(const QpSolver&) = delete;
  virtual ~QpSolver() = default;

  /// Solves one problem. The vectors must have the model's sizes. Allocates nothing.
  virtual void solve(const QpInput& input, QpSolution& solution) = 0;

  /// Forgets the last solution: the next solve starts cold.
  virtual void reset() = 0;

  virtual const QpModel& model() const = 0;
};

enum class QpSolverKind { hildreth, active_set };

/// A solver by its kind. `max_sweeps` is Hildreth's cap; the active-set solver, which ends by
/// itself, has a cap of its own that is never reached but by a defect. Throws std::invalid_argument
/// if H is not symmetric positive definite, shapes do not fit, or the cap is not positive.
std::unique_ptr<QpSolver> make_qp_solver(QpSolverKind kind, const QpModel& model, int max_sweeps);

/// What solvers share: a model with what follows from it alone.
struct QpFactors {
  QpModel model;
  Eigen::MatrixXd columns;    ///< Ω again, by columns: faster to multiply where n is small
  Eigen::MatrixXd H_inverse;  ///< n×n
  Eigen::MatrixXd step;       ///< H⁻¹ Ωᵀ, n×m: how z answers to a row's multiplier
  Eigen::MatrixXd gram;       ///< Ω H⁻¹ Ωᵀ, m×m: how the rows do
  Eigen::MatrixXd L;          ///< lower triangular, H = L Lᵀ

  /// Throws std::invalid_argument as make_qp_solver.
  explicit QpFactors(QpModel qp);

  Eigen::Index variables() const { return model.H.rows(); }
  Eigen::Index rows() const { return model.Omega.rows(); }

  /// What is wrong with an input before anything is solved, or `solved` if nothing is: not_finite,
  /// or infeasible where a lower bound is above its upper one.
  static QpStatus examine(const QpInput& input);
};

}  // namespace breakwater
