// Hildreth's quadratic programming: coordinate ascent on the dual.
#pragma once

#include <breakwater/linear/qp.h>

namespace breakwater {

/// The thesis' solver (2.3.4, 2.3.7): sweeps over the rows and moves each row's multiplier to where
/// that row alone would be satisfied,
///     λ_i ← max(0, λ_i + (Ω_i z − ω_i)/(Ω_i H⁻¹ Ω_iᵀ)),
/// until no multiplier moves by more than the tolerance 1e-8, or the cap on sweeps is reached. At
/// the cap z is what the sweeps have got so far, which violates rows; the status says so. An
/// infeasible problem has no fixed point, so it ends at the cap too.
///
/// What differs from the textbook: the values Ω z are kept and changed when a multiplier does
/// (which is seldom), instead of being summed anew for every row; it starts from the last
/// multipliers, unless they were on their way to infinity, as those of an infeasible problem are:
/// at the cap, and so far off that the dual objective would be largest at more than half as much
/// again of them all; a row's two sides are two neighbours in the sweep.
///
/// Source: C. Hildreth, Naval Res. Logist. Q. 4 (1957) 79–85; L. Wang, Model Predictive Control
/// System Design and Implementation Using MATLAB (2009), 2.4.4.
class HildrethQp final : public QpSolver {
 public:
  /// Throws std::invalid_argument as make_qp_solver.
  HildrethQp(const QpModel& model, int max_sweeps);

  void solve(const QpInput& input, QpSolution& solution) override;
  void reset() override;
  const QpModel& model() const override { return factors_.model; }

 private:
  double sweep(const QpInput& input);
  double excess(const QpInput& input, const Eigen::VectorXd& mu) const;
  double move(Eigen::Index row, double& multiplier, double sign, double violation,
              const QpInput& input);

  QpFactors factors_;
  int max_sweeps_;
  Eigen::VectorXd lambda_upper_;
  Eigen::VectorXd lambda_lower_;
  Eigen::VectorXd values_free_;  // Ω z_free
  Eigen::VectorXd values_;       // Ω z
  Eigen::VectorXd z_free_;       // −H⁻¹ g
  Eigen::VectorXd gradient_;
};

}  // namespace breakwater
