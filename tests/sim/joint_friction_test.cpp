#include <breakwater/sim/external_force.h>
#include <breakwater/sim/joint_friction.h>
#include <breakwater/sim/simulation.h>
#include "python.h"
#include "sim/small_models.h"

namespace breakwater::joint_friction_test {

using testing::FunctionController;
using Force = std::function<double(double time_s, double position_m, double velocity_m_s)>;

struct Slider {
  double mass_kg = 1.0;
  StribeckFriction::Curve curve = {
      .coulomb = 1.0, .static_ratio = 1.5, .velocity = 0.001, .exponent = 2.0};
  Bristles bristles = {1e5, std::sqrt(1e5)};
  double viscous = 0.4;
  Integrator integrator = Integrator::euler;
  double step_s = 1e-4;
};

Slider without_bristles() {
  Slider slider;
  slider.curve.velocity = 0.02;
  slider.bristles = {};
  return slider;
}

// A mass on a slide with friction, and a force.
class Bench {
 public:
  Bench(const Slider& slider, Force force, std::unique_ptr<FrictionLaw> law)
      : controller_([force](const Sample& y, Eigen::Ref<Eigen::VectorXd> u) {
          u(0) = force(y.time_s, y.y(0), y.y(1));
        }) {
    std::ostringstream mjcf;
    mjcf
        << R"(<mujoco><option gravity="0 0 0"/><worldbody><body><inertial pos="0 0 0" mass=")"
        << slider.mass_kg << R"(" diaginertia="1 1 1"/><joint name="x" type="slide" axis="1 0 0"/>)"
        << R"(</body></worldbody><actuator><motor name="push" joint="x"/></actuator>)"
        << R"(<sensor><jointpos name="x" joint="x"/><jointvel name="v" joint="x"/></sensor></mujoco>)";
    Model model = testing::model_of(mjcf.str());
    model.set_physics(slider.step_s, slider.integrator);
    author_friction(model, 0, slider.viscous, slider.curve.coulomb);
    if (law) friction_ = std::make_unique<JointFriction>(model, "x", std::move(law));
    SensingSetup sensing;
    sensing.channels = {{.name = "x", .sensor = "x"}, {.name = "v", .sensor = "v"}};
    simulation_ = std::make_unique<Simulation>(std::move(model), controller_, sensing, 1);
    if (friction_) simulation_->add(*friction_);
  }
  Bench(const Slider& slider, Force force)
      : Bench(slider, std::move(force),
              std::make_unique<StribeckFriction>(slider.curve, slider.bristles)) {}

  // Runs to a time. Positions and velocities are those at its end.
  void run_to(double time_s) {
    const auto steps = static_cast<std::int64_t>(std::round(time_s / simulation_->timestep_s()));
    while (simulation_->steps() < steps) simulation_->step();
  }
  double position() const { return simulation_->data().qpos[0]; }
  double velocity() const { return simulation_->data().qvel[0]; }
  Simulation& simulation() { return *simulation_; }
  const JointFriction& friction() const { return *friction_; }

 private:
  FunctionController controller_;
  std::unique_ptr<JointFriction> friction_;
  std::unique_ptr<Simulation> simulation_;
};

struct Task {
  double amplitude_N = 0.0;
  double omega_rad_s = 1.0;
  double pull_N_m = 0.0;
  double pull_m_s = 0.0;
  double duration_s = 1.0;

  Force force() const {
    return [task = *this](double t, double x, double) {
      return task.amplitude_N * std::sin(task.omega_rad_s * t) +
             task.pull_N_m * (task.pull_m_s * t - x);
    };
  }
};

constexpr int kOutputs = 400;

std::vector<double> by_scipy(const Slider& slider, const Task& task) {
  std::ostringstream input;
  input.precision(17);
  input << slider.mass_kg << ' ' << slider.curve.coulomb << ' ' << slider.curve.static_ratio << ' '
        << slider.curve.velocity << ' ' << slider.bristles.stiffness << ' '
        << slider.bristles.damping << ' ' << slider.viscous << ' ' << task.amplitude_N << ' '
        << task.omega_rad_s << ' ' << task.pull_N_m << ' ' << task.pull_m_s << ' '
        << task.duration_s << ' ' << kOutputs;
  return testing::run_python("sim/scipy_friction.py", input.str());
}

// The largest difference of the positions, over the largest position.
double difference(const Slider& slider, const Task& task, const std::vector<double>& reference) {
  Bench bench(slider, task.force());
  double most = 0.0, largest = 0.0;
  for (std::size_t i = 0; i < reference.size(); ++i) {
    bench.run_to(task.duration_s * static_cast<double>(i + 1) / kOutputs);
    most = std::max(most, std::abs(bench.position() - reference[i]));
    largest = std::max(largest, std::abs(reference[i]));
  }
  return most / largest;
}

