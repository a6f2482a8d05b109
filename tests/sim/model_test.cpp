// A model's file, its elements, and what is computed from it.
#include <atomic>
#include <chrono>
#include <thread>

#include <breakwater/plants/planar_chain.h>
#include <breakwater/sim/engine_guard.h>
#include <breakwater/sim/external_force.h>
#include <breakwater/sim/linear_model.h>
#include <breakwater/sim/model.h>
#include <breakwater/sim/transmission.h>
#include "environment.h"
#include "sim/small_models.h"
#include "tables.h"

namespace breakwater::model_test {

using testing::model_of;

std::string complaint(const std::string& mjcf) {
  const std::string what = complaint_of([&] { model_of(mjcf); });
  EXPECT_TRUE(lacks(what, "\n"));
  return what.empty() ? "" : what.substr(what.find(".xml") + 4);
}

std::string with_body(const std::string& body, const std::string& option = "") {
  return "<mujoco>" + option + "<worldbody><body name='b'>" + body + "</body></worldbody></mujoco>";
}

const char* const kInertial = "<inertial pos='0 0 0' mass='1' diaginertia='1 1 1'/>";
const char* const kHinge = "<joint name='j' type='hinge'/>";

std::string of_mass(const std::string& mass) {
  return testing::replaced(kInertial, "mass='1'", "mass='" + mass + "'") + kHinge;
}

TEST(Model, RefusesErrorsThatTheEngineAccepts) {
  const std::string good = std::string(kInertial) + kHinge;
  for (const std::string timestep : {"0", "-1", "nan", "inf"}) {
    EXPECT_NE(complaint(with_body(good, "<option timestep='" + timestep + "'/>")), "") << timestep;
  }
  EXPECT_NE(complaint(with_body(good + "<geom name='g' size='1e300' mass='0'/>")), "");
  for (const auto& row : testing::rows_of("ModelErrors")) {
    EXPECT_EQ(complaint(with_body(row.at(0), row.at(1))), row.at(2));
  }
}

TEST(Model, ReportsAModelTooLargeForMemory) {
  for (const auto& [thrower, what] :
       {std::pair{+[] { throw std::bad_alloc(); }, "new"},
        std::pair{+[] { throw std::length_error(""); }, "a vector"}}) {
    EXPECT_EQ(call_engine([&] { thrower(); }), "could not allocate memory for a model of this size")
        << what;
  }
}

TEST(Model, RefusesNonNumbersInIncludedFilesToo) {
  const testing::TemporaryPath part{"part.xml", "<mujoco>\n<option gravity='0 0 inf'/>\n</mujoco>"};
  EXPECT_EQ(
      complaint_of([&] { model_of("<mujoco><include file='" + part.string() + "'/></mujoco>"); }),
      part.string() + ":2: <option> gravity=\"0 0 inf\": must be finite and not beyond 1e30");
}

TEST(Model, NamesTheLineOfAnError) {
  EXPECT_TRUE(
      complaint("<mujoco>\n<worldbody>\n<bodie/>\n</worldbody>\n</mujoco>").starts_with(":3: "));
  EXPECT_TRUE(complaint("<mujoco>\n<worldbody>\n").starts_with(":"));
  EXPECT_REFUSED(Model::load("/no/such/model.xml"));
  EXPECT_REFUSED(Model::load("/"));
}

TEST(Model, NamesMissingElements) {
  const Model arm = Model::load(testing::source_file("models/arm.xml"));
  EXPECT_GE(arm.id(mjOBJ_SENSOR, "tip_force"), 0);
  EXPECT_TRUE(has(complaint_of([&] { arm.id(mjOBJ_SENSOR, "tip_fource"); }),
                  "arm.xml: has no sensor named \"tip_fource\""));
}

TEST(Model, FindsGeomsByTheBeginOfTheirName) {
  const Model model =
      model_of(with_body(std::string(kInertial) + kHinge +
                         "<geom name='link_a' size='1'/><geom size='1'/>"
                         "<geom name='tip' size='1'/><geom name='link' size='1'/>"));
  EXPECT_EQ(model.geoms_named("link"), (std::vector<int>{0, 3}));
}

TEST(Model, LoadsOnManyThreadsAtOnce) {
  std::vector<std::jthread> threads;
  for (int i = 0; i < 4; ++i) {
    threads.emplace_back([] {
      for (int k = 0; k < 5; ++k) Model::load(testing::source_file("models/arm.xml"));
    });
  }
}

TEST(Model, SharedModelsWaitForOtherCallers) {
  std::atomic<bool> is_called = false, is_over = false;
  auto shared = std::make_unique<SharedModels>([&](const std::string&) {
    is_called = true;
    std::this_thread::sleep_for(std::chrono::milliseconds(100));
    is_over = true;
  });
  const std::jthread loading([] { Model::load(testing::source_file("models/motor.xml")); });
  while (!is_called) std::this_thread::yield();
  shared.reset();
  EXPECT_TRUE(is_over);
}

TEST(Model, ANewOwnerIsToldOfFilesThatAreKnown) {
  const std::string file = testing::source_file("models/motor.xml");
  int compiled = 0, told = 0;
  const SharedModels first([&](const std::string&) { ++compiled; });
  for (int i = 0; i < 2; ++i) Model::load(file);
  EXPECT_EQ(compiled, 1);
  const SharedModels another;
  Model::load(file);
  EXPECT_EQ(compiled, 1) << "it asks for nothing, so nothing is compiled again";
  const SharedModels second([&](const std::string& name) {
    EXPECT_EQ(name, file);
    ++told;
  });
  for (int i = 0; i < 2; ++i) Model::load(file);
  EXPECT_EQ(told, 1);
}

TEST(Model, OnlyWithAnOwnerAFileIsReadOnce) {
  const testing::TemporaryPath file("read_once.xml");
  const auto masses = [&] {
    std::vector<double> found;
    for (const char* mass : {"1", "2"}) {
      std::ofstream(file) << with_body(of_mass(mass));
      found.push_back(Model::load_physics(file.string())->body_mass[1]);
      found.push_back(Model::load(file.string())->body_mass[1]);
    }
    return found;
  };
  EXPECT_EQ(masses(), (std::vector<double>{1, 1, 2, 2}));
  const SharedModels owner;
  EXPECT_EQ(masses(), (std::vector<double>{1, 1, 1, 1}));
}

TEST(Models, MotorAndCartHaveTheThesisParameters) {
  const Model motor = Model::load(testing::source_file("models/motor.xml"));
  const Model cart = Model::load(testing::source_file("models/cart.xml"));
  for (const Model* model : {&motor, &cart}) {
    mjData* data = mj_makeData(model->get());
    mj_forward(model->get(), data);
    EXPECT_EQ((*model)->nv, 1);
    EXPECT_EQ((*model)->nu, 1);
    EXPECT_NEAR(data->qM[0], model == &motor ? 1.0 : 0.625, 1e-12);
    EXPECT_EQ((*model)->dof_damping[0], model == &motor ? 0.0 : 0.78);
    EXPECT_NO_THROW(model->id(mjOBJ_KEY, "home"));
    mj_deleteData(data);
  }
}

// The controllers' URDF and the simulated MJCF describe the same arm.
TEST(Models, UrdfAndMjcfOfTheArmAgree) {
  const PlanarChain chain = load_planar_chain(testing::source_file("models/arm.urdf"));
  const Model model = Model::load(testing::source_file("models/arm.xml"));
  ASSERT_EQ(model->nv, chain.joints());
  mjData* data = mj_makeData(model.get());
  const int tip = model.id(mjOBJ_SITE, "tip");
  testing::Random random;
  for (int trial = 0; trial < 200; ++trial) {
    const Eigen::Vector3d q = random.vector(3, 3.0);
    const Eigen::Vector3d dq = random.vector(3, 3.0);
    std::copy_n(q.data(), 3, data->qpos);
    std::copy_n(dq.data(), 3, data->qvel);
    mj_forward(model.get(), data);

    const TipPose X = chain.tip_pose(q);
    EXPECT_NEAR(data->site_xpos[3 * tip], X[0], 1e-13);
    EXPECT_NEAR(data->site_xpos[3 * tip + 1], X[1], 1e-13);

    double J_position[9], J_rotation[9];
    mj_jacSite(model.get(), data, J_position, J_rotation, tip);
    TaskJacobian J(3, 3);
    chain.tip_jacobian(q, J);
    Eigen::Matrix3d M;
    double dense[9];
    mj_fullM(model.get(), dense, data->qM);
    for (int j = 0; j < 3; ++j) {
      EXPECT_NEAR(J_position[j], J(0, j), 1e-13);
      EXPECT_NEAR(J_position[3 + j], J(1, j), 1e-13);
      EXPECT_NEAR(J_rotation[6 + j], J(2, j), 1e-13);
      for (int i = 0; i < 3; ++i) M(i, j) = dense[3 * i + j];
      M(j, j) -= model->dof_armature[j];
    }
    EXPECT_LT((M - chain.mass_matrix(q)).cwiseAbs().maxCoeff(), 1e-13);
  }
  for (int i = 0; i < 3; ++i) {
    EXPECT_EQ(model->actuator_ctrlrange[2 * i + 1], chain.effort_limits_Nm()(i));
    EXPECT_EQ(model->actuator_ctrlrange[2 * i], -chain.effort_limits_Nm()(i));
  }
  mj_deleteData(data);
}

// READINGS: the nominal inertia is close to that of the armature and of the stretched links.
TEST(Models, TrueInertiaIsAboutHalfTheNominalAtTheFirstJoint) {
  const PlanarChain chain = load_planar_chain(testing::source_file("models/arm.urdf"));
  const Model model = Model::load(testing::source_file("models/arm.xml"));
  const Eigen::MatrixXd M = chain.mass_matrix(Eigen::Vector3d::Zero());
  EXPECT_NEAR(M(0, 0) + model->dof_armature[0], 1.05, 0.01);
  EXPECT_NEAR(M(1, 1) + model->dof_armature[1], 0.87, 0.01);
  EXPECT_NEAR(M(2, 2) + model->dof_armature[2], 0.82, 0.01);
}

TEST(ApparentMass, ForASliderIsItsMassPlusItsArmature) {
  const Model model = testing::model_of(R"(<mujoco><worldbody><body>
      <inertial pos="0 0 0" mass="2" diaginertia="1e-3 1e-3 1e-3"/>
      <joint type="slide" axis="1 0 0" armature="3"/><site name="tip"/></body></worldbody></mujoco>)");
  const DataPointer data = model.make_data();
  mj_forward(model.get(), data.get());
  ApparentMass along_x(model, "tip", Eigen::Vector3d::UnitX());
  EXPECT_DOUBLE_EQ(along_x(model, *data), 5.0);
  ApparentMass along_y(model, "tip", Eigen::Vector3d::UnitY());
  EXPECT_TRUE(std::isinf(along_y(model, *data)));
  EXPECT_REFUSED(ApparentMass(model, "nose", Eigen::Vector3d::UnitX()));
}

// The engine's response to a force at the tip: e a = (eᵀ J M⁻¹ Jᵀ e) F.
TEST(ApparentMass, IsForceOverAccelerationOfTheArmsTip) {
  Model model = Model::load(testing::source_file("models/arm.xml"));
  model.get()->opt.disableflags |=
      mjDSBL_CONSTRAINT;  // removes the wall and the holds of the joints
  const DataPointer data = model.make_data();
  const int tip = model.id(mjOBJ_SITE, "tip");
  const int body = model->site_bodyid[tip];
  ApparentMass mass(model, "tip", Eigen::Vector3d::UnitX());
  testing::Random random;
  for (int i = 0; i < 20; ++i) {
    for (int j = 0; j < model->nq; ++j) data->qpos[j] = random.uniform(-1.5, 1.5);
    mju_zero(data->qvel, model->nv);
    mju_zero(data->qfrc_applied, model->nv);
    mj_forward(model.get(), data.get());
    const Eigen::VectorXd at_rest = Eigen::Map<Eigen::VectorXd>(data->qacc, model->nv);
    const double force[3] = {7.0, 0.0, 0.0};
    const double torque[3] = {0.0, 0.0, 0.0};
    mj_applyFT(model.get(), data.get(), force, torque,
               data->site_xpos + static_cast<std::ptrdiff_t>(3) * tip, body, data->qfrc_applied);
    mj_forward(model.get(), data.get());
    const Eigen::VectorXd change = Eigen::Map<Eigen::VectorXd>(data->qacc, model->nv) - at_rest;
    // The tip's acceleration at rest, by a small displacement along the joint acceleration.
    constexpr double kSmall = 1e-6;
    for (int j = 0; j < model->nq; ++j) data->qpos[j] += 0.5 * kSmall * change(j);
    mj_kinematics(model.get(), data.get());
    const double ahead = data->site_xpos[3 * tip];
    for (int j = 0; j < model->nq; ++j) data->qpos[j] -= kSmall * change(j);
    mj_kinematics(model.get(), data.get());
    const double acceleration = (ahead - data->site_xpos[3 * tip]) / kSmall;
    for (int j = 0; j < model->nq; ++j) data->qpos[j] += 0.5 * kSmall * change(j);
    mju_zero(data->qfrc_applied, model->nv);
    mj_forward(model.get(), data.get());
    EXPECT_NEAR(mass(model, *data), 7.0 / acceleration, 1e-5 * mass(model, *data));
  }
}

TEST(BodyForce, AddsAForceAlongItsDirectionWithoutATorque) {
  const Model model = testing::model_of(R"(<mujoco><worldbody><body name="a"><freejoint/>
      <geom size="0.1"/></body><body name="b"><freejoint/><geom size="0.1"/></body></worldbody>
      </mujoco>)");
  BodyForce force(model, "b", {0.0, 3.0, 4.0});
  force.hold(2.0);
  const DataPointer data = model.make_data();
  force.apply(0.0, *model.get(), *data);
  force.apply(0.0, *model.get(), *data);
  const double expected[] = {0.0, 2.4, 3.2, 0.0, 0.0, 0.0};
  for (int i = 0; i < 6; ++i) {
    EXPECT_EQ(data->xfrc_applied[6 + i], 0.0) << "another body, " << i;
    EXPECT_NEAR(data->xfrc_applied[12 + i], expected[i], 1e-15) << i;
  }
  EXPECT_REFUSED(BodyForce(model, "b", Eigen::Vector3d::Zero()));
  EXPECT_REFUSED(BodyForce(model, "c", {1.0, 0.0, 0.0}));
}

// A linearised plant and its joint inertia against closed forms.

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
  Transmission spring(drive, "motor", "pole", {.ratio = N, .stiffness = K, .damping = D});
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
  EXPECT_REFUSED(linearise(model("<body><inertial pos='0 0 0' mass='1' diaginertia='1 1 1'/>"
                                 "<joint type='ball'/></body>",
                                 ""),
                           std::vector<double>{1, 0, 0, 0}, {}, {}));
}

