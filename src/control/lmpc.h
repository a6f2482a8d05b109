// Linear model predictive control that optimises input changes: thesis 2.3.3, 2.3.5 and 2.3.7.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <memory>
#include <vector>

#include <breakwater/control/prediction.h>
#include <breakwater/linear/horizon.h>
#include <breakwater/linear/qp.h>

namespace breakwater {

/// lower ≤ one component of x, u or Δu ≤ upper, at some steps of the prediction.
struct PredictedBound {
  Eigen::Index component = 0;
  double lower = 0.0;
  double upper = 0.0;
  /// Of x(k + i): i from 1 to N_p. Of u(k + i) and Δu(k + i): i from 0 to N_u − 1.
  std::vector<int> steps;
};

/// The first `count` steps, from 0 on.
std::vector<int> first_steps(int count);

/// `count` steps spread evenly over 1 … last, of which the last is one.
std::vector<int> spread_steps(int count, int last);

/// What to do when no ΔU satisfies all bounds.
enum class OnInfeasible {
  /// Bounds of states give way, in the order in which they are declared; if that does not suffice,
  /// because bounds on u have moved away from u(k−1), those on Δu last. Bounds on u never do.
  soften,
  stop  ///< ControlFailure
};

struct LmpcDesign {
  Eigen::MatrixXd A;         ///< n×n, of the sampled model
  Eigen::MatrixXd B;         ///< n×m
  int prediction_steps = 0;  ///< N_p
  int control_steps = 0;     ///< N_u ≤ N_p: the input stays after that
  Eigen::MatrixXd Q;         ///< n×n, positive semidefinite: weight on the states' errors
  Eigen::MatrixXd Q_last;    ///< n×n, the same at step N_p: a terminal penalty (Eq. 2.49)
  Eigen::MatrixXd R;         ///< m×m, positive semidefinite: weight on Δu
  Eigen::MatrixXd S;         ///< m×m, positive semidefinite: weight on u; empty: none

  std::vector<PredictedBound> change_bounds;  ///< on Δu
  std::vector<PredictedBound> input_bounds;   ///< on u
  std::vector<PredictedBound> state_bounds;   ///< on x, in the order in which they may give way

  QpSolverKind solver = QpSolverKind::active_set;
  int max_iterations = 0;
  OnInfeasible on_infeasible = OnInfeasible::soften;
  double softness = 0.0;  ///< of a bound that gives way: by s·μ for its multiplier μ
};

/// What the optimisations had to do so far. One may take several solves, where bounds give way.
struct QpStatistics {
  std::int64_t optimisations = 0;
  std::int64_t unsolved = 0;    ///< whose problem, as it was given, was not solved
  std::int64_t softened = 0;    ///< of these, how many had to let bounds give way
  std::int64_t capped = 0;      ///< of these, how many were left with an approximate solution
  std::int64_t iterations = 0;  ///< of all solves
  int most_iterations = 0;      ///< of an optimisation
  double time_s = 0.0;  ///< of the processor; some 0.3 us of each solve are the clock itself
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
/// With S = R of a regulator, R = 0, N_u = N_p and Q_last its Riccati solution this is that
/// regulator, whatever the horizon, as long as no bound is active.
class Lmpc {
 public:
  /// Throws std::invalid_argument if the shapes do not fit, a horizon is no horizon, a weight is
  /// not positive semidefinite, H is not positive definite, or a bound is none.
  explicit Lmpc(const LmpcDesign& design);

  /// Forgets the last solution and the statistics.
  void reset();

  /// Δu(k) (m), from x(k) (n), u(k−1) (m) and the reference trajectory T_ref (N_p n). The bounds on
  /// u are moved by −`reserved` (m), the input that is added elsewhere. Where the exact solver was
  /// left with an approximate solution, Δu(k) is brought into its bounds, those on u before those
  /// on Δu. Allocates nothing. Throws ControlFailure if the bounds cannot be satisfied.
  const Eigen::VectorXd& optimise(const Eigen::Ref<const Eigen::VectorXd>& x,
                                  const Eigen::Ref<const Eigen::VectorXd>& last_input,
                                  const Eigen::Ref<const Eigen::VectorXd>& reference,
                                  const Eigen::Ref<const Eigen::VectorXd>& reserved);

  /// Sweeps or changes of the last optimisation, all its solves together.
  int iterations() const { return iterations_; }

  /// How many bounds gave way at the last optimisation: of states, and one more where Δu's did.
  int softened_bounds() const { return softened_bounds_; }

  /// The bounds on component `i` of u(k).
  double first_input_lower(Eigen::Index i) const { return first_input_.lower(i); }
  double first_input_upper(Eigen::Index i) const { return first_input_.upper(i); }

  /// Whether the bounds on u and Δu alone leave anything from u(k−1) on.
  bool inputs_are_feasible(const Eigen::Ref<const Eigen::VectorXd>& last_input) const;

  Eigen::Index states() const { return prediction_.Psi.cols(); }
  Eigen::Index inputs() const { return prediction_.Gamma.cols(); }
  int prediction_steps() const { return design_.prediction_steps; }
  const Prediction& prediction() const { return prediction_; }

  /// Of the last optimisation: the problem, and what the solver made of it.
  const QpModel& qp_model() const { return solver_->model(); }
  const QpInput& qp_input() const { return input_; }
  const QpSolution& solution() const { return solution_; }
  const QpStatistics& statistics() const { return statistics_; }

 private:
  using RowKind = Horizon::RowKind;
  struct Row {
    RowKind kind;
    int step;         // as Horizon::Row
    Eigen::Index at;  // of it, in u of all steps or in Z
    Eigen::Index component;
    double lower;
    double upper;
    std::size_t bound;  // which one of its kind it belongs to
  };

  struct Range {
    Eigen::VectorXd lower;
    Eigen::VectorXd upper;
  };

  QpModel make_model();
  Horizon make_horizon() const;
  void add_rows(RowKind kind, const std::vector<PredictedBound>& bounds, Eigen::Index width,
                int first_step, int last_step);
  void set_slope(const Eigen::Ref<const Eigen::VectorXd>& x,
                 const Eigen::Ref<const Eigen::VectorXd>& last_input,
                 const Eigen::Ref<const Eigen::VectorXd>& reference);
  void set_bounds(const Eigen::Ref<const Eigen::VectorXd>& last_input,
                  const Eigen::Ref<const Eigen::VectorXd>& reserved);
  void solve();
  void soften();
  void give_way(RowKind kind, std::size_t bound);
  static Range first_step(const std::vector<PredictedBound>& bounds, Eigen::Index width);

  LmpcDesign design_;
  Prediction prediction_;
  std::vector<Row> rows_;
  Eigen::MatrixXd weighted_;  // Θᵀ Q̅
  Eigen::MatrixXd sums_;      // C_2ᵀ S̅ C_1
  std::unique_ptr<QpSolver> solver_;
  std::unique_ptr<HorizonSweeps> sweeps_;  // or nullptr: the matrices are multiplied with
  QpInput input_;
  QpSolution solution_;
  Eigen::VectorXd free_;    // Ψ x + Γ u
  Eigen::VectorXd errors_;  // free_ − T_ref
  Eigen::VectorXd change_;
  Range first_change_;  // of Δu(k)
  Range first_input_;   // of u(k)
  int softened_bounds_ = 0;
  int iterations_ = 0;      // of this optimisation
  double elapsed_s_ = 0.0;  // by this optimisation's solves
  QpStatistics statistics_;
};

}  // namespace breakwater