constexpr Integrator kAll[] = {Integrator::euler, Integrator::rk4, Integrator::implicit};

TEST(JointFriction, BristlesHaveThePreslidingHysteresisOfAFineIntegration) {
  Slider slider;
  const Task task = {.amplitude_N = 0.9, .omega_rad_s = 6.0, .duration_s = 2.0};
  const std::vector<double> reference = by_scipy(slider, task);
  ASSERT_EQ(reference.size(), kOutputs);
  for (const Integrator integrator : kAll) {
    slider.integrator = integrator;
    EXPECT_LT(difference(slider, task, reference), 0.005) << static_cast<int>(integrator);
  }
}

TEST(JointFriction, StickSlipIsThatOfAFineIntegration) {
  const Task task = {.pull_N_m = 2.0, .pull_m_s = 0.1, .duration_s = 20.0};
  for (Slider slider : {Slider(), without_bristles()}) {
    const std::vector<double> reference = by_scipy(slider, task);
    ASSERT_EQ(reference.size(), kOutputs);
    for (const Integrator integrator : kAll) {
      slider.integrator = integrator;
      EXPECT_LT(difference(slider, task, reference), 0.005)
          << slider.bristles.stiffness << ' ' << static_cast<int>(integrator);
    }
  }
}

TEST(JointFriction, SlidesSteadilyAtTheLevelOfItsSpeed) {
  for (Slider slider : {Slider(), without_bristles()}) {
    for (const Integrator integrator : kAll) {
      slider.integrator = integrator;
      for (const double speed : {0.01, 0.03, 0.1, 1.0}) {
        // A servo holds the speed, so that the falling part of the curve is stable.
        Bench bench(slider, [speed](double, double, double v) { return 1e3 * (speed - v); });
        bench.run_to(1.0);
        double sum = 0.0;
        for (int k = 0; k < 1000; ++k) {
          bench.simulation().step();
          sum -= bench.friction().force();
        }
        const double level = StribeckFriction(slider.curve).level(bench.velocity(), 0.0);
        EXPECT_NEAR(sum / 1000.0, level, 0.005 * level)
            << speed << ' ' << slider.bristles.stiffness << ' ' << static_cast<int>(integrator);
      }
    }
  }
}

TEST(JointFriction, BristlesHoldALoadWithoutCreep) {
  for (const Integrator integrator : kAll) {
    Slider slider;
    slider.integrator = integrator;
    Bench bench(slider, [](double, double, double) { return 0.8; });
    bench.run_to(1.0);
    const double start_m = bench.position();
    EXPECT_NEAR(start_m, 1.5 / 1e5 * -std::log(1.0 - 0.8 / 1.5), 1e-5);
    bench.run_to(integrator == Integrator::euler ? 100.0 : 10.0);
    EXPECT_LT(std::abs(bench.position() - start_m), 1e-9) << static_cast<int>(integrator);
  }
}

TEST(JointFriction, BristlesAreStableOnAnyMassAndStep) {
  for (const Integrator integrator : kAll) {
    for (const double mass_kg : {1e-4, 1e-2, 1.0}) {
      for (const double step_s : {1e-4, 1e-3}) {
        Slider slider;
        slider.mass_kg = mass_kg;
        slider.step_s = step_s;
        slider.integrator = integrator;
        slider.viscous = std::min(0.4, mass_kg / step_s);  // within the stability of RK4
        Bench bench(slider, [](double t, double, double) { return t < 0.5 ? 3.0 : 0.5; });
        bench.run_to(0.5);
        EXPECT_GT(bench.velocity(), 0.0);
        EXPECT_LE(bench.velocity(), 2.0 / slider.viscous + 1e-6);
        bench.run_to(2.0);
        EXPECT_LT(std::abs(bench.velocity()), 1e-6)
            << static_cast<int>(integrator) << ' ' << mass_kg << ' ' << step_s;
      }
    }
  }
}

TEST(JointFriction, NeverAddsEnergyOverACycle) {
  for (Slider slider : {Slider(), without_bristles()}) {
    for (const Integrator integrator : kAll) {
      slider.integrator = integrator;
      for (const double amplitude_N : {0.5, 1.2, 2.0, 20.0}) {
        for (const double period_s : {0.05, 0.5}) {
          const double omega = 2.0 * M_PI / period_s;
          Bench bench(slider, [amplitude_N, omega](double t, double, double) {
            return amplitude_N * std::sin(omega * t);
          });
          bench.run_to(4.0 * period_s);
          double work_J = 0.0;
          const double end_s = 5.0 * period_s;
          while (bench.simulation().time_s() < end_s) {
            const double before = bench.position();
            bench.simulation().step();
            work_J += bench.friction().force() * (bench.position() - before);
          }
          EXPECT_LT(work_J, 1e-15) << amplitude_N << ' ' << period_s;
        }
      }
    }
  }
}

