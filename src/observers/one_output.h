// Covariance of a Kalman filter with one output. The loops are short and keep P symmetric.
#pragma once

#include <Eigen/Core>

namespace breakwater::one_output {

template <int N>
using Covariance = Eigen::Matrix<double, N, N>;
template <int N>
using State = Eigen::Matrix<double, N, 1>;

/// Σ a_i b_i, summed in pairs for speed.
template <int N, typename A, typename B>
double product(const A& a, const B& b) {
  if constexpr (N == 1) {
    return a(0) * b(0);
  } else {
    double terms[N];
    for (int i = 0; i < N; ++i) terms[i] = a(i) * b(i);
    for (int width = 1; width < N; width *= 2) {
      for (int i = 0; i + width < N; i += 2 * width) terms[i] += terms[i + width];
    }
    return terms[0];
  }
}

/// P ← A P Aᵀ + Q, exactly symmetric.
template <int N>
void predict_covariance(const Covariance<N>& A, const Covariance<N>& Q, Covariance<N>& P) {
  double AP[N][N];
  for (int i = 0; i < N; ++i) {
    for (int j = 0; j < N; ++j) {
      AP[i][j] = product<N>([&](int k) { return A(i, k); }, [&](int k) { return P(k, j); });
    }
  }
  for (int i = 0; i < N; ++i) {
    for (int j = 0; j <= i; ++j) {
      P(i, j) = P(j, i) =
          Q(i, j) + product<N>([&](int k) { return AP[i][k]; }, [&](int k) { return A(j, k); });
    }
  }
}

/// P c. If `is_first`, c = (1, 0, …) and the result is the first column of P.
template <int N>
State<N> times(const Covariance<N>& P, const State<N>& c, bool is_first) {
  if (is_first) return P.col(0);
  State<N> result;
  for (int i = 0; i < N; ++i) {
    result(i) = product<N>([&](int k) { return P(i, k); }, c);
  }
  return result;
}

/// Replaces P(k|k−1) by P(k|k), multiplied by inflation(i, j), for the gain K, h = P c and the
/// noise variance R. Joseph's form is
///     (I − K cᵀ) P (I − K cᵀ)ᵀ + K R Kᵀ = M + w Kᵀ + K wᵀ   with   M = P − K hᵀ,
///     w = (K R − M c)/2.
template <int N, typename Inflation>
void correct(Covariance<N>& P, const State<N>& K, const State<N>& h, const State<N>& c,
             bool is_first, double R, const Inflation& inflation) {
  Covariance<N> M;
  for (int i = 0; i < N; ++i) {
    for (int j = 0; j <= i; ++j) M(i, j) = M(j, i) = P(i, j) - K(i) * h(j);
  }
  const State<N> Mc = times<N>(M, c, is_first);
  State<N> w;
  for (int i = 0; i < N; ++i) w(i) = 0.5 * (K(i) * R - Mc(i));
  for (int i = 0; i < N; ++i) {
    for (int j = 0; j <= i; ++j) {
      P(i, j) = P(j, i) = (M(i, j) + (w(i) * K(j) + w(j) * K(i))) * inflation(i, j);
    }
  }
}

}  // namespace breakwater::one_output
