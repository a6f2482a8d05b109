// Linear model predictive control over input changes: thesis 2.3.3, 2.3.5 and 2.3.7, and Eq. 2.43.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <memory>
#include <vector>

#include <breakwater/linear/horizon.h>
#include <breakwater/linear/qp.h>

namespace breakwater {

/// The states of the next N_p samples, stacked. They depend on the state x(k), the input u(k−1) and
/// the input changes ΔU = [Δu(k); …; Δu(k + N_u − 1)], after which the input is constant:
///     Z = [x(k+1); …; x(k + N_p)] = Ψ x(k) + Γ u(k−1) + Θ ΔU.
struct Prediction {
  Eigen::MatrixXd Psi;    ///< N_p n × n: A, A², …
  Eigen::MatrixXd Gamma;  ///< N_p n × m: B, A B + B, … = S_1, S_2, …
  Eigen::MatrixXd Theta;  ///< N_p n × N_u m: block (i, j) is S_{i−j+1}, or 0 above the diagonal
};

/// The prediction for x(k+1) = A x(k) + B u(k). Throws std::invalid_argument unless the shapes fit
/// and 1 ≤ N_u ≤ N_p.
Prediction predict(const Eigen::MatrixXd& A, const Eigen::MatrixXd& B, int prediction_steps,
                   int control_steps);

/// lower ≤ a component of x, u or Δu ≤ upper, at some steps of the prediction.
struct PredictedBound {
  Eigen::Index component = 0;
  double lower = 0.0;
  double upper = 0.0;
  /// i of x(k + i), from 1 to N_p, or of u(k + i) and Δu(k + i), from 0 to N_u − 1.
  std::vector<int> steps;
};

/// The steps 0 … count − 1.
std::vector<int> first_steps(int count);

/// `count` steps spread evenly over 1 … last, including last.
std::vector<int> spread_steps(int count, int last);

/// The number of samples from one optimisation to the next. Throws std::invalid_argument unless the
/// period is a whole multiple of the sampling period.
int samples_per_move(double period_s, double sampling_s);

/// The reaction if no ΔU satisfies all bounds.
enum class OnInfeasible {
  /// Softens the bounds on states, in the order of their declaration. Then softens those on Δu: the
  /// bounds on u may have moved away from u(k−1). Bounds on u stay hard.
  soften,
  stop  ///< throws ControlFailure
};

/// The model and the weights on the errors of states, with Q_last at the end (Eq. 2.49), on Δu and
/// on u. An empty S is no weight on u. Lmpc derives the rows from the bounds.
struct LmpcDesign : Horizon {
  std::vector<PredictedBound> change_bounds;  ///< on Δu
  std::vector<PredictedBound> input_bounds;   ///< on u
  std::vector<PredictedBound> state_bounds;   ///< on x, in the order of softening

  QpSolverKind solver = QpSolverKind::active_set;
  int max_iterations = 1;  ///< for Hildreth's method
  OnInfeasible on_infeasible = OnInfeasible::soften;
  double softness = 1.0;  ///< s: a softened bound moves by s·μ for its multiplier μ
};

/// Counts of the optimisations so far. An optimisation takes several solves if it softens bounds.
struct QpStatistics {
  std::int64_t optimisations = 0;
  std::int64_t unsolved = 0;    ///< the original problem had no accurate solution
  std::int64_t softened = 0;    ///< part of `unsolved`: bounds were softened
  std::int64_t capped = 0;      ///< part of `unsolved`: the result is approximate
  std::int64_t iterations = 0;  ///< sum over all solves
  int most_iterations = 0;      ///< largest number in one optimisation
  double time_s = 0.0;  ///< processor time; reading the clock takes about 0.3 us of each solve
  double longest_s = 0.0;
};

/// Minimises over ΔU, for x(k+1) = A x(k) + B u(k) and u(k) = u(k−1) + Δu(k) (Eqs. 2.40, 2.42),
///     J = Σ_{i=1}^{N_p − 1} ‖r_i − x_i‖²_Q + ‖r_{N_p} − x_{N_p}‖²_{Q_last}
///         + Σ_{i=0}^{N_u − 1} ‖Δu_i‖²_R + ‖u_i‖²_S
/// subject to the bounds (Eq. 2.41). With Prediction, and u_i = u(k−1) + Σ_{j≤i} Δu_j = C_1 u + C_2
/// ΔU, this is the quadratic program
///     H = Θᵀ Q̅ Θ + R̅ + C_2ᵀ S̅ C_2,   g = −Θᵀ Q̅ ε + C_2ᵀ S̅ C_1 u,   ε = T_ref − Ψ x − Γ u
/// (Eq. 2.44; the thesis' V is twice this). Its rows are those of Δu, then u, then x.
///
/// With S = R of a regulator, R = 0, N_u = N_p and its Riccati solution as Q_last, this equals the
/// regulator. It holds for any horizon without active bounds.
class Lmpc {
 public:
  /// Throws std::invalid_argument unless the shapes fit, the horizons and bounds are valid, the
  /// weights are positive semidefinite and H is positive definite.
  explicit Lmpc(const LmpcDesign& design);

