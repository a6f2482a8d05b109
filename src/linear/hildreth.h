// Hildreth's quadratic programming: coordinate ascent on the dual.
#pragma once

#include <breakwater/linear/qp.h>

namespace breakwater {

/// The thesis' solver (2.3.4, 2.3.7). Each sweep sets the multiplier of each row to the value that
/// satisfies this row alone,
///     λ_i ← max(0, λ_i + (Ω_i z − ω_i)/(Ω_i H⁻¹ Ω_iᵀ)),
/// until the KKT residual is at most 1e-8 or the number of sweeps reaches its limit. At the limit,
/// z is the approximation so far and violates rows, as the status says. An infeasible problem has
/// no fixed point and also ends there.
///
/// Differences from the textbook: Ω z is stored and updated with each multiplier that changes,
/// which is rare. The two sides of a row are neighbours in the sweep. The solver starts from the
/// last multipliers unless they diverge, as those of an infeasible problem do. Multipliers λ
/// diverge if the dual objective of c λ is largest at c > 1.5 when the limit is reached. This c
/// must also not decrease in the second half of the sweeps.
///
/// Source: C. Hildreth, Naval Res. Logist. Q. 4 (1957) 79–85; L. Wang, Model Predictive Control
/// System Design and Implementation Using MATLAB (2009), 2.4.4.
class HildrethQp final : public QpSolver {
 public:
  /// Throws std::invalid_argument as make_qp_solver() does.
  HildrethQp(const QpModel& model, int max_sweeps);

  void solve(const QpInput& input, QpSolution& solution) override;
  void reset() override;
  const QpModel& model() const override { return factors_.model; }

 private:
  void place(const QpInput& input, QpSolution& solution);
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
