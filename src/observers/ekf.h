// The extended Kalman filter.
#pragma once

#include <algorithm>
#include <cmath>

#include "observers/nonlinear_kalman.h"

namespace breakwater {

/// x(k|k−1) = f(x, u), P(k|k−1) = F P Fᵀ + Q + W_s G Gᵀ with F = ∂f/∂x and G = ∂f/∂u at the last
/// estimate, by central differences; then the shared correction.
///
/// With W_s > 0 the process noise enters as the input does, which is how the thesis treats it in
/// its extended filters (3.4.3.2).
template <Process P, int p>
class Ekf final : public GaussianEstimate<P::kStates, p> {
 public:
  static constexpr int N = P::kStates;
  using Base = GaussianEstimate<N, p>;
  using typename Base::Covariance;
  using typename Base::Output;
  using typename Base::State;
  using Input = typename P::Input;
  using Design = NonlinearKalmanDesign<N, p>;

  /// Throws std::invalid_argument as check(design), or if W_s is negative.
  Ekf(const P& process, const Design& design, double input_noise)
      : process_(process), design_(design), input_noise_(input_noise) {
    check(design);
    if (!(input_noise >= 0.0)) throw std::invalid_argument("EKF: W_s must be 0 or more");
    reset(State::Zero());
  }

  void reset(const State& x) {
    x_ = x;
    P_ = design_.P0;
  }

  /// From sample k − 1 to k under the input that was held. Allocates nothing.
  void predict(const Input& u) {
    F_ = process_.linear();
    typename P::Nonlinear g, g_plus, g_minus;
    process_.nonlinear(x_, u, g);
    State x = x_;
    for (int j = 0; j < P::kArguments; ++j) {
      const double step = difference(x_(j));
      x(j) = x_(j) + step;
      process_.nonlinear(x, u, g_plus);
      x(j) = x_(j) - step;
      process_.nonlinear(x, u, g_minus);
      x(j) = x_(j);
      F_.template block<P::kRows, 1>(P::kFirstRow, j) += (g_plus - g_minus) / (2.0 * step);
    }
    work_.noalias() = F_ * P_;
    P_.template triangularView<Eigen::Lower>() = work_ * F_.transpose();
    P_.template triangularView<Eigen::Lower>() += design_.Q;
    if (input_noise_ > 0.0) add_input_noise(u);
    this->mirror();
    const State linear = process_.linear() * x_;
    x_ = linear;
    x_.template segment<P::kRows>(P::kFirstRow) += g;
  }

  void correct(const Output& y) { Base::correct(y, design_.R); }

 private:
  using Base::P_;
  using Base::x_;

  // The step at which rounding and curvature cost alike.
  static double difference(double at) { return 6e-6 * std::max(1.0, std::abs(at)); }

  void add_input_noise(const Input& u) {
    Eigen::Matrix<double, P::kRows, P::kInputs> G;
    typename P::Nonlinear g_plus, g_minus;
    Input varied = u;
    for (int j = 0; j < P::kInputs; ++j) {
      const double step = difference(u(j));
      varied(j) = u(j) + step;
      process_.nonlinear(x_, varied, g_plus);
      varied(j) = u(j) - step;
      process_.nonlinear(x_, varied, g_minus);
      varied(j) = u(j);
      G.col(j) = (g_plus - g_minus) / (2.0 * step);
    }
    P_.template block<P::kRows, P::kRows>(P::kFirstRow, P::kFirstRow) +=
        input_noise_ * (G * G.transpose());
  }

  P process_;
  Design design_;
  double input_noise_;
  Covariance F_;
  Covariance work_;
};

}  // namespace breakwater
