#include <breakwater/sim/wall_contact.h>

#include <cmath>
#include <memory>

#include <breakwater/sim/simulation.h>
#include "sim/small_models.h"

namespace breakwater::wall_contact_test {
namespace {

constexpr double kBall_kg = 0.5, kWall_kg = 1.5, kStiffness_N_m = 1e4, kSpeed_m_s = 0.3;
// The two masses oscillate on the spring of the contact.
const double kOmega_rad_s = std::sqrt(kStiffness_N_m * (1.0 / kBall_kg + 1.0 / kWall_kg));

// A ball that touches a free wall.
class Impact {
 public:
  Impact(Integrator integrator, double step_s)
      : controller_([](const Sample&, Eigen::Ref<Eigen::VectorXd>) {}),
        simulation_(model(integrator, step_s), controller_, {}, 1),
        contact_(simulation_.model(), "ball", "wall",
                 std::make_unique<KelvinVoigt>(kStiffness_N_m, 0.0, KelvinVoigt::By::force),
                 {.kind = WallMotionKind::free, .mass_kg = kWall_kg}) {
    contact_.set_solid(true);
    simulation_.add(contact_);
    const double speed = kSpeed_m_s;
    simulation_.set_velocity({&speed, 1});
  }
  void step() { simulation_.step(); }
  double time_s() const { return simulation_.data().time; }
  double ball_m() const { return simulation_.data().qpos[0]; }
  double ball_m_s() const { return simulation_.data().qvel[0]; }
  const WallContact& contact() const { return contact_; }

 private:
  static Model model(Integrator integrator, double step_s) {
    Model model = testing::model_of(R"(<mujoco><option gravity="0 0 0"/><worldbody>
      <geom name="wall" type="plane" size="1 1 1" zaxis="-1 0 0" contype="0" conaffinity="0"/>
      <body><inertial pos="0 0 0" mass="0.5" diaginertia="1 1 1"/>
        <joint name="x" type="slide" axis="1 0 0"/>
        <geom name="ball" type="sphere" size="0.02" pos="-0.02 0 0" mass="0" contype="0"
          conaffinity="0"/></body></worldbody></mujoco>)");
    model.set_physics(step_s, integrator);
    return model;
  }

  testing::FunctionController controller_;
  Simulation simulation_;
  WallContact contact_;
};

// Euler's method moves the wall by the new speed, as the engine moves the ball.
TEST(WallContact, AFreeWallMovesByTheSpeedThatTheForceGaveIt) {
  Impact impact(Integrator::euler, 1e-4);
  double impulse = 0.0, wall_m = 0.0;
  for (int k = 0; k < 400; ++k) {
    impact.step();
    ASSERT_NEAR(impact.contact().wall_m(), wall_m, 1e-15) << k;
    impulse += impact.contact().impulse_Ns();
    wall_m += 1e-4 * impulse / kWall_kg;
    ASSERT_NEAR(impact.ball_m_s(), kSpeed_m_s - impulse / kBall_kg, 1e-12) << k;
  }
  EXPECT_NEAR(impulse, 2.0 * kSpeed_m_s / (1.0 / kBall_kg + 1.0 / kWall_kg), 1e-3 * impulse);
}

// Two masses on a spring: half a period of a sine, then both are free.
TEST(WallContact, AFreeWallHasTheClosedFormsMotion) {
  Impact impact(Integrator::rk4, 1e-4);
  const double share = kBall_kg / (kBall_kg + kWall_kg), end_s = M_PI / kOmega_rad_s;
  for (double t = 0.0; t < 0.95 * end_s; t = impact.time_s()) {
    const double depth = kSpeed_m_s / kOmega_rad_s * std::sin(kOmega_rad_s * t);
    ASSERT_NEAR(impact.ball_m(), share * kSpeed_m_s * t + (1.0 - share) * depth, 1e-10) << t;
    impact.step();
    ASSERT_NEAR(impact.contact().wall_m(), share * (kSpeed_m_s * t - depth), 1e-10) << t;
    ASSERT_NEAR(impact.contact().force_N(), kStiffness_N_m * depth, 1e-6) << t;
  }
}

}  // namespace
}  // namespace breakwater::wall_contact_test
