#include <breakwater/sim/apparent_mass.h>

#include <cmath>

#include "sim/small_models.h"
#include "support.h"

namespace breakwater::apparent_mass_test {
namespace {

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
  EXPECT_THROW(ApparentMass(model, "nose", Eigen::Vector3d::UnitX()), std::invalid_argument);
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

}  // namespace
}  // namespace breakwater::apparent_mass_test