TEST(JointFriction, AFlatStribeckCurveIsCoulombFriction) {
  Slider slider = without_bristles();
  slider.curve.static_ratio = 1.0;
  for (const Integrator integrator : kAll) {
    slider.integrator = integrator;
    const auto force = [](double t, double, double) { return 3.0 * std::sin(5.0 * t); };
    Bench stribeck(slider, force);
    Bench coulomb(slider, force, nullptr);
    stribeck.run_to(2.0);
    coulomb.run_to(2.0);
    EXPECT_EQ(stribeck.simulation().state_hash(), coulomb.simulation().state_hash());
  }
}

TEST(JointFriction, ALoadedGearNeedsMoreForce) {
  // It moves where |τ| > F_C + μ |τ|, with the acceleration (|τ| (1 − μ) − F_C)/m.
  Slider slider;
  slider.viscous = 0.0;
  for (const double force_N : {1.2, -4.0}) {
    Bench bench(
        slider, [force_N](double, double, double) { return force_N; },
        std::make_unique<LoadDependentFriction>(1.0, 0.25));
    bench.run_to(1.0);
    const double left_N = std::abs(force_N) * 0.75 - 1.0;
    EXPECT_NEAR(std::abs(bench.velocity()), std::max(left_N, 0.0), 1e-3);
    EXPECT_NEAR(std::abs(bench.friction().force()), left_N > 0.0 ? 1.0 + 0.25 * 4.0 : 1.2, 2e-3);
  }
}

// A disturbance on the load of a transmission does not press its teeth together; its torque does.
TEST(JointFriction, LoadOfATransmissionRubsByTheTorqueTransmitted) {
  for (const double torque_Nm : {0.0, 2.0}) {
    Model model = Model::load(testing::source_file("models/two_inertia.xml"));
    author_friction(model, model.id(mjOBJ_JOINT, "load"), 0.0, 0.1);
    const Transmission transmission(model, "motor", "load", {.stiffness = 50.0});
    JointForce disturbance(model, "load");
    disturbance.hold(1.0);
    JointFriction friction(model, "load", std::make_unique<LoadDependentFriction>(0.1, 0.5),
                           &transmission);
    FunctionController controller(
        [](const Sample&, Eigen::Ref<Eigen::VectorXd> u) { u.setZero(); });
    SensingSetup sensing;
    sensing.channels = {{.name = "angle", .sensor = "load_pos"}};
    Simulation simulation(std::move(model), controller, sensing, 1);
    simulation.add(disturbance);
    simulation.add(transmission);
    simulation.add(friction);
    simulation.set_position(std::array{torque_Nm / 50.0, 0.0});
    simulation.set_velocity(std::array{1.0, 1.0});
    simulation.step();
    EXPECT_NEAR(friction.force(), -(0.1 + 0.5 * torque_Nm), 0.01) << torque_Nm;
  }
}

TEST(JointFriction, RefusesWhatIsNoFriction) {
  using Curve = StribeckFriction::Curve;
  const std::vector<std::function<void()>> wrong = {
      [] { StribeckFriction(Curve{.coulomb = 0.0}); },
      [] { StribeckFriction(Curve{.coulomb = 1.0, .static_ratio = 0.9}); },
      [] { StribeckFriction(Curve{.coulomb = 1.0, .velocity = 0.0}); },
      [] { StribeckFriction(Curve{.coulomb = 1.0, .exponent = 0.0}); },
      [] {
        StribeckFriction(Curve{.coulomb = 1.0}, {-1.0, 0.0});
      },
      [] {
        StribeckFriction(Curve{.coulomb = 1.0}, {1.0, std::nan("")});
      },
      [] { LoadDependentFriction(0.0, 0.1); },
      [] { LoadDependentFriction(1.0, 1.0); },
      [] { LoadDependentFriction(1.0, -0.1); }};
  for (std::size_t i = 0; i < wrong.size(); ++i) {
    EXPECT_REFUSED(wrong[i]()) << i;
  }
  Model model = Model::load(testing::source_file("models/cart.xml"));
  model.get()->opt.solver = mjSOL_PGS;
  EXPECT_TRUE(has(complaint_of([&] {
                    JointFriction(model, "rail",
                                  std::make_unique<StribeckFriction>(Curve{.coulomb = 1.0},
                                                                     Bristles{1.0, 0.0}));
                  }),
                  "friction with bristles needs the solver Newton or CG"));
}

}  // namespace breakwater::joint_friction_test
