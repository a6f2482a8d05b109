#include <breakwater/linear/ldl_factor.h>

#include <type_traits>

namespace breakwater {
namespace {

// Loops with fixed lengths, which the compiler unrolls.
template <int k>
void unit_forward(std::integral_constant<int, k>, const double* L, Eigen::Index stride, double* x) {
  for (int j = 0; j + 1 < k; ++j) {
    for (int i = j + 1; i < k; ++i) x[i] -= x[j] * L[j * stride + i];
  }
}

template <int k>
void unit_backward(std::integral_constant<int, k>, const double* L, Eigen::Index stride,
                   double* x) {
  for (int i = k - 1; i > 0; --i) {
    for (int j = 0; j < i; ++j) x[j] -= x[i] * L[j * stride + i];
  }
}

// Four columns at once: this reads and writes x a quarter as often.
void unit_forward(Eigen::Index k, const double* L, Eigen::Index stride, double* x) {
  Eigen::Index j = 0;
  for (; j + 4 <= k; j += 4) {
    const double* first = L + j * stride;
    const double* second = first + stride;
    const double* third = second + stride;
    const double* fourth = third + stride;
    const double x0 = x[j];
    const double x1 = x[j + 1] - x0 * first[j + 1];
    const double x2 = x[j + 2] - x0 * first[j + 2] - x1 * second[j + 2];
    const double x3 = x[j + 3] - x0 * first[j + 3] - x1 * second[j + 3] - x2 * third[j + 3];
    x[j + 1] = x1;
    x[j + 2] = x2;
    x[j + 3] = x3;
    for (Eigen::Index i = j + 4; i < k; ++i) {
      x[i] -= (x0 * first[i] + x1 * second[i]) + (x2 * third[i] + x3 * fourth[i]);
    }
  }
  for (; j < k; ++j) {
    for (Eigen::Index i = j + 1; i < k; ++i) x[i] -= x[j] * L[j * stride + i];
  }
}

void unit_backward(Eigen::Index k, const double* L, Eigen::Index stride, double* x) {
  using Column = Eigen::Map<const Eigen::VectorXd>;
  for (Eigen::Index j = k - 2; j >= 0; --j) {
    const Eigen::Index below = k - j - 1;
    x[j] -= Column(L + j * stride + j + 1, below).dot(Column(x + j + 1, below));
  }
}

// Calls solve(k) with a small k as a constant. A factor of size 1 is only its diagonal.
template <typename Solve>
void of_size(Eigen::Index size, const Solve& solve) {
  switch (size) {
    case 0:
    case 1:
      return;
    case 2:
      return solve(std::integral_constant<int, 2>{});
    case 3:
      return solve(std::integral_constant<int, 3>{});
    case 4:
      return solve(std::integral_constant<int, 4>{});
    case 5:
      return solve(std::integral_constant<int, 5>{});
    case 6:
      return solve(std::integral_constant<int, 6>{});
    default:
      return solve(size);
  }
}

}  // namespace

double LdlFactor::forward_solve(double* x) const {
  const double* L = L_.data();
  const Eigen::Index stride = L_.outerStride();
  of_size(size_, [&](auto k) { unit_forward(k, L, stride, x); });
  double square = 0.0;
  for (Eigen::Index j = 0; j < size_; ++j) {
    const double half = x[j] * D_inverse_(j);
    square += half * x[j];
    x[j] = half;
  }
  return square;
}

void LdlFactor::backward_solve(double* x) const {
  const double* L = L_.data();
  const Eigen::Index stride = L_.outerStride();
  of_size(size_, [&](auto k) { unit_backward(k, L, stride, x); });
}

void LdlFactor::remove(Eigen::Index position) {
  const Eigen::Index last = --size_;
  const Eigen::Index stride = L_.outerStride();
  const Eigen::Index left = last - position;  // number of rows below
  double* w = falling_.data();
  const double* gone = L_.data() + position * stride + position + 1;
  for (Eigen::Index i = 0; i < left; ++i) w[i] = gone[i];
  double alpha = D_(position);
  for (Eigen::Index j = 0; j < position; ++j) {
    double* column = L_.data() + j * stride;
    for (Eigen::Index i = position; i < last; ++i) column[i] = column[i + 1];
  }
  for (Eigen::Index j = position; j < last; ++j, ++w) {
    const double* old = L_.data() + (j + 1) * stride + 1;  // the row moves up by one
    double* column = L_.data() + j * stride;
    const double d = D_(j + 1);
    const double p = *w;
    const double d_new = d + alpha * p * p;
    const double inverse = 1.0 / d_new;
    const double beta = alpha * p * inverse;
    alpha *= d * inverse;
    D_(j) = d_new;
    D_inverse_(j) = inverse;
    for (Eigen::Index i = j + 1; i < last; ++i) {
      const double fallen = w[i - j] - p * old[i];
      w[i - j] = fallen;
      column[i] = old[i] + beta * fallen;
    }
  }
}

}  // namespace breakwater
