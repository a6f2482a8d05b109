// The appearance of a model as data agrees with the model's file.
#include <breakwater/render/scene_description.h>

#include <cmath>
#include <numeric>

#include "support.h"

namespace breakwater::scene_description_test {
namespace {

Model load(const std::string& mjcf) {
  const testing::TemporaryPath file{"look.xml", mjcf};
  return Model::load(file.string());
}

Model robot() {
  return load(R"(<mujoco><compiler angle="radian" autolimits="true"/>
    <visual><headlight ambient="0.3 0.3 0.3" diffuse="0.1 0.2 0.3"/></visual>
    <statistic center="1 2 3" extent="2"/>
    <asset>
      <texture name="tiles" type="2d" builtin="checker" rgb1="1 0 0" rgb2="0 0 1" width="8" height="8"/>
      <texture name="air" type="skybox" builtin="gradient" width="4" height="24"/>
      <material name="tiles" texture="tiles" texrepeat="3 4" texuniform="true" emission="0.2"/>
      <material name="paint" rgba="0.1 0.2 0.3 0.4" specular="0.9" shininess="0.7"/>
      <mesh name="wedge" vertex="0 0 0  1 0 0  0 1 0  0 0 1"/>
      <hfield name="hills" nrow="3" ncol="2" size="1 2 3 0.1"/>
    </asset>
    <worldbody>
      <light name="lamp" pos="0 0 4" dir="0 0 -1" diffuse="0.5 0.6 0.7" cutoff="30"/>
      <camera name="eye" pos="0 -3 1" xyaxes="1 0 0 0 0 1" fovy="33"/>
      <geom name="ground" type="plane" size="5 6 1" material="tiles"/>
      <geom name="hills" type="hfield" hfield="hills"/>
      <geom name="own" type="box" size="0.1 0.2 0.3" material="paint" rgba="0.9 0.8 0.7 1"/>
      <geom name="unseen" type="sphere" size="0.1" group="4"/>
      <geom name="clear" type="sphere" size="0.1" rgba="1 1 1 0"/>
      <body name="arm" pos="1 0 0">
        <joint name="elbow" type="hinge" axis="0 0 1" pos="0 0 0.5" range="-1 2"/>
        <geom name="painted" type="capsule" size="0.05" fromto="0 0 0 1 0 0" material="paint"/>
        <geom name="wedge" type="mesh" mesh="wedge"/>
        <geom name="wedge2" type="mesh" mesh="wedge"/>
        <site name="tip" pos="1 0 0"/>
      </body>
    </worldbody></mujoco>)");
}

SceneDescription whole(const Model& model) {
  std::vector<int> all(static_cast<std::size_t>(model->ngeom));
  std::iota(all.begin(), all.end(), 0);
  return describe_scene(model, all);
}

const SceneGeom& geom(const SceneDescription& scene, const std::string& name) {
  for (const SceneGeom& one : scene.geoms) {
    if (one.name == name) return one;
  }
  throw std::out_of_range(name);
}

TEST(SceneDescription, HasShapesSizesAndColours) {
  const Model model = robot();
  const SceneDescription scene = whole(model);
  EXPECT_EQ(geom(scene, "own").shape, SceneGeom::Shape::box);
  EXPECT_EQ(geom(scene, "own").size, (std::array{0.1, 0.2, 0.3}));
  // The geom's own colour has priority over the material's.
  EXPECT_NEAR(geom(scene, "own").rgba[0], 0.9, 1e-6);
  EXPECT_NEAR(geom(scene, "own").specular, 0.9, 1e-6);
  EXPECT_NEAR(geom(scene, "painted").rgba[3], 0.4, 1e-6);
  EXPECT_NEAR(geom(scene, "painted").shininess, 0.7, 1e-6);
  EXPECT_EQ(geom(scene, "painted").shape, SceneGeom::Shape::capsule);
  EXPECT_EQ(scene.bodies.at(static_cast<std::size_t>(geom(scene, "painted").body)), "arm");
  EXPECT_EQ(scene.centre_m, (std::array{1.0, 2.0, 3.0}));
  EXPECT_NEAR(scene.headlight.diffuse[2], 0.3, 1e-6);
  ASSERT_EQ(scene.lights.size(), 1U);
  EXPECT_FALSE(scene.lights[0].is_directional);
  EXPECT_NEAR(scene.lights[0].cutoff_deg, 30.0, 1e-6);
  ASSERT_EQ(scene.cameras.size(), 1U);
  EXPECT_EQ(scene.cameras[0].name, "eye");
  EXPECT_NEAR(scene.cameras[0].field_of_view_deg, 33.0, 1e-9);
}

TEST(SceneDescription, HasEachNeededAssetOnce) {
  const Model model = robot();
  const SceneDescription scene = whole(model);
  EXPECT_EQ(scene.meshes.size(), 1U);
  EXPECT_EQ(geom(scene, "wedge").mesh, geom(scene, "wedge2").mesh);
  EXPECT_EQ(scene.meshes[0].vertices.size(), 12U);
  EXPECT_EQ(scene.meshes[0].normals.size(), 12U);
  EXPECT_EQ(scene.meshes[0].faces.size(), 12U);
  // The faces of a tetrahedron point outward.
  const std::vector<float>& v = scene.meshes[0].vertices;
  const auto vertex = [&](int i) { return Eigen::Vector3d(v[3 * i], v[3 * i + 1], v[3 * i + 2]); };
  const Eigen::Vector3d middle = 0.25 * (vertex(0) + vertex(1) + vertex(2) + vertex(3));
  for (std::size_t f = 0; f < 12; f += 3) {
    const Eigen::Vector3d a = vertex(scene.meshes[0].faces[f]);
    const Eigen::Vector3d b = vertex(scene.meshes[0].faces[f + 1]);
    const Eigen::Vector3d c = vertex(scene.meshes[0].faces[f + 2]);
    EXPECT_GT((b - a).cross(c - a).dot(a - middle), 0.0);
  }
  ASSERT_EQ(scene.height_fields.size(), 1U);
  EXPECT_EQ(scene.height_fields[0].rows, 3);
  EXPECT_EQ(scene.height_fields[0].heights.size(), 6U);
  ASSERT_EQ(scene.textures.size(), 2U);
  const SceneTexture& tiles =
      scene.textures[static_cast<std::size_t>(geom(scene, "ground").texture)];
  EXPECT_EQ(tiles.rgb.size(), 8U * 8U * 3U);
  EXPECT_FALSE(tiles.is_cube);
  EXPECT_EQ(tiles.rgb[0] + tiles.rgb[2], 255);  // red or blue
  EXPECT_TRUE(geom(scene, "ground").texture_is_uniform);
  EXPECT_EQ(geom(scene, "ground").texture_repeat, (std::array{3.0, 4.0}));
  EXPECT_TRUE(scene.textures[static_cast<std::size_t>(scene.sky)].is_cube);
  // Without the geom the mesh is left out.
  const SceneDescription one = describe_scene(model, {model.id(mjOBJ_GEOM, "own")});
  EXPECT_TRUE(one.meshes.empty() && one.height_fields.empty());
  EXPECT_EQ(one.geoms.size(), 1U);
}

TEST(SceneDescription, ListsTheDrawnGeoms) {
  const Model model = robot();
  const auto drawn = [&](const char* name) { return is_drawn(model, model.id(mjOBJ_GEOM, name)); };
  EXPECT_TRUE(drawn("own") && drawn("painted") && drawn("ground"));
  EXPECT_FALSE(drawn("unseen"));
  EXPECT_FALSE(drawn("clear"));
}

TEST(SceneDescription, AJointsPointerShowsItsAngle) {
  const Model model = robot();
  const SceneDescription scene = whole(model);
  ASSERT_EQ(scene.joints.size(), 1U);
  const SceneJoint& elbow = scene.joints[0];
  EXPECT_TRUE(elbow.is_hinge && elbow.is_limited);
  EXPECT_EQ(elbow.range, (std::array{-1.0, 2.0}));
  EXPECT_EQ(elbow.anchor_m, (std::array{1.0, 0.0, 0.5}));
  EXPECT_EQ(elbow.pointer, elbow.body_pointer);  // at 0 the body is as in the file
  EXPECT_NEAR(elbow.axis[2], 1.0, 1e-12);
}

TEST(ScenePoser, TurnsTheArmAboutItsJoint) {
  const Model model = robot();
  ScenePoser poser(model);
  const double angle = 0.7;
  poser.pose(std::array{angle});
  const Pose arm = poser.body(model.id(mjOBJ_BODY, "arm"));
  EXPECT_NEAR(arm.position_m[0], 1.0, 1e-12);  // the joint is above the body's origin
  EXPECT_NEAR(arm.rotation[0], std::cos(0.5 * angle), 1e-12);
  EXPECT_NEAR(arm.rotation[3], std::sin(0.5 * angle), 1e-12);
  const Pose eye = poser.camera(0);
  EXPECT_NEAR(eye.position_m[1], -3.0, 1e-12);
  // The camera looks along +y, which is its −z axis: a quarter turn about x.
  EXPECT_NEAR(std::abs(eye.rotation[0]), std::sqrt(0.5), 1e-12);
  EXPECT_NEAR(std::abs(eye.rotation[1]), std::sqrt(0.5), 1e-12);
  const SiteOnBody tip = site_on_body(model, model.id(mjOBJ_SITE, "tip"));
  EXPECT_EQ(tip.body, model.id(mjOBJ_BODY, "arm"));
  EXPECT_EQ(tip.pose.position_m, (std::array{1.0, 0.0, 0.0}));
}

}  // namespace
}  // namespace breakwater::scene_description_test
