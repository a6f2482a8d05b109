// The active set as it was in version 0.2: kept to measure later ones against.
#pragma once

#include <vector>

#include "factors.h"

namespace breakwater::v0_2 {

/// Solves a QpModel exactly, in finitely many steps. The working set is the rows that are held at a
/// bound. With S = Ω_W H⁻¹ Ω_Wᵀ its minimiser is
///     z = −H⁻¹ (g + Ω_Wᵀ μ_W),   S μ_W = −Ω_W H⁻¹ g − β_W   (β: the bounds held).
/// It starts from the last solve's working set, and lets go of rows whose multipliers have the
/// wrong sign. Then, as long as a row is violated, the row that is violated most (in the metric of
/// H⁻¹) is driven to its bound along the direction that keeps the working set at theirs; a row of
/// the working set whose multiplier would change sign on the way leaves. Every step raises the dual
/// objective, so no working set comes twice. If a violated row depends on the working set and
/// nothing can leave, no z satisfies these rows: infeasible.
///
/// S is kept as its Cholesky factor, to which rows are added and from which they are removed. As
/// that squares the condition of the working set, the multipliers are refined by the true residual
/// where it is above 1e-10. What is called solved has a KKT residual of at most 1e-8: a problem
/// that cannot be brought there is solved anew from nothing, and is reported as iteration_cap if
/// that does not help.
///
/// Source: D. Goldfarb, A. Idnani, Math. Program. 27 (1983) 1–33, in the dual's variables as in
/// D. Arnström, A. Bemporad, D. Axehill, IEEE Trans. Autom. Control 67 (2022) 4362–4369.
class ActiveSetQp final : public QpSolver {
 public:
  /// `max_changes` is the cap on the working set's changes from one start: what is solved anew from
  /// nothing has as many again. Throws std::invalid_argument as make_qp_solver.
  ActiveSetQp(const QpModel& model, int max_changes);

  void solve(const QpInput& input, QpSolution& solution) override;
  void reset() override;
  const QpModel& model() const override { return factors_.model; }

 private:
  struct Violation {
    Eigen::Index row = -1;  // −1: none
    double amount = 0.0;
    bool upper = false;
  };

  Eigen::Index active() const { return static_cast<Eigen::Index>(working_set_.size()); }
  double side(Eigen::Index row) const { return at_upper_[static_cast<std::size_t>(row)] ? 1 : -1; }

  void take_over(const QpInput& input);
  void attempt(const QpInput& input, QpSolution& solution);
  void refactor();
  QpStatus search(const QpInput& input, QpSolution& solution);
  void make_dual_feasible(const QpInput& input);
  void solve_multipliers(const QpInput& input);
  void place(QpSolution& solution);
  Violation worst_violation(const QpInput& input) const;
  QpStatus drive_to_bound(const QpInput& input, Violation violation, QpSolution& solution);
  double pivot_towards(Eigen::Index row);
  void hold_bounds(const QpInput& input);
  void refine(const QpInput& input, QpSolution& solution);
  void finish(const QpInput& input, QpSolution& solution);

  void factor_solve(Eigen::VectorXd& x) const;
  void forward_solve(Eigen::VectorXd& x) const;
  void backward_solve(Eigen::VectorXd& x) const;
  void add(Eigen::Index row, bool upper, double pivot);
  void remove(Eigen::Index position);

  QpFactors factors_;
  int max_changes_;
  int changes_left_ = 0;  // of this attempt

  std::vector<Eigen::Index> working_set_;
  std::vector<Eigen::Index> previous_;  // room for refactor()
  std::vector<char> is_active_;         // of each row
  std::vector<char> at_upper_;          // of each active row
  Eigen::VectorXd softness_;            // that the factor holds
  Eigen::MatrixXd factor_;              // L of S = L Lᵀ, in the top left corner

  // All sized for the largest working set; the first active() entries count.
  Eigen::VectorXd mu_;         // of the working set
  Eigen::VectorXd half_;       // L⁻¹ × (a row's column of the Gram matrix)
  Eigen::VectorXd direction_;  // S⁻¹ × the same: how the working set's multipliers answer
  Eigen::VectorXd correction_;

  Eigen::VectorXd z_free_;    // −H⁻¹ g, n
  Eigen::VectorXd values_;    // Ω z, m
  Eigen::VectorXd gradient_;  // n
  Eigen::VectorXd residual_;  // n
};

}  // namespace breakwater::v0_2
