// An exact quadratic programming solver: a warm-started dual active-set method.
#pragma once

#include <memory>

#include <breakwater/linear/qp.h>

namespace breakwater {

/// Solves a QpModel exactly, in finitely many steps. The working set is the rows that are held at a
/// bound. With S = Ω_W H⁻¹ Ω_Wᵀ its minimiser is
///     z = −H⁻¹ (g + Ω_Wᵀ μ_W),   S μ_W = −Ω_W H⁻¹ g − β_W   (β: the bounds held).
/// It starts from the last solve's working set, and lets go of rows whose multipliers have the
/// wrong sign. Then, as long as a row is violated, the row that is violated most (in the metric of
/// H⁻¹) is driven to its bound along the direction that keeps the working set at theirs; a row of
/// the working set whose multiplier would change sign on the way leaves. Every step raises the dual
/// objective, so no working set comes twice. If a violated row depends on the working set and
/// nothing can leave, no z satisfies these rows: infeasible, if infeasibility_margin() agrees.
///
/// S is kept as its factor L D Lᵀ, to which rows are added and from which they are removed. As
/// that squares the condition of the working set, the multipliers are refined by the true residual
/// where it is above 1e-10. What is called solved has a KKT residual of at most 1e-8: a problem
/// that cannot be brought there is solved anew from nothing, then by OrthogonalActiveSet, and is
/// reported as inaccurate if that does not help.
///
/// Source: D. Goldfarb, A. Idnani, Math. Program. 27 (1983) 1–33, in the dual's variables as in
/// D. Arnström, A. Bemporad, D. Axehill, IEEE Trans. Autom. Control 67 (2022) 4362–4369.
class ActiveSetQp final : public QpSolver {
 public:
  /// `max_changes` is the cap on the working set's changes from one start: what is solved anew has
  /// as many again. Throws std::invalid_argument as make_qp_solver.
  ActiveSetQp(const QpModel& model, int max_changes);

  void solve(const QpInput& input, QpSolution& solution) override {
    solver_->solve(input, solution);
  }
  void reset() override { solver_->reset(); }
  const QpModel& model() const override { return solver_->model(); }

 private:
  std::unique_ptr<QpSolver> solver_;  // made for the number of variables, where that is small
};

}  // namespace breakwater
