#include <Eigen/LU>
#include <regex>

#include <breakwater/plants/motor_and_load.h>
#include <breakwater/plants/xml_file.h>
#include <breakwater/sim/joint_friction.h>
#include <breakwater/sim/simulation.h>
#include <breakwater/sim/transmission.h>
#include "sim/small_models.h"

namespace breakwater::transmission_test {

using Complex = std::complex<double>;
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

TEST(Transmission, FreeSpringKeepsMomentumAndEnergy) {
  for (const double ratio : {1.0, 2.5}) {
    for (const double error : {0.0, 0.05}) {
      Drive drive({.ratio = ratio, .stiffness = 50.0, .kinematic_error = error});
      drive.start({0.4, -0.1}, {3.0, -1.0});
      const auto energy = [&] {
        const auto v = drive.simulation.qvel();
        const double twist = drive.transmission.twist(drive.motor(), drive.load());
        return 0.5 * (kMotor * v[0] * v[0] + kLoad * v[1] * v[1] + 50.0 * twist * twist);
      };
      const auto momentum = [&] {
        return ratio * kMotor * drive.simulation.qvel()[0] + kLoad * drive.simulation.qvel()[1];
      };
      drive.simulation.step();
      const double first_energy = energy(), first_momentum = momentum();
      double momentum_change = 0.0;
      for (int k = 0; k < 10000; ++k) {
        drive.simulation.step();
        momentum_change = std::max(momentum_change, std::abs(momentum() - first_momentum));
      }
      EXPECT_NEAR(energy(), first_energy, 1e-8 * first_energy) << ratio << " " << error;
      if (error == 0.0) {
        EXPECT_LT(momentum_change, 1e-12) << ratio;
      } else {
        EXPECT_GT(momentum_change, 1e-4) << "an error has no effect";
      }
    }
  }
}

TEST(Transmission, DamperTakesExactlyTheEnergyThatIsLost) {
  const TransmissionDesign design{.stiffness = 50.0, .damping = 0.05};
  Drive drive(design, 1e-5);
  drive.start({0.2, 0.0}, {0.0, 0.0});
  double lost = 0.0, last_rate = 0.0;
  for (int k = 0; k < 20000; ++k) {
    drive.simulation.step();
    const double rate = drive.simulation.qvel()[0] - drive.simulation.qvel()[1];
    lost += 0.5e-5 * design.damping * (rate * rate + last_rate * last_rate);
    last_rate = rate;
  }
  const auto v = drive.simulation.qvel();
  const double twist = drive.motor() - drive.load();
  const double left = 0.5 * (kMotor * v[0] * v[0] + kLoad * v[1] * v[1] + 50.0 * twist * twist);
  EXPECT_NEAR(left + lost, 0.5 * 50.0 * 0.2 * 0.2, 1e-6);
  EXPECT_GT(lost, 0.5);
}

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

constexpr double kMotorFriction = 0.15;

// Responses of both angles to the motor's torque at one frequency. A weak position feedback holds
// the drive; it is part of the torque, which is held between the samples.
std::array<Complex, 2> measured_response(const TransmissionDesign& design, double omega,
                                         double settle_s) {
  constexpr double kTimestep = 1e-3;
  const double steps = std::round(20.0 * std::numbers::pi / (omega * kTimestep));  // ten periods
  const double exact = 20.0 * std::numbers::pi / (steps * kTimestep);
  const auto law = [&](const Sample& sample, Eigen::Ref<Eigen::VectorXd> u) {
    u(0) = 0.1 * std::sin(exact * sample.time_s) - 0.3 * sample.y(0);
  };
  FunctionController controller(law);
  Model model = drive(kTimestep);
  author_friction(model, model.id(mjOBJ_JOINT, "motor"), kMotorFriction, 0.0);
  Simulation simulation(std::move(model), controller, no_channel(), 1);
  const Transmission transmission(simulation.model(), "motor", "load", design);
  simulation.add(transmission);
  while (simulation.time_s() < settle_s) simulation.step();
  std::array<Complex, 2> angles{};
  Complex torque = 0.0;
  for (double k = 0.0; k < steps; k += 1.0) {
    simulation.step();
    const Complex turned = std::polar(1.0, -exact * simulation.time_s());
    for (std::size_t i = 0; i < 2; ++i) angles[i] += simulation.qpos()[i] * turned;
    torque += simulation.actuation()(0) * turned * std::polar(1.0, -0.5 * exact * kTimestep);
  }
  return {angles[0] / torque, angles[1] / torque};
}

TwoInertia numbers_of(const TransmissionDesign& design) {
  return {.motor_inertia = kMotor,
          .load_inertia = kLoad,
          .stiffness = design.stiffness,
          .damping = design.damping,
          .motor_friction = kMotorFriction,
          .ratio = design.ratio};
}

std::array<Complex, 2> closed_form(const TwoInertia& numbers, double omega) {
  const StateSpace plant = motor_and_load(numbers, Side::motor);
  const Eigen::MatrixXcd resolvent =
      Complex(0.0, omega) * Eigen::MatrixXcd::Identity(4, 4) - plant.A.cast<Complex>();
  const Eigen::MatrixXcd x = resolvent.partialPivLu().solve(plant.B.cast<Complex>());
  return {x(0, 0), x(2, 0)};
}

TEST(Transmission, FrequencyResponseIsThatOfTwoInertias) {
  for (const double ratio : {1.0, 2.0}) {
    const TransmissionDesign design{.ratio = ratio, .stiffness = 50.0, .damping = 0.03};
    const TwoInertia numbers = numbers_of(design);
    const double peak = resonance_rad_s(numbers), notch = antiresonance_rad_s(numbers);
    for (int i = 0; i <= 10; ++i) {
      const double omega = 0.1 * peak * std::pow(30.0, i / 10.0);
      if (std::abs(omega / peak - 1.0) < 0.02 || std::abs(omega / notch - 1.0) < 0.02) continue;
      const auto found = measured_response(design, omega, 4.0),
                 expected = closed_form(numbers, omega);
      for (std::size_t side = 0; side < 2; ++side) {
        const Complex quotient = found[side] / expected[side];
        EXPECT_NEAR(20.0 * std::log10(std::abs(quotient)), 0.0, 1.0) << omega << " " << side;
        EXPECT_NEAR(std::arg(quotient) * 180.0 / std::numbers::pi, 0.0, 5.0)
            << omega << " " << side;
      }
    }
  }
}

// At the anti-resonance the motor's angle, and at the resonance the load's, turns its sign.
TEST(Transmission, ResonancesAreWithinHalfAPercent) {
  const TransmissionDesign design{.stiffness = 50.0, .damping = 0.01};
  const TwoInertia numbers = numbers_of(design);
  const auto real = [&](double omega, std::size_t side) {
    return measured_response(design, omega, 12.0)[side].real();
  };
  const double notch = antiresonance_rad_s(numbers), peak = resonance_rad_s(numbers);
  EXPECT_LT(real(0.995 * notch, 0), 0.0);
  EXPECT_GT(real(1.005 * notch, 0), 0.0);
  EXPECT_LT(real(0.995 * peak, 1), 0.0);
  EXPECT_GT(real(1.005 * peak, 1), 0.0);
}

// u = −k_p q_l, with friction at both inertias. For a dead zone the describing function is a lower
// stiffness K' of the spring. The loop oscillates where it has poles on the imaginary axis:
//     ω² = K' S/C,  K' (J_m J_l S²/C² − (J_m + J_l) S/C) = c_m c_l S/C − k_p
// with S = c_m + c_l and C = J_m c_l + J_l c_m.
TEST(Transmission, BacklashOscillatesAsTheDescribingFunctionPredicts) {
  constexpr double kGain = 10.0, kMotorC = 0.3, kLoadC = 0.02, kStiffness = 50.0, kPlay = 0.02;
  constexpr double S = kMotorC + kLoadC, C = kMotor * kLoadC + kLoad * kMotorC;
  const double reduced = (kMotorC * kLoadC * S / C - kGain) /
                         (kMotor * kLoad * S * S / (C * C) - (kMotor + kLoad) * S / C);
  ASSERT_GT(reduced, 0.0);
  ASSERT_LT(reduced, kStiffness);
  const double predicted = std::sqrt(reduced * S / C);
  // The amplitude of the twist, from 1 − (2/π)(asin r + r √(1 − r²)) = K'/K with r = b/(2A).
  double low = 0.0, high = 1.0;
  for (int i = 0; i < 60; ++i) {
    const double r = 0.5 * (low + high);
    const double gain = 1.0 - 2.0 / std::numbers::pi * (std::asin(r) + r * std::sqrt(1.0 - r * r));
    (gain > reduced / kStiffness ? low : high) = r;
  }
  const double amplitude = 0.5 * kPlay / low;

  FunctionController controller(
      [](const Sample& sample, Eigen::Ref<Eigen::VectorXd> u) { u(0) = -kGain * sample.y(0); });
  Model model = drive(5e-4);
  author_friction(model, model.id(mjOBJ_JOINT, "motor"), kMotorC, 0.0);
  author_friction(model, model.id(mjOBJ_JOINT, "load"), kLoadC, 0.0);
  SensingSetup setup;
  setup.channels = {{.name = "angle", .sensor = "load_pos"}};
  Simulation simulation(std::move(model), controller, setup, 1);
  const Transmission transmission(simulation.model(), "motor", "load",
                                  {.stiffness = kStiffness, .backlash = kPlay});
  simulation.add(transmission);
  simulation.set_position(std::array{0.05, 0.05});
  while (simulation.time_s() < 15.0) simulation.step();
  double last = simulation.qpos()[1], largest = 0.0;
  std::vector<double> risings;
  while (simulation.time_s() < 25.0) {
    simulation.step();
    const double now = simulation.qpos()[1];
    if (last < 0.0 && now >= 0.0) risings.push_back(simulation.time_s());
    last = now;
    largest = std::max(largest, std::abs(transmission.twist(simulation.qpos()[0], now)));
  }
  ASSERT_GT(risings.size(), 10U);
  const double found = 2.0 * std::numbers::pi * static_cast<double>(risings.size() - 1) /
                       (risings.back() - risings.front());
  EXPECT_NEAR(found, predicted, 0.1 * predicted);
  EXPECT_NEAR(largest, amplitude, 0.2 * amplitude);
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
  std::string text = read_text(testing::source_file("models/two_inertia.xml"));
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
      const Transmission transmission(simulation.model(), motor, "load", design);
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
