// Contacts of the engine and of own laws against closed forms. regression/cases.txt has friction,
// and tests/python/logs_test.py walls that move.
#include <fmt/format.h>

#include <breakwater/linear/eigenvalues.h>
#include <breakwater/sim/contact.h>
#include <breakwater/sim/model.h>
#include <breakwater/sim/simulation.h>
#include <breakwater/sim/wall_contact.h>
#include "sim/small_models.h"

namespace breakwater::contact_test {

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
  Ball(double mass, double armature, const KelvinVoigt& law)
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
  EXPECT_REFUSED(author_contact(model, ball, wall, {0.0, 1.0}));
  EXPECT_REFUSED(author_contact(model, ball, wall, {1.0, -1.0}));
  EXPECT_REFUSED(author_contact(model, ball, wall, {std::nan(""), 1.0}));
  EXPECT_REFUSED(author_contact(model, wall, wall, {1.0, 1.0}));
  model.get()->geom_condim[wall] = 3;
  EXPECT_REFUSED(author_contact(model, ball, wall, {1.0, 1.0}));
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

// The largest growth in a step of m ẍ = −k x − c ẋ.
double growth(Integrator integrator, double h, const ContactSlopes& slopes) {
  const double k = slopes.stiffness_N_m / slopes.mass_kg;
  const double c = slopes.damping_Ns_m / slopes.mass_kg;
  Eigen::Matrix2d step;
  if (integrator == Integrator::rk4) {
    const Eigen::Matrix2d a = h * (Eigen::Matrix2d() << 0.0, 1.0, -k, -c).finished();
    step = Eigen::Matrix2d::Identity() + a + a * a / 2.0 + a * a * a / 6.0 + a * a * a * a / 24.0;
  } else {  // v += h a, x += h v
    step << 1.0 - h * h * k, h - h * h * c, -h * k, 1.0 - h * c;
  }
  return spectral_radius(step);
}

TEST(ContactStability, TheLimitIsWhereTheStepBeginsToGrow) {
  testing::Random random;
  for (const Integrator integrator : {Integrator::euler, Integrator::rk4, Integrator::implicit}) {
    for (int i = 0; i < 200; ++i) {
      const ContactSlopes slopes = {.stiffness_N_m = std::pow(10.0, random.uniform(1.0, 7.0)),
                                    .damping_Ns_m = std::pow(10.0, random.uniform(-1.0, 4.0)),
                                    .mass_kg = std::pow(10.0, random.uniform(-2.0, 2.0))};
      const double h = longest_stable_timestep_s(integrator, slopes);
      EXPECT_LE(growth(integrator, 0.999 * h, slopes), 1.0 + 1e-12);
      EXPECT_GT(growth(integrator, 1.001 * h, slopes), 1.0);
      EXPECT_TRUE(is_stable(integrator, 0.999 * h, slopes));
      EXPECT_FALSE(is_stable(integrator, 1.001 * h, slopes));
    }
  }
}

TEST(ContactStability, ARelaxationHasALimitOfItsOwn) {
  const ContactSlopes slopes = {.stiffness_N_m = 1.0, .relaxation_1_s = 1e3};
  EXPECT_DOUBLE_EQ(longest_stable_timestep_s(Integrator::euler, slopes), 2e-3);
  EXPECT_FALSE(is_stable(Integrator::rk4, 2.1e-3, slopes));
}

TEST(ContactStability, SlopesAreThoseOfTheLaw) {
  const HuntCrossley law(1e5, 1.5, 0.8);
  const ContactSlopes slopes = slopes_of(law, {}, 4e-4, 0.5, 2.0);
  EXPECT_NEAR(slopes.stiffness_N_m, 1e5 * 1.5 * 0.02 * 1.4, 1e-2);
  EXPECT_NEAR(slopes.damping_Ns_m, 1e5 * 8e-6 * 0.8, 1e-6);
  EXPECT_EQ(slopes.mass_kg, 2.0);
  WallMotion wall{.mass_kg = 6.0, .stiffness_N_m = 100.0, .damping_Ns_m = 10.0};
  EXPECT_EQ(with_wall(slopes, wall).mass_kg, 2.0) << "a fixed wall";
  wall.kind = WallMotionKind::free;
  const ContactSlopes both = with_wall(slopes, wall);
  EXPECT_DOUBLE_EQ(both.mass_kg, 1.5);
  EXPECT_NEAR(both.stiffness_N_m, slopes.stiffness_N_m + 25.0, 1e-9);
  EXPECT_NEAR(both.damping_Ns_m, slopes.damping_Ns_m + 2.5, 1e-12);
  const StandardLinearSolid solid(1e3, 2e3, 0.01);
  EXPECT_NEAR(slopes_of(solid, {}, 1e-3, 0.0, 1.0).stiffness_N_m, 3e3, 1e-3);
  EXPECT_NEAR(slopes_of(solid, {}, 1e-3, 0.0, 1.0).relaxation_1_s, 100.0, 1e-3);
}

// A plane of any normal turns by the whole angle, and a geom with it.
// The frames are those that the engine computes.
TEST(TiltWall, TurnsThePlaneByTheAngle) {
  for (const char* zaxis : {"-1 0 0", "0.3 -0.2 -0.9", "0 0 1", "0 0 -1"}) {
    for (const char* pos : {"1 2 3", "0 0 0"}) {
      SCOPED_TRACE(zaxis);
      Model model = testing::model_of(
          fmt::format(R"(<mujoco><worldbody><geom name="wall" type="plane" size="1 1 1" pos="{}"
          zaxis="{}"/><geom name="wall_mark" size="0.1" pos="4 -1 2"/></worldbody></mujoco>)",
                      pos, zaxis));
      const DataPointer data = model.make_data();
      const auto compute = [&] { mj_kinematics(model.get(), data.get()); };
      const auto normal = [&] {
        const mjtNum* frame = data->geom_xmat;
        return Eigen::Vector3d(frame[2], frame[5], frame[8]);
      };
      const auto place = [&](int geom) { return Eigen::Vector3d(data->geom_xpos + 3 * geom); };
      compute();
      const Eigen::Vector3d before = normal(), wall = place(0), mark = place(1);
      tilt_wall(model, "wall", 0.5);
      compute();
      EXPECT_NEAR(normal().dot(before), std::cos(0.5), 1e-12);
      if (before.z() * before.z() == 1.0) {
        EXPECT_NEAR(normal().y(), 0.0, 1e-12);  // about the plane's own y axis
        EXPECT_NEAR(normal().x(), std::sin(0.5), 1e-12);
      } else {
        EXPECT_GT(before.cross(normal()).z(), 0.0);  // counter-clockwise
      }
      EXPECT_EQ(place(0), wall);
      EXPECT_NEAR((place(1) - wall).norm(), (mark - wall).norm(), 1e-12);
      EXPECT_NEAR((place(1) - wall).dot(normal()), (mark - wall).dot(before), 1e-12);
    }
  }
}

