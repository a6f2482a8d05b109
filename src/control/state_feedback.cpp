#include <breakwater/control/state_feedback.h>

#include <Eigen/LU>
#include <utility>

#include <breakwater/math/refuse_unless.h>

namespace breakwater {

Eigen::RowVectorXd place_feedback_poles(const StateSpace& continuous_plant, const PoleGroup& poles,
                                        double period_s) {
  const StateSpace sampled = zero_order_hold(continuous_plant, period_s);
  return place_observer_poles(sampled.A.transpose(), sampled.B.transpose(),
                              sample_poles({poles}, period_s))
      .transpose();
}

StateFeedback::StateFeedback(std::shared_ptr<DisturbanceEstimator> estimator,
                             const StateFeedbackDesign& design)
    : EstimatingControl(std::move(estimator), design.loop), K_(design.K) {
  const StateSpace& plant = design.plant;
  check(plant);
  const Eigen::Index n = plant.states();
  refuse_unless(plant.inputs() == 1 && design.E.size() == n && design.K.size() == n &&
                    state().size() == n && design.controlled >= 0 && design.controlled < n,
                "state feedback: estimator, gain and plant do not fit");
  // [A B; c 0] [x*; u*] = [E d; r], for d = 1 and for r = 1.
  Eigen::MatrixXd rest = Eigen::MatrixXd::Zero(n + 1, n + 1), wanted = rest.leftCols(2);
  rest.topLeftCorner(n, n) = plant.A;
  rest.topRightCorner(n, 1) = plant.B;
  rest(n, design.controlled) = 1.0;
  wanted.col(0).head(n) = design.E;
  wanted(n, 1) = 1.0;
  const Eigen::FullPivLU<Eigen::MatrixXd> factor(rest);
  refuse_unless(factor.isInvertible(), "state feedback: the plant cannot rest at every reference");
  const Eigen::MatrixXd found = factor.solve(wanted);
  const Eigen::RowVectorXd gains = found.row(n) + design.K * found.topRows(n);
  disturbance_gain_ = gains(0);
  reference_gain_ = gains(1);
}

DisturbanceCancellingPdDesign resonance_ratio(const TwoInertia& plant, double damping_ratio) {
  check(plant);
  refuse_unless(damping_ratio > 0.0, "resonance ratio control: the damping ratio must be positive");
  const double omega = antiresonance_rad_s(plant);
  const double load_at_motor = plant.load_inertia / (plant.ratio * plant.ratio);
  const double K_r = 4.0 * damping_ratio * damping_ratio * plant.motor_inertia / load_at_motor;
  return {.k_p = plant.motor_inertia * omega * omega,
          .k_d = 4.0 * damping_ratio * plant.motor_inertia * omega,
          .cancelled_share = 1.0 - K_r};
}

LqrControl::LqrControl(std::shared_ptr<DisturbanceEstimator> estimator, const AxisLoopDesign& loop,
                       Eigen::RowVectorXd K, bool uses_true_state)
    : EstimatingControl(std::move(estimator), loop),
      K_(std::move(K)),
      uses_true_state_(uses_true_state) {
  refuse_unless(K_.size() == state().size(), "LQR: estimator and gain must be for the same plant");
}

}  // namespace breakwater
