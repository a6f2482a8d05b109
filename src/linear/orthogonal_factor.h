// The orthogonal factor of a working set of a quadratic program.
#pragma once

#include <Eigen/Core>
#include <vector>

#include <breakwater/linear/qp.h>

namespace breakwater {

/// The rows of a working set as vectors c = L⁻¹ Ω_iᵀ, with H = L Lᵀ. Each is extended by √softness
/// in a component of its own. They are factored as Q R. Unlike the factor of S = Rᵀ R, this does
/// not square their condition number. Nothing is allocated after construction.
class OrthogonalFactor {
 public:
  /// `factors` must outlive this.
  explicit OrthogonalFactor(const QpFactors& factors);

  /// Removes all rows. The next ones have this softness (m).
  void clear(const Eigen::VectorXd& softness);
  /// Finds the combination `direction` of the working set (its first entries) that is nearest to
  /// another row. True residuals correct it. Returns the squared length of the rest; 0: the row
  /// depends on the working set.
  double compare(Eigen::Index row, Eigen::VectorXd& direction);
  /// Adds the row of the last compare().
  void add(Eigen::Index row);
  void remove(Eigen::Index position);
  /// Newton's step for the working set as equations. `gradient` is H z + g + Ωᵀ μ (n) and becomes
  /// the excess of z. `lacking` has each row's distance below its bound and becomes the excess of
  /// its multiplier.
  void correct(Eigen::VectorXd& gradient, Eigen::VectorXd& lacking) const;

 private:
  Eigen::Index size() const { return static_cast<Eigen::Index>(rows_.size()); }
  auto basis() const { return Q_.topLeftCorner(depth_, size()); }
  auto triangle() const { return R_.topLeftCorner(size(), size()); }

  const QpFactors& factors_;
  std::vector<Eigen::Index> rows_;
  Eigen::VectorXd softness_;
  Eigen::Index depth_ = 0;  // length of the vectors: n, or n + m if a row is soft
  Eigen::MatrixXd Q_;       // (n + m)×m
  Eigen::MatrixXd R_;       // m×m
  Eigen::VectorXd c_;       // a row's vector, or its rest orthogonal to the working set
  Eigen::VectorXd shares_;  // Qᵀ c
  Eigen::VectorXd correction_;
};

}  // namespace breakwater
