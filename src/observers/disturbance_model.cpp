#include <breakwater/observers/disturbance_model.h>

#include <breakwater/linear/state_space.h>
#include <breakwater/math/refuse_unless.h>

namespace breakwater {

ExtendedPlant extend_by_disturbance_model(const StateSpace& sampled_plant, int order,
                                          double period_s, const Eigen::MatrixXd& E) {
  check(sampled_plant);
  refuse_unless(order >= 0 && order <= 2, "disturbance model: the order must be 0, 1 or 2");
  refuse_unless(period_s > 0.0, "disturbance model: the sampling period must be positive");
  const Eigen::Index n = sampled_plant.states();
  const Eigen::Index m = sampled_plant.inputs();
  const Eigen::Index p = sampled_plant.outputs();
  refuse_unless(E.size() == 0 || (E.rows() == n && E.cols() == m),
                "disturbance model: E must have the shape of B");
  const Eigen::Index size = n + m * (order + 1);
  StateSpace extended{Eigen::MatrixXd::Identity(size, size), Eigen::MatrixXd::Zero(size, m),
                      Eigen::MatrixXd::Zero(p, size)};
  extended.A.topLeftCorner(n, n) = sampled_plant.A;
  extended.A.block(0, n, n, m) = E.size() > 0 ? -E : -sampled_plant.B;
  for (int derivative = 0; derivative < order; ++derivative) {
    extended.A.block(n + m * derivative, n + m * (derivative + 1), m, m)
        .diagonal()
        .setConstant(period_s);
  }
  extended.B.topRows(n) = sampled_plant.B;
  extended.C.leftCols(n) = sampled_plant.C;
  check_observable("disturbance model", extended.A, extended.C);
  return {extended, n, period_s};
}

ExtendedPlant sample_with_disturbance_model(const StateSpace& continuous_plant, int order,
                                            double period_s, const Eigen::MatrixXd& E) {
  const StateSpace sampled = zero_order_hold(continuous_plant, period_s);
  if (E.size() == 0) {
    ExtendedPlant plant = extend_by_disturbance_model(sampled, order, period_s);
    plant.continuous = continuous_plant;
    return plant;
  }
  const StateSpace disturbed{continuous_plant.A, E, continuous_plant.C};
  return extend_by_disturbance_model(sampled, order, period_s,
                                     zero_order_hold(disturbed, period_s).B);
}

}  // namespace breakwater
