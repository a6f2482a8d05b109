// Random quadratic programs with the sizes of the cart's controllers.
#pragma once

#include <Eigen/QR>

#include <breakwater/linear/qp.h>
#include "support.h"

namespace breakwater::testing {

struct QpSize {
  Eigen::Index variables;
  Eigen::Index rows;
};

/// 5/60, 3/52, 3/212 and 114/456 variables and one-sided constraints.
inline constexpr QpSize kQpSizes[] = {{5, 30}, {3, 26}, {3, 106}, {114, 228}};

/// Constraints are random, sums of consecutive variables as in Δu form, or multiples of others.
inline QpModel random_qp_model(Random& random, const QpSize& size) {
  const auto [n, m] = size;
  QpModel model;
  const Eigen::MatrixXd root = random.matrix(n, n);
  model.H = root.transpose() * root;
  model.H.diagonal().array() += std::pow(10.0, random.uniform(-3.0, 1.0));
  model.Omega = random.matrix(m, n);
  for (Eigen::Index i = 1; i < m; ++i) {
    const double kind = random.uniform(0.0, 1.0);
    if (kind < 0.3) {
      const auto length = static_cast<Eigen::Index>(random.uniform(1.0, static_cast<double>(n)));
      model.Omega.row(i).setZero();
      model.Omega.row(i).head(length).setOnes();
    } else if (kind < 0.35) {
      model.Omega.row(i) = random.uniform(-2.0, 2.0) * model.Omega.row(i - 1);
    }
  }
  return model;
}

/// Bounds that some z satisfies. Some constraints have no bounds, some have equal ones.
inline QpInput random_feasible_input(Random& random, const QpModel& model) {
  const Eigen::Index n = model.H.rows();
  const Eigen::Index m = model.Omega.rows();
  QpInput input(n, m);
  input.g = random.vector(n, std::pow(10.0, random.uniform(-1.0, 2.0)));
  const Eigen::VectorXd values = model.Omega * random.vector(n);
  for (Eigen::Index i = 0; i < m; ++i) {
    const double kind = random.uniform(0.0, 1.0);
    const double width = kind < 0.02 ? 0.0 : random.uniform(0.0, 1.0);
    if (kind < 0.9) input.lower(i) = values(i) - width;
    if (kind < 0.8 || kind >= 0.95) input.upper(i) = values(i) + width;
  }
  return input;
}

/// Makes a feasible input infeasible: the last constraint becomes a positive combination of some
/// others, with a bound that these exclude.
inline void make_infeasible(Random& random, QpModel& model, QpInput& input, double by) {
  const Eigen::Index last = model.Omega.rows() - 1;
  model.Omega.row(last).setZero();
  double most = 0.0;
  for (int k = 0; k < 3; ++k) {
    const auto row = static_cast<Eigen::Index>(random.uniform(0.0, static_cast<double>(last)));
    if (std::isinf(input.upper(row))) input.upper(row) = 200.0;  // never active
    const double weight = random.uniform(0.1, 1.0);
    model.Omega.row(last) += weight * model.Omega.row(row);
    most += weight * input.upper(row);
  }
  input.lower(last) = most + by;
  input.upper(last) = most + by + 1.0;
}

/// The error of a solution from the definition, without kkt_residual().
inline double optimality_error(const QpModel& model, const QpInput& input, const QpSolution& s) {
  // The same program with a diagonal of ones in H and with rows of size 1.
  const Eigen::VectorXd root = model.H.diagonal().cwiseSqrt();
  const Eigen::MatrixXd rows = model.Omega * root.cwiseInverse().asDiagonal();
  const Eigen::VectorXd size =
      rows.rowwise().lpNorm<Eigen::Infinity>().cwiseMax(input.softness.cwiseSqrt());
  const Eigen::VectorXd mu = s.mu.cwiseProduct(size);
  const double slope = std::max(input.g.cwiseQuotient(root).cwiseAbs().maxCoeff(),
                                mu.size() == 0 ? 0.0 : mu.cwiseAbs().maxCoeff());
  double bound = 0.0;
  for (Eigen::Index i = 0; i < size.size(); ++i) {
    for (const double one : {input.lower(i), input.upper(i)}) {
      if (std::isfinite(one) && size(i) > 0.0) bound = std::max(bound, std::abs(one) / size(i));
    }
  }
  const double reach = std::max(std::min(s.z.cwiseProduct(root).cwiseAbs().maxCoeff(), bound),
                                kQpGradientShare * slope);
  const auto share = [](double a, double b) { return a == 0.0 ? 0.0 : a / b; };
  const Eigen::VectorXd gradient = model.H * s.z + input.g + model.Omega.transpose() * s.mu;
  double error = share(gradient.cwiseQuotient(root).cwiseAbs().maxCoeff(), slope);
  const Eigen::VectorXd values = model.Omega * s.z - input.softness.cwiseProduct(s.mu);
  for (Eigen::Index i = 0; i < values.size(); ++i) {
    const double above = values(i) - input.upper(i);
    const double below = input.lower(i) - values(i);
    error = std::max(error, share(std::max({0.0, above, below}), size(i) * reach));
    if (mu(i) == 0.0) continue;
    const double slack = share(std::abs(mu(i) > 0.0 ? above : below), size(i) * reach);
    error = std::max(error, std::abs(mu(i)) * slack / slope);
  }
  return error;
}

/// A quadratic program of any size and condition.
struct HardQp {
  QpModel model;
  QpInput input;
};

/// 2 to 24 variables, 1 to 60 constraints, H of any scale with a condition of 1 to 1e8. Constraints
/// are random, sums of consecutive variables, single variables, zero, or copies, multiples, sums
/// and near copies (1e-9 to 1e-3) of others. One z satisfies all. Many are active there, some as
/// equations.
inline HardQp hard_feasible_qp(Random& random) {
  const auto whole = [&random](Eigen::Index least, Eigen::Index most) {
    return static_cast<Eigen::Index>(
        std::floor(random.uniform(static_cast<double>(least), static_cast<double>(most) + 1.0)));
  };
  const Eigen::Index n = whole(2, 24);
  const Eigen::Index m = whole(1, 60);
  // Few digits make sums of constraints exact.
  const auto rounded = [](const Eigen::MatrixXd& rows) -> Eigen::MatrixXd {
    constexpr double kGrid = 1ULL << 36;
    return (kGrid * rows).array().round() / kGrid;
  };
  const double decades = random.uniform(0.0, 8.0);
  const double top = random.uniform(0.0, decades);
  Eigen::VectorXd roots(n);  // eigenvalues of H
  for (Eigen::Index j = 0; j < n; ++j) {
    const double below = j == 0 ? 0.0 : j == 1 ? decades : random.uniform(0.0, decades);
    roots(j) = std::pow(10.0, 0.5 * (top - below));
  }
  const Eigen::MatrixXd axes =
      Eigen::HouseholderQR<Eigen::MatrixXd>(random.matrix(n, n)).householderQ();
  const Eigen::MatrixXd root = axes * roots.asDiagonal();
  HardQp qp{{root * root.transpose(), rounded(random.matrix(m, n))}, QpInput(n, m)};
  qp.model.H = (0.5 * (qp.model.H + qp.model.H.transpose())).eval();
  for (Eigen::Index i = 0; i < m; ++i) {
    const double kind = random.uniform(0.0, 1.0);
    auto row = qp.model.Omega.row(i);
    if (kind < 0.15) {
      row.setZero();
      row.head(whole(1, n)).setOnes();
    } else if (kind < 0.2) {
      row = Eigen::RowVectorXd::Unit(n, whole(0, n - 1));
    } else if (kind < 0.35 && i > 0) {
      const Eigen::RowVectorXd other = qp.model.Omega.row(whole(0, i - 1));
      const double off = kind < 0.31 ? 0.0 : std::pow(10.0, random.uniform(-9.0, -3.0));
      row = (kind < 0.25 ? 1.0 : kind < 0.28 ? -0.75 : 1.0) * other + rounded(off * row);
      if (kind >= 0.28 && kind < 0.31) row += 0.5 * qp.model.Omega.row(whole(0, i - 1));
    } else if (kind > 0.995) {
      row.setZero();
    }
  }
  qp.input.g = random.vector(n, std::pow(10.0, random.uniform(-1.0, 2.0)));
  const Eigen::VectorXd values = qp.model.Omega * random.vector(n);
  const double equations = random.uniform(0.0, 0.2);  // share of equations
  for (Eigen::Index i = 0; i < m; ++i) {
    const double kind = random.uniform(0.0, 1.0);
    const double below = random.uniform(0.0, 1.0);
    const double above = random.uniform(0.0, 1.0);
    qp.input.lower(i) = kind < 0.3 ? values(i) : values(i) - below;
    qp.input.upper(i) = kind < equations ? values(i) : values(i) + above;
    if (kind > 0.95) qp.input.lower(i) = -kNoBound;
    if (kind > 0.9 && kind < 0.95) qp.input.upper(i) = kNoBound;
  }
  return qp;
}

/// An infeasible program: the last constraint is an exact sum of others, and its bound exceeds
/// theirs by 1e-6 to 10.
inline HardQp hard_infeasible_qp(Random& random) {
  HardQp qp = hard_feasible_qp(random);
  while (qp.model.Omega.rows() < 2) qp = hard_feasible_qp(random);
  auto& [model, input] = qp;
  const Eigen::Index last = model.Omega.rows() - 1;
  model.Omega.row(last).setZero();
  double most = 0.0;
  for (double terms = random.uniform(0.0, 8.0); terms > 0.0; terms -= 1.0) {
    const auto row = static_cast<Eigen::Index>(random.uniform(0.0, static_cast<double>(last)));
    const bool is_upper = input.lower(row) == -kNoBound ||
                          (input.upper(row) < kNoBound && random.uniform(0.0, 1.0) < 0.5);
    const double weight = (is_upper ? 0.125 : -0.125) * std::ceil(random.uniform(0.0, 8.0));
    model.Omega.row(last) += weight * model.Omega.row(row);
    most += weight * (is_upper ? input.upper(row) : input.lower(row));
  }
  input.lower(last) = most + std::pow(10.0, random.uniform(-6.0, 1.0));
  input.upper(last) = random.uniform(0.0, 1.0) < 0.5 ? kNoBound : input.lower(last) + 1.0;
  return qp;
}

}  // namespace breakwater::testing