TEST(OpenGlAsked, ReadsTheVariablesOfMujocosPrograms) {
  struct Row {
    std::string library, device;
    std::optional<int> number;
    bool software_only;
  };
  const std::vector<Row> rows = {{"", "", {}, true},       {"EGL", "", {}, false},
                                 {"osmesa", "", {}, true}, {"osmesa", "1", {}, true},
                                 {"egl", "0", 0, false},   {"", "2", 2, true}};
  for (const Row& row : rows) {
    const testing::Environment library("MUJOCO_GL", row.library);
    const testing::Environment device("MUJOCO_EGL_DEVICE_ID", row.device);
    const OpenGlAsked asked = opengl_asked();
    EXPECT_EQ(asked.device, row.number) << row.library << " " << row.device;
    EXPECT_EQ(asked.software_only, row.software_only) << row.library << " " << row.device;
  }
}

TEST(OpenGlAsked, RefusesOtherValues) {
  for (const char* number : {"-1", "1x", "x", "1.5", "99999999999"}) {
    const testing::Environment device("MUJOCO_EGL_DEVICE_ID", number);
    EXPECT_REFUSED(opengl_asked()) << number;
  }
  const testing::Environment library("MUJOCO_GL", "glfw");
  EXPECT_REFUSED(opengl_asked());
}

}  // namespace breakwater::model_test
