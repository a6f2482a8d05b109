// An active set with an orthogonal factor: for quadratic programs that the faster one loses.
#pragma once

#include <vector>

#include <breakwater/linear/qp.h>

namespace breakwater {

/// The dual active-set method of ActiveSetQp, slower and with half of the digits lost. With
/// H = L Lᵀ a row is the vector c = L⁻¹ Ω_iᵀ, followed by √softness in a place of its own. The
/// working set's vectors are kept as Q R, which does not square their condition as S = Rᵀ R does.
/// z and the multipliers are corrected by their true residuals at every change of the working set,
/// and so is the combination of rows that a new one is compared with. Rows whose two bounds are
/// equal never leave. It is `infeasible` only with a certificate (infeasibility_margin()).
///
/// Source: D. Goldfarb, A. Idnani, Math. Program. 27 (1983) 1–33.
class OrthogonalActiveSet {
 public:
  /// `factors` must outlive it. `max_changes` is the cap on the working set's changes.
  OrthogonalActiveSet(const QpFactors& factors, int max_changes);

  /// Starts from nothing. The input must have passed QpFactors::examine(). solution.iterations
  /// grows by the changes. Allocates nothing.
  void solve(const QpInput& input, QpSolution& solution);

 private:
  struct Active {
    Eigen::Index row;
    double side;  // 1: at its upper bound, −1: at its lower, 0: at both
  };

  const Active& active(Eigen::Index j) const { return active_[static_cast<std::size_t>(j)]; }
  Eigen::Index active_count() const { return static_cast<Eigen::Index>(active_.size()); }
  auto basis() const { return Q_.topLeftCorner(depth_, active_count()); }
  auto triangle() const { return R_.topLeftCorner(active_count(), active_count()); }

  QpStatus search(const QpInput& input, QpSolution& solution);
  Active worst_violation(const QpInput& input) const;
  QpStatus drive_to_bound(const QpInput& input, Active row, QpSolution& solution);
  double compare(const QpInput& input, Eigen::Index row);
  bool is_proof(const QpInput& input, Active row);
  void add(Active row, double length);
  void remove(Eigen::Index position, QpSolution& solution);
  void correct(const QpInput& input, QpSolution& solution);

  const QpFactors& factors_;
  int max_changes_;
  int changes_left_ = 0;
  std::vector<Active> active_;
  std::vector<bool> is_active_;
  Eigen::Index depth_ = 0;     // of the vectors: n, and m more where a row is soft
  Eigen::MatrixXd Q_;          // (n + m)×m
  Eigen::MatrixXd R_;          // m×m
  Eigen::VectorXd c_;          // a row's vector, or what is left of it outside of the working set's
  Eigen::VectorXd shares_;     // Qᵀ c
  Eigen::VectorXd direction_;  // R⁻¹ Qᵀ c
  Eigen::VectorXd correction_;
  Eigen::VectorXd residual_;  // n
  Eigen::VectorXd values_;    // Ω z
  Eigen::VectorXd proof_;     // m
};

}  // namespace breakwater
