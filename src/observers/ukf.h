// The unscented Kalman filter with 2n sigma points.
#pragma once

#include <Eigen/Cholesky>
#include <cmath>
#include <cstdint>

#include <breakwater/observers/nonlinear_kalman.h>
#include <breakwater/observers/raise_eigenvalues.h>

namespace breakwater {
namespace detail {

/// Sends the symmetric set x ± √n L e_j through the process. `mean` gets their mean; T and S the
/// halves of differences and sums of each pair about it, so that the points' covariance is
/// (T Tᵀ + S Sᵀ)/n; S lives in the process' nonlinear rows. L is lower triangular, so pair j
/// differs from the mean in states j … n − 1 alone.
template <Process P>
struct SigmaPoints {
  static constexpr int N = P::kStates;
  using State = Eigen::Matrix<double, N, 1>;
  using Square = Eigen::Matrix<double, N, N>;

  void spread(const P& process, const State& x, const Square& L, const typename P::Input& u) {
    const Square& A = process.linear();
    const double root_n = std::sqrt(static_cast<double>(N));
    T.noalias() = A * L.template triangularView<Eigen::Lower>();
    T *= root_n;
    mean.noalias() = A * x;
    typename P::Nonlinear at_mean, plus, minus;
    process.nonlinear(x, u, at_mean);
    typename P::Nonlinear mean_of_g = static_cast<double>(N - P::kArguments) / N * at_mean;
    for (int j = 0; j < P::kArguments; ++j) {
      const State offset = root_n * L.col(j);
      process.nonlinear(x + offset, u, plus);
      process.nonlinear(x - offset, u, minus);
      S.col(j) = 0.5 * (plus + minus);
      T.template block<P::kRows, 1>(P::kFirstRow, j) += 0.5 * (plus - minus);
      mean_of_g += S.col(j) / N;
    }
    S.colwise() -= mean_of_g;
    // Pairs that have the mean's g all have the same S.
    rest = std::sqrt(static_cast<double>(N - P::kArguments)) * (at_mean - mean_of_g);
    mean.template segment<P::kRows>(P::kFirstRow) += mean_of_g;
  }

  State mean;
  Square T;
  Eigen::Matrix<double, P::kRows, P::kArguments> S;
  typename P::Nonlinear rest;
};

}  // namespace detail

/// Unscented Kalman filter with α = 1, β = κ = 0: 2n sigma points x ± √n L e_j of equal weight
/// 1/(2n), L Lᵀ = P. S. J. Julier and J. K. Uhlmann, Proc. IEEE 92 (2004) 401–422.
///
/// L is P's Cholesky factor. Should P lose its definiteness by rounding, its eigenvalues are raised
/// to 1e-12 of the largest, which is counted in repairs().
template <Process P, int p>
class Ukf final : public GaussianEstimate<P::kStates, p> {
 public:
  static constexpr int N = P::kStates;
  using Base = GaussianEstimate<N, p>;
  using typename Base::Covariance;
  using typename Base::Design;
  using typename Base::State;
  using Input = typename P::Input;

  /// Throws std::invalid_argument as check(design).
  Ukf(const P& process, const Design& design) : Base(design), process_(process) {}

  /// From sample k − 1 to k under the input that was held. Allocates nothing.
  void predict(const Input& u) {
    factor_.compute(P_);
    if (factor_.info() != Eigen::Success) repair();
    root_ = factor_.matrixL();
    points_.spread(process_, x_, root_, u);
    x_ = points_.mean;
    constexpr double kWeight = 1.0 / N;
    P_.template triangularView<Eigen::Lower>() = points_.T * points_.T.transpose();
    nonlinear_part_.noalias() = points_.S * points_.S.transpose();
    nonlinear_part_.noalias() += points_.rest * points_.rest.transpose();
    P_.template block<P::kRows, P::kRows>(P::kFirstRow, P::kFirstRow) += nonlinear_part_;
    P_.template triangularView<Eigen::Lower>() = kWeight * P_ + design_.Q;
    this->mirror();
  }

  /// For a process whose parameters are tracked: both may change between samples.
  P& process() { return process_; }
  void set_process_noise(const Covariance& Q) { design_.Q = Q; }

  std::int64_t repairs() const { return repairs_; }

 private:
  using Base::design_;
  using Base::P_;
  using Base::x_;

  void repair() {
    constexpr double kFloor = 1e-12;
    static_assert(N <= kMostStates);
    ++repairs_;
    raise_eigenvalues(P_, kFloor);
    this->mirror();
    factor_.compute(P_);
  }

  P process_;
  Eigen::LLT<Covariance> factor_;
  Covariance root_;
  detail::SigmaPoints<P> points_;
  Eigen::Matrix<double, P::kRows, P::kRows> nonlinear_part_;
  std::int64_t repairs_ = 0;
};

}  // namespace breakwater
