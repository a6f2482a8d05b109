// Products of small matrices, compiled for each size.
#pragma once

namespace breakwater {

/// a[first]·b[first] + … of `count` terms, `a_step` and `b_step` apart, added in pairs.
template <int count, int a_step, int b_step>
double sum_of_products(const double* a, const double* b) {
  if constexpr (count == 1) {
    return a[0] * b[0];
  } else {
    constexpr int half = count / 2;
    return sum_of_products<half, a_step, b_step>(a, b) +
           sum_of_products<count - half, a_step, b_step>(a + half * a_step, b + half * b_step);
  }
}

/// aᵀ b of n numbers: the sum over even places, then over odd ones, as two lanes give it.
template <int n>
double dot(const double* a, const double* b) {
  if constexpr (n == 1) {
    return a[0] * b[0];
  } else {
    const double pairs =
        sum_of_products<n / 2, 2, 2>(a, b) + sum_of_products<n / 2, 2, 2>(a + 1, b + 1);
    return n % 2 == 0 ? pairs : pairs + a[n - 1] * b[n - 1];
  }
}

/// y = M x for an n×n matrix by columns. y is neither M nor x. The last row of an odd n is added in
/// pairs: the goldens keep this order.
template <int n>
void multiply(const double* M, const double* x, double* y) {
  constexpr int even = n - n % 2;
  for (int i = 0; i < even; ++i) y[i] = M[i] * x[0];
  for (int j = 1; j < n; ++j) {
    for (int i = 0; i < even; ++i) y[i] += M[j * n + i] * x[j];
  }
  if constexpr (n % 2 == 1) y[n - 1] = sum_of_products<n, n, 1>(M + n - 1, x);
}

}  // namespace breakwater
