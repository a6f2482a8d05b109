#include <breakwater/linear/working_set.h>

#include <Eigen/Jacobi>
#include <cmath>
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

constexpr int kUnrolled = 6;  // the largest fixed length

// Calls solve(k) with a small k as a constant. A factor of size 1 is only its diagonal.
template <int k = 2, typename Solve>
void of_size(Eigen::Index size, const Solve& solve) {
  if constexpr (k > kUnrolled) {
    solve(size);
  } else if (size == k) {
    solve(std::integral_constant<int, k>{});
  } else if (size > k) {
    of_size<k + 1>(size, solve);
  }
}

constexpr double kDependent = 1e-11;  // smaller relative rest: the row depends on the working set
constexpr int kPasses = 3;            // the first one and two corrections

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

OrthogonalFactor::OrthogonalFactor(const QpFactors& factors) : factors_(factors) {
  const Eigen::Index n = factors.variables();
  const Eigen::Index m = factors.rows();
  rows_.reserve(static_cast<std::size_t>(m));
  Q_.resize(n + m, m);
  R_.resize(m, m);
  c_.setZero(n + m);
  softness_ = shares_ = correction_ = Eigen::VectorXd::Zero(m);
}

void OrthogonalFactor::clear(const Eigen::VectorXd& softness) {
  rows_.clear();
  softness_ = softness;
  const bool has_soft = (softness.array() != 0.0).any();
  depth_ = factors_.variables() + (has_soft ? factors_.rows() : 0);
}

double OrthogonalFactor::compare(Eigen::Index row, Eigen::VectorXd& direction) {
  const Eigen::Index n = factors_.variables();
  const Eigen::Index k = size();
  const auto& Omega = factors_.model.Omega;
  auto c = c_.head(depth_);
  auto rest = c_.head(n);
  shares_.head(k).setZero();
  direction.head(k).setZero();
  for (int pass = 0; pass < kPasses; ++pass) {
    rest = Omega.row(row).transpose();
    c.tail(depth_ - n).setZero();
    for (Eigen::Index j = 0; j < k; ++j) {
      const Eigen::Index other = rows_[static_cast<std::size_t>(j)];
      rest -= direction(j) * Omega.row(other).transpose();
      if (depth_ > n) c(n + other) = -direction(j) * std::sqrt(softness_(other));
    }
    if (depth_ > n) c(n + row) = std::sqrt(softness_(row));
    factors_.L.triangularView<Eigen::Lower>().solveInPlace(rest);
    auto correction = correction_.head(k);
    correction.noalias() = basis().transpose() * c;
    c.noalias() -= basis() * correction;
    shares_.head(k) += correction;
    triangle().triangularView<Eigen::Upper>().solveInPlace(correction);
    direction.head(k) += correction;
  }
  const double length = c.norm();
  const double own = std::sqrt(factors_.gram(row, row) + softness_(row));
  // n independent hard rows span the whole space.
  return length <= kDependent * own || (depth_ == n && k == n) ? 0.0 : length * length;
}

void OrthogonalFactor::add(Eigen::Index row) {
  const Eigen::Index k = size();
  const double length = c_.head(depth_).norm();
  Q_.col(k).head(depth_) = c_.head(depth_) / length;
  R_.col(k).head(k) = shares_.head(k);
  R_(k, k) = length;
  rows_.push_back(row);
}

void OrthogonalFactor::remove(Eigen::Index position) {
  const Eigen::Index k = size();
  rows_.erase(rows_.begin() + position);
  for (Eigen::Index j = position; j + 1 < k; ++j) R_.col(j).head(j + 2) = R_.col(j + 1).head(j + 2);
  for (Eigen::Index j = position; j + 1 < k; ++j) {
    Eigen::JacobiRotation<double> rotation;
    rotation.makeGivens(R_(j, j), R_(j + 1, j));
    R_.block(0, j, k, k - 1 - j).applyOnTheLeft(j, j + 1, rotation.adjoint());
    Q_.topRows(depth_).applyOnTheRight(j, j + 1, rotation);
  }
}

void OrthogonalFactor::correct(Eigen::VectorXd& gradient, Eigen::VectorXd& lacking) const {
  const auto Q = basis().topRows(factors_.variables());
  auto y = lacking.head(size());
  triangle().transpose().triangularView<Eigen::Lower>().solveInPlace(y);
  factors_.L.triangularView<Eigen::Lower>().solveInPlace(gradient);
  y.noalias() += Q.transpose() * gradient;
  gradient.noalias() -= Q * y;
  factors_.L.triangularView<Eigen::Lower>().transpose().solveInPlace(gradient);
  triangle().triangularView<Eigen::Upper>().solveInPlace(y);
}

}  // namespace breakwater
