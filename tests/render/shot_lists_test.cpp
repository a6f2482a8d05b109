#include <breakwater/pictures/shot_list.h>
#include <breakwater/pictures/staging.h>
#include "catalogue.h"
#include "render/media.h"

namespace breakwater::shot_lists_test {
namespace fs = std::filesystem;

constexpr int kWidth = 480;
constexpr int kHeight = 270;

// The smallest share of pixels, over all moments, that change if the moving bodies are not drawn.
double smallest_share_of_the_plant(const FinishedRun& run, ShotList shots) {
  shots.arrows.clear();
  shots.lines.clear();
  const auto pictures = [&](bool with_plant) {
    std::vector<PictureRun> staged;
    staged.push_back(stage(run, shots, ""));
    mjModel& model = *staged.front().model.get();
    for (int i = 0; i < model.ngeom; ++i) {
      const int body = model.geom_bodyid[i];
      if (with_plant || model.body_weldid[body] == 0 || model.body_mocapid[body] >= 0) continue;
      model.geom_group[i] = 5;
    }
    Picture picture(staged,
                    {.width = kWidth, .height = kHeight, .look = kFastLook, .captions = false});
    std::vector<std::vector<std::uint8_t>> all;
    for (const ShotMoment& moment : shots.moments) {
      const std::uint8_t* pixels = picture.draw(*time_of(moment, run));
      all.emplace_back(pixels, pixels + std::ptrdiff_t{4} * kWidth * kHeight);
    }
    return all;
  };
  const auto with = pictures(true);
  const auto without = pictures(false);
  double smallest = 1.0;
  for (std::size_t i = 0; i < with.size(); ++i) {
    int differ = 0;
    for (std::size_t p = 0; p < with[i].size(); p += 4) {
      int most = 0;
      for (std::size_t k = p; k < p + 3; ++k) {
        most = std::max(most, std::abs(with[i][k] - without[i][k]));
      }
      differ += most > 30 ? 1 : 0;
    }
    smallest = std::min(smallest, static_cast<double>(differ) / (kWidth * kHeight));
  }
  return smallest;
}

void expect_arrows_inside(const FinishedRun& run, const ShotList& shots) {
  PictureRun staged = stage(run, shots, "");
  const Offscreen offscreen(kWidth, kHeight);
  SceneView view(offscreen, staged.model, staged.camera, kFastLook);
  for (const ShotMoment& moment : shots.moments) {
    const double time_s = *time_of(moment, run);
    const auto row = std::lower_bound(run.times_s().begin(), run.times_s().end(), time_s - 1e-9) -
                     run.times_s().begin();
    view.pose({run.qpos().row(static_cast<std::size_t>(row)), run.qpos().width});
    view.draw({0, 0, kWidth, kHeight}, {});
    for (std::size_t i = 0; i < staged.arrows.size(); ++i) {
      const auto ends = view.ends_of(arrow_at(staged.arrows[i], time_s));
      const std::string which = shots.arrows[i].track.signal + ", " + moment.caption;
      ASSERT_TRUE(ends) << which;
      for (const Point& end : {ends->from, ends->to}) {
        EXPECT_GE(end.x, 0.0) << which;
        EXPECT_LE(end.x, kWidth) << which;
        EXPECT_GE(end.y, 0.0) << which;
        EXPECT_LE(end.y, kHeight) << which;
      }
    }
  }
}

class ShotLists : public testing::ProgramTest, public ::testing::WithParamInterface<std::string> {};

TEST_P(ShotLists, FitARunOfTheirScenario) {
  if (GetParam() == "plant") GTEST_SKIP() << "the model and the duration are the user's";
  ASSERT_TRUE(fs::exists(testing::source_file("scenarios/" + GetParam() + "/shots.toml")))
      << "every scenario has a shot list";
  const ShotList shots = shot_list(testing::catalogue().get<ScenarioKind>(GetParam()).shots());

  // The default case, up to the end of the shot list.
  ran("breakwater run " + GetParam() + " --quiet --out run --duration " +
      std::to_string(shots.to_s));

  constexpr int kFps = 2;
  EXPECT_EQ(ran("breakwater video run --look fast --size 640x480 --fps " + std::to_string(kFps) +
                " 2>&1 > said"),
            "");
  const auto frames = std::llround((shots.to_s - shots.from_s) / shots.style.speed * kFps);
  EXPECT_EQ(testing::probe(folder_ / "run/video.mp4", "nb_read_frames"), std::to_string(frames));

  ran("breakwater strip run --look fast --size 320x240");
  // All moments are side by side.
  const testing::Png png(folder_ / "run/strip.png");
  const auto count = static_cast<int>(shots.moments.size());
  EXPECT_GE(count, 2);
  EXPECT_GE(png.width, 320 * count);
  EXPECT_LT(png.width, 320 * count + 20 * count);

  const FinishedRun finished(testing::catalogue(), SavedRun(folder_ / "run"));
  const double seen = smallest_share_of_the_plant(finished, shots);
  EXPECT_GT(seen, 0.002) << "in one of the moments the plant is hardly in the picture";
  EXPECT_LT(seen, 0.5);
  expect_arrows_inside(finished, shots);
}

INSTANTIATE_TEST_SUITE_P(All, ShotLists, ::testing::ValuesIn(testing::scenario_names()),
                         [](const auto& list) { return list.param; });

// A larger difference of colours from the gallery means another picture. Other versions of Mesa
// differ by less than 0.5.
constexpr double kSamePicture = 2.0;

using Gallery = testing::ProgramTest;

TEST_F(Gallery, ShowsThePresentPictures) {
  ran("arm_wall_contact --quiet --duration 32 --out run");
  const auto still_at = [&](const std::string& time_s) {
    ran("breakwater still run --size 960x540 --out still.png --at " + time_s);
    return testing::Png(folder_ / "still.png");
  };
  const testing::Png shown(testing::source_file("renders/gallery/arm_wall_contact.png"));
  EXPECT_LT(testing::mean_difference(still_at("30.58"), shown), kSamePicture);
  // The measure separates pictures: 280 ms earlier the force and the pose differ.
  EXPECT_GT(testing::mean_difference(still_at("30.3"), shown), kSamePicture);
}

}  // namespace breakwater::shot_lists_test
