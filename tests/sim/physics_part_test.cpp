#include <mujoco/mjxmacro.h>
#include <cstring>

#include <breakwater/sim/physics_part.h>
#include "sim/small_models.h"

namespace breakwater::physics_part_test {

using Names = std::vector<std::string>;

// One file, compiled completely and for physics only.
struct Both {
  Model whole;
  Model physics;
};

Both both(const std::string& file, const Names& geoms = {}) {
  return {Model::load(file), Model::load_physics(file, geoms)};
}

Both both_of(const std::string& mjcf, const Names& geoms = {}) {
  return both(testing::TemporaryPath("model.xml", mjcf).string(), geoms);
}

std::vector<double> states(Model& model, int steps) {
  const DataPointer data = model.make_data();
  for (int i = 0; i < model->nu; ++i) data->ctrl[i] = 0.3 * (i + 1);
  std::vector<double> all;
  for (int k = 0; k < steps; ++k) {
    mj_step(model.get(), data.get());
    all.insert(all.end(), data->qpos, data->qpos + model->nq);
    all.insert(all.end(), data->qvel, data->qvel + model->nv);
    all.insert(all.end(), data->sensordata, data->sensordata + model->nsensordata);
  }
  return all;
}

void expect_same_bits(const std::vector<double>& a, const std::vector<double>& b) {
  ASSERT_EQ(a.size(), b.size());
  EXPECT_EQ(std::memcmp(a.data(), b.data(), a.size() * sizeof(double)), 0);
}

// Compares all arrays of a model that do not depend on geoms and materials.
void expect_same_but_geoms(const Model& whole, const Model& physics) {
  const std::vector<std::string> renumbered = {
      "body_geomnum", "body_geomadr", "site_matid",   "tendon_matid", "pair_geom1",
      "pair_geom2",   "sensor_objid", "sensor_refid", "wrap_objid",   "tuple_objid"};
  const mjModel& a = *whole.get();
  const mjModel& b = *physics.get();
  MJMODEL_POINTERS_PREAMBLE((&a))
#define X(type, name, rows, columns)                                                         \
  if (a.rows == b.rows &&                                                                    \
      std::find(renumbered.begin(), renumbered.end(), #name) == renumbered.end()) {          \
    const auto bytes =                                                                       \
        sizeof(type) * static_cast<std::size_t>(a.rows) * static_cast<std::size_t>(columns); \
    EXPECT_EQ(std::memcmp(a.name, b.name, bytes), 0) << whole.file() << ": " << #name;       \
  }
  MJMODEL_POINTERS
#undef X
}

TEST(PhysicsPart, GivesTheSameStatesForTheShippedModels) {
  for (const char* name : {"arm", "cart", "motor", "quadrotor"}) {
    const Names geoms = std::string(name) == "arm" ? Names{"wall"} : Names{};
    Both models = both(testing::source_file("models/" + std::string(name) + ".xml"), geoms);
    EXPECT_EQ(models.physics->ngeom, geoms.empty() ? 0 : 2) << name;  // the wall, and the tip
    EXPECT_EQ(models.physics->ncam + models.physics->nlight + models.physics->ntex, 0) << name;
    EXPECT_EQ(models.physics->nbody, models.whole->nbody);
    EXPECT_LT(models.physics->njmax, 40) << name;
    expect_same_but_geoms(models.whole, models.physics);
    expect_same_bits(states(models.whole, 500), states(models.physics, 500));
  }
}

// Each geom is needed for a different reason. The pendulum's inertia is from geoms that are
// removed.
constexpr const char* kAllReasons = R"(<mujoco>
  <compiler angle="radian"/>
  <option density="2"/>
  <asset><material name="red" rgba="1 0 0 1"/><texture name="sky" type="skybox" builtin="flat"
    width="8" height="8"/></asset>
  <worldbody>
    <light name="lamp" pos="0 0 3"/><camera name="side" pos="0 -2 0"/>
    <geom name="floor" type="plane" size="2 2 1" pos="0 0 -1.2"/>
    <geom name="picture" type="box" size="1 1 1" contype="0" conaffinity="0" material="red"/>
    <geom name="paired" type="plane" size="1 1 1" pos="0 0 -1.21" contype="0" conaffinity="0"/>
    <site name="anchor" pos="0.3 0 0.3"/>
    <body name="pendulum" pos="0 0 0" euler="0.1 0.2 0.3">
      <joint name="hinge" axis="0 1 0"/>
      <geom name="rod" type="capsule" size="0.02" fromto="0 0 0 0.1 0.2 -1" contype="0"
            conaffinity="0"/>
      <geom name="lump" type="box" size="0.1 0.2 0.05" pos="0.1 0 -0.5" euler="0.4 0.5 0.6"
            contype="0" conaffinity="0"/>
      <geom name="wrapped" type="sphere" size="0.1" pos="0.1 0 -0.1" contype="0" conaffinity="0"
            mass="0"/>
      <geom name="sensed" type="sphere" size="0.1" pos="0 0 -1" contype="0" conaffinity="0"
            mass="0.1"/>
      <geom name="listed" type="sphere" size="0.01" contype="0" conaffinity="0" mass="0"/>
      <geom name="bob" type="sphere" size="0.1" pos="0.2 0 -1.1" contype="0" conaffinity="0"/>
      <site name="end" pos="0 0 -0.6" material="red"/>
      <body name="leaf" pos="0.5 0 0"><joint name="twig" axis="1 0 0"/>
        <geom name="ball" type="sphere" size="0.05" pos="0 0 -1.1"/>
        <geom name="vane" type="ellipsoid" size="0.2 0.1 0.02" fluidshape="ellipsoid" contype="0"
              conaffinity="0"/>
      </body>
    </body>
  </worldbody>
  <tendon><spatial name="string" stiffness="5" springlength="0.2" material="red">
    <site site="anchor"/>
    <geom geom="wrapped"/><site site="end"/></spatial></tendon>
  <contact><pair geom1="paired" geom2="bob"/></contact>
  <custom><tuple name="list"><element objtype="geom" objname="listed" prm="1"/></tuple></custom>
  <sensor><framepos name="where" objtype="geom" objname="sensed"/>
    <framepos name="apart" objtype="geom" objname="ball" reftype="geom" refname="sensed"/>
    <tendonpos name="long" tendon="string"/></sensor>
</mujoco>)";

TEST(PhysicsPart, KeepsReferencedGeoms) {
  Both models = both_of(kAllReasons);
  const Model& part = models.physics;
  for (const char* name :
       {"floor", "ball", "paired", "bob", "wrapped", "sensed", "listed", "vane"}) {
    EXPECT_TRUE(part.has(mjOBJ_GEOM, name)) << name;
  }
  for (const char* name : {"picture", "rod", "lump"}) {
    EXPECT_FALSE(part.has(mjOBJ_GEOM, name)) << name;
  }
  EXPECT_FALSE(part.has(mjOBJ_CAMERA, "side"));
  EXPECT_FALSE(part.has(mjOBJ_LIGHT, "lamp"));
  EXPECT_FALSE(part.has(mjOBJ_MATERIAL, "red"));
  for (int i = 0; i < part->nsite; ++i) EXPECT_EQ(part->site_matid[i], -1);
  for (int i = 0; i < part->ngeom; ++i) EXPECT_EQ(part->geom_matid[i], -1);
  for (int i = 0; i < part->ntendon; ++i) EXPECT_EQ(part->tendon_matid[i], -1);
  const auto expect_named = [&](int geom, const char* name) {
    EXPECT_EQ(geom, part.id(mjOBJ_GEOM, name));
  };
  expect_named(part->sensor_objid[part.id(mjOBJ_SENSOR, "where")], "sensed");
  expect_named(part->sensor_objid[part.id(mjOBJ_SENSOR, "apart")], "ball");
  expect_named(part->sensor_refid[part.id(mjOBJ_SENSOR, "apart")], "sensed");
  expect_named(part->pair_geom1[0], "paired");
  expect_named(part->pair_geom2[0], "bob");
  expect_named(part->wrap_objid[1], "wrapped");
  expect_named(part->tuple_objid[0], "listed");
  expect_same_but_geoms(models.whole, models.physics);
  expect_same_bits(states(models.whole, 3000), states(models.physics, 3000));
}

TEST(PhysicsPart, KeepsNamedGeomsAndTheirContactPartners) {
  const std::string file = testing::source_file("models/arm.xml");
  EXPECT_EQ(Model::load_physics(file)->ngeom, 0);  // the wall is not solid in the file
  const Model part = Model::load_physics(file, {"wall"});
  EXPECT_TRUE(part.has(mjOBJ_GEOM, "wall"));
  EXPECT_TRUE(part.has(mjOBJ_GEOM, "tip"));
  EXPECT_TRUE(Model::load_physics(file, {"table"}).has(mjOBJ_GEOM, "table"));
  EXPECT_EQ(Model::load_physics(file, {"no such geom"})->ngeom, Model::load(file)->ngeom);
  const SharedModels shared;
  for (int i = 0; i < 2; ++i) {
    EXPECT_EQ(Model::load_physics(file)->ngeom, 0);
    EXPECT_EQ(Model::load_physics(file, {"wall"})->ngeom, 2);
    EXPECT_EQ(Model::load(file)->ngeom, Model::load(file)->ngeom);
  }
}

TEST(PhysicsPart, KeepsAllGeomsForARangefinder) {
  const char* const mjcf = R"(<mujoco><worldbody>
    <geom name="seen" type="box" size="1 1 1" pos="0 0 -3" contype="0" conaffinity="0"/>
    <body name="probe"><joint name="slide" type="slide" axis="0 0 1"/>
      <inertial pos="0 0 0" mass="1" diaginertia="1 1 1"/>
      <site name="eye" xyaxes="1 0 0 0 -1 0"/></body></worldbody>
    <sensor><rangefinder name="height" site="eye"/></sensor></mujoco>)";
  Both models = both_of(mjcf);
  EXPECT_TRUE(models.physics.has(mjOBJ_GEOM, "seen"));
  const std::vector<double> seen = states(models.physics, 100);
  EXPECT_NEAR(seen[2], 2.0, 1e-12);
  expect_same_bits(states(models.whole, 100), seen);
}

