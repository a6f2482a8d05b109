// Limits, added rotors and refusals of transmissions. tests/python/plants_test.py has their
// motions.
#include <regex>

#include <breakwater/sim/joint_friction.h>
#include <breakwater/sim/simulation.h>
#include <breakwater/sim/transmission.h>
#include "sim/small_models.h"

namespace breakwater::transmission_test {

using testing::FunctionController;

constexpr double kMotor = 0.01, kLoad = 0.02;  // the inertias of models/two_inertia.xml

Model drive(double timestep_s = 1e-4, Integrator integrator = Integrator::rk4) {
  Model model = Model::load(testing::source_file("models/two_inertia.xml"));
  model.set_physics(timestep_s, integrator);
  return model;
}

SensingSetup no_channel() {
  SensingSetup setup;
  setup.channels = {{.name = "angle", .sensor = "motor_pos"}};
  return setup;
}

// The drive without a torque.
struct Drive {
  explicit Drive(const TransmissionDesign& design, double timestep_s = 1e-4)
      : controller([](const Sample&, Eigen::Ref<Eigen::VectorXd> u) { u.setZero(); }),
        simulation(drive(timestep_s), controller, no_channel(), 1),
        transmission(simulation.model(), "motor", "load", design) {
    simulation.add(transmission);
  }
  void start(const std::array<double, 2>& position, const std::array<double, 2>& velocity) {
    simulation.set_position(position);
    simulation.set_velocity(velocity);
  }
  double motor() const { return simulation.qpos()[0]; }
  double load() const { return simulation.qpos()[1]; }

