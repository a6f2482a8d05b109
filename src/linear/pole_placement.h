// Pole placement for multi-output observers.
#pragma once

#include <Eigen/Core>
#include <Eigen/LU>
#include <complex>
#include <vector>

namespace breakwater {

/// The poles that one output is to place. A complex pole stands beside its conjugate.
using PoleGroup = std::vector<std::complex<double>>;

/// Observer gain H (n×p) with eig(A − H C) = the union of `groups`.
///
/// Group i holds the poles that output i places, so there are p groups with n poles in all. Each
/// pole λ of group i gets the left eigenvector w with wᵀ(A − λ I) = e_iᵀ C; then Hᵀ W = V, where
/// the columns of V are the e_i. On a plant made of decoupled chains, one per output, this gives
/// each chain its own group and leaves the chains decoupled (the joints of Eq. 2.54). A pole that
/// stands m times in one group gets a Jordan chain of length m.
///
/// Source: eigenstructure assignment, B. C. Moore, IEEE Trans. Autom. Control 21 (1976) 689–692.
///
/// Throws std::invalid_argument if the shapes do not fit, a pole is not finite or lacks its
/// conjugate, a pole already is an eigenvalue of A, or the groups cannot be placed through those
/// outputs (in particular, if (A, C) is not observable).
Eigen::MatrixXd place_observer_poles(const Eigen::MatrixXd& A, const Eigen::MatrixXd& C,
                                     const std::vector<PoleGroup>& groups);

/// place_observer_poles() again and again, of one size: allocates nothing once it is made.
class ObserverPlacement {
 public:
  ObserverPlacement(Eigen::Index states, Eigen::Index outputs);

  /// Writes H (n×p). Throws as place_observer_poles() does, but for poles that are too close.
  void place(const Eigen::Ref<const Eigen::MatrixXd>& A, const Eigen::Ref<const Eigen::MatrixXd>& C,
             const std::vector<PoleGroup>& groups, Eigen::MatrixXd& H);
  /// Whether the last poles could be placed with sense. Allocates.
  bool is_well_conditioned() const;

 private:
  // The poles of a fast sampled observer crowd together just below 1, which makes the eigenvector
  // matrix badly conditioned: hence extended precision.
  using Scalar = std::complex<long double>;
  using Matrix = Eigen::Matrix<Scalar, Eigen::Dynamic, Eigen::Dynamic>;
  using Vector = Eigen::Matrix<Scalar, Eigen::Dynamic, 1>;
  using Scale = Eigen::Array<long double, Eigen::Dynamic, 1>;

  template <typename Rhs>
  void solve(const Rhs& rhs, Rhs& permuted, Rhs& solution) const;

  PoleGroup group_;
  Matrix shifted_;
  Eigen::FullPivLU<Matrix> lu_;
  Matrix W_, V_;
  Vector vector_, permuted_vector_;
  Scale row_scale_, column_scale_;
  Matrix rows_scaled_, balanced_;
  Matrix scaled_V_, permuted_, solved_;
};

/// z = e^{s T_s}: where a sampled system must put a continuous pole s [1/s]. Throws
/// std::invalid_argument unless each lies left of the imaginary axis, as those of an observer must.
std::vector<PoleGroup> sample_poles(const std::vector<PoleGroup>& continuous, double period_s);
/// The same into `sampled`, which allocates nothing the second time.
void sample_poles(const std::vector<PoleGroup>& continuous, double period_s,
                  std::vector<PoleGroup>& sampled);

/// The eigenvalues of a real square matrix.
PoleGroup eigenvalues(const Eigen::MatrixXd& A);

/// The largest magnitude of an eigenvalue.
double spectral_radius(const Eigen::MatrixXd& A);

}  // namespace breakwater
