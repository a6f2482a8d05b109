// The stepping loop: sensing, control, actuation and friction.
#include <chrono>
#include <thread>

#include <breakwater/sim/engine_guard.h>
#include <breakwater/sim/joint_friction.h>
#include <breakwater/sim/simulation.h>
#include "sim/small_models.h"

namespace breakwater::simulation_test {

using testing::FunctionController;

SensingSetup shaft() {
  SensingSetup setup;
  setup.channels = {{.name = "q", .sensor = "shaft_pos"}};
  return setup;
}

Model motor(double timestep_s = 1e-3, Integrator integrator = Integrator::rk4) {
  Model model = Model::load(testing::source_file("models/motor.xml"));
  model.set_physics(timestep_s, integrator);
  return model;
}

void run(Simulation& simulation, int steps) {
  for (int k = 0; k < steps; ++k) simulation.step();
}

TEST(Simulation, Rk4IntegratesAHeldTorqueExactly) {
  // J q̈ = τ(k), held: q(k+1) = q + T q̇ + T²/2 τ, except for rounding.
  const double T = 0.01;
  FunctionController controller([k = 0](const Sample&, Eigen::Ref<Eigen::VectorXd> u) mutable {
    u(0) = std::sin(0.7 * k++);
  });
  Simulation simulation(motor(1e-3), controller, shaft(), 10);
  double q = 0, dq = 0;
  for (int k = 0; k < 200; ++k) {
    run(simulation, 10);
    const double torque = std::sin(0.7 * k);
    q += T * dq + T * T / 2 * torque;
    dq += T * torque;
    EXPECT_NEAR(simulation.data().qpos[0], q, 1e-13);
    EXPECT_NEAR(simulation.data().qvel[0], dq, 1e-13);
  }
  EXPECT_EQ(controller.updates, 200);
  EXPECT_EQ(controller.resets, 1);
}

TEST(Simulation, ControllerIsCalledAtItsOwnRateWithFreshAngles) {
  std::vector<double> times, angles;
  FunctionController controller([&](const Sample& y, Eigen::Ref<Eigen::VectorXd> u) {
    times.push_back(y.time_s);
    angles.push_back(y.y(0));
    u(0) = 2.0;
  });
  Simulation simulation(motor(1e-3), controller, shaft(), 4);
  run(simulation, 41);
  ASSERT_EQ(times.size(), 11U);
  for (std::size_t k = 0; k < times.size(); ++k) {
    EXPECT_DOUBLE_EQ(times[k], 0.004 * static_cast<double>(k));
    EXPECT_NEAR(angles[k], times[k] * times[k], 1e-14);  // ½·2·t²: the angle at the same time
  }
}

TEST(Simulation, ShowsTheStateAtTheBeginningOfAStep) {
  FunctionController controller([](const Sample&, Eigen::Ref<Eigen::VectorXd> u) { u(0) = 2.0; });
  Simulation simulation(motor(), controller, shaft(), 2);
  run(simulation, 3);
  EXPECT_DOUBLE_EQ(simulation.time_s(), 0.002);
  EXPECT_TRUE(simulation.sampled());
  EXPECT_NEAR(simulation.qpos()[0], 0.002 * 0.002, 1e-15);
  EXPECT_NEAR(simulation.qvel()[0], 0.004, 1e-15);
  EXPECT_EQ(simulation.sensor("shaft_pos"), simulation.qpos()[0]);
  run(simulation, 1);
  EXPECT_FALSE(simulation.sampled());
}

TEST(Simulation, SaturatesAndRecordsIt) {
  Model model = Model::load(testing::source_file("models/arm.xml"));
  SensingSetup sensing;
  sensing.channels = {{.name = "q1", .sensor = "joint1_pos"}};
  double ask = 5.0;
  FunctionController controller(
      [&](const Sample&, Eigen::Ref<Eigen::VectorXd> u) { u << ask, -ask, 0.0; });
  Simulation simulation(std::move(model), controller, sensing, 1);
  simulation.set_collidable(simulation.model().id(mjOBJ_GEOM, "wall"), false);
  simulation.step();
  EXPECT_FALSE(simulation.saturated());
  EXPECT_EQ(simulation.actuation()(0), 5.0);
  ask = 100.0;
  simulation.step();
  EXPECT_TRUE(simulation.saturated());
  EXPECT_EQ(simulation.command()(0), 100.0);
  EXPECT_EQ(simulation.actuation()(0), 20.7360);
  EXPECT_EQ(simulation.actuation()(1), -20.7360);
  EXPECT_EQ(simulation.data().ctrl[0], 20.7360);
  ask = 20.7360;
  simulation.step();
  EXPECT_TRUE(simulation.saturated());
}

TEST(Simulation, SwitchesTheContactsOfOneGeom) {
  FunctionController controller([](const Sample&, Eigen::Ref<Eigen::VectorXd>) {});
  Simulation simulation(testing::model_of(R"(<mujoco><worldbody><geom size="1"/><geom size="1"/>
      <geom size="1"/></worldbody></mujoco>)"),
                        controller, {}, 1);
  const auto expect = [&](int first, int second, int third) {
    const int expected[] = {first, second, third};
    for (int i = 0; i < 3; ++i) {
      EXPECT_EQ(simulation.model()->geom_contype[i], expected[i]) << i;
      EXPECT_EQ(simulation.model()->geom_conaffinity[i], expected[i]) << i;
    }
  };
  simulation.set_collidable(2, false);
  expect(1, 1, 0);
  simulation.set_collidable(2, true);
  expect(1, 1, 1);
}

TEST(Simulation, ForcesActInTheSameStep) {
  class Wind final : public ExternalForce {
   public:
    void apply(double time_s, const mjModel& model, mjData& data) override {
      const int cart = mj_name2id(&model, mjOBJ_BODY, "cart");
      data.xfrc_applied[6 * cart] += time_s < 0.5 ? 3.0 : 0.0;
    }
  };
  FunctionController controller([](const Sample&, Eigen::Ref<Eigen::VectorXd> u) { u(0) = 0; });
  SensingSetup sensing;
  sensing.channels = {{.name = "z", .sensor = "cart_pos"}};
  Model model = Model::load(testing::source_file("models/cart.xml"));
  model.get()->dof_damping[0] = 0.0;
  Simulation simulation(std::move(model), controller, sensing, 10);
  Wind wind;
  simulation.add(wind);
  simulation.step();
  EXPECT_NEAR(simulation.data().qvel[0], 3.0 / 0.625 * 1e-3, 1e-15);
  run(simulation, 999);
  EXPECT_NEAR(simulation.data().qvel[0], 3.0 / 0.625 * 0.5, 0.01);
}

TEST(Simulation, IgnoresOtherDataOfTheSameEngine) {
  // The control law steps scratch data of its own, for example to linearise.
  const Model scratch_model = motor();
  mjData* scratch = mj_makeData(scratch_model.get());
  FunctionController controller([&](const Sample&, Eigen::Ref<Eigen::VectorXd> u) {
    mj_forward(scratch_model.get(), scratch);
    u(0) = 1;
  });
  Simulation simulation(motor(), controller, shaft(), 5);
  run(simulation, 20);
  EXPECT_EQ(controller.updates, 4);
  mj_step(scratch_model.get(), scratch);
  EXPECT_EQ(controller.updates, 4);
  mj_deleteData(scratch);
}

// Expects the run to fail. Returns the time and the reason.
RunFailure failure_of(Simulation& simulation, int steps) {
  try {
    run(simulation, steps);
  } catch (const RunFailure& failure) {
    return failure;
  }
  ADD_FAILURE() << "the run did not fail";
  return {0.0, ""};
}

TEST(Simulation, EndsOnAnEngineWarning) {
  FunctionController controller([](const Sample& y, Eigen::Ref<Eigen::VectorXd> u) {
    u(0) = 1e9 * std::exp(300.0 * y.time_s);
  });
  Simulation simulation(motor(), controller, shaft(), 1);
  const RunFailure failure = failure_of(simulation, 1000);
  EXPECT_GT(failure.time_s(), 0.0);
  EXPECT_LT(failure.time_s(), 0.1);
  const std::string reason = failure.what();
  EXPECT_TRUE(reason.starts_with("diverged: ") || reason.starts_with("an actuator command"))
      << reason;
  EXPECT_TRUE(has(reason, "Time = "));  // the engine's message
}

TEST(Simulation, EndsOnANanCommand) {
  FunctionController controller([](const Sample& y, Eigen::Ref<Eigen::VectorXd> u) {
    u(0) = y.time_s < 0.05 - 1e-9 ? 0.0 : std::nan("");
  });
  Simulation simulation(motor(), controller, shaft(), 1);
  const RunFailure failure = failure_of(simulation, 1000);
  EXPECT_DOUBLE_EQ(failure.time_s(), 0.05);
  EXPECT_STREQ(failure.what(), "command of actuator 1 is not finite");
}

TEST(Simulation, PassesAControllersExceptionOn) {
  FunctionController controller(
      [](const Sample&, Eigen::Ref<Eigen::VectorXd>) { throw std::logic_error("from the law"); });
  Simulation simulation(motor(), controller, shaft(), 1);
  EXPECT_THROW(simulation.step(), std::logic_error);
}

TEST(Simulation, FirstBrokenMeasurementEndsTheRun) {
  FunctionController controller([](const Sample&, Eigen::Ref<Eigen::VectorXd> u) { u(0) = 1; });
  SensingSetup setup = shaft();
  setup.fault = {"q", 0.1, 1};
  Simulation simulation(motor(), controller, setup, 10);
  const RunFailure failure = failure_of(simulation, 1000);
  EXPECT_DOUBLE_EQ(failure.time_s(), 0.1);
  EXPECT_STREQ(failure.what(), "sensor q is not finite");
}

TEST(Simulation, DropsBrokenMeasurementsIfAsked) {
  std::vector<double> seen;
  FunctionController controller([&](const Sample& y, Eigen::Ref<Eigen::VectorXd> u) {
    seen.push_back(y.y(0));
    u(0) = 1;
  });
  SensingSetup setup = shaft();
  setup.nan_policy = NanPolicy::drop;
  setup.fault = {"q", 0.1, 2};
  Simulation simulation(motor(), controller, setup, 10);
  run(simulation, 200);
  EXPECT_EQ(simulation.sensing().dropped(), 2);
  EXPECT_EQ(seen[10], seen[9]);
  EXPECT_EQ(seen[11], seen[9]);
  EXPECT_GT(seen[12], seen[9]);

  setup.fault.samples = 3;
  FunctionController another([](const Sample&, Eigen::Ref<Eigen::VectorXd> u) { u(0) = 1; });
  Simulation broken(motor(), another, setup, 10);
  EXPECT_DOUBLE_EQ(failure_of(broken, 200).time_s(), 0.12);
}

std::uint64_t hash_of_a_run(double torque) {
  FunctionController controller([=](const Sample& y, Eigen::Ref<Eigen::VectorXd> u) {
    u(0) = torque * std::cos(y.time_s) - y.y(0);
  });
  Simulation simulation(motor(), controller, shaft(), 5);
  run(simulation, 2000);
  return simulation.state_hash();
}

TEST(Simulation, EqualRunsHaveEqualHashesOnAnyThread) {
  const std::uint64_t expected = hash_of_a_run(1.0);
  EXPECT_EQ(hash_of_a_run(1.0), expected);
  EXPECT_NE(hash_of_a_run(1.0 + 1e-15), expected);
  std::uint64_t hashes[4] = {};
  {
    std::vector<std::jthread> threads;
    for (auto& hash : hashes) threads.emplace_back([&hash] { hash = hash_of_a_run(1.0); });
  }
  for (const auto hash : hashes) EXPECT_EQ(hash, expected);
}

TEST(Simulation, RefusesMismatchedSizes) {
  FunctionController controller([](const Sample&, Eigen::Ref<Eigen::VectorXd>) {});
  SensingSetup unknown = shaft();
  unknown.channels[0].sensor = "shaft_angle";
  EXPECT_REFUSED(Simulation(motor(), controller, unknown, 1));
  SensingSetup component = shaft();
  component.channels[0].component = 1;
  EXPECT_REFUSED(Simulation(motor(), controller, component, 1));
  SensingSetup fault = shaft();
  fault.fault.channel = "p";
  EXPECT_REFUSED(Simulation(motor(), controller, fault, 1));
  EXPECT_REFUSED(Simulation(motor(), controller, shaft(), 0));
  Simulation simulation(motor(), controller, shaft(), 1);
  const double two[2] = {0, 0};
  EXPECT_REFUSED(simulation.set_position(two));
}

TEST(EngineGuard, ReturnsTheTextOfAFatalError) {
  const std::string text = call_engine([](void*) { mju_error("out of stack"); }, nullptr);
  EXPECT_EQ(text, "out of stack");
  EXPECT_EQ(call_engine([](void*) {}, nullptr), "");
}

// mju_error_s, called as in the engine.
TEST(EngineGuardDeathTest, AnErrorOutsideIsPrintedBeforeTheAbort) {
  EXPECT_DEATH(
      {
        call_engine([] {});
        mju_error_s("no such thing: %s", "stack");
      },
      "MuJoCo: no such thing: stack");
}

// The error message for a model whose memory `spoil` has damaged.
std::string refusal(const std::function<void(mjModel&)>& spoil,
                    const std::function<void(Model&)>& body) {
  Model model = Model::load(testing::source_file("models/arm.xml"));
  spoil(*model.get());
  return complaint_of([&] { body(model); });
}

TEST(EngineGuard, RefusesAModelWithoutEnoughStack) {
  const std::string text =
      refusal([](mjModel& m) { m.nstack = 1; }, [](Model& model) { model.scale_inertia(2.0); });
  EXPECT_TRUE(text.ends_with("models/arm.xml: Stack overflow")) << text;
}

TEST(EngineGuard, RefusesASimulationTooLargeForMemory) {
  const auto spoil = [](mjModel& m) {
    m.njmax = 8000000;
  };  // the engine allocates the square of this number
  for (const std::string& text :
       {refusal(spoil, [](Model& model) { model.make_data(); }),
        refusal(spoil, [](Model& model) { model.scale_inertia(2.0); }),
        refusal(spoil, [](Model& model) {
          FunctionController controller([](const Sample&, Eigen::Ref<Eigen::VectorXd>) {});
          Simulation(std::move(model), controller, SensingSetup{}, 1);
        })}) {
    EXPECT_TRUE(text.ends_with("models/arm.xml: the engine has no memory for a simulation"))
        << text;
  }
}

TEST(SharedModels, AreCompiledOnceByAnyThread) {
  const std::string file = testing::source_file("models/arm.xml");
  int compiled = 0;
  const SharedModels shared([&](const std::string& which) {
    EXPECT_EQ(which, file);
    ++compiled;
    std::this_thread::sleep_for(std::chrono::milliseconds(50));  // waits for the other threads
  });
  {
    std::vector<std::jthread> threads;
    for (int i = 0; i < 4; ++i) threads.emplace_back([&] { Model::load(file); });
  }
  EXPECT_EQ(compiled, 1);
}

TEST(EngineGuard, LackOfMemoryIsNotAnErrorOfTheModel) {
  const Model model = motor();
  mju_user_malloc = [](std::size_t) -> void* { return nullptr; };
  EXPECT_THROW(model.make_data(), OutOfMemory);
  mju_user_malloc = nullptr;
  EXPECT_NO_THROW(model.make_data());
}

TEST(EngineGuard, FatalErrorsInsideAStepEndTheRun) {
  FunctionController controller([](const Sample&, Eigen::Ref<Eigen::VectorXd> u) { u(0) = 1; });
  Model model = motor();
  model.get()->opt.integrator = 77;
  Simulation simulation(std::move(model), controller, shaft(), 1);
  EXPECT_STREQ(failure_of(simulation, 1).what(), "Invalid integrator");
}

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

TEST(Friction, RefusesNonsense) {
  Model model = cart();
  EXPECT_REFUSED(author_friction(model, 0, -1.0, 0.0));
  EXPECT_REFUSED(author_friction(model, 0, 0.0, std::nan("")));
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
  EXPECT_REFUSED(model.scale_inertia(0.0));
  EXPECT_REFUSED(model.scale_inertia(INFINITY));
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
  EXPECT_REFUSED(model.limit_actuator(0, 0.0));
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
  EXPECT_REFUSED(Sensing(cart(), setup));
}

// A tool of 1 kg behind a turning wrist. Its sensor reads the force that holds it.
TEST(Sensing, TakesTheToolsWeightOffAsItTurns) {
  Model model = testing::model_of(R"(<mujoco><worldbody><body>
      <joint type="hinge" axis="0 1 0"/><inertial pos="0 0 0" mass="0.5" diaginertia="1 1 1"/>
      <body><inertial pos="0 0 0" mass="1" diaginertia="1 1 1"/><site name="flange"/></body>
      </body></worldbody><sensor><force name="flange" site="flange"/></sensor></mujoco>)");
  const DataPointer data = model.make_data();
  const auto sample_at = [&](Sensing& sensing, double angle_rad, double time_s) {
    data->qpos[0] = angle_rad;
    mj_forward(model.get(), data.get());
    sensing.after_step(*data);
    Sample sample;
    sample.time_s = time_s;
    sample.y.resize(3);
    sensing.take(0, *data, sample);
    return Eigen::Vector3d(sample.y);
  };
  const auto sensing_of = [&](double weighed_kg, double tare_at_s) {
    SensingSetup setup;
    for (const int i : {0, 1, 2}) {
      setup.channels.push_back({.name = "force" + std::to_string(i),
                                .sensor = "flange",
                                .component = i,
                                .weighed_kg = weighed_kg,
                                .tare_at_s = tare_at_s});
    }
    return Sensing(model, setup);
  };
  for (const double angle_rad : {0.0, 0.5 * M_PI, 2.1}) {
    const Eigen::Vector3d weight(-9.81 * std::sin(angle_rad), 0.0, 9.81 * std::cos(angle_rad));
    Sensing raw = sensing_of(0.0, SensorChannel::kNever);
    EXPECT_LT((sample_at(raw, angle_rad, 0.0) - weight).norm(), 1e-9);
    for (const double weighed_kg : {1.0, SensorChannel::kAllBeyond}) {
      Sensing weighed = sensing_of(weighed_kg, SensorChannel::kNever);
      EXPECT_LT(sample_at(weighed, angle_rad, 0.0).norm(), 1e-9);
    }
    Sensing half = sensing_of(0.5, SensorChannel::kNever);
    EXPECT_LT((sample_at(half, angle_rad, 0.0) - 0.5 * weight).norm(), 1e-9);
    // A tare holds for one direction alone.
    Sensing tared = sensing_of(0.0, 0.5);
    EXPECT_LT((sample_at(tared, 0.0, 0.4) - Eigen::Vector3d(0, 0, 9.81)).norm(), 1e-9);
    EXPECT_LT(sample_at(tared, 0.0, 0.5).norm(), 1e-9);
    EXPECT_LT((sample_at(tared, angle_rad, 0.6) - weight + Eigen::Vector3d(0, 0, 9.81)).norm(),
              1e-9);
  }
  model.get()->opt.disableflags |= mjDSBL_GRAVITY;
  Sensing weightless = sensing_of(1.0, SensorChannel::kNever);
  EXPECT_LT(sample_at(weightless, 2.1, 0.0).norm(), 1e-9);
}

}  // namespace breakwater::simulation_test
