#include <breakwater/observers/disturbance_model.h>

#include <breakwater/linear/state_space.h>
#include <breakwater/math/refuse_unless.h>

namespace breakwater {
namespace {

// `E` (n×m) is sampled too.
ExtendedPlant extend(const StateSpace& sampled_plant, const Eigen::MatrixXd& E, int order,
                     double period_s) {
  check(sampled_plant);
  refuse_unless(order >= 0 && order <= 2, "disturbance model: the order must be 0, 1 or 2");
  refuse_unless(period_s > 0.0, "disturbance model: the sampling period must be positive");
  const Eigen::Index n = sampled_plant.states();
  const Eigen::Index m = sampled_plant.inputs();
  const Eigen::Index p = sampled_plant.outputs();
  const Eigen::Index size = n + m * (order + 1);
  StateSpace extended{Eigen::MatrixXd::Identity(size, size), Eigen::MatrixXd::Zero(size, m),
                      Eigen::MatrixXd::Zero(p, size)};
  extended.A.topLeftCorner(n, n) = sampled_plant.A;
  extended.A.block(0, n, n, m) = -E;
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

}  // namespace

ExtendedPlant extend_by_disturbance_model(const StateSpace& sampled_plant, int order,
                                          double period_s) {
  return extend(sampled_plant, sampled_plant.B, order, period_s);
}

ExtendedPlant sample_with_disturbance_model(const StateSpace& continuous_plant, int order,
                                            double period_s, const Eigen::MatrixXd& E) {
  const StateSpace sampled = zero_order_hold(continuous_plant, period_s);
  if (E.size() == 0) {
    ExtendedPlant plant = extend(sampled, sampled.B, order, period_s);
    plant.continuous = continuous_plant;
    return plant;
  }
  refuse_unless(E.rows() == continuous_plant.states() && E.cols() == continuous_plant.inputs(),
                "disturbance model: E must have the shape of B");
  const StateSpace disturbed{continuous_plant.A, E, continuous_plant.C};
  return extend(sampled, zero_order_hold(disturbed, period_s).B, order, period_s);
}

}  // namespace breakwater
