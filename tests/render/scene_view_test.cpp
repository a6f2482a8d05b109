// The scene is drawn at the geometrically right places.
#include <breakwater/render/scene_view.h>

#include <Eigen/Geometry>
#include <array>

#include <breakwater/render/offscreen.h>
#include <breakwater/render/picture.h>
#include "support.h"

namespace breakwater::scene_view_test {
namespace {

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
  ASSERT_FALSE(offscreen.slowness()) << offscreen.renderer();
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
  const Model model = ball();
  const Eigen::Quaterniond a(Eigen::AngleAxisd(0.4, Eigen::Vector3d(1, 2, 3).normalized()));
  Eigen::Quaterniond b(Eigen::AngleAxisd(1.3, Eigen::Vector3d(-1, 0.5, 1).normalized()));
  b.coeffs() *= -1.0;  // the same rotation
  const std::array<double, 7> first = {1, 2, 3, a.w(), a.x(), a.y(), a.z()};
  const std::array<double, 7> second = {2, 0, 3, b.w(), b.x(), b.y(), b.z()};
  std::vector<double> qpos;
  interpolate_qpos(*model.get(), first, second, 0.3, qpos);
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

}  // namespace
}  // namespace breakwater::scene_view_test