  /// Clears u, the last solution and the statistics.
  void reset();

  /// u(k−1) (m), to which optimise() adds Δu(k).
  Eigen::VectorXd& u() { return u_; }
  /// The reference trajectory T_ref (N_p n).
  Eigen::VectorXd& reference() { return reference_; }
  /// An input added elsewhere (m): the bounds on u move by its negative.
  Eigen::VectorXd& reserved() { return reserved_; }

  /// Returns Δu(k) (m) from x(k) (n). If the exact solver only has an approximate solution, Δu(k)
  /// is clipped to the bounds on Δu, then to those on u. Allocates nothing. Throws ControlFailure
  /// if the bounds cannot be satisfied.
  const Eigen::VectorXd& optimise(const Eigen::Ref<const Eigen::VectorXd>& x);

  // Signals for a log:
  /// Sweeps or changes of the active set in the last optimisation, in all its solves.
  const double& iterations() const { return iterations_; }
  /// Number of softened state bounds in the last optimisation, plus one if those on Δu were.
  const double& softened_bounds() const { return softened_bounds_; }

  Eigen::Index states() const { return prediction_.Psi.cols(); }
  Eigen::Index inputs() const { return prediction_.Gamma.cols(); }
  int prediction_steps() const { return design_.prediction_steps; }

  /// The problem and the solution of the last optimisation.
  const QpModel& qp_model() const { return solver_->model(); }
  const QpInput& qp_input() const { return input_; }
  const QpSolution& solution() const { return solution_; }
  const QpStatistics& statistics() const { return statistics_; }

 private:
  using RowKind = Horizon::RowKind;
  struct Row : Horizon::Row {
    Eigen::Index at;  // index in u of all steps or in Z
    double lower;
    double upper;
    std::size_t bound;  // index among the bounds of its kind
  };

  QpModel make_model();
  void add_rows(RowKind kind, const std::vector<PredictedBound>& bounds, Eigen::Index width);
  void set_slope(const Eigen::Ref<const Eigen::VectorXd>& x);
  void set_bounds();
  void solve();
  void soften();
  void give_way(RowKind kind, std::size_t bound);
  void clip(RowKind kind);

  LmpcDesign design_;
  Prediction prediction_;
  std::vector<Row> rows_;
  Eigen::MatrixXd weighted_;  // Θᵀ Q̅
  Eigen::MatrixXd sums_;      // C_2ᵀ S̅ C_1
  std::unique_ptr<QpSolver> solver_;
  QpInput input_;
  QpSolution solution_;
  Eigen::VectorXd u_;
  Eigen::VectorXd reserved_;
  Eigen::VectorXd reference_;
  Eigen::VectorXd free_;    // Ψ x + Γ u
  Eigen::VectorXd errors_;  // free_ − T_ref
  Eigen::VectorXd change_;
  double softened_bounds_ = 0.0;
  double iterations_ = 0.0;  // in this optimisation
  double elapsed_s_ = 0.0;   // time of this optimisation's solves
  QpStatistics statistics_;
};

}  // namespace breakwater
