// The extended Kalman filter.
#pragma once

#include <algorithm>
#include <cmath>

#include <breakwater/observers/nonlinear_kalman.h>

namespace breakwater {

/// Predicts x(k|k−1) = f(x, u), P(k|k−1) = F P Fᵀ + Q + W_s G Gᵀ. The derivatives F = ∂f/∂x and G =
/// ∂f/∂u are central differences at the last estimate. The correction is GaussianEstimate's.
///
/// With W_s > 0 the process noise enters like the input, as in the thesis (3.4.3.2).
template <Process P, int p>
class Ekf final : public GaussianEstimate<P::kStates, p> {
 public:
  static constexpr int N = P::kStates;
  using Base = GaussianEstimate<N, p>;
  using typename Base::Covariance;
  using typename Base::Design;
  using typename Base::State;
  using Input = typename P::Input;

  /// Throws std::invalid_argument as GaussianEstimate does, or if W_s is negative.
  Ekf(const P& process, const Design& design, double input_noise)
      : Base(design), process_(process), input_noise_(input_noise) {
    refuse_unless(input_noise >= 0.0, "EKF: W_s must be 0 or more");
  }

  /// Predicts sample k from sample k − 1 and the held input. Allocates nothing.
  void predict(const Input& u);

 private:
  using Base::design_;
  using Base::P_;
  using Base::x_;

  // The derivative of the process with respect to `entry` of x or u, which changes meanwhile. The
  // step balances the errors of rounding and curvature.
  typename P::Nonlinear derivative(const State& x, const Input& u, double& entry) const;

  void add_input_noise(const Input& u);

  P process_;
  double input_noise_;
  Covariance F_;
  SparseSquare<N> sparse_F_;
  Covariance work_;
  Covariance FP_;
};

template <Process P, int p>
void Ekf<P, p>::predict(const Input& u) {
  F_ = process_.linear();
  typename P::Nonlinear g;
  process_.nonlinear(x_, u, g);
  State x = x_;
  for (int j = 0; j < P::kArguments; ++j) {
    F_.template block<P::kRows, 1>(P::kFirstRow, j) += derivative(x, u, x(j));
  }
  sparse_F_.assign(F_);
  sparse_F_.transposed_times(P_, work_);  // P Fᵀ
  FP_ = work_.transpose();
  sparse_F_.transposed_times(FP_, P_);
  P_ += design_.Q;
  if (input_noise_ > 0.0) add_input_noise(u);
  this->mirror();
  const State linear = process_.linear() * x_;
  x_ = linear;
  x_.template segment<P::kRows>(P::kFirstRow) += g;
}

template <Process P, int p>
typename P::Nonlinear Ekf<P, p>::derivative(const State& x, const Input& u, double& entry) const {
  const double at = entry;
  const double step = 6e-6 * std::max(1.0, std::abs(at));
  typename P::Nonlinear g_plus, g_minus;
  entry = at + step;
  process_.nonlinear(x, u, g_plus);
  entry = at - step;
  process_.nonlinear(x, u, g_minus);
  entry = at;
  return (g_plus - g_minus) / (2.0 * step);
}

template <Process P, int p>
void Ekf<P, p>::add_input_noise(const Input& u) {
  Eigen::Matrix<double, P::kRows, P::kInputs> G;
  Input varied = u;
  for (int j = 0; j < P::kInputs; ++j) G.col(j) = derivative(x_, varied, varied(j));
  P_.template block<P::kRows, P::kRows>(P::kFirstRow, P::kFirstRow) +=
      input_noise_ * (G * G.transpose());
}

}  // namespace breakwater
