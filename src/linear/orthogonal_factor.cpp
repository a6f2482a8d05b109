#include <breakwater/linear/orthogonal_factor.h>

#include <Eigen/Jacobi>
#include <cmath>

namespace breakwater {
namespace {

constexpr double kDependent = 1e-11;  // smaller relative rest: the row depends on the working set
constexpr int kPasses = 3;            // the first one and two corrections

}  // namespace

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
