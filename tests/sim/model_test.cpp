#include <breakwater/sim/model.h>

#include <array>
#include <atomic>
#include <chrono>
#include <memory>
#include <thread>

#include <breakwater/plants/planar_chain.h>
#include <breakwater/sim/engine_guard.h>
#include "sim/small_models.h"

namespace breakwater {
namespace {

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
  const std::string inertial = kInertial, good = inertial + kHinge;
  for (const std::string timestep : {"0", "-1", "nan", "inf"}) {
    EXPECT_NE(complaint(with_body(good, "<option timestep='" + timestep + "'/>")), "") << timestep;
  }
  EXPECT_NE(complaint(with_body(good + "<geom name='g' size='1e300' mass='0'/>")), "");
  // The engine reads some of these as 0 or accepts them silently.
  for (const auto& [body, option, line] : std::vector<std::array<std::string, 3>>{
           {good, "", ""},
           {of_mass("1e300"), "",
            ":1: <inertial> mass=\"1e300\": must be finite and not beyond 1e30"},
           {of_mass("9e8"), "", ""},
           {of_mass("1.1e9"), "", ": body \"b\": mass is out of range"},
           {of_mass("-1"), "", ":1: <inertial> mass=\"-1\": must not be negative"},
           {good + "<geom name='g' size='1e6' mass='0'/>", "", ""},
           {good + "<geom name='g' size='2e6' mass='0'/>", "",
            ": geom \"g\": size or position is out of range"},
           {good + "<geom name='g' size='9e5' pos='0 0 -2e6' mass='0'/>", "",
            ": geom \"g\": size or position is out of range"},
           {good + "<site name='nan' pos='0 NaN 0'/>", "",
            ":1: <site> pos=\"0 NaN 0\": must be finite and not beyond 1e30"},
           {inertial + "<joint name='j' type='hinge' armature='-1'/>", "",
            ":1: <joint> armature=\"-1\": must not be negative"},
           {good, "<size nuser_body='1000' nconmax='200'/>", ""},
           {good, "<size nuser_body='2000000000'/>",
            ":1: <size> nuser_body=\"2000000000\": must be at most 1000"},
           {good, "<size nkey='20000000'/>",
            ":1: <size> nkey=\"20000000\": must be at most 10000000"},
           {good, "<custom><numeric name='n' size='20000000' data='1'/></custom>",
            ":1: <numeric> size=\"20000000\": must be at most 10000000"},
           {good, "<asset><hfield name='h' nrow='20000' ncol='20000' size='1 1 1 1'/></asset>",
            ":1: <hfield>: here height fields and textures take 1600 MB: must be at most 250 MB"},
           {good, "<asset><texture name='t' builtin='flat' width='10000' height='10000'/></asset>",
            ":1: <texture>: here height fields and textures take 1800 MB: must be at most 250 MB"},
           {good,
            "<asset><texture name='t' type='2d' builtin='flat' width='8000' "
            "height='8000'/><texture "
            "name='s' type='2d' builtin='flat' width='8000' height='8000'/></asset>",
            ":1: <texture>: here height fields and textures take 384 MB: must be at most 250 MB"},
           {good,
            "<asset><texture name='t' type='2d' builtin='flat' width='64' height='64'/></asset>",
            ""}}) {
    EXPECT_EQ(complaint(with_body(body, option)), line);
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
  EXPECT_THROW(Model::load("/no/such/model.xml"), std::invalid_argument);
  EXPECT_THROW(Model::load("/"), std::invalid_argument);
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
    TipJacobian J;
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

}  // namespace
}  // namespace breakwater
