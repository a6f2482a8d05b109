// An exact solver of quadratic programs: a dual active-set method with warm start.
#pragma once

#include <memory>

#include <breakwater/linear/qp.h>

namespace breakwater {

/// Solves a QpModel exactly, in a finite number of steps. The working set contains the active rows
/// W. With S = Ω_W H⁻¹ Ω_Wᵀ and their bounds β_W, the minimiser is
///     z = −H⁻¹ (g + Ω_Wᵀ μ_W),   S μ_W = −Ω_W H⁻¹ g − β_W.
/// It starts from the last working set without the rows whose multipliers have the wrong sign. Each
/// iteration takes the row with the largest violation in the metric of H⁻¹. It moves this row to
/// its bound along a direction that keeps the active rows at theirs. A row whose multiplier would
/// change sign on the way leaves the working set. Every step raises the dual objective, so no
/// working set occurs twice. If the violated row depends on the working set and no row can leave,
/// the problem is infeasible. infeasibility_margin() must confirm this.
///
/// S is stored as its factor L D Lᵀ, which rows join and leave. This squares the condition number
/// of the working set. The true residual therefore refines multipliers if it is above 1e-10. A
/// solved problem has a KKT residual of at most 1e-8. Otherwise the solver starts again without the
/// last working set, and then calls OrthogonalActiveSet. The last resort is status `inaccurate`.
///
/// Source: D. Goldfarb, A. Idnani, Math. Program. 27 (1983) 1–33, in the dual's variables as in
/// D. Arnström, A. Bemporad, D. Axehill, IEEE Trans. Autom. Control 67 (2022) 4362–4369.
class ActiveSetQp final : public QpSolver {
 public:
  /// `max_changes` bounds the changes of the working set in one attempt. Throws
  /// std::invalid_argument as make_qp_solver() does.
  ActiveSetQp(const QpModel& model, int max_changes);

  void solve(const QpInput& input, QpSolution& solution) override {
    solver_->solve(input, solution);
  }
  void reset() override { solver_->reset(); }
  const QpModel& model() const override { return solver_->model(); }

  /// Changes the matrices between two solves. They have the sizes of the first ones; H is symmetric
  /// positive definite, which is not checked. The next solve starts from the last working set.
  /// Throws std::invalid_argument if a size differs or the model has a Horizon. Allocates nothing.
  void set_matrices(const Eigen::MatrixXd& H, const QpModel::RowMajor& Omega) {
    solver_->set_matrices(H, Omega);
  }

  /// The interface of the solvers for each number of variables.
  class Core : public QpSolver {
   public:
    virtual void set_matrices(const Eigen::MatrixXd& H, const QpModel::RowMajor& Omega) = 0;
  };

 private:
  std::unique_ptr<Core> solver_;  // specialised for a small number of variables
};

}  // namespace breakwater