// A body with two balls that falls onto a floor and against a step, with up to four contacts.
std::string tumbling(const std::string& ball) {
  return R"(<mujoco><option timestep="0.001" cone="elliptic"/>
    <worldbody>
      <geom name="floor" type="plane" size="5 5 1"/>
      <geom name="step" type="box" size="0.2 1 0.05" pos="0.25 0 0.05"/>
      <body name="dumbbell" pos="0 0 0.5" euler="10 25 0"><freejoint/>
        <geom name="one" type="sphere" size="0.1" pos="-0.15 0 0" )" +
         ball + R"(/>
        <geom name="two" type="sphere" size="0.1" pos="0.15 0 0"/>
      </body></worldbody></mujoco>)";
}

ModelPointer listed(const Model& model) {
  return with_contact_pairs(*model.get(), model.file());
}

TEST(ContactPairs, EqualTheSearchedContactsToTheBit) {
  Model searched = testing::model_of(tumbling(""));
  Model listing = testing::model_of(tumbling(""));
  listing.list_contacts();
  ASSERT_EQ(listing->npair, 4);
  ASSERT_EQ(searched->npair, 0);
  const DataPointer a = searched.make_data();
  const DataPointer b = listing.make_data();
  int most = 0;
  for (int k = 0; k < 4000; ++k) {
    // The step is absent in between.
    if (k == 1500 || k == 2000) {
      for (Model* model : {&searched, &listing}) {
        model->set_collidable(model->id(mjOBJ_GEOM, "step"), k == 2000);
      }
    }
    mj_step(searched.get(), a.get());
    mj_step(listing.get(), b.get());
    ASSERT_EQ(a->ncon, b->ncon) << k;
    most = std::max(most, a->ncon);
    ASSERT_EQ(std::memcmp(a->qpos, b->qpos, sizeof(double) * 7), 0) << k;
    ASSERT_EQ(std::memcmp(a->qvel, b->qvel, sizeof(double) * 6), 0) << k;
  }
  EXPECT_GE(most, 2);
}

