// Laws of physics that the engine keeps, and the elementary functions that it calls.
#include <dlfcn.h>
#include <mujoco/mujoco.h>
#include <cstdio>

#include <breakwater/math/functions.h>
#include <breakwater/plants/planar_chain.h>
#include <breakwater/sim/engine_guard.h>
#include <breakwater/sim/simulation.h>
#include "sim/small_models.h"

namespace breakwater::physics_laws_test {

using testing::FunctionController;

// No torque acts on the arm. So its energy is constant, and so is its angular momentum about the
// first joint.
TEST(PhysicsLaws, AFreeArmKeepsItsEnergyAndAngularMomentum) {
  const PlanarChain chain = load_planar_chain(testing::source_file("models/arm.urdf"));
  Model model = Model::load(testing::source_file("models/arm.xml"));
  model.set_physics(1e-3, Integrator::rk4);
  for (int i = 0; i < 3; ++i) {
    model.get()->dof_frictionloss[i] = 0.0;
    model.add_armature(i, -0.99 * model->dof_armature[i]);  // the links couple strongly
  }
  const Eigen::Vector3d armature = Eigen::Map<const Eigen::Vector3d>(model->dof_armature);
  FunctionController controller([](const Sample&, Eigen::Ref<Eigen::VectorXd> u) { u.setZero(); });
  Simulation simulation(std::move(model), controller, {}, 1);
  simulation.set_collidable(simulation.model().id(mjOBJ_GEOM, "wall"), false);
  simulation.set_position(std::vector<double>{0.3, 1.0, -0.5});
  simulation.set_velocity(std::vector<double>{2.0, -3.0, 4.0});
  const auto momenta = [&]() -> Eigen::Vector3d {
    const Eigen::Map<const Eigen::Vector3d> q(simulation.data().qpos), dq(simulation.data().qvel);
    Eigen::Matrix3d M = chain.mass_matrix(q);
    M.diagonal() += armature;
    return M * dq;
  };
  const auto energy = [&] {
    return 0.5 * momenta().dot(Eigen::Map<const Eigen::Vector3d>(simulation.data().qvel));
  };
  const double first_energy = energy(), first_momentum = momenta()(0);
  double energy_change = 0.0, momentum_change = 0.0, speed_change = 0.0;
  for (int k = 0; k < 5000; ++k) {
    simulation.step();
    energy_change = std::max(energy_change, std::abs(energy() - first_energy));
    momentum_change = std::max(momentum_change, std::abs(momenta()(0) - first_momentum));
    speed_change = std::max(speed_change, std::abs(simulation.data().qvel[0] - 2.0));
  }
  EXPECT_LT(energy_change, 1e-8 * first_energy);
  EXPECT_LT(momentum_change, 1e-8 * std::abs(first_momentum));
  EXPECT_GT(speed_change, 1.0) << "the links exchange no energy";
}

// q̈ = u(k) − ω² q + cos(νt): the command is held, the spring and the wave act at every stage.
class SpringAndWave final : public ExternalForce {
 public:
  static constexpr double kOmega = 5.0, kNu = 7.0;
  void apply(double time_s, const mjModel&, mjData& data) override {
    data.qfrc_applied[0] += std::cos(kNu * time_s) - kOmega * kOmega * data.qpos[0];
  }
};

double command(int k) {
  return 10.0 * std::sin(0.7 * k);
}

constexpr double kPeriod_s = 0.04;
constexpr int kSamples = 25;

// The closed form: in each period, the particular solution and a free oscillation about it.
class ExactMotion {
 public:
  double position() const { return q_; }

  void pass_period(int k) {
    const double omega = SpringAndWave::kOmega, nu = SpringAndWave::kNu;
    const double amplitude = 1.0 / (omega * omega - nu * nu);
    const double t = k * kPeriod_s, after = t + kPeriod_s, held = command(k) / (omega * omega);
    const double free = q_ - held - amplitude * std::cos(nu * t);
    const double free_rate = dq_ + amplitude * nu * std::sin(nu * t);
    const double c = std::cos(omega * kPeriod_s), s = std::sin(omega * kPeriod_s);
    q_ = held + amplitude * std::cos(nu * after) + free * c + free_rate / omega * s;
    dq_ = -amplitude * nu * std::sin(nu * after) - free * omega * s + free_rate * c;
  }

