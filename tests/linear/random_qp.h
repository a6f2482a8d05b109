// Random quadratic programs with the sizes of the cart's controllers.
#pragma once

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

}  // namespace breakwater::testing