TEST(ContactPairs, AreNotUsedIfTheyMightDiffer) {
  for (const char* unlike : {"friction=\"0.3\"", "solref=\"0.01 1\"", "condim=\"6\"",
                             "margin=\"0.01\"", "priority=\"1\"", "solmix=\"2\""}) {
    EXPECT_EQ(listed(testing::model_of(tumbling(unlike))), nullptr) << unlike;
  }
  // Two moving bodies, each with a geom that could touch the other one.
  EXPECT_EQ(listed(testing::model_of(R"(<mujoco><worldbody><geom name="floor" type="plane"
      size="1 1 1"/><body><freejoint/><geom size="0.1"/></body><body pos="0 0 1"><freejoint/>
      <geom size="0.1"/></body></worldbody></mujoco>)")),
            nullptr);
  const auto with_contact = [](const std::string& list) {
    return testing::model_of(R"(<mujoco><worldbody><geom name="floor" type="plane" size="1 1 1"/>
        <body name="ball"><freejoint/><geom name="skin" size="0.1"/></body></worldbody><contact>)" +
                             list + "</contact></mujoco>");
  };
  EXPECT_NE(listed(with_contact("")), nullptr);
  EXPECT_EQ(listed(with_contact(R"(<exclude body1="world" body2="ball"/>)")), nullptr);
  EXPECT_EQ(listed(with_contact(R"(<pair geom1="floor" geom2="skin"/>)")), nullptr);
  EXPECT_EQ(listed(Model::load(testing::source_file("models/arm.xml"))), nullptr);
  EXPECT_EQ(listed(Model::load_physics(testing::source_file("models/motor.xml"))), nullptr);
}

}  // namespace breakwater::physics_part_test
