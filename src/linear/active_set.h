// An exact solver of quadratic programs: a dual active-set method with warm start.
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <memory>
#include <vector>

#include <breakwater/linear/qp.h>
#include <breakwater/linear/working_set.h>

namespace breakwater {

/// Violations t_i = share_i max(v_i − upper_i, lower_i − v_i) of rows i with values v_i.
struct RowScan {
  double violation = 0.0;    ///< the largest t_i, or 0
  double worst_score = 0.0;  ///< the largest weight_i (t_i − tolerance), or 0
};

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
/// S is stored as its factor L D Lᵀ. A solved problem has a KKT residual of at most 1e-8. Otherwise
/// the solver starts again without the last working set, and at last with an OrthogonalFactor
/// instead of S. If this fails, the status is `inaccurate`.
/// docs/explanation/methods/quadratic-programs.md.
///
/// Source: D. Goldfarb, A. Idnani, Math. Program. 27 (1983) 1–33, in the dual's variables as in
/// D. Arnström, A. Bemporad, D. Axehill, IEEE Trans. Autom. Control 67 (2022) 4362–4369.
class ActiveSetQp final : public QpSolver {
 public:
  /// `max_changes` bounds the changes of the working set in one attempt. Throws
  /// std::invalid_argument as make_qp_solver() does.
  ActiveSetQp(const QpModel& model, int max_changes);

  void reset() override;

  /// Changes the matrices between two solves. They have the sizes of the first ones; H is symmetric
  /// positive definite, which is not checked. The next solve starts from the last working set.
  /// Throws std::invalid_argument if a size differs or the model has sweeps. Allocates nothing.
  void set_matrices(const Eigen::MatrixXd& H, const QpModel::RowMajor& Omega);

 private:
  struct Small;

  struct Violation {
    Eigen::Index row = -1;  // −1: none
    double amount = 0.0;
    bool upper = false;
  };

  // A row of the working set.
  struct Active {
    Eigen::Index row;
    double side;    // 1: at its upper bound, −1: at its lower, 0: at both
    double length;  // squared, in the metric of H⁻¹
  };

  Eigen::Index active_count() const { return static_cast<Eigen::Index>(active_.size()); }
  const Active& active(Eigen::Index j) const { return active_[static_cast<std::size_t>(j)]; }
  static double bound(const QpInput& input, const Active& row) {
    return row.side > 0.0 ? input.upper(row.row) : input.lower(row.row);
  }
  double softness(Eigen::Index row) const { return has_soft_ ? softness_(row) : 0.0; }
  // Its squared length in the metric of H⁻¹.
  double length(Eigen::Index row) const { return factors_.gram(row, row) + softness(row); }
  // The error of the j-th active row at its bound.
  double error_at(const QpInput& input, Eigen::Index j) const {
    const Eigen::Index row = active(j).row;
    return values_(row) - softness(row) * mu_(j) - bound(input, active(j));
  }
  const double* row_data(Eigen::Index row) const {
    return factors_.model.Omega.data() + row * factors_.variables();
  }

  void find(const QpInput& input, bool is_empty, QpSolution& solution) override;
  void derive();
  void take_over(const QpInput& input);
  void attempt(const QpInput& input, QpSolution& solution);
  void weigh_all();
  void refactor();
  QpStatus search(const QpInput& input, QpSolution& solution);
  void make_dual_feasible(const QpInput& input);
  void place(const QpInput& input, QpSolution& solution);
  void scan(const QpInput& input, const QpSolution& solution);
  void move(const Eigen::VectorXd& from, const Eigen::VectorXd& mu, Eigen::VectorXd& z) const;
  void multiply(const Eigen::MatrixXd& M, const Eigen::VectorXd& x, Eigen::VectorXd& y) const;
  void rows_of(const Eigen::VectorXd& z, Eigen::VectorXd& values);
  Violation worst_violation(const QpInput& input) const;
  QpStatus drive_to_bound(const QpInput& input, Violation violation, QpSolution& solution);
  void set_proof(Eigen::Index row, double sign);
  double what_is_left(const QpInput& input, const Violation& violation, double multiplier,
                      QpSolution& solution);
  void settle(const QpInput& input, QpSolution& solution);
  void correct(const QpInput& input, QpSolution& solution);
  bool is_proven(const QpInput& input) const;
  double active_error(const QpInput& input) const;
  double tolerance() const { return kQpViolation * std::max(reach_, kQpGradientShare * slope_); }
  double pivot_towards(Eigen::Index row);
  double pivot_with_less_cancellation(Eigen::Index row, double own);
  void hold_bounds(const QpInput& input, QpSolution& solution);
  void refine(const QpInput& input, QpSolution& solution);
  void finish(const QpInput& input, QpSolution& solution);
  void measure(const QpInput& input, QpSolution& solution);
  void set_multipliers(QpSolution& solution) const;
  void set_gradient(const QpInput& input, const QpSolution& solution);
  void add(Eigen::Index row, double side, double pivot);
  void remove(Eigen::Index position);

  const Small* small_;        // products for this number of variables; nullptr: it is not small
  double largest_row_ = 0.0;  // ‖Ω‖∞
  int max_changes_;
  int changes_left_ = 0;  // in this attempt

  // nullptr unless the problem has a long Horizon.
  std::shared_ptr<HorizonSweeps> sweeps_;

  LdlFactor factor_;  // factor of S
  // In the last attempt, instead of factor_:
  bool is_careful_ = false;
  OrthogonalFactor orthogonal_;
  Eigen::Index entering_ = -1;  // a row on its way to its bound, or none
  double entering_mu_ = 0.0;    // its multiplier

  std::vector<Active> active_;
  std::vector<Active> previous_;  // work space of refactor()
  Eigen::VectorXd size_;          // the rows' sizes (kkt_residual())
  Eigen::VectorXd share_;         // 1/size
  Eigen::VectorXd free_weight_;   // size/length of each row in the metric of H⁻¹
  Eigen::VectorXd weight_;        // the same; 0: active
  Eigen::VectorXd softness_;      // softness in the present factor
  bool has_soft_ = false;
  bool is_tilted_ = false;  // the residual is not only due to violated rows

  // Their size is that of the largest working set. Only the first active_count() entries
  // are used.
  Eigen::VectorXd mu_;         // multipliers of the working set
  Eigen::VectorXd target_;     // S μ
  Eigen::VectorXd half_;       // D⁻¹ L⁻¹ s, with the column s of a row in the Gram matrix
  Eigen::VectorXd direction_;  // S⁻¹ s: the response of the working set's multipliers
  Eigen::VectorXd correction_;

  Eigen::VectorXd inverse_root_;  // 1/√H_jj
  double slope_ = 0.0;            // largest |g_j|/√H_jj
  double bound_ = 0.0;            // β of kkt_residual()
  double reach_ = 0.0;            // ζ without its least value
  double zeta_ = 0.0;             // ζ of the last measure()
  Eigen::VectorXd z_free_;        // −H⁻¹ g
  Eigen::VectorXd values_;        // Ω z
  Eigen::VectorXd scores_;        // weighted violations of the rows
  RowScan scan_;
  Eigen::VectorXd values_free_;  // Ω z_free
  Eigen::VectorXd gradient_;
  Eigen::VectorXd residual_;
  Eigen::VectorXd room_;   // n
  Eigen::VectorXd proof_;  // m: certificate of infeasibility
};

}  // namespace breakwater