 private:
  double q_ = 0.0, dq_ = 0.0;
};

double largest_error(Integrator integrator, int steps_per_sample) {
  Model model = Model::load(testing::source_file("models/motor.xml"));
  model.set_physics(kPeriod_s / steps_per_sample, integrator);
  FunctionController controller(
      [k = 0](const Sample&, Eigen::Ref<Eigen::VectorXd> u) mutable { u(0) = command(k++); });
  Simulation simulation(std::move(model), controller, {}, steps_per_sample);
  SpringAndWave force;
  simulation.add(force);
  ExactMotion exact;
  double largest = 0.0;
  for (int k = 0; k < kSamples; ++k) {
    for (int i = 0; i < steps_per_sample; ++i) simulation.step();
    exact.pass_period(k);
    largest = std::max(largest, std::abs(simulation.data().qpos[0] - exact.position()));
  }
  return largest;
}

TEST(PhysicsLaws, EachIntegratorHasItsOrderWithTheCallback) {
  const struct {
    Integrator integrator;
    int order;
    std::array<int, 3> steps_per_sample;
  } rows[] = {{Integrator::euler, 1, {40, 80, 160}},
              {Integrator::implicit, 1, {40, 80, 160}},
              {Integrator::rk4, 4, {4, 8, 16}}};
  for (const auto& [integrator, order, steps] : rows) {
    for (int i = 0; i < 2; ++i) {
      const double coarse = largest_error(integrator, steps[i]),
                   fine = largest_error(integrator, steps[i + 1]);
      EXPECT_NEAR(std::log2(coarse / fine), order, 0.1)
          << static_cast<int>(integrator) << ": " << coarse << " " << fine;
    }
  }
}

// How many of the results have other bits than the functions of math/ and of glibc.
struct Differences {
  int from_math = 0, from_glibc = 0;

  void count(double result, double math, double glibc) {
    from_math += static_cast<int>(result != math);
    from_glibc += static_cast<int>(result != glibc);
  }
};

TEST(EngineFunctions, MujocoCallsThoseOfMath) {
  engine_functions();
  Differences cosine, exponential;
  testing::Random random;
  const double axis[] = {0.0, 0.0, 1.0};
  for (int i = 0; i < 100000; ++i) {
    const double x = random.uniform(0.0, 3.0);
    double quaternion[4];
    mju_axisAngle2Quat(quaternion, axis, 2.0 * x);
    cosine.count(quaternion[0], math::cos(x), std::cos(x));
    // The decay of a critically damped spring from rest at 1: (1 + ωt) e^(−ωt).
    const double decayed = mju_springDamper(1.0, 0.0, 1.0, 2.0, x);
    exponential.count(decayed, (1.0 + x) * math::exp(-x), (1.0 + x) * std::exp(-x));
  }
  EXPECT_EQ(cosine.from_math, 0);
  EXPECT_GT(cosine.from_glibc, 0) << "the test sees no difference";
  EXPECT_EQ(exponential.from_math, 0);
}

TEST(EngineFunctions, ALibraryWithReadOnlyImportsIsRedirectedToo) {
  void* const library = dlopen(READ_ONLY_IMPORTS, RTLD_NOW);
  ASSERT_NE(library, nullptr) << dlerror();
  const auto tangent = reinterpret_cast<double (*)(double)>(dlsym(library, "tangent"));
  EXPECT_EQ(redirect_elementary_functions(reinterpret_cast<const void*>(tangent)),
            std::vector<std::string>{"tan"});
  int differences = 0;
  testing::Random random;
  for (int i = 0; i < 100000; ++i) {
    const double x = random.uniform(-1.5, 1.5);
    EXPECT_EQ(tangent(x), math::tan(x));
    differences += static_cast<int>(tangent(x) != std::tan(x));
  }
  EXPECT_GT(differences, 0) << "the test sees no difference";
  dlclose(library);
}

TEST(EngineFunctions, ALibraryWithoutSuchCallsIsRefused) {
  EXPECT_TRUE(has(complaint_of<std::runtime_error>([] { redirect_elementary_functions(stdout); }),
                  "libc.so"));
  int local = 0;
  EXPECT_THROW(redirect_elementary_functions(&local), std::runtime_error);
}

}  // namespace breakwater::physics_laws_test
