// The factor S = L D Lᵀ of a matrix that gains and loses rows.
#pragma once

#include <Eigen/Core>

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

}  // namespace breakwater