// A floor's frame is its body's.
TEST(PlaceWall, MovesAFloor) {
  Model model = testing::model_of(
      R"(<mujoco><worldbody><geom name="wall" type="plane" size="1 1 1"/></worldbody></mujoco>)");
  const DataPointer data = model.make_data();
  place_wall(model, "wall", 0.25);
  mj_kinematics(model.get(), data.get());
  EXPECT_EQ(data->geom_xpos[0], 0.25);
}

// The first touch is in a later stage of RK4's step.
TEST(WallContact, FrictionActsFromTheFirstTouch) {
  testing::FunctionController controller([](const Sample&, Eigen::Ref<Eigen::VectorXd>) {});
  Simulation simulation(
      testing::model_of(
          R"(<mujoco><option timestep="1e-3" gravity="0 0 0" integrator="RK4"/><worldbody>
      <geom name="wall" type="plane" size="9 9 1" contype="0" conaffinity="0"/>
      <body pos="0 0 0.1001"><joint type="slide" axis="1 0 0"/><joint type="slide" axis="0 1 0"/>
        <joint type="slide" axis="0 0 1"/>
        <geom name="ball" size="0.1" mass="1" contype="0" conaffinity="0"/></body></worldbody>
      </mujoco>)"),
      controller, {}, 1);
  WallContact contact(simulation.model(), "ball", "wall",
                      std::make_unique<KelvinVoigt>(1e4, 200.0, KelvinVoigt::By::force), {}, {0.5});
  contact.set_solid(true);
  simulation.add(contact);
  simulation.set_velocity(std::array{1.0, 0.0, -0.5});
  simulation.step();
  EXPECT_EQ(contact.force_N(), 0.0);
  EXPECT_GT(contact.impulse_Ns(), 0.0);
  EXPECT_NEAR(1.0 - simulation.data().qvel[0], 0.5 * contact.impulse_Ns(), 1e-6);
}

TEST(GeomContact, IsTheWeightOfTheBallThatRests) {
  const Model model = testing::model_of(R"(<mujoco><worldbody>
      <geom name="floor" type="plane" size="1 1 1"/>
      <body pos="0 0 0.1"><joint type="slide" axis="0 0 1" damping="20"/>
        <geom name="light" type="sphere" size="0.1" mass="1"/></body>
      <body pos="0.5 0 0.1"><joint type="slide" axis="0 0 1" damping="20"/>
        <geom name="heavy" type="sphere" size="0.1" mass="3"/><site name="tip"/></body>
      </worldbody></mujoco>)");
  const DataPointer data = model.make_data();
  for (int k = 0; k < 2000; ++k) mj_step(model.get(), data.get());
  const auto force_N = [&](const char* one, const char* other) {
    return GeomContact(model, one, other).force_N(*model.get(), *data);
  };
  EXPECT_NEAR(force_N("light", "floor"), 9.81, 1e-3);
  EXPECT_NEAR(force_N("floor", "light"), 9.81, 1e-3);
  EXPECT_NEAR(force_N("heavy", "floor"), 29.43, 1e-3);
  EXPECT_EQ(force_N("heavy", "light"), 0.0);
  EXPECT_EQ(geom_id(model, "heavy"), 2);
  EXPECT_EQ(site_id(model, "tip"), 0);
}

}  // namespace breakwater::contact_test
