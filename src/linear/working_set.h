// The factors of the working set of a quadratic program: S = L D Lᵀ, and Q R.
#pragma once

#include <Eigen/Core>
#include <vector>

#include <breakwater/linear/qp.h>

namespace breakwater {

/// The factor of a symmetric positive definite matrix S (k×k, k ≤ capacity) with L unit lower
/// triangular and D diagonal. A new row and its column are added at the end. Any row can be
/// removed. Nothing is allocated after construction. k is the size of all vectors here.
class LdlFactor {
 public:
  explicit LdlFactor(Eigen::Index capacity)
      : L_(Eigen::MatrixXd::Zero(capacity, capacity)),
        D_(Eigen::VectorXd::Zero(capacity)),
        D_inverse_(D_),
        falling_(D_) {}

  Eigen::Index size() const { return size_; }
  void clear() { size_ = 0; }
  /// The diagonal element of row j after elimination of the rows before it, or more.
  double pivot(Eigen::Index j) const { return D_(j); }

  /// x ← D⁻¹ L⁻¹ x. Returns xᵀ S⁻¹ x for the old x.
  double forward_solve(double* x) const;
  /// x ← L⁻ᵀ x. After forward_solve(), the result is S⁻¹ x.
  void backward_solve(double* x) const;
  void solve(double* x) const {
    forward_solve(x);
    backward_solve(x);
  }

  /// Adds the row s of S: `half` is D⁻¹ L⁻¹ s, `pivot` (> 0) its diagonal element minus sᵀ S⁻¹ s.
  void add(const double* half, double pivot) {
    for (Eigen::Index j = 0; j < size_; ++j) L_(size_, j) = half[j];
    D_(size_) = pivot;
    D_inverse_(size_) = 1.0 / pivot;
    ++size_;
  }

  /// Removes row and column `position`. The rows below gain the rank-one term d l lᵀ of the removed
  /// column (P. E. Gill, G. H. Golub, W. Murray, M. A. Saunders, Math. Comp. 28 (1974) 505–535,
  /// method C1).
  void remove(Eigen::Index position);

 private:
  Eigen::Index size_ = 0;
  Eigen::MatrixXd L_;  // below the diagonal, in the top left corner
  Eigen::VectorXd D_;
  Eigen::VectorXd D_inverse_;
  Eigen::VectorXd falling_;  // the rest of l
};

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
