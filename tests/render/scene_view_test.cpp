// Scenes: their description and their view.
#include <zlib.h>

#include <Eigen/Geometry>

#include <breakwater/render/offscreen.h>
#include <breakwater/render/picture.h>
#include <breakwater/render/scene_description.h>
#include <breakwater/render/scene_view.h>
#include "support.h"

namespace breakwater::scene_view_test {

constexpr int kWidth = 320;
constexpr int kHeight = 240;
constexpr Colour kRed{1.0, 0.0, 0.0, 1.0};

Model load(const std::string& mjcf) {
  const testing::TemporaryPath file{"scene.xml", mjcf};
  return Model::load(file.string());
}

// A ball on a free joint. The camera looks along -z from 2 m with 60 degrees.
Model ball() {
  return load(R"(<mujoco><worldbody>
    <light pos="0 0 3"/>
    <camera name="above" pos="0 0 2" xyaxes="1 0 0 0 1 0" fovy="60"/>
    <body name="ball"><freejoint/>
      <geom type="sphere" size="0.05" mass="1" rgba="0 0 1 1"/><site name="middle"/>
      <site name="side" pos="0.2 0 0"/></body>
    </worldbody></mujoco>)");
}

// The mean position of the mainly blue or red pixels.
Point centre(const std::vector<std::uint8_t>& pixels, bool red) {
  double x = 0.0;
  double y = 0.0;
  int count = 0;
  for (int i = 0; i < kWidth * kHeight; ++i) {
    const std::uint8_t* p = &pixels[4 * static_cast<std::size_t>(i)];
    if (red ? p[2] > p[0] + 60 : p[0] > p[2] + 60) {
      const int row = i / kWidth;
      x += i % kWidth + 0.5;
      y += row + 0.5;
      ++count;
    }
  }
  EXPECT_GT(count, 0);
  return {x / count, y / count};
}

// A checker finer than the pixels: mipmaps make it grey, without them it aliases.
TEST(SceneView, TexturesAreMinifiedAsTheLookSpecifies) {
  Model model = load(R"(<mujoco><asset>
      <texture name="fine" type="2d" builtin="checker" rgb1="0 0 0" rgb2="1 1 1" width="64" height="64"/>
      <material name="fine" texture="fine" texrepeat="400 400"/></asset>
    <worldbody><light pos="0 0 3"/>
    <camera name="above" pos="0 0 2" xyaxes="1 0 0 0 1 0" fovy="60"/>
    <geom type="plane" size="3 3 .1" material="fine"/></worldbody></mujoco>)");
  const auto spread = [&](Minification minification) {
    Offscreen offscreen(kWidth, kHeight);
    SceneView view(offscreen, model, camera_id(model, "above"),
                   {.shadows = false, .sky = false, .minification = minification});
    view.pose({});
    view.draw({0, 0, kWidth, kHeight}, {});
    offscreen.finish();
    double sum = 0.0, squares = 0.0;
    for (std::size_t i = 0; i < offscreen.pixels().size(); i += 4) {
      const double grey = offscreen.pixels()[i];
      sum += grey;
      squares += grey * grey;
    }
    const double mean = sum / (kWidth * kHeight);
    return std::sqrt(squares / (kWidth * kHeight) - mean * mean);
  };
  const double aliased = spread(Minification::no_mipmaps);
  EXPECT_GT(aliased, 2.0 * spread(Minification::nearest_mipmap));
  EXPECT_GT(aliased, 2.0 * spread(Minification::trilinear));
}

TEST(SceneView, APinholeCameraSeesTheBallAtItsPosition) {
  Model model = ball();
  Offscreen offscreen(kWidth, kHeight);
  ASSERT_TRUE(has(offscreen.renderer(), "llvmpipe")) << offscreen.renderer();
  SceneView view(offscreen, model, camera_id(model, "above"), kFastLook);
  for (const auto& at : {std::array{0.0, 0.0}, std::array{0.6, 0.3}, std::array{-0.5, -0.7}}) {
    view.pose(std::array{at[0], at[1], 0.0, 1.0, 0.0, 0.0, 0.0});
    view.draw({0, 0, kWidth, kHeight}, {});
    offscreen.finish();
    const Point seen = centre(offscreen.pixels(), false);
    const double per_m = 0.5 * kHeight / (2.0 * std::tan(0.5 * 60.0 * 3.14159265358979 / 180.0));
    EXPECT_NEAR(seen.x, 0.5 * kWidth + per_m * at[0], 1.0);
    EXPECT_NEAR(seen.y, 0.5 * kHeight - per_m * at[1], 1.0);
  }
}

TEST(SceneView, KnowsWhereAnArrowEnds) {
  Model model = ball();
  Offscreen offscreen(kWidth, kHeight);
  SceneView view(offscreen, model, camera_id(model, "above"), kFastLook);
  // Rotated by 90 degrees about z: the site's x axis is the world's y axis.
  view.pose(std::array{0.1, 0.0, 0.0, std::sqrt(0.5), 0.0, 0.0, std::sqrt(0.5)});
  SceneArrow arrow;
  arrow.site = model.id(mjOBJ_SITE, "side");
  arrow.in_site_frame = true;
  arrow.vector_m = {0.3, 0.0, 0.0};
  arrow.colour = kRed;
  view.draw({0, 0, kWidth, kHeight}, {arrow});
  offscreen.finish();
  const Point seen = centre(offscreen.pixels(), true);
  const auto ends = view.ends_of(arrow);
  ASSERT_TRUE(ends);
  const Point* const end = &ends->to;
  const double per_m = 0.5 * kHeight / (2.0 * std::tan(0.5 * 60.0 * 3.14159265358979 / 180.0));
  EXPECT_NEAR(end->x, 0.5 * kWidth + per_m * 0.1, 0.1);
  EXPECT_NEAR(end->y, 0.5 * kHeight - per_m * 0.5, 0.1);
  // The arrow reaches from the site at 0.2 m to 0.5 m.
  EXPECT_NEAR(seen.x, end->x, 1.5);
  int top = kHeight;
  int bottom = 0;
  for (int i = 0; i < kWidth * kHeight; ++i) {
    const std::uint8_t* p = &offscreen.pixels()[4 * static_cast<std::size_t>(i)];
    if (p[2] <= p[0] + 60) continue;
    top = std::min(top, i / kWidth);
    bottom = std::max(bottom, i / kWidth + 1);
  }
  EXPECT_NEAR(top, end->y, 2.0);
  EXPECT_NEAR(bottom, end->y + 0.3 * per_m, 2.0);
}

TEST(SceneView, AnUnknownCameraIsRefusedByName) {
  const Model model = ball();
  EXPECT_EQ(camera_id(model, ""), -1);
  EXPECT_TRUE(
      has(complaint_of([&] { camera_id(model, "below"); }), "has no camera \"below\", but above"));
}

TEST(InterpolateQpos, TurnsTheShortestWay) {
  PictureRun run{.model = ball()};
  const Eigen::Quaterniond a(Eigen::AngleAxisd(0.4, Eigen::Vector3d(1, 2, 3).normalized()));
  Eigen::Quaterniond b(Eigen::AngleAxisd(1.3, Eigen::Vector3d(-1, 0.5, 1).normalized()));
  b.coeffs() *= -1.0;  // the same rotation
  run.times_s = {0.0, 1.0};
  run.qpos = {2, 7, {1, 2, 3, a.w(), a.x(), a.y(), a.z(), 2, 0, 3, b.w(), b.x(), b.y(), b.z()}};
  std::vector<double> qpos;
  interpolate_qpos(run, 0.3, qpos);
  EXPECT_NEAR(qpos[0], 1.3, 1e-12);
  EXPECT_NEAR(qpos[1], 1.4, 1e-12);
  const Eigen::Quaterniond expected = a.slerp(0.3, b);
  const Eigen::Quaterniond turned(qpos[3], qpos[4], qpos[5], qpos[6]);
  EXPECT_LT(expected.angularDistance(turned), 1e-9);
}

// Half-transparent blue: half of the background is visible, not black.
TEST(Picture, ATranslucentGeomShowsTheBackground) {
  std::vector<PictureRun> runs;
  runs.push_back({.model = load(R"(<mujoco><worldbody>
      <camera name="side" pos="0 -4 0" xyaxes="1 0 0 0 0 1" fovy="40"/>
      <geom type="plane" size="0.5 0.5 0.1" zaxis="0 -1 0" rgba="0 0 0 0.5"/>
      <body pos="0 0 9"><joint type="slide"/><geom type="sphere" size="0.01" mass="1"/></body>
      </worldbody></mujoco>)")});
  runs.back().camera = 0;
  runs.back().times_s = {0.0, 1.0};
  runs.back().qpos = {2, 1, {0.0, 0.0}};
  Picture picture(runs, {.width = kWidth, .height = kHeight, .look = kFastLook, .captions = false});
  const std::uint8_t* pixels = picture.draw(0.0);
  const auto grey = [&](int x, int y) { return pixels[4 * (y * kWidth + x) + 1]; };
  const int background = grey(2, kHeight / 2);
  EXPECT_GT(background, 200);
  // Black with a highlight of at most 50.
  const int through = grey(kWidth / 2, kHeight / 2);
  EXPECT_GE(through, background / 2 - 4);
  EXPECT_LE(through, background / 2 + 50);
}

// Changes besides qpos: a scenario changes the heights of a height field.
TEST(Picture, ShowsTheMovingParts) {
  const auto run = [](bool moves) {
    PictureRun staged{.model = load(R"(<mujoco><asset>
      <hfield name="water" nrow="2" ncol="2" size="1 1 0.5 0.1"/></asset><worldbody>
      <light pos="0 0 3"/><camera name="side" pos="0 -4 0.2" xyaxes="1 0 0 0 0 1" fovy="40"/>
      <geom type="hfield" hfield="water" rgba="0 0.3 1 1"/>
      <body><joint type="slide"/><geom type="sphere" size="0.01" mass="1"/></body>
      </worldbody></mujoco>)")};
    staged.camera = 0;
    staged.times_s = {0.0, 1.0};
    staged.qpos = {2, 1, {0.0, 0.0}};
    if (moves) {
      staged.animate = [](Model& model, double time_s) {
        std::fill_n(model.get()->hfield_data, 4, static_cast<float>(time_s));
      };
    }
    return staged;
  };
  const auto blue_rows = [](const std::uint8_t* pixels) {
    int rows = 0;
    for (int y = 0; y < kHeight; ++y) {
      const std::uint8_t* p = pixels + 4 * (y * kWidth + kWidth / 2);
      rows += p[0] > p[2] + 60 ? 1 : 0;
    }
    return rows;
  };
  PictureStyle style{.width = kWidth, .height = kHeight, .look = kFastLook, .captions = false};
  for (const bool moves : {false, true}) {
    std::vector<PictureRun> runs;
    runs.push_back(run(moves));
    Picture picture(runs, style);
    const int before = blue_rows(picture.draw(0.0));
    const int after = blue_rows(picture.draw(1.0));
    if (moves) {
      EXPECT_GT(after, before + 15) << "the surface rises by half a metre";
    } else {
      EXPECT_EQ(after, before);
    }
  }
}

// The appearance of a model as data agrees with the model's file.

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

using Json = nlohmann::ordered_json;

// A model's description, and the assets that it names.
struct Described {
  SceneAssets assets;
  Json scene;

  Described(const Model& model, const std::vector<int>& geoms)
      : scene(describe_scene(model, geoms, {}, assets)) {}
  explicit Described(const Model& model) : Described(model, all_of(model->ngeom)) {}

  static std::vector<int> all_of(int count) {
    std::vector<int> all(static_cast<std::size_t>(count));
    std::iota(all.begin(), all.end(), 0);
    return all;
  }
  const Json& geom(const std::string& name) const {
    return *std::find_if(scene["geoms"].begin(), scene["geoms"].end(),
                         [&](const Json& one) { return one["name"] == name; });
  }
  const Json& asset(const Json& number) const { return assets.all().at(number.get<std::size_t>()); }
};

// Decodes base64, then zlib.
template <typename Number>
std::vector<Number> unpacked(const std::string& text, std::size_t count) {
  std::vector<std::uint8_t> stream;
  const std::string digits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  for (std::size_t i = 0; i < text.size(); i += 4) {
    unsigned word = 0;
    for (std::size_t k = 0; k < 4; ++k) {
      word =
          word << 6U | (text[i + k] == '=' ? 0U : static_cast<unsigned>(digits.find(text[i + k])));
    }
    for (unsigned shift : {16U, 8U, 0U}) stream.push_back(static_cast<std::uint8_t>(word >> shift));
  }
  std::vector<Number> back(count);
  uLongf size = count * sizeof(Number);
  EXPECT_EQ(uncompress(reinterpret_cast<Bytef*>(back.data()), &size, stream.data(), stream.size()),
            Z_OK);
  EXPECT_EQ(size, count * sizeof(Number));
  return back;
}

TEST(PageData, BytesArePackedAsAZlibStream) {
  const std::vector<std::uint8_t> bytes(10000, 7);
  const std::string text = packed_bytes(bytes);
  EXPECT_LT(text.size(), 100U);
  EXPECT_EQ(unpacked<std::uint8_t>(text, bytes.size()), bytes);
}

TEST(SceneDescription, HasShapesSizesAndColours) {
  const Model model = robot();
  const Described all(model);
  const Json& own = all.geom("own");
  EXPECT_EQ(own["shape"], "box");
  EXPECT_EQ(own["size"], (Json{0.1, 0.2, 0.3}));
  // The geom's own colour has priority over the material's.
  EXPECT_NEAR(own["rgba"][0], 0.9, 1e-6);
  EXPECT_NEAR(own["specular"], 0.9, 1e-6);
  const Json& painted = all.geom("painted");
  EXPECT_NEAR(painted["rgba"][3], 0.4, 1e-6);
  EXPECT_NEAR(painted["shininess"], 0.7, 1e-6);
  EXPECT_EQ(painted["shape"], "capsule");
  const Json& scene = all.scene;
  EXPECT_EQ(scene["bodies"].at(painted["body"].get<std::size_t>()), "arm");
  EXPECT_EQ(scene["centre"], (Json{1.0, 2.0, 3.0}));
  EXPECT_NEAR(scene["headlight"]["diffuse"][2], 0.3, 1e-6);
  ASSERT_EQ(scene["lights"].size(), 1U);
  EXPECT_EQ(scene["lights"][0]["directional"], false);
  EXPECT_NEAR(scene["lights"][0]["cutoff"], 30.0, 1e-6);
  ASSERT_EQ(scene["cameras"].size(), 1U);
  EXPECT_EQ(scene["cameras"][0]["name"], "eye");
  EXPECT_NEAR(scene["cameras"][0]["fovy"], 33.0, 1e-9);
}

TEST(SceneDescription, HasEachNeededAssetOnce) {
  const Model model = robot();
  const Described all(model);
  EXPECT_EQ(all.assets.all().size(), 4U) << "a mesh, a height field and two textures";
  EXPECT_EQ(all.geom("wedge")["asset"], all.geom("wedge2")["asset"]);
  const Json& mesh = all.asset(all.geom("wedge")["asset"]);
  const auto v = unpacked<float>(mesh["vertices"], 12);
  unpacked<float>(mesh["normals"], 12);
  EXPECT_EQ(mesh["wide"], false);
  // The faces of a tetrahedron point outward.
  const auto vertex = [&](int i) { return Eigen::Vector3d(v[3 * i], v[3 * i + 1], v[3 * i + 2]); };
  const Eigen::Vector3d middle = 0.25 * (vertex(0) + vertex(1) + vertex(2) + vertex(3));
  const auto faces = unpacked<std::uint16_t>(mesh["faces"], 12);
  for (std::size_t f = 0; f < 12; f += 3) {
    const Eigen::Vector3d a = vertex(faces[f]);
    const Eigen::Vector3d b = vertex(faces[f + 1]);
    const Eigen::Vector3d c = vertex(faces[f + 2]);
    EXPECT_GT((b - a).cross(c - a).dot(a - middle), 0.0);
  }
  const Json& hills = all.asset(all.geom("hills")["asset"]);
  EXPECT_EQ(hills["rows"], 3);
  unpacked<float>(hills["heights"], 6);
  const Json& ground = all.geom("ground");
  const Json& tiles = all.asset(ground["texture"]);
  const auto rgb = unpacked<std::uint8_t>(tiles["rgb"], std::size_t{8} * 8 * 3);
  EXPECT_EQ(tiles["cube"], false);
  EXPECT_EQ(rgb[0] + rgb[2], 255);  // red or blue
  EXPECT_EQ(ground["uniform"], true);
  EXPECT_EQ(ground["repeat"], (Json{3.0, 4.0}));
  EXPECT_EQ(all.asset(all.scene["sky"])["cube"], true);
  // Without the geoms their assets are left out.
  const Described one(model, {model.id(mjOBJ_GEOM, "own")});
  EXPECT_EQ(one.assets.all().size(), 1U) << "the sky";
  EXPECT_EQ(one.scene["geoms"].size(), 1U);
}

TEST(SceneDescription, ListsTheDrawnGeoms) {
  const Model model = robot();
  const auto drawn = [&](const char* name) { return is_drawn(model, model.id(mjOBJ_GEOM, name)); };
  EXPECT_TRUE(drawn("own") && drawn("painted") && drawn("ground"));
  EXPECT_FALSE(drawn("unseen"));
  EXPECT_FALSE(drawn("clear"));
}

TEST(ScenePoser, TurnsTheArmAboutItsJoint) {
  const Model model = robot();
  ScenePoser poser(model);
  const double angle = 0.7;
  poser.pose(std::array{angle});
  const Pose arm = poser.body(model.id(mjOBJ_BODY, "arm"));
  EXPECT_NEAR(arm[0], 1.0, 1e-12);  // the joint is above the body's origin
  EXPECT_NEAR(arm[3], std::cos(0.5 * angle), 1e-12);
  EXPECT_NEAR(arm[6], std::sin(0.5 * angle), 1e-12);
  const Pose eye = poser.camera(0);
  EXPECT_NEAR(eye[1], -3.0, 1e-12);
  // The camera looks along +y, which is its −z axis: a quarter turn about x.
  EXPECT_NEAR(std::abs(eye[3]), std::sqrt(0.5), 1e-12);
  EXPECT_NEAR(std::abs(eye[4]), std::sqrt(0.5), 1e-12);
}

}  // namespace breakwater::scene_view_test
