// Mean and covariance of a mixture of normal distributions.
#pragma once

#include <cstddef>

namespace breakwater {

/// The first `count` of `parts` have a mean x and a covariance P. Their weights(i) add up to 1.
/// Writes
///     x = Σ w_i x_i,   P = Σ w_i (P_i + (x_i − x)(x_i − x)ᵀ).
template <typename Parts, typename Weights, typename State, typename Covariance>
void mix(const Parts& parts, std::size_t count, const Weights& weights, State& x, Covariance& P) {
  x.setZero();
  for (std::size_t i = 0; i < count; ++i) x += weights(static_cast<long>(i)) * parts[i].x;
  P.setZero();
  for (std::size_t i = 0; i < count; ++i) {
    const auto offset = (parts[i].x - x).eval();
    P += weights(static_cast<long>(i)) * (parts[i].P + offset * offset.transpose());
  }
}

}  // namespace breakwater
