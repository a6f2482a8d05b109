#include <breakwater/sim/contact.h>

#include <cmath>

#include "sim/small_models.h"

namespace breakwater {
namespace {

// A ball of mass m on a slide with a motor, 0.1 m before a wall.
Model ball_and_wall(double mass, double armature) {
  return testing::model_of(R"(<mujoco>
    <option timestep="1e-5" gravity="0 0 0" jacobian="dense"/>
    <worldbody>
      <geom name="wall" type="plane" size="1 1 1" pos="0.1 0 0" zaxis="-1 0 0" condim="1"/>
      <body name="ball"><inertial pos="0 0 0" mass=")" +
                           std::to_string(mass) + R"(" diaginertia="1e-3 1e-3 1e-3"/>
        <joint name="x" type="slide" axis="1 0 0" armature=")" +
                           std::to_string(armature) + R"("/>
        <geom name="ball" type="sphere" size="0.02" pos="-0.02 0 0" mass="0" condim="1"/>
        <site name="skin" type="sphere" size="0.03" pos="-0.02 0 0"/>
      </body></worldbody>
    <actuator><motor joint="x"/></actuator>
    <sensor><touch name="touch" site="skin"/></sensor></mujoco>)");
}

class Ball {
 public:
  Ball(double mass, double armature, const ContactLaw& law)
      : model_(ball_and_wall(mass, armature)) {
    author_contact(model_, model_.id(mjOBJ_GEOM, "ball"), model_.id(mjOBJ_GEOM, "wall"), law);
    data_ = mj_makeData(model_.get());
  }
  ~Ball() { mj_deleteData(data_); }
  Ball(const Ball&) = delete;
  Ball& operator=(const Ball&) = delete;

  mjData& data() { return *data_; }
  void step() { mj_step(model_.get(), data_); }
  double depth() const { return data_->qpos[0] - 0.1; }

 private:
  Model model_;
  mjData* data_;
};

TEST(Contact, StaticDepthIsForceOverStiffness) {
  for (const double K : {200.0, 1000.0, 1e5}) {
    for (const double armature : {0.0, 3.0}) {
      for (const double force : {0.5, 20.0}) {
        Ball ball(0.5, armature, {K, 2.0 * std::sqrt(K * (0.5 + armature))});
        ball.data().qpos[0] = 0.1;
        ball.data().ctrl[0] = force;
        for (int k = 0; k < 400000 && std::abs(ball.data().qvel[0]) + (k < 1000) > 1e-12; ++k) {
          ball.step();
        }
        EXPECT_NEAR(ball.depth(), force / K, 1e-6 * force / K) << K << " " << armature;
        EXPECT_NEAR(ball.data().sensordata[0], force, 1e-6 * force);
      }
    }
  }
}

TEST(Contact, ImpactMatchesAMassOnASpringAndDamper) {
  // m ẍ = −K x − B ẋ from ẋ = v: x = v/ω e^{−σt} sin ωt, until the force would become negative. The
  // mass includes the term d/((1−d) w) that author_contact() states. w = 1/(3·1.7 kg) is the
  // engine's mean over three directions; the ball moves in one.
  const double K = 1000.0, B = 10.0, v = 0.19;
  const double m = 1.7 + 0.001 / 0.999 * 3 * 1.7;
  Ball ball(1.7, 0.0, {K, B});
  ball.data().qpos[0] = 0.1;
  ball.data().qvel[0] = v;
  const double sigma = B / (2 * m);
  const double omega = std::sqrt(K / m - sigma * sigma);
  const double peak_depth = v / std::sqrt(K / m);
  for (double t = 0; t < 0.9 * M_PI / omega; t = ball.data().time) {
    const double expected = v / omega * std::exp(-sigma * t) * std::sin(omega * t);
    ASSERT_NEAR(ball.depth(), expected, 2e-4 * peak_depth) << t;  // Euler at 10 us
    ball.step();
  }
}

TEST(Contact, NeverPulls) {
  Ball ball(1.0, 0.0, {1000.0, 500.0});
  ball.data().qpos[0] = 0.101;
  ball.data().qvel[0] = -1.0;  // fast separation: K r − B v would be negative
  ball.step();
  EXPECT_EQ(ball.data().sensordata[0], 0.0);
}

TEST(Contact, RefusesUnsupportedContacts) {
  Model model = ball_and_wall(1.0, 0.0);
  const int ball = model.id(mjOBJ_GEOM, "ball"), wall = model.id(mjOBJ_GEOM, "wall");
  EXPECT_THROW(author_contact(model, ball, wall, {0.0, 1.0}), std::invalid_argument);
  EXPECT_THROW(author_contact(model, ball, wall, {1.0, -1.0}), std::invalid_argument);
  EXPECT_THROW(author_contact(model, ball, wall, {std::nan(""), 1.0}), std::invalid_argument);
  EXPECT_THROW(author_contact(model, wall, wall, {1.0, 1.0}), std::invalid_argument);
  model.get()->geom_condim[wall] = 3;
  EXPECT_THROW(author_contact(model, ball, wall, {1.0, 1.0}), std::invalid_argument);
}

// The arm's wall therefore belongs to the world. If a wall has its own body, MuJoCo 2.2.2 finds
// each contact twice, and 1 kN/m acts as 2 kN/m.
TEST(Contact, EngineDoublesContactsWithAPlaneOnItsOwnBody) {
  for (const bool own_body : {false, true}) {
    const std::string plane = R"(<geom type="plane" size="1 1 1" zaxis="-1 0 0"/>)";
    const Model model = testing::model_of(
        "<mujoco><worldbody>" + (own_body ? "<body>" + plane + "</body>" : plane) +
        R"(<body><joint type="slide" axis="1 0 0"/><geom size="0.01"/></body>
        </worldbody></mujoco>)");
    mjData* data = mj_makeData(model.get());
    mj_forward(model.get(), data);
    EXPECT_EQ(data->ncon, own_body ? 2 : 1);
    mj_deleteData(data);
  }
}

}  // namespace
}  // namespace breakwater
