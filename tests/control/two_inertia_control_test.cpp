// Controllers and estimators of two inertias, on the sampled plant.
#include <Eigen/LU>

#include <breakwater/control/predictive_control.h>
#include <breakwater/control/state_feedback.h>
#include <breakwater/observers/idob.h>
#include <breakwater/observers/kfd.h>
#include <breakwater/observers/multiple_model_estimator.h>
#include <breakwater/observers/stf.h>
#include <breakwater/plants/damped_inertia.h>
#include "support.h"

namespace breakwater::two_inertia_control_test {

using Complex = std::complex<double>;
using Estimator = std::shared_ptr<DisturbanceEstimator>;

constexpr double kPeriod = 1e-3;
const TwoInertia kPlant{.motor_inertia = 0.01,
                        .load_inertia = 0.02,
                        .stiffness = 50.0,
                        .damping = 0.01,
                        .motor_friction = 0.01,
                        .load_friction = 0.005};

SensorError sensor(double quantum) {
  return {Eigen::VectorXd::Constant(1, quantum), Eigen::VectorXd::Constant(1, 1e-6)};
}

ExtendedPlant extended(Side side) {
  return sample_with_disturbance_model(motor_and_load(kPlant, side), 0, kPeriod,
                                       load_torque_input(kPlant, side));
}

Estimator kfd(Side side) {
  const ExtendedPlant plant = extended(side);
  return std::make_unique<Kfd>(KalmanDesign{plant, disturbance_noise(plant, 1e-7),
                                            Eigen::MatrixXd::Constant(1, 1, 1e-10),
                                            Eigen::MatrixXd::Identity(5, 5)});
}

Estimator stf(Side side) {
  return std::make_unique<Stf>(stf_design(extended(side), sensor(1e-5), kPeriod), sensor(1e-5));
}

Estimator qbank(Side side) {
  const double inertia = kPlant.motor_inertia + kPlant.load_inertia;
  return sized_multiple_model({motor_and_load(kPlant, side), kPeriod, sensor(1e-5), 2.0,
                               load_torque_input(kPlant, side), inertia});
}

StateFeedbackDesign feedback(Side side) {
  StateFeedbackDesign design{.plant = motor_and_load(kPlant, side),
                             .E = load_torque_input(kPlant, side),
                             .controlled = side == Side::load ? 0 : 2,
                             .K = {},
                             .loop = {.reference = {0.5, 0.0},
                                      .period_s = kPeriod,
                                      .units = rotation_units(),
                                      .start_state = Eigen::VectorXd::Zero(4)}};
  design.K = place_feedback_poles(design.plant, {-40.0, -45.0, -50.0, -55.0}, kPeriod);
  return design;
}

// Runs a loop with a load torque d from `from_s` on. `watch` gets the time and the state.
Eigen::VectorXd run_loop(Controller& controller, Side side, double d, double from_s, double to_s,
                         double quantum = 0.0, double period_s = kPeriod,
                         const std::function<void(double, const Eigen::VectorXd&)>& watch = {}) {
  const StateSpace continuous = motor_and_load(kPlant, side);
  const StateSpace plant = zero_order_hold(continuous, period_s);
  const Eigen::MatrixXd E =
      zero_order_hold({continuous.A, load_torque_input(kPlant, side), continuous.C}, period_s).B;
  Eigen::VectorXd x = Eigen::VectorXd::Zero(4), u = Eigen::VectorXd::Zero(1);
  Sample sample{0.0, Eigen::VectorXd::Zero(1)};
  controller.reset(sample);
  for (int k = 0; k * period_s < to_s; ++k) {
    sample.time_s = k * period_s;
    sample.y(0) = quantum > 0.0 ? quantum * std::round(x(0) / quantum) : x(0);
    if (watch) watch(sample.time_s, x);
    controller.update(sample, u);
    x = plant.A * x + plant.B * u(0) - E * (sample.time_s >= from_s ? d : 0.0);
  }
  return x;
}

TEST(ResonanceRatio, IdealLoopHasItsPolesAtTheAntiResonance) {
  for (const double ratio : {1.0, 3.0}) {
    for (const double zeta : {1.0, 0.7}) {
      TwoInertia plant{.motor_inertia = 0.003, .load_inertia = 0.08, .stiffness = 60.0};
      plant.ratio = ratio;
      const DisturbanceCancellingPdDesign gains = resonance_ratio(plant, zeta);
      // τ̂ is the spring's torque at the motor, T/N.
      const StateSpace open = motor_and_load(plant, Side::motor);
      const Eigen::RowVector4d twist(1.0 / ratio, 0.0, -1.0, 0.0);
      const Eigen::RowVector4d feedback = -Eigen::RowVector4d(gains.k_p, gains.k_d, 0.0, 0.0) +
                                          gains.cancelled_share * plant.stiffness / ratio * twist;
      const Eigen::Matrix4d closed = open.A + open.B * feedback;
      const double omega = antiresonance_rad_s(plant);
      for (const Complex s : {Complex(10.0, 0.0), Complex(0.0, 40.0), Complex(-30.0, 20.0)}) {
        const Complex found =
            (s * Eigen::Matrix4cd::Identity() - closed.cast<Complex>()).determinant();
        const Complex factor = s * s + 2.0 * zeta * omega * s + omega * omega;
        EXPECT_LT(std::abs(found - factor * factor), 1e-9 * std::abs(factor * factor));
      }
    }
  }
}

TEST(ResonanceRatio, LoadFollowsTheClosedForm) {
  constexpr double kFast = 1e-4;
  const TwoInertia& p = kPlant;
  const DisturbanceCancellingPdDesign gains = resonance_ratio(p, 1.0);
  DisturbanceCancellingPd controller(
      std::make_shared<Idob>(damped_inertia(p.motor_inertia, p.motor_friction),
                             std::vector<PoleGroup>{{-2000.0, -2200.0, -2400.0}}, kFast),
      {.k_p = gains.k_p,
       .k_d = gains.k_d,
       .cancelled_share = gains.cancelled_share,
       .loop = {.reference = {1.0, 0.0}, .period_s = kFast, .units = rotation_units()}});
  double largest = 0.0;
  run_loop(controller, Side::motor, 0.0, 0.0, 0.4, 0.0, kFast,
           [&](double t, const Eigen::VectorXd& x) {
             const double a = antiresonance_rad_s(p) * t;
             const double expected = 1.0 - std::exp(-a) * (1.0 + a + a * a / 2.0 + a * a * a / 6.0);
             largest = std::max(largest, std::abs(x(2) - expected));
           });
  EXPECT_LT(largest, 0.03);
}

TEST(ResonanceRatio, NeedsAPositiveDampingRatio) {
  EXPECT_REFUSED(resonance_ratio(kPlant, 0.0));
  EXPECT_REFUSED(resonance_ratio({}, 1.0));
}

TEST(StateFeedback, PlacesThePolesOfTheClosedLoop) {
  const StateSpace plant = motor_and_load(kPlant, Side::motor);
  const PoleGroup wanted = {{-40.0, 30.0}, {-40.0, -30.0}, -60.0, -90.0};
  const StateSpace sampled = zero_order_hold(plant, kPeriod);
  const Eigen::MatrixXd closed =
      sampled.A - sampled.B * place_feedback_poles(plant, wanted, kPeriod);
  for (const Complex& pole : wanted) {
    const Complex z = std::exp(pole * kPeriod);
    const double distance =
        std::abs((closed.cast<Complex>() - z * Eigen::Matrix4cd::Identity()).determinant());
    // The characteristic polynomial at z, relative to its slope.
    Complex slope = 1.0;
    for (const Complex& other : wanted) {
      if (other != pole) slope *= z - std::exp(other * kPeriod);
    }
    EXPECT_LT(distance, 1e-7 * std::abs(slope));
  }
}

TEST(StateFeedback, OfOneInertiaIsPdControl) {
  const StateSpace plant = damped_inertia(0.03, 0.1);
  StateFeedbackDesign design{.plant = plant, .E = plant.B};
  design.K = Eigen::RowVector2d(7.0, 0.9);
  const StateFeedback controller(
      std::make_shared<Idob>(plant, std::vector<PoleGroup>{{-20.0, -25.0, -30.0}}, kPeriod),
      design);
  EXPECT_NEAR(controller.reference_gain(), 7.0, 1e-12);
  EXPECT_NEAR(controller.disturbance_gain(), 1.0, 1e-12);
}

TEST(StateFeedback, LoadReachesItsReferenceUnderALoadTorque) {
  for (const Side side : {Side::motor, Side::load}) {
    for (const auto& make : {kfd, stf, qbank}) {
      const Estimator estimator = make(side);
      StateFeedback controller(estimator, feedback(side));
      const bool rounds = make != kfd;
      const Eigen::VectorXd x = run_loop(controller, side, 0.8, 0.5, 3.0, rounds ? 1e-5 : 0.0);
      const Eigen::Index load = side == Side::load ? 0 : 2;
      const double within = rounds ? 1e-4 : 1e-6;
      EXPECT_NEAR(x(load), 0.5, within);
      EXPECT_NEAR(x(2 - load), 0.5 + 0.8 / kPlant.stiffness, within);
      EXPECT_NEAR(estimator->disturbance()(0), 0.8, rounds ? 2e-2 : 1e-5);
    }
  }
}

TEST(PredictiveControl, BringsTheLoadOfTwoInertiasToItsReference) {
  const ExtendedPlant plant = extended(Side::motor);
  PredictiveControlDesign design{.samples_per_move = 1,
                                 .controlled = 2,
                                 .loop = {.reference = {0.5, 0.0},
                                          .units = rotation_units(),
                                          .start_state = Eigen::VectorXd::Zero(4)}};
  design.lmpc.A = plant.sampled.A;
  design.lmpc.B = plant.sampled.B;
  design.lmpc.prediction_steps = 60;
  design.lmpc.control_steps = 10;
  design.lmpc.max_iterations = 100;
  design.lmpc.softness = 1e-6;
  design.lmpc.Q = Eigen::VectorXd::Unit(5, 2).asDiagonal();
  design.lmpc.Q(3, 3) = 1e-4;
  design.lmpc.Q_last = 10.0 * design.lmpc.Q;
  design.lmpc.R = Eigen::MatrixXd::Constant(1, 1, 1e-3);
  PredictiveControl controller(kfd(Side::motor), design);
  EXPECT_NEAR(run_loop(controller, Side::motor, 0.8, 0.5, 3.0)(2), 0.5, 1e-5);
}

TEST(StateFeedback, RefusesWhatDoesNotFit) {
  const auto refused = [](const std::function<void(StateFeedbackDesign&)>& change) {
    StateFeedbackDesign design = feedback(Side::motor);
    change(design);
    EXPECT_REFUSED(StateFeedback(kfd(Side::motor), design));
  };
  refused([](StateFeedbackDesign& d) { d.K = Eigen::RowVector2d::Ones(); });
  refused([](StateFeedbackDesign& d) { d.E = Eigen::Vector2d::Ones(); });
  refused([](StateFeedbackDesign& d) { d.loop.start_state = Eigen::Vector2d::Zero(); });
  refused([](StateFeedbackDesign& d) { d.controlled = 4; });
  refused([](StateFeedbackDesign& d) { d.controlled = 1; });  // no rest at a velocity
  refused([](StateFeedbackDesign& d) { d.loop.force_limit = 0.0; });
  refused([](StateFeedbackDesign& d) { d.loop.period_s = -1.0; });
}

TEST(MultipleModelBank, RefusesAPlantOfAnotherShape) {
  const auto design = [] {
    return MultipleModelDesign{motor_and_load(kPlant, Side::motor),    kPeriod, sensor(1e-5), 2.0,
                               load_torque_input(kPlant, Side::motor), 0.03};
  };
  EXPECT_NO_THROW(sized_multiple_model(design()));
  MultipleModelDesign measured_twice = design();
  measured_twice.plant.C(0, 2) = 1.0;
  EXPECT_REFUSED(sized_multiple_model(measured_twice));
  MultipleModelDesign held = design();  // a spring to the world: it cannot rest everywhere
  held.plant.A(3, 2) -= 10.0;
  EXPECT_REFUSED(sized_multiple_model(held));
}

}  // namespace breakwater::two_inertia_control_test
