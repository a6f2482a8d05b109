#include <breakwater/linear/state_space.h>

#include <Eigen/QR>
#include <stdexcept>
#include <string>
#include <unsupported/Eigen/MatrixFunctions>

#include <breakwater/math/refuse_unless.h>

namespace breakwater {

void check(const StateSpace& plant) {
  const Eigen::Index n = plant.A.rows();
  refuse_unless(n != 0 && plant.A.cols() == n && plant.B.rows() == n && plant.C.cols() == n,
                "state space: A must be n×n, B n×m and C p×n");
  refuse_unless(plant.A.allFinite() && plant.B.allFinite() && plant.C.allFinite(),
                "state space: A, B and C must be finite");
}

StateSpace zero_order_hold(const StateSpace& continuous, double period_s) {
  check(continuous);
  refuse_unless(period_s > 0.0, "zero-order hold: the sampling period must be positive");
  const Eigen::Index n = continuous.states();
  const Eigen::Index m = continuous.inputs();
  Eigen::MatrixXd generator = Eigen::MatrixXd::Zero(n + m, n + m);
  generator.topLeftCorner(n, n) = continuous.A * period_s;
  generator.topRightCorner(n, m) = continuous.B * period_s;
  const Eigen::MatrixXd transition = generator.exp();
  refuse_unless(transition.allFinite(), "zero-order hold: the sampled plant has no finite numbers");
  return {transition.topLeftCorner(n, n), transition.topRightCorner(n, m), continuous.C};
}

StateSpace extend_by_input_disturbance(const StateSpace& continuous) {
  check(continuous);
  const Eigen::Index n = continuous.states();
  const Eigen::Index m = continuous.inputs();
  const Eigen::Index p = continuous.outputs();
  StateSpace extended{Eigen::MatrixXd::Zero(n + m, n + m), Eigen::MatrixXd::Zero(n + m, m),
                      Eigen::MatrixXd::Zero(p, n + m)};
  extended.A.topLeftCorner(n, n) = continuous.A;
  extended.A.topRightCorner(n, m) = -continuous.B;
  extended.B.topRows(n) = continuous.B;
  extended.C.leftCols(n) = continuous.C;
  return extended;
}

Eigen::Index observability_rank(const Eigen::MatrixXd& A, const Eigen::MatrixXd& C) {
  const Eigen::Index n = A.rows();
  const Eigen::Index p = C.rows();
  Eigen::MatrixXd U_o(p * n, n);
  Eigen::MatrixXd block = C;
  for (Eigen::Index i = 0; i < n; ++i) {
    U_o.middleRows(i * p, p) = block;
    block = block * A;
  }
  for (auto column : U_o.colwise()) {
    const double norm = column.norm();
    if (norm > 0.0) column /= norm;
  }
  Eigen::ColPivHouseholderQR<Eigen::MatrixXd> qr(U_o);
  qr.setThreshold(1e-12);
  return qr.rank();
}

void check_observable(const char* design, const Eigen::MatrixXd& A, const Eigen::MatrixXd& C) {
  const Eigen::Index rank = observability_rank(A, C);
  if (rank == A.rows()) return;
  throw std::invalid_argument(std::string(design) +
                              ": the extended plant is not observable (rank " +
                              std::to_string(rank) + " of " + std::to_string(A.rows()) + ")");
}

}  // namespace breakwater
