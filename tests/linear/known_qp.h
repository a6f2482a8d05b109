// Quadratic programs with known solutions, in any units.
#pragma once

#include "linear/random_qp.h"

namespace breakwater::testing {

/// A program and its only solution z, or none if it is infeasible.
struct KnownQp {
  QpModel model;
  QpInput input;
  Eigen::VectorXd z;
  bool is_feasible = true;
};

inline constexpr std::array kKnownQpFamilies = {
    "box",           "dense rows",     "a degenerate vertex", "copies of rows", "multiples of rows",
    "near copies",   "equations",      "narrow bounds",       "soft rows",      "sums of variables",
    "condition 1e6", "nothing active", "far bounds",          "zero rows",      "a solution of 0",
    "a weak cost",   "no common point"};

/// A program of a family. Its solution comes first: g follows from the multipliers of the rows that
/// are active there.
inline KnownQp known_qp(Random& random, std::size_t family) {
  const std::string_view name = kKnownQpFamilies[family];
  const auto is = [&](const char* other) { return name == other; };
  const auto whole = [&random](Eigen::Index least, Eigen::Index most) {
    return static_cast<Eigen::Index>(
        std::floor(random.uniform(static_cast<double>(least), static_cast<double>(most) + 1.0)));
  };
  const Eigen::Index n = whole(1, 9);
  const Eigen::Index m = is("box") ? n : whole(2, 24);
  const Eigen::MatrixXd axes =
      Eigen::HouseholderQR<Eigen::MatrixXd>(random.matrix(n, n)).householderQ();
  const double decades = is("condition 1e6") ? 6.0 : 2.0;
  Eigen::VectorXd roots(n);
  for (double& root : roots) root = std::pow(10.0, -0.5 * random.uniform(0.0, decades));
  KnownQp qp{{axes * roots.cwiseAbs2().asDiagonal() * axes.transpose(), random.matrix(m, n)},
             QpInput(n, m),
             random.vector(n)};
  auto& [model, input, z, is_feasible] = qp;
  model.H = (0.5 * (model.H + model.H.transpose())).eval();
  if (is("box")) model.Omega.setIdentity();
  if (is("a solution of 0")) z.setZero();
  if (is("far bounds")) z *= 1e4;
  for (Eigen::Index i = 1; i < m; ++i) {
    const Eigen::RowVectorXd other = model.Omega.row(whole(0, i - 1));
    const bool now = random.uniform(0.0, 1.0) < 0.5;
    if (is("copies of rows") && now) model.Omega.row(i) = other;
    if (is("multiples of rows") && now) model.Omega.row(i) = random.uniform(-2.0, 2.0) * other;
    if (is("near copies") && now) model.Omega.row(i) = other + 1e-2 * random.matrix(1, n);
    if (is("zero rows") && now) model.Omega.row(i).setZero();
    if (is("sums of variables")) {
      model.Omega.row(i).setZero();
      model.Omega.row(i).head(whole(1, n)).setOnes();
    }
  }
  if (is("soft rows")) {
    for (double& soft : input.softness) soft = std::pow(10.0, random.uniform(-3.0, 1.0));
  }
  // Up to n rows are active; at a degenerate vertex, more of them, and some without a multiplier.
  const Eigen::Index active = is("nothing active")        ? 0
                              : is("a degenerate vertex") ? m
                                                          : whole(0, std::min(n, m));
  Eigen::VectorXd mu = Eigen::VectorXd::Zero(m);
  for (Eigen::Index i = 0; i < active; ++i) {
    if (i < n || random.uniform(0.0, 1.0) < 0.3) {
      mu(i) = random.uniform(0.1, 1.0) * (random.uniform(-1.0, 1.0) < 0.0 ? -1.0 : 1.0);
    }
  }
  if (is("zero rows")) {
    for (Eigen::Index i = 0; i < m; ++i) {
      if (model.Omega.row(i).isZero(0.0)) mu(i) = 0.0;
    }
  }
  const Eigen::VectorXd values = model.Omega * z - input.softness.cwiseProduct(mu);
  for (Eigen::Index i = 0; i < m; ++i) {
    const double width = is("narrow bounds") ? 1e-9 : random.uniform(0.1, 2.0);
    const bool is_active = i < active;
    const bool is_upper = mu(i) > 0.0 || (mu(i) == 0.0 && random.uniform(0.0, 1.0) < 0.5);
    input.upper(i) = values(i) + (is_active && is_upper ? 0.0 : width);
    input.lower(i) = values(i) - (is_active && !is_upper ? 0.0 : width);
    if (is("equations") && is_active) input.lower(i) = input.upper(i) = values(i);
    if (!is_active && random.uniform(0.0, 1.0) < 0.2) input.upper(i) = kNoBound;
  }
  const double weight = is("a weak cost") ? 1e-5 : 1.0;
  model.H *= weight;
  input.softness /= weight;
  input.g = -model.H * z - weight * (model.Omega.transpose() * mu);
  if (is("no common point")) {
    // The first two rows have one direction, and contradict each other.
    const double by = std::pow(10.0, random.uniform(-4.0, 1.0));
    model.Omega.row(1) = model.Omega.row(0);
    input.upper(0) = values(0);
    input.lower(0) = -kNoBound;
    input.lower(1) = values(0) + by;
    input.upper(1) = kNoBound;
    is_feasible = false;
  }
  return qp;
}

/// The same program in other units: z_j = 2ᵃ z_j', rows times 2ᵇ and a cost times 2ᶜ, with |a|,
/// |b|, |c| of at most 27.
inline KnownQp in_other_units(Random& random, KnownQp qp) {
  const auto unit = [&random] { return std::exp2(std::round(random.uniform(-27.0, 27.0))); };
  auto& [model, input, z, is_feasible] = qp;
  const bool has_rows = random.uniform(0.0, 1.0) < 0.7;
  const bool has_variables = random.uniform(0.0, 1.0) < 0.7;
  const double cost = random.uniform(0.0, 1.0) < 0.7 ? unit() : 1.0;
  const double common = unit();  // some have one unit for all
  const bool is_common = random.uniform(0.0, 1.0) < 0.3;
  for (Eigen::Index j = 0; j < z.size() && has_variables; ++j) {
    const double d = is_common ? common : unit();
    model.H.col(j) *= d;
    model.H.row(j) *= d;
    model.Omega.col(j) *= d;
    input.g(j) *= d;
    z(j) /= d;
  }
  for (Eigen::Index i = 0; i < input.lower.size() && has_rows; ++i) {
    const double r = is_common ? common : unit();
    model.Omega.row(i) *= r;
    input.lower(i) *= r;
    input.upper(i) *= r;
    input.softness(i) *= r * r;
  }
  model.H *= cost;
  input.g *= cost;
  input.softness /= cost;
  return qp;
}

/// The distance of z from the solution in the cost's own metric, relative to the solution or, near
/// 0, to the gradient.
inline double known_error(const KnownQp& qp, const Eigen::VectorXd& z) {
  const auto length = [&](const Eigen::VectorXd& x) {
    return std::sqrt(std::max(0.0, x.dot(qp.model.H * x)));
  };
  const Eigen::VectorXd root = qp.model.H.diagonal().cwiseSqrt();
  const double least = kQpGradientShare * qp.input.g.cwiseQuotient(root).lpNorm<Eigen::Infinity>();
  const double error = length(z - qp.z);
  return error == 0.0 ? 0.0 : error / std::max(length(qp.z), least);
}

}  // namespace breakwater::testing