  FunctionController controller;
  Simulation simulation;
  Transmission transmission;
};

TEST(Transmission, BacklashIsADeadZoneThatNeverPulls) {
  Drive drive({.stiffness = 100.0, .damping = 0.5, .backlash = 0.02});
  const Transmission& t = drive.transmission;
  EXPECT_EQ(t.torque(0.0099, 1.0, 0.0, 0.0), 0.0);
  EXPECT_EQ(t.torque(-0.0099, -1.0, 0.0, 0.0), 0.0);
  EXPECT_NEAR(t.torque(0.03, 0.0, 0.0, 0.0), 2.0, 1e-12);
  EXPECT_NEAR(t.torque(0.0, 0.0, 0.03, 0.0), -2.0, 1e-12);
  EXPECT_NEAR(t.torque(0.03, 1.0, 0.0, 0.0), 2.5, 1e-12);
  EXPECT_EQ(t.torque(0.012, -1.0, 0.0, 0.0), 0.0);
  EXPECT_EQ(t.torque(-0.012, 1.0, 0.0, 0.0), 0.0);
  // Without a load the motor takes the load along only after half the play.
  drive.start({0.0, 0.0}, {0.5, 0.0});
  while (drive.simulation.time_s() < 0.0195) drive.simulation.step();
  EXPECT_EQ(drive.load(), 0.0);
  while (drive.simulation.time_s() < 0.06) drive.simulation.step();
  EXPECT_GT(drive.load(), 0.0);
}

// The longest stable timestep is 2.83/ω_r with RK4, and 2/ω_r with the others.
TEST(Transmission, RefusesATimestepBeyondTheStabilityLimit) {
  const double omega = std::sqrt(50.0 * (1.0 / kMotor + 1.0 / kLoad));
  for (const auto& [integrator, limit] :
       {std::pair{Integrator::rk4, std::sqrt(8.0)}, std::pair{Integrator::euler, 2.0}}) {
    const auto check = [&, which = integrator](double timestep_s) {
      const Model model = drive(timestep_s, which);
      Transmission(model, "motor", "load", {.stiffness = 50.0}).check_stability(model);
    };
    EXPECT_NO_THROW(check(0.99 * limit / omega));
    EXPECT_REFUSED(check(1.01 * limit / omega));
  }
  const Model slow = drive(0.04);
  EXPECT_TRUE(has(complaint_of([&] {
                    Transmission(slow, "motor", "load", {.stiffness = 50.0}).check_stability(slow);
                  }),
                  "that divides it is 0.02"));
}

// models/two_inertia.xml without its motor, and with a rotor added in its place.
Model drive_with_added_rotor(double ratio) {
  std::string text = testing::text_of(testing::source_file("models/two_inertia.xml"));
  const auto erase = [&](const std::string& from, const std::string& to) {
    const std::size_t begin = text.find(from), end = text.find(to, begin);
    text.erase(begin, end + to.size() - begin);
  };
  erase("<body name=\"rotor\">", "</body>");
  erase("<jointpos name=\"motor_pos\"", "/>");
  erase("<jointvel name=\"motor_vel\"", "/>");
  text = std::regex_replace(text, std::regex("joint=\"motor\""), "joint=\"load\"");
  text = std::regex_replace(text, std::regex("qpos=\"0 0\""), "qpos=\"0.5\"");
  Model model = testing::model_of(text);
  model.set_physics(1e-4, Integrator::rk4);
  model.add_rotor(0, 0, ratio, kMotor, "rotor");
  return model;
}

TEST(AddedRotor, MovesAsTheMotorOfTheModelFile) {
  for (const double ratio : {1.0, 2.5}) {
    const TransmissionDesign design{
        .ratio = ratio, .stiffness = 50.0, .damping = 0.01, .kinematic_error = 0.01};
    const auto run = [&](Model model, const std::string& motor) {
      author_friction(model, model.id(mjOBJ_JOINT, motor), 0.02, 0.0);
      author_friction(model, model.id(mjOBJ_JOINT, "load"), 0.005, 0.0);
      FunctionController controller([](const Sample& sample, Eigen::Ref<Eigen::VectorXd> u) {
        u(0) = std::sin(40.0 * sample.time_s);
      });
      SensingSetup setup;
      setup.channels = {{.name = "angle", .sensor = "load_pos"}};
      Simulation simulation(std::move(model), controller, setup, 1);
      Transmission transmission(simulation.model(), motor, "load", design);
      simulation.add(transmission);
      while (simulation.time_s() < 1.0) simulation.step();
      const auto q = simulation.qpos();
      // The added rotor is the last joint, that of the file the first.
      return motor == "rotor" ? std::array{q[1], q[0]} : std::array{q[0], q[1]};
    };
    const auto added = run(drive_with_added_rotor(ratio), "rotor"), own = run(drive(), "motor");
    EXPECT_GT(std::abs(own[1]), 1e-3);
    EXPECT_NEAR(added[0], own[0], 1e-12) << ratio;
    EXPECT_NEAR(added[1], own[1], 1e-12) << ratio;
  }
}

TEST(AddedRotor, BeginsWithoutATwistInEachPose) {
  const Model model = drive_with_added_rotor(2.5);
  EXPECT_EQ(model->qpos0[1], 0.0);
  EXPECT_EQ(model->key_qpos[0], 0.5);
  EXPECT_EQ(model->key_qpos[1], 1.25);
  EXPECT_EQ(model->actuator_trnid[0], model.id(mjOBJ_JOINT, "rotor"));
  EXPECT_EQ(model.id(mjOBJ_JOINT, "load"), 0);
}

// Gravity acts on neither a rotor that turns nor one that slides.
TEST(AddedRotor, GravityDoesNotActOnIt) {
  for (const char* type : {"hinge", "slide"}) {
    Model model = testing::model_of(
        std::string("<mujoco><worldbody><body name='b'><joint name='load' axis='0 1 0' type='") +
        type + "'/><geom size='0.1' mass='1' pos='0.1 0 0'/></body></worldbody>" +
        "<actuator><motor name='motor' joint='load'/></actuator></mujoco>");
    model.add_rotor(0, 0, 1.0, 0.01, "rotor");
    const DataPointer data = model.make_data();
    for (int k = 0; k < 100; ++k) mj_step(model.get(), data.get());
    EXPECT_EQ(data->qpos[1], 0.0) << type;
    EXPECT_EQ(data->warning[mjWARN_INERTIA].number, 0) << type;
  }
}

TEST(AddedRotor, RefusesNonsense) {
  Model model = drive_with_added_rotor(1.0);
  EXPECT_REFUSED(model.add_rotor(0, 0, 1.0, 0.01, "rotor"));
  EXPECT_REFUSED(model.add_rotor(0, 0, 1.0, 0.01, "load"));
  EXPECT_REFUSED(model.add_rotor(0, 0, 1.0, 0.0, "other"));
}

TEST(Transmission, RefusesNonsense) {
  const Model model = drive();
  const auto make = [&](const std::string& motor, const std::string& load,
                        const TransmissionDesign& design) {
    return Transmission(model, motor, load, design);
  };
  EXPECT_REFUSED(make("motor", "motor", {.stiffness = 1.0}));
  EXPECT_REFUSED(make("motor", "wheel", {.stiffness = 1.0}));
  for (const TransmissionDesign& wrong :
       {TransmissionDesign{}, TransmissionDesign{.ratio = 0.0, .stiffness = 1.0},
        TransmissionDesign{.stiffness = 1.0, .damping = -1.0},
        TransmissionDesign{.stiffness = 1.0, .backlash = std::nan("")},
        TransmissionDesign{.stiffness = 1.0, .kinematic_error = INFINITY}}) {
    EXPECT_REFUSED(make("motor", "load", wrong));
  }
}

}  // namespace breakwater::transmission_test
