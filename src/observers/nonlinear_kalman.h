// The common part of the extended and the unscented Kalman filter.
#pragma once

#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <array>
#include <concepts>
#include <cstddef>

#include <breakwater/linear/riccati.h>
#include <breakwater/math/refuse_unless.h>

namespace breakwater {

/// An N×N matrix in compressed rows. Products sum in the order of the columns. They skip the zeros
/// of the matrix, also when the other factor is not finite. Allocates nothing.
template <int N>
class SparseSquare {
 public:
  void assign(const Eigen::Matrix<double, N, N>& matrix) {
    std::size_t count = 0;
    for (int i = 0; i < N; ++i) {
      for (int k = 0; k < N; ++k) {
        if (matrix(i, k) != 0.0) entries_[count++] = {k, matrix(i, k)};
      }
      row_ends_[static_cast<std::size_t>(i)] = count;
    }
  }

  /// result = A x.
  void times(const Eigen::Matrix<double, N, 1>& x, Eigen::Matrix<double, N, 1>& result) const {
    std::size_t e = 0;
    for (int i = 0; i < N; ++i) {
      double sum = 0.0;
      for (; e < row_ends_[static_cast<std::size_t>(i)]; ++e) {
        sum += entries_[e].value * x(entries_[e].column);
      }
      result(i) = sum;
    }
  }

  /// result = X Aᵀ. X and result must not overlap.
  void transposed_times(const Eigen::Matrix<double, N, N>& X,
                        Eigen::Matrix<double, N, N>& result) const {
    std::size_t e = 0;
    for (int i = 0; i < N; ++i) {
      result.col(i).setZero();
      for (; e < row_ends_[static_cast<std::size_t>(i)]; ++e) {
        result.col(i) += entries_[e].value * X.col(entries_[e].column);
      }
    }
  }

 private:
  struct Entry {
    int column;
    double value;
  };
  std::array<Entry, static_cast<std::size_t>(N* N)> entries_{};
  std::array<std::size_t, N> row_ends_{};
};

/// A sampled process x(k+1) = A x(k) + g(x(k), u(k)) + noise. g fills only the kRows rows from
/// kFirstRow on, and depends only on the first kArguments states. A process without this structure
/// has A = 0, kFirstRow = 0 and kRows = kArguments = kStates.
///
/// linear() is constant. Only Ukf::change_process() may change it.
///
/// The structure only saves work: the linear part is predicted exactly. A sigma point that equals
/// the mean in the first kArguments states shares its g.
template <typename P>
concept Process = requires(const P& process, const typename P::State& x, const typename P::Input& u,
                           typename P::Nonlinear& g) {
  { P::kStates } -> std::convertible_to<int>;
  { P::kInputs } -> std::convertible_to<int>;
  { P::kFirstRow } -> std::convertible_to<int>;
  { P::kRows } -> std::convertible_to<int>;
  { P::kArguments } -> std::convertible_to<int>;
  process.nonlinear(x, u, g);
  { process.linear() } -> std::convertible_to<Eigen::Matrix<double, P::kStates, P::kStates>>;
};

/// The fixed-size types of a process.
template <int N, int M, int Rows>
struct ProcessTypes {
  using State = Eigen::Matrix<double, N, 1>;
  using Input = Eigen::Matrix<double, M, 1>;
  using Nonlinear = Eigen::Matrix<double, Rows, 1>;
};

/// Covariances of the process noise in one sample, the measurement noise and the first estimate.
template <int N, int p>
struct NonlinearKalmanDesign {
  Eigen::Matrix<double, N, N> Q;
  Eigen::Matrix<double, p, p> R;
  Eigen::Matrix<double, N, N> P0;
};

/// State, covariance and correction of a filter that measures the first p states, y = [I 0] x +
/// noise (Eq. 3.30). All filters share the correction: for a linear measurement, the unscented
/// transform gives the same result.
template <int N, int p>
class GaussianEstimate {
 public:
  using State = Eigen::Matrix<double, N, 1>;
  using Covariance = Eigen::Matrix<double, N, N>;
  using Output = Eigen::Matrix<double, p, 1>;
  using Design = NonlinearKalmanDesign<N, p>;

  /// Throws std::invalid_argument unless Q is positive semidefinite, and R and P0 positive
  /// definite.
  explicit GaussianEstimate(const Design& design) : design_(design) {
    refuse_unless(is_positive_semidefinite(design.Q),
                  "Kalman filter: Q must be symmetric positive semidefinite");
    refuse_unless(is_positive_definite(design.R) && is_positive_definite(design.P0),
                  "Kalman filter: R and P0 must be symmetric positive definite");
    reset(State::Zero());
  }

  void reset(const State& x) {
    x_ = x;
    P_ = design_.P0;
  }

  const State& x() const { return x_; }
  const Covariance& P() const { return P_; }
  /// e = y − C x(k|k−1), S = C P Cᵀ + R, K = P Cᵀ S⁻¹, x += K e, P −= K S Kᵀ. With S = L_S L_Sᵀ,
  /// K S Kᵀ = W Wᵀ, W = P Cᵀ L_S⁻ᵀ.
  void correct(const Output& y);

 protected:
  /// Copies the lower triangle to the upper one: P is exactly symmetric.
  void mirror() { P_.template triangularView<Eigen::StrictlyUpper>() = P_.transpose(); }

  Design design_;
  State x_;
  Covariance P_;

 private:
  Eigen::Matrix<double, p, p> S_;
  Eigen::LLT<Eigen::Matrix<double, p, p>> factor_;
  Eigen::Matrix<double, N, p> W_;
};

// This and the predictions of the filters stand outside their classes. Inside, each file would
// compile them in spite of `extern template`.
template <int N, int p>
void GaussianEstimate<N, p>::correct(const Output& y) {
  const Output e = y - x_.template head<p>();
  S_ = P_.template topLeftCorner<p, p>() + design_.R;
  factor_.compute(S_);
  W_ = P_.template leftCols<p>();
  factor_.matrixU().template solveInPlace<Eigen::OnTheRight>(W_);
  x_.noalias() += W_ * factor_.matrixL().solve(e);
  P_.noalias() -= W_.lazyProduct(W_.transpose());
  // For an odd N, Eigen sums the last rows in another order: symmetry is not exact.
  if constexpr (N % 2 != 0) mirror();
}

}  // namespace breakwater
