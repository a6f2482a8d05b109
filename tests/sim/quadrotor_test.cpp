// The quadrotor's MJCF and its forces against the thesis' matrices, closed forms and an ODE.
#include <Eigen/Geometry>

#include <breakwater/sim/simulation.h>
#include <breakwater/sim/underwater_force.h>
#include "sim/small_models.h"

namespace breakwater::quadrotor_test {

using Vector12d = Eigen::Matrix<double, 12, 1>;
const Eigen::Vector3d kStart(0.0, 0.0, -10.0);

Model quadrotor(const QuadrotorParameters& vehicle = {}) {
  Model model = Model::load(testing::source_file("models/quadrotor.xml"));
  model.add_mass(model.id(mjOBJ_BODY, "quadrotor"),
                 vehicle.moving_mass_kg() - QuadrotorParameters().mass_kg);
  return model;
}

// Thrusts as a function of time, held for 10 ms as in the simulation.
using Thrusts = std::function<Eigen::Vector4d(double)>;

std::vector<Vector12d> simulate(QuadrotorPhysics physics, const WaveLoadSetup& waves,
                                const Thrusts& thrusts, double duration_s,
                                const QuadrotorParameters& vehicle = {}) {
  testing::FunctionController controller(
      [&](const Sample& y, Eigen::Ref<Eigen::VectorXd> u) { u = thrusts(y.time_s); });
  Simulation sim(quadrotor(vehicle), controller, {}, 10);
  UnderwaterForce water(sim.model(), vehicle, physics, waves, kStart);
  sim.add(water);
  sim.set_position(std::vector<double>{0, 0, -10, 1, 0, 0, 0});
  std::vector<Vector12d> states;
  for (int k = 0; k <= std::lround(duration_s / 1e-3); ++k) {
    sim.step();
    const FreeMotion m(sim.qpos().data(), sim.qvel().data());
    Vector12d state;
    state << m.position, m.euler, m.velocity, attitude_rates(AttitudeTrig(m.euler), m.body_rates);
    states.push_back(state);
    water.advance(sim.time_s(), FreeMotion(sim.data().qpos, sim.data().qvel));
  }
  return states;
}

// The same motion by RK4 on the thesis' equations in ζ.
std::vector<Vector12d> integrate(QuadrotorPhysics physics, const WaveLoadSetup& waves,
                                 const Thrusts& thrusts, double duration_s) {
  const QuadrotorModel model({}, physics);
  const Model file = quadrotor();
  const UnderwaterForce water(file, {}, physics, waves, kStart);
  const Eigen::Matrix4d B = thruster_matrix(model.parameters().thruster_arm_m);
  Vector12d x = Vector12d::Zero();
  x.head<3>() = kStart;
  std::vector<Vector12d> states;
  const double h = 1e-3;
  for (int k = 0; k <= std::lround(duration_s / h); ++k) {
    states.push_back(x);
    const Eigen::Vector4d U = B * thrusts(k / 10 * 1e-2);
    const auto rate = [&](double t, const Vector12d& s) {
      const Eigen::Quaterniond q = Eigen::AngleAxisd(s(5), Eigen::Vector3d::UnitZ()) *
                                   Eigen::AngleAxisd(s(4), Eigen::Vector3d::UnitY()) *
                                   Eigen::AngleAxisd(s(3), Eigen::Vector3d::UnitX());
      const double qpos[] = {s(0), s(1), s(2), q.w(), q.x(), q.y(), q.z()};
      const Vector6d v = s.tail<6>();
      Vector6d load = water.wave_load(t, FreeMotion(qpos, v.data()));
      load.tail<3>() = q.inverse() * Eigen::Vector3d(load.tail<3>());
      Vector12d dx;
      dx << v, model.acceleration(AttitudeTrig(s.segment<3>(3)), v, U, load);
      return dx;
    };
    const double t = h * k;
    const Vector12d k1 = rate(t, x), k2 = rate(t + 0.5 * h, x + 0.5 * h * k1),
                    k3 = rate(t + 0.5 * h, x + 0.5 * h * k2), k4 = rate(t + h, x + h * k3);
    x += h / 6.0 * (k1 + 2.0 * k2 + 2.0 * k3 + k4);
  }
  return states;
}

struct Deviation {
  double position_m = 0.0;
  double angle_rad = 0.0;
};
Deviation deviation(const std::vector<Vector12d>& a, const std::vector<Vector12d>& b) {
  Deviation d;
  for (std::size_t i = 0; i < a.size(); ++i) {
    d.position_m = std::max(d.position_m, (a[i] - b[i]).head<3>().norm());
    d.angle_rad = std::max(d.angle_rad, (a[i] - b[i]).segment<3>(3).norm());
  }
  return d;
}

TEST(QuadrotorModelFile, ActuatorsAreTheColumnsOfTheThrusterMatrix) {
  const Model model = quadrotor();
  mjData* d = mj_makeData(model.get());
  const Eigen::Matrix4d B = thruster_matrix(QuadrotorParameters().thruster_arm_m);
  mj_resetDataKeyframe(model.get(), d, model.id(mjOBJ_KEY, "home"));
  for (int i = 0; i < 4; ++i) {
    mju_zero(d->ctrl, 4);
    d->ctrl[i] = 1.0;
    mj_forward(model.get(), d);
    const Vector6d force = Eigen::Map<Vector6d>(d->qfrc_actuator);
    EXPECT_NEAR(force.head<2>().norm(), 0.0, 1e-12);
    EXPECT_NEAR((force.tail<4>() - B.col(i)).norm(), 0.0, 1e-9) << "thruster " << i + 1;
  }
  mj_deleteData(d);
}

TEST(QuadrotorModelFile, IsTable34) {
  const Model model = quadrotor();
  const QuadrotorParameters table;
  const int body = model.id(mjOBJ_BODY, "quadrotor");
  EXPECT_DOUBLE_EQ(model->body_mass[body], table.mass_kg);
  for (int i = 0; i < 3; ++i) {
    EXPECT_DOUBLE_EQ(model->body_inertia[3 * body + i], table.inertia_kgm2(i));
  }
  EXPECT_DOUBLE_EQ(-model->opt.gravity[2], table.gravity_m_s2);
  EXPECT_EQ(model->opt.density, 0.0);
  EXPECT_EQ(model->opt.viscosity, 0.0);
  EXPECT_DOUBLE_EQ(model->actuator_ctrlrange[1], table.thrust_limit_N);
}

// (m + ρ V C_a) v̇ = w − D v − F v² downwards, from rest at −10 m: the closed form of a fall with
// drag. The added mass has no weight.
TEST(QuadrotorForces, FreeSink) {
  for (const double added : {0.0, 0.5}) {
    QuadrotorParameters p;
    p.added_mass_coefficient = added;
    const auto states = simulate(
        QuadrotorPhysics::physical, {}, [](double) { return Eigen::Vector4d::Zero(); }, 2.0, p);
    EXPECT_NEAR(states.back()(2), added == 0.0 ? -13.62 : -12.70, 0.01);
    EXPECT_NEAR(states.back().head<2>().norm(), 0.0, 1e-12);

    const double mass_kg = 1.38 + 1.1 * added;
    const double a = p.quadratic_drag(2) / mass_kg, b = p.linear_drag(2) / mass_kg,
                 c = p.net_weight_N() / mass_kg;
    // v̇ = c − b v − a v² = a (v1 − v)(v + v2)
    const double root = std::sqrt(b * b + 4.0 * a * c);
    const double v1 = (root - b) / (2.0 * a), v2 = (root + b) / (2.0 * a);
    const double q = a * (v1 + v2), t = 2.0;
    // v = v1 v2 (e^{qt} − 1)/(v2 e^{qt} + v1). Its integral:
    const double fallen = v1 * t + std::log((v1 * std::exp(-q * t) + v2) / (v1 + v2)) / a;
    EXPECT_NEAR(states.back()(2), -10.0 - fallen, 1e-9) << added;
  }
}

TEST(QuadrotorForces, PlanarPitchMatchesTheOde) {
  const Thrusts thrusts = [](double t) {
    const double push = 0.02 * std::sin(2.0 * t);
    return Eigen::Vector4d(0.7, 0.7 + push, 0.7, 0.7 - push);
  };
  for (const QuadrotorPhysics physics : {QuadrotorPhysics::physical, QuadrotorPhysics::thesis}) {
    const Deviation d =
        deviation(simulate(physics, {}, thrusts, 5.0), integrate(physics, {}, thrusts, 5.0));
    EXPECT_LT(d.position_m, 5e-4);
    EXPECT_LT(d.angle_rad, 1e-4);
  }
}

WaveLoadSetup sea(WaveMode mode) {
  WaveLoadSetup waves;
  waves.mode = mode;
  waves.sea.significant_height_m = 2.0;
  return waves;
}

// The ODE uses φ̇, θ̇, ψ̇ as body rates, so it is accurate only for small angles.
TEST(QuadrotorForces, SmallMotionMatchesTheOde) {
  const Thrusts thrusts = [](double t) -> Eigen::Vector4d {
    return Eigen::Vector4d::Constant(0.7) +
           0.05 * Eigen::Vector4d(std::sin(2.0 * t), std::sin(3.0 * t), -std::sin(2.0 * t),
                                  -std::sin(3.0 * t) + 0.2 * std::sin(t));
  };
  for (const auto& [physics, waves] :
       {std::pair(QuadrotorPhysics::physical, WaveLoadSetup()),
        std::pair(QuadrotorPhysics::thesis, WaveLoadSetup()),
        std::pair(QuadrotorPhysics::physical, sea(WaveMode::physical))}) {
    const auto states = simulate(physics, waves, thrusts, 5.0);
    const Deviation d = deviation(states, integrate(physics, waves, thrusts, 5.0));
    EXPECT_LT(d.angle_rad, 1e-3);
    EXPECT_LT(d.position_m, 1e-2);
    double largest = 0.0;
    for (const Vector12d& s : states) {
      largest = std::max(largest, s.segment<3>(3).cwiseAbs().maxCoeff());
    }
    EXPECT_GT(largest, 1e-2);  // the vehicle moves
  }
}

// The two plants differ by the thesis' lateral pull of the net weight when tilted.
TEST(QuadrotorForces, ThesisWeightDoublesTheLateralForce) {
  const QuadrotorParameters p;
  const QuadrotorModel physical(p, QuadrotorPhysics::physical);
  const QuadrotorModel thesis(p, QuadrotorPhysics::thesis);
  const AttitudeTrig tilted(Eigen::Vector3d(0.0, 0.1, 0.0));
  const Eigen::Vector4d hover(p.net_weight_N(), 0, 0, 0);
  const double a = physical.acceleration(tilted, Vector6d::Zero(), hover)(0);
  EXPECT_NEAR(a, p.net_weight_N() / p.mass_kg * std::sin(0.1), 1e-12);
  EXPECT_NEAR(thesis.acceleration(tilted, Vector6d::Zero(), hover)(0), 2.0 * a, 1e-12);
}

// The water on a page is that of the simulation.
TEST(WaveLoads, TheSurfaceIsTheSumOfItsWaves) {
  const Model model = quadrotor();
  WaveLoadSetup setup = sea(WaveMode::physical);
  setup.sea.heading_rad = 0.6;
  setup.change_at_s = 20.0;
  setup.change_to_period_s = 5.0;
  const UnderwaterForce force(model, {}, QuadrotorPhysics::physical, setup, kStart);
  const auto waves = setup.water().plane_waves();
  EXPECT_EQ(waves.size(), 2U * static_cast<std::size_t>(setup.sea.components));
  for (const double time_s : {0.0, 13.0, 24.0, 31.0, 80.0}) {
    for (const double x : {-50.0, 3.0}) {
      double sum = 0.0;
      for (const auto& [a, k_x, k_y, omega, phase, before, after, from_s, to_s] : waves) {
        const double changed = std::clamp((time_s - from_s) / (to_s - from_s), 0.0, 1.0);
        sum += (before + changed * (after - before)) * a *
               std::cos(k_x * x + k_y * 7.0 - omega * time_s + phase);
      }
      EXPECT_NEAR(sum, force.elevation(time_s, x, 7.0), 1e-12);
    }
  }
}

// A vehicle that moves with the water has no drag. Only the pressure force remains.
TEST(WaveLoads, NoDragOnAVehicleThatMovesWithTheWater) {
  const Model model = quadrotor();
  WaveLoadSetup setup = sea(WaveMode::physical);
  setup.current_m_s << 0.3, -0.2, 0.0;
  const QuadrotorParameters p;
  const UnderwaterForce force(model, p, QuadrotorPhysics::physical, setup, kStart);
  const WaterMotion water = Waves(setup.sea, setup.low_pass_s).at(3.0, kStart);
  const Eigen::Vector3d u = water.velocity + setup.current_m_s;
  const double qpos[] = {0, 0, -10, 1, 0, 0, 0};
  const double qvel[] = {u.x(), u.y(), u.z(), 0, 0, 0};
  Vector6d velocity = Vector6d::Zero();
  velocity.head<3>() = u;
  const Vector6d load = force.wave_load(3.0, FreeMotion(qpos, qvel)) - p.drag(velocity);
  EXPECT_NEAR((load.head<3>() - 1.1 * 1.5 * water.acceleration).norm(), 0.0, 1e-12);
}

// Without drag a vehicle moves ρ V C_m/(m + ρ V C_a) times as far as small waves move the water. A
// neutral one follows it if C_m = 1 + C_a.
TEST(WaveLoads, ANeutralVehicleFollowsTheWater) {
  struct Row {
    double mass_kg, C_a, C_m, ratio;
  };
  for (const Row& row : {Row{1.1, 0.5, 1.5, 1.0}, Row{1.1, 0.0, 1.0, 1.0}, Row{1.1, 0.9, 1.9, 1.0},
                         Row{1.38, 0.5, 1.5, 0.8549}, Row{1.1, 0.0, 1.5, 1.5}}) {
    QuadrotorParameters vehicle;
    vehicle.mass_kg = row.mass_kg;
    vehicle.added_mass_coefficient = row.C_a;
    vehicle.linear_drag.setZero();
    vehicle.quadratic_drag.setZero();
    WaveLoadSetup setup = sea(WaveMode::physical);
    setup.sea.significant_height_m = 1e-3;
    setup.inertia_coefficient = row.C_m;
    setup.buoyancy_arm_m = 0.0;  // no torque, so the thrust stays vertical
    const double duration_s = 8.0, h = 1e-3;
    const Eigen::Vector4d hover = Eigen::Vector4d::Constant(vehicle.net_weight_N() / 4.0);
    const auto states = simulate(
        QuadrotorPhysics::physical, setup, [&](double) { return hover; }, duration_s, vehicle);
    const Waves waves(setup.sea, setup.low_pass_s);
    const Eigen::Vector3d first = waves.at(0.0, kStart).velocity;
    Eigen::Vector3d water = Eigen::Vector3d::Zero();  // relative to a start at rest
    for (int k = 0; k < std::lround(duration_s / h); ++k) {
      water += h * (waves.at(h * (k + 0.5), kStart).velocity - first);
    }
    const Eigen::Vector3d vehicle_moved = states.back().head<3>() - kStart;
    EXPECT_NEAR((vehicle_moved - row.ratio * water).norm(), 0.0, 1e-3 * water.norm()) << row.C_a;
  }
}

// 0.13 N RMS per metre of H_s at 10 m.
TEST(WaveLoads, PhysicalForceHasItsSize) {
  const Model model = quadrotor();
  const double qpos[] = {0, 0, -10, 1, 0, 0, 0};
  const double qvel[] = {0, 0, 0, 0, 0, 0};
  double sum = 0.0;
  const UnderwaterForce force(model, {}, QuadrotorPhysics::physical, sea(WaveMode::physical),
                              kStart);
  const int samples = 20000;
  for (int i = 0; i < samples; ++i) {
    const double f = force.wave_load(0.1 * i, FreeMotion(qpos, qvel))(2);
    sum += f * f;
  }
  EXPECT_NEAR(std::sqrt(sum / samples) / 2.0, 0.13, 0.01);
}

// The thesis' force is along the body's axis. Its angle jumps by π with the sign of d_z.
TEST(WaveLoads, ThesisTorqueJumps) {
  const Model model = quadrotor();
  UnderwaterForce force(model, {}, QuadrotorPhysics::thesis, sea(WaveMode::thesis), kStart);
  const double tilt = 0.1;
  const double qpos[] = {0, 0, -10, std::cos(tilt / 2), std::sin(tilt / 2), 0, 0};
  const double qvel[] = {0, 0, 0, 0, 0, 0};
  const FreeMotion tilted(qpos, qvel);
  double lowest = 0.0, highest = 0.0;
  for (int k = 0; k < 20000; ++k) {
    force.advance(1e-3 * k, tilted);
    const Vector6d load = force.wave_load(1e-3 * k, tilted);
    EXPECT_NEAR(load.head<3>().cross(tilted.rotation.col(2)).norm(), 0.0, 1e-12);
    const double torque = tilted.rotation.col(0).dot(load.tail<3>());
    lowest = std::min(lowest, torque);
    highest = std::max(highest, torque);
  }
  // Upwards atan2 gives −tilt, downwards π − tilt, times 0.1 N m/rad.
  EXPECT_NEAR(lowest, -0.1 * tilt, 1e-4);
  EXPECT_NEAR(highest, 0.1 * (M_PI - tilt), 1e-3);
}

TEST(WaveLoads, StillWaterGivesNone) {
  const Model model = quadrotor();
  for (const WaveMode mode : {WaveMode::physical, WaveMode::thesis}) {
    WaveLoadSetup setup;
    setup.mode = mode;
    UnderwaterForce force(model, {}, QuadrotorPhysics::physical, setup, kStart);
    const double qpos[] = {0, 0, -10, 1, 0, 0, 0};
    const double qvel[] = {0.1, 0.2, 0.3, 0, 0, 0};
    force.advance(0.0, FreeMotion(qpos, qvel));
    EXPECT_EQ(force.wave_load(1.0, FreeMotion(qpos, qvel)).norm(), 0.0);
  }
}

}  // namespace breakwater::quadrotor_test
