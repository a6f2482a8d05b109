// The unscented Kalman filter that carries P's Cholesky factor.
#pragma once

#include <Eigen/Eigenvalues>
#include <Eigen/QR>

#include <breakwater/observers/ukf.h>

namespace breakwater {

/// The filter of ukf.h in square-root form: P = L Lᵀ is never formed in the recursion, so it cannot
/// lose its definiteness. The prediction triangularises [T S]/√n and Q^½ side by side, the
/// correction the array
///     [R^½  C L]      [S^½  0 ]
///     [0    L  ]  to  [K S^½  L⁺],
/// each by Householder's QR of the transpose. R. van der Merwe and E. A. Wan, ICASSP 2001; the
/// array for a linear measurement: T. Kailath et al., Linear Estimation, 2000, 12.
template <Process Model, int p>
class SquareRootUkf {
 public:
  static constexpr int N = Model::kStates;
  using State = Eigen::Matrix<double, N, 1>;
  using Covariance = Eigen::Matrix<double, N, N>;
  using Output = Eigen::Matrix<double, p, 1>;
  using Input = typename Model::Input;
  using Design = NonlinearKalmanDesign<N, p>;

  /// Throws std::invalid_argument as check(design).
  SquareRootUkf(const Model& process, const Design& design)
      : process_(process), design_(design), points_(process) {
    check(design);
    // Q is only semidefinite: its root by eigenvalues.
    const Eigen::SelfAdjointEigenSolver<Covariance> eigen(design.Q);
    root_Q_ = eigen.eigenvectors() * eigen.eigenvalues().cwiseMax(0.0).cwiseSqrt().asDiagonal();
    root_R_ = design.R.llt().matrixL();
    reset(State::Zero());
  }

  void reset(const State& x) {
    x_ = x;
    L_ = design_.P0.llt().matrixL();
  }

  void predict(const Input& u) {
    points_.spread(process_, x_, L_.transpose(), u);
    x_ = points_.mean;
    const double weight = 1.0 / std::sqrt(static_cast<double>(N));
    spread_.setZero();
    spread_.template topRows<N>() = weight * points_.transposed_T;
    spread_.template block<Model::kArguments, Model::kRows>(N, Model::kFirstRow) =
        weight * points_.S.transpose();
    spread_.template block<1, Model::kRows>(N + Model::kArguments, Model::kFirstRow) =
        weight * points_.rest.transpose();
    spread_.template bottomRows<N>() = root_Q_.transpose();
    predict_qr_.compute(spread_);
    const Covariance upper =
        predict_qr_.matrixQR().template topRows<N>().template triangularView<Eigen::Upper>();
    L_ = with_positive_diagonal(upper.transpose());
  }

  void correct(const Output& y) {
    array_.setZero();
    array_.template topLeftCorner<p, p>() = root_R_.transpose();
    array_.template bottomLeftCorner<N, p>() = L_.template topRows<p>().transpose();
    array_.template bottomRightCorner<N, N>() = L_.transpose();
    correct_qr_.compute(array_);
    const Eigen::Matrix<double, N + p, N + p> upper =
        correct_qr_.matrixQR().template triangularView<Eigen::Upper>();
    const Eigen::Matrix<double, p, p> root_S = upper.template topLeftCorner<p, p>().transpose();
    const Eigen::Matrix<double, N, p> K_root_S = upper.template topRightCorner<p, N>().transpose();
    const Output innovation = y - x_.template head<p>();
    x_.noalias() += K_root_S * root_S.template triangularView<Eigen::Lower>().solve(innovation);
    const Covariance root = upper.template bottomRightCorner<N, N>().transpose();
    L_ = with_positive_diagonal(root);
  }

  const State& x() const { return x_; }
  Covariance P() const { return L_ * L_.transpose(); }
  const Covariance& L() const { return L_; }

 private:
  // QR leaves the signs of its rows open; the columns' signs do not matter to L Lᵀ.
  static Covariance with_positive_diagonal(Covariance root) {
    for (int j = 0; j < N; ++j) {
      if (root(j, j) < 0.0) root.col(j) = -root.col(j);
    }
    return root;
  }

  using Spread = Eigen::Matrix<double, 2 * N + Model::kArguments + 1, N>;
  using Array = Eigen::Matrix<double, N + p, N + p>;

  Model process_;
  Design design_;
  Covariance root_Q_;
  Eigen::Matrix<double, p, p> root_R_;
  State x_;
  Covariance L_;
  detail::SigmaPoints<Model> points_;
  Spread spread_;
  Array array_;
  Eigen::HouseholderQR<Spread> predict_qr_;
  Eigen::HouseholderQR<Array> correct_qr_;
};

}  // namespace breakwater
