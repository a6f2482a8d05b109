
#include <cmath>

#include <breakwater/sim/joint_friction.h>
#include <breakwater/sim/simulation.h>
#include "sim/small_models.h"

namespace breakwater::actuation_test {
namespace {

using testing::FunctionController;

constexpr double kMass = 0.625;

Model cart() {
  Model model = Model::load(testing::source_file("models/cart.xml"));
  model.set_physics(1e-3, Integrator::rk4);
  return model;
}

SensingSetup rail() {
  SensingSetup setup;
  setup.channels = {{.name = "position", .sensor = "cart_pos"}};
  return setup;
}

FunctionController pushes(double force_N) {
  return FunctionController(
      [force_N](const Sample&, Eigen::Ref<Eigen::VectorXd> u) { u(0) = force_N; });
}

void run(Simulation& simulation, int steps) {
  for (int k = 0; k < steps; ++k) simulation.step();
}

TEST(Friction, ViscousFrictionGivesItsTerminalSpeed) {
  Model model = cart();
  author_friction(model, 0, 2.0, 0.0);
  FunctionController controller = pushes(1.0);
  Simulation simulation(std::move(model), controller, rail(), 1);
  run(simulation, 5000);
  EXPECT_NEAR(simulation.qvel()[0], 0.5, 1e-6);
}

TEST(Friction, CoulombFrictionHoldsSmallForcesAndReducesLargeOnes) {
  Model model = cart();
  author_friction(model, 0, 0.0, 0.3);
  FunctionController weak = pushes(0.29);
  Simulation held(std::move(model), weak, rail(), 1);
  run(held, 10000);
  EXPECT_LT(std::abs(held.qpos()[0]), 1e-4);  // 10 µm/s of creep

  Model another = cart();
  author_friction(another, 0, 0.0, 0.3);
  FunctionController strong = pushes(1.0);
  Simulation moving(std::move(another), strong, rail(), 1);
  run(moving, 1001);
  EXPECT_NEAR(moving.qvel()[0], (1.0 - 0.3) / kMass, 2e-3);
}

TEST(Friction, StopsAMovingBodyAfterTheDistanceFromItsEnergy) {
  // ½ M v² = F_C s from 0.5 m/s, after a push of 0.1 s.
  Model model = cart();
  author_friction(model, 0, 0.0, 0.3);
  FunctionController controller([](const Sample& y, Eigen::Ref<Eigen::VectorXd> u) {
    u(0) = y.time_s < 0.1 ? 0.3 + kMass * 0.5 / 0.1 : 0.0;
  });
  Simulation simulation(std::move(model), controller, rail(), 1);
  run(simulation, 101);
  const double start = simulation.qpos()[0], speed = simulation.qvel()[0];
  run(simulation, 5000);
  EXPECT_NEAR(simulation.qpos()[0] - start, 0.5 * kMass * speed * speed / 0.3, 2e-3);
  EXPECT_NEAR(simulation.qvel()[0], 0.0, 1e-5);
}

TEST(Friction, RefusesNonsense) {
  Model model = cart();
  EXPECT_THROW(author_friction(model, 0, -1.0, 0.0), std::invalid_argument);
  EXPECT_THROW(author_friction(model, 0, 0.0, std::nan("")), std::invalid_argument);
}

TEST(Model, ScaledInertiaAcceleratesAccordingly) {
  for (const double ratio : {0.5, 1.0, 3.0}) {
    Model model = cart();
    author_friction(model, 0, 0.0, 0.0);
    model.scale_inertia(ratio);
    FunctionController controller = pushes(2.0);
    Simulation simulation(std::move(model), controller, rail(), 1);
    run(simulation, 1001);
    EXPECT_NEAR(simulation.qvel()[0], 2.0 / (ratio * kMass), 1e-9) << ratio;
  }
  Model model = cart();
  EXPECT_THROW(model.scale_inertia(0.0), std::invalid_argument);
  EXPECT_THROW(model.scale_inertia(INFINITY), std::invalid_argument);
}

TEST(Model, ALimitedActuatorSaturatesAndAnInfiniteLimitDoesNot) {
  for (const double limit : {2.0, HUGE_VAL}) {
    Model model = cart();
    model.limit_actuator(0, limit);
    FunctionController controller = pushes(5.0);
    Simulation simulation(std::move(model), controller, rail(), 1);
    run(simulation, 2);
    EXPECT_EQ(simulation.actuation()(0), std::min(limit, 5.0));
    EXPECT_EQ(simulation.saturated(), limit < 5.0);
  }
  Model model = cart();
  EXPECT_THROW(model.limit_actuator(0, 0.0), std::invalid_argument);
}

TEST(Simulation, ADelayedCommandReachesItsDriveAtItsStep) {
  FunctionController controller(
      [](const Sample& y, Eigen::Ref<Eigen::VectorXd> u) { u(0) = 1.0 + y.time_s; });
  Simulation simulation(cart(), controller, rail(), 2);
  simulation.set_timing({.delay_s = 3e-3}, 1);
  for (int step = 0; step < 20; ++step) {
    simulation.step();
    const int sent = (step - 3) / 2 * 2;  // the step of the sample
    EXPECT_DOUBLE_EQ(simulation.actuation()(0), step < 3 ? 0.0 : 1.0 + 1e-3 * sent) << step;
  }
}

TEST(Simulation, TheCurrentOfAMotorMayExceedTheLimitOfItsCommand) {
  Model model = cart();
  author_friction(model, 0, 0.0, 0.0);
  model.limit_actuator(0, 2.0);
  FunctionController controller = pushes(5.0);
  Simulation simulation(std::move(model), controller, rail(), 1);
  simulation.set_drive(0, {.bandwidth_rad_s = 300.0, .damping_ratio = 0.2});
  double largest_N = 0.0, impulse_Ns = 0.0;
  for (int k = 0; k < 200; ++k) {
    simulation.step();
    largest_N = std::max(largest_N, simulation.drive_force()(0));
    impulse_Ns += 1e-3 * simulation.drive_force()(0);
  }
  EXPECT_EQ(simulation.actuation()(0), 2.0);
  EXPECT_GT(largest_N, 2.5);
  EXPECT_NEAR(kMass * simulation.data().qvel[0], impulse_Ns, 1e-9);
}

TEST(Simulation, RoundsACommandToTheStepsOfItsDrive) {
  FunctionController controller(
      [](const Sample& y, Eigen::Ref<Eigen::VectorXd> u) { u(0) = std::sin(20.0 * y.time_s); });
  Simulation simulation(cart(), controller, rail(), 1);
  simulation.set_pwm(0, Pwm{0.2});
  for (int k = 0; k < 300; ++k) {
    simulation.step();
    EXPECT_DOUBLE_EQ(simulation.actuation()(0), 0.2 * std::round(simulation.command()(0) / 0.2));
    EXPECT_EQ(simulation.data().ctrl[0], simulation.actuation()(0));
  }
}

TEST(Sensing, DisturbsQuantisesAddsNoiseAndDelaysInThatOrder) {
  SensingSetup setup = rail();
  setup.channels[0].disturbance = {DisturbanceKind::step, 0.0123, 0.0, 0.1};
  setup.channels[0].encoder.quantum = 0.01;
  setup.channels[0].noise_std = 1e-4;
  setup.channels[0].delay_samples = 3;
  setup.seed = 5;
  FunctionController controller = pushes(1.0);
  Simulation simulation(cart(), controller, setup, 2);
  const Noise noise(5, "position");
  std::vector<double> sent;
  for (int k = 0; k < 400; ++k) {
    simulation.step();
    if (!simulation.sampled()) continue;
    const double t = simulation.time_s();
    const double disturbed = simulation.qpos()[0] + (t >= 0.1 ? 0.0123 : 0.0);
    sent.push_back(0.01 * std::round(disturbed / 0.01) + 1e-4 * noise(sent.size()));
    const std::size_t newest = sent.size() - 1;
    EXPECT_DOUBLE_EQ(simulation.sample().y(0), sent[newest >= 3 ? newest - 3 : 0]);
  }
}

TEST(Sensing, RefusesANegativeDelay) {
  SensingSetup setup = rail();
  setup.channels[0].delay_samples = -1;
  EXPECT_THROW(Sensing(cart(), setup), std::invalid_argument);
}

}  // namespace
}  // namespace breakwater::actuation_test
