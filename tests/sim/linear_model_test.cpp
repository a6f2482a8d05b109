// A linearised plant and its joint inertia against closed forms.
#include <breakwater/sim/linear_model.h>
#include <breakwater/sim/transmission.h>

#include <cmath>

#include "support.h"

namespace breakwater {
namespace {

struct LinearModelTest : ::testing::Test {
  // A model of the MJCF text inside <worldbody>, and of `motors`.
  Model model(const std::string& bodies, const std::string& motors) {
    const std::string file = (root_ / "plant.xml").string();
    std::filesystem::create_directories(std::filesystem::path(file).parent_path());
    std::ofstream(file) << "<mujoco><compiler angle=\"radian\"/><option gravity=\"0 0 -9.81\"/>"
                           "<worldbody>"
                        << bodies << "</worldbody><actuator>" << motors << "</actuator></mujoco>";
    return Model::load(file);
  }

  testing::TemporaryPath root_{"linear_model"};
};

constexpr const char* kCart =
    "<body><inertial pos='0 0 0' mass='2' diaginertia='1e-6 1e-6 1e-6'/>"
    "<joint name='rail' type='slide' axis='1 0 0' damping='0.4'/>"
    "<body><inertial pos='0 0 0.5' mass='0.3' diaginertia='0.02 0.02 0.02'/>"
    "<joint name='pole' type='hinge' axis='0 1 0'/></body></body>";

// (M + m) ẍ + m l θ̈ = u − c ẋ and m l ẍ + (I + m l²) θ̈ = m g l θ about the upright pole.
TEST_F(LinearModelTest, PendulumOnACart) {
  const LinearModel linear =
      linearise(model(kCart, "<motor joint='rail'/>"), std::vector<double>{0.2, 0.0}, {0, 1}, {0});
  const double M = 2.3, ml = 0.15, J = 0.02 + 0.3 * 0.25, g = 9.81, c = 0.4;
  const double det = M * J - ml * ml;
  Eigen::MatrixXd A = Eigen::MatrixXd::Zero(4, 4);
  A.topRightCorner(2, 2).setIdentity();
  A.row(2) << 0.0, -ml * ml * g / det, -J * c / det, 0.0;
  A.row(3) << 0.0, M * ml * g / det, ml * c / det, 0.0;
  const Eigen::Vector4d B(0.0, 0.0, J / det, -ml / det);
  EXPECT_LT((linear.plant.A - A).cwiseAbs().maxCoeff(), 1e-6);
  EXPECT_LT((linear.plant.B - B).cwiseAbs().maxCoeff(), 1e-8);
  EXPECT_EQ(linear.plant.C, (Eigen::MatrixXd::Identity(2, 4)));
  EXPECT_NEAR(linear.held_input(0), 0.0, 1e-9);
  EXPECT_NEAR(linear.acceleration, 0.0, 1e-9);
}

// A driven pole is held against gravity: u₀ = −m g l sin θ.
TEST_F(LinearModelTest, HoldsThePose) {
  const LinearModel linear =
      linearise(model("<body><inertial pos='0 0 0.5' mass='0.3' diaginertia='0.02 0.02 0.02'/>"
                      "<joint name='pole' type='hinge' axis='0 1 0'/></body>",
                      "<motor joint='pole'/>"),
                std::vector<double>{0.7}, {0}, {0});
  EXPECT_NEAR(linear.held_input(0), -0.3 * 9.81 * 0.5 * std::sin(0.7), 1e-9);
  EXPECT_NEAR(linear.plant.A(1, 0), 0.3 * 9.81 * 0.5 * std::cos(0.7) / (0.02 + 0.3 * 0.25), 1e-6);
}

// M₁₁ = I₁ + I₂ + m₁ c₁² + m₂ (l₁² + c₂² + 2 l₁ c₂ cos q₂), M₁₂ = I₂ + m₂ (c₂² + l₁ c₂ cos q₂),
// M₂₂ = I₂ + m₂ c₂².
TEST_F(LinearModelTest, InertiaOfTwoLinks) {
  const Model arm = model(
      "<body><inertial pos='0.15 0 0' mass='2' diaginertia='1e-3 1.5e-2 1.5e-2'/>"
      "<joint type='hinge' axis='0 0 1'/>"
      "<body pos='0.3 0 0'><inertial pos='0.125 0 0' mass='1' diaginertia='1e-3 6e-3 6e-3'/>"
      "<joint type='hinge' axis='0 0 1'/></body></body>",
      "");
  const double q = 0.9, coupling = 0.3 * 0.125 * std::cos(q), own = 6e-3 + 0.125 * 0.125;
  const Eigen::MatrixXd M = joint_inertia(arm, std::vector<double>{0.4, q});
  EXPECT_NEAR(M(0, 0), 1.5e-2 + 2 * 0.15 * 0.15 + 0.09 + own + 2 * coupling, 1e-12);
  EXPECT_NEAR(M(0, 1), own + coupling, 1e-12);
  EXPECT_NEAR(M(1, 0), own + coupling, 1e-12);
  EXPECT_NEAR(M(1, 1), own, 1e-12);
}

// A motor holds a pendulum at θ through a gear and a spring. T = −m g l sin θ, u₀ = T/N, and the
// motor stands N T/K further. The rows of A are those of the two inertias, with gravity.
TEST_F(LinearModelTest, PendulumBehindASpring) {
  const double N = 3.0, K = 50.0, D = 0.1, J_m = 0.01, J_l = 0.02 + 0.3 * 0.25, angle = 0.7;
  Model drive = model(
      "<body><inertial pos='0 0 0' mass='1' diaginertia='0.01 0.01 0.01'/>"
      "<joint name='motor' type='hinge' axis='0 1 0'/></body>"
      "<body><inertial pos='0 0 0.5' mass='0.3' diaginertia='0.02 0.02 0.02'/>"
      "<joint name='pole' type='hinge' axis='0 1 0'/></body>",
      "<motor joint='motor'/>");
  const Transmission spring(drive, "motor", "pole", {.ratio = N, .stiffness = K, .damping = D});
  const LinearModel linear =
      linearise(std::move(drive), std::vector<double>{N * angle, angle}, {1}, {0}, {{&spring, 0}});
  const double torque = -0.3 * 9.81 * 0.5 * std::sin(angle);
  EXPECT_NEAR(linear.held_input(0), torque / N, 1e-9);
  EXPECT_NEAR(linear.qpos(0), N * (angle + torque / K), 1e-9);
  EXPECT_EQ(linear.qpos(1), angle);
  EXPECT_NEAR(linear.acceleration, 0.0, 1e-8);
  const double gravity = 0.3 * 9.81 * 0.5 * std::cos(angle);
  Eigen::MatrixXd A(2, 4);
  A << -K / (N * N * J_m), K / (N * J_m), -D / (N * N * J_m), D / (N * J_m),  //
      K / (N * J_l), (gravity - K) / J_l, D / (N * J_l), -D / J_l;
  EXPECT_LT((linear.plant.A.bottomRows(2) - A).cwiseAbs().maxCoeff(), 1e-5);
  EXPECT_NEAR(linear.plant.B(2, 0), 1.0 / J_m, 1e-6);
}

TEST_F(LinearModelTest, RefusesABall) {
  EXPECT_THROW(linearise(model("<body><inertial pos='0 0 0' mass='1' diaginertia='1 1 1'/>"
                               "<joint type='ball'/></body>",
                               ""),
                         std::vector<double>{1, 0, 0, 0}, {}, {}),
               std::invalid_argument);
}

}  // namespace
}  // namespace breakwater
