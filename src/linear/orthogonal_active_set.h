// An active-set method with an orthogonal factor, for badly conditioned quadratic programs.
#pragma once

#include <algorithm>
#include <cmath>
#include <vector>

#include <breakwater/linear/qp.h>

namespace breakwater {

/// The dual active-set method of ActiveSetQp, slower, for problems that it cannot solve. With H = L
/// Lᵀ, a row is the vector c = L⁻¹ Ω_iᵀ, extended by √softness in its own component. The vectors of
/// the working set are stored as Q R. Unlike S = Rᵀ R, this does not square their condition number.
/// After every change of the working set, true residuals correct z and the multipliers. They also
/// correct the combination of rows for comparison with a new row. Rows with two equal bounds never
/// leave. The status is `infeasible` only with a certificate (infeasibility_margin()).
///
/// Source: D. Goldfarb, A. Idnani, Math. Program. 27 (1983) 1–33.
class OrthogonalActiveSet {
 public:
  /// `factors` must outlive this. `max_changes` bounds the changes of the working set.
  OrthogonalActiveSet(const QpFactors& factors, int max_changes);

  /// Starts from an empty working set. The input must have passed QpFactors::examine(). Adds the
  /// number of changes to solution.iterations. Allocates nothing.
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
  Active worst_violation(const QpInput& input, double tolerance) const;
  double size(const QpInput& input, Eigen::Index row) const {
    return std::max(factors_.size(row), std::sqrt(input.softness(row)));
  }
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
  Eigen::Index depth_ = 0;     // length of the vectors: n, or n + m if a row is soft
  Eigen::MatrixXd Q_;          // (n + m)×m
  Eigen::MatrixXd R_;          // m×m
  Eigen::VectorXd c_;          // a row's vector, or its rest orthogonal to the working set
  Eigen::VectorXd shares_;     // Qᵀ c
  Eigen::VectorXd direction_;  // R⁻¹ Qᵀ c
  Eigen::VectorXd correction_;
  Eigen::VectorXd residual_;  // n
  Eigen::VectorXd values_;    // Ω z
  Eigen::VectorXd proof_;     // m
};

}  // namespace breakwater
