// The unscented Kalman filter with 2n sigma points.
#pragma once

#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <cmath>
#include <cstdint>

#include <breakwater/observers/nonlinear_kalman.h>

namespace breakwater {

constexpr int kMostStates = 32;  ///< the largest n

/// Raises the eigenvalues of a symmetric n×n matrix, n ≤ kMostStates, to at least `floor` times the
/// largest one. Reads the lower triangle, writes both. Allocates nothing.
void raise_eigenvalues(Eigen::Ref<Eigen::MatrixXd> matrix, double floor);

/// Unscented Kalman filter with α = 1, β = κ = 0: 2n sigma points x ± √n L e_j of equal weight
/// 1/(2n), L Lᵀ = P. S. J. Julier and J. K. Uhlmann, Proc. IEEE 92 (2004) 401–422.
///
/// L is P's Cholesky factor. If rounding makes P indefinite, its eigenvalues are raised to 1e-12 of
/// the largest one. repairs() counts this.
template <Process P, int p>
class Ukf final : public GaussianEstimate<P::kStates, p> {
 public:
  static constexpr int N = P::kStates;
  using Base = GaussianEstimate<N, p>;
  using typename Base::Covariance;
  using typename Base::Design;
  using typename Base::State;
  using Input = typename P::Input;

  /// Throws std::invalid_argument as GaussianEstimate does.
  Ukf(const P& process, const Design& design) : Base(design), process_(process) {
    A_.assign(process_.linear());
  }

  /// Predicts sample k from sample k − 1 and the held input. Allocates nothing.
  void predict(const Input& u);

  /// Changes the process between samples: calls `change(process)` and reads linear() again, and Q()
  /// if the process has it.
  template <typename Change>
  void change_process(const Change& change) {
    change(process_);
    A_.assign(process_.linear());
    if constexpr (requires { process_.Q(); }) design_.Q = process_.Q();
  }

  std::int64_t repairs() const { return repairs_; }

 private:
  using Base::design_;
  using Base::P_;
  using Base::x_;

  void repair();

  P process_;
  SparseSquare<N> A_;  // the process' linear part
  Eigen::LLT<Covariance> factor_;
  Covariance transposed_L_;
  Covariance transposed_T_;
  Eigen::Matrix<double, P::kRows, P::kArguments> half_sums_;  // S, the columns that differ
  Eigen::Matrix<double, P::kRows, P::kRows> nonlinear_part_;
  std::int64_t repairs_ = 0;
};

// Maps the symmetric set x ± √n L e_j through the process. T has half of the difference of each
// pair of results, and S half of its sum minus the mean. The covariance is (T Tᵀ + S Sᵀ)/n. S is 0
// outside the process' nonlinear rows. L is lower triangular, so pair j differs from x in states
// j … n − 1 alone. L and T are stored transposed, for products with the sparse linear part.
template <Process P, int p>
void Ukf<P, p>::predict(const Input& u) {
  factor_.compute(P_);
  if (factor_.info() != Eigen::Success) repair();
  transposed_L_ = factor_.matrixL().transpose();
  const double root_n = std::sqrt(static_cast<double>(N));
  A_.transposed_times(transposed_L_, transposed_T_);
  transposed_T_ *= root_n;
  typename P::Nonlinear at_mean, plus, minus;
  process_.nonlinear(x_, u, at_mean);
  typename P::Nonlinear mean_of_g = static_cast<double>(N - P::kArguments) / N * at_mean;
  State moved = x_;
  for (int j = 0; j < P::kArguments; ++j) {
    const Eigen::Matrix<double, P::kArguments, 1> offset =
        root_n * transposed_L_.row(j).template head<P::kArguments>().transpose();
    moved.template head<P::kArguments>() = x_.template head<P::kArguments>() + offset;
    process_.nonlinear(moved, u, plus);
    moved.template head<P::kArguments>() = x_.template head<P::kArguments>() - offset;
    process_.nonlinear(moved, u, minus);
    half_sums_.col(j) = 0.5 * (plus + minus);
    transposed_T_.template block<1, P::kRows>(j, P::kFirstRow) += 0.5 * (plus - minus).transpose();
    mean_of_g += half_sums_.col(j) / N;
  }
  half_sums_.colwise() -= mean_of_g;
  // All pairs beyond kArguments have the same g as x, hence the same column of S.
  const typename P::Nonlinear rest =
      std::sqrt(static_cast<double>(N - P::kArguments)) * (at_mean - mean_of_g);
  A_.times(x_, moved);
  x_ = moved;
  x_.template segment<P::kRows>(P::kFirstRow) += mean_of_g;
  constexpr double kWeight = 1.0 / N;
  P_.template triangularView<Eigen::Lower>() = transposed_T_.transpose() * transposed_T_;
  nonlinear_part_.noalias() = half_sums_ * half_sums_.transpose();
  nonlinear_part_.noalias() += rest * rest.transpose();
  P_.template block<P::kRows, P::kRows>(P::kFirstRow, P::kFirstRow) += nonlinear_part_;
  P_.template triangularView<Eigen::Lower>() = kWeight * P_ + design_.Q;
  this->mirror();
}

template <Process P, int p>
void Ukf<P, p>::repair() {
  constexpr double kFloor = 1e-12;
  static_assert(N <= kMostStates);
  ++repairs_;
  raise_eigenvalues(P_, kFloor);
  this->mirror();
  factor_.compute(P_);
}

}  // namespace breakwater
