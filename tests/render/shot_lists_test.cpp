// Every scenario's shot list against a run of its scenario.
#include <gtest/gtest.h>

#include <cmath>

#include "cli/program.h"
#include "render/media.h"
#include "scenario/scenario.h"
#include "scenario/shot_list.h"
#include "support.h"

namespace breakwater {
namespace {
namespace fs = std::filesystem;
using testing::ProgramResult;
using testing::run_program;

class ShotLists : public ::testing::TestWithParam<std::string> {};

TEST_P(ShotLists, FitARunOfTheirScenario) {
  const fs::path folder = testing::temporary_path("shots_" + GetParam());
  const testing::Removed removed(folder);
  fs::create_directories(folder);
  ASSERT_TRUE(fs::exists(testing::source_file("renders/" + GetParam() + ".toml")))
      << "every scenario has a shot list";
  const ShotList shots = shot_list(GetParam());

  // The default case, as far as the shot list goes.
  const ProgramResult run = run_program({"breakwater", "run", GetParam(), "--quiet", "--duration",
                                         std::to_string(shots.to_s), "--out", "run"},
                                        folder);
  ASSERT_EQ(run.status, 0) << run.err;

  constexpr int kFps = 2;
  const ProgramResult video = run_program({"breakwater", "video", "run", "--look", "fast", "--size",
                                           "640x480", "--fps", std::to_string(kFps)},
                                          folder);
  ASSERT_EQ(video.status, 0) << video.err;
  EXPECT_TRUE(video.err.empty()) << video.err;
  const auto frames = std::llround((shots.to_s - shots.from_s) / shots.speed * kFps);
  EXPECT_EQ(testing::probe(folder / "run/video.mp4", "nb_read_frames"), std::to_string(frames));

  const ProgramResult strip =
      run_program({"breakwater", "strip", "run", "--look", "fast", "--size", "320x240"}, folder);
  ASSERT_EQ(strip.status, 0) << strip.err;
  // All of the moments come, side by side.
  const testing::Png png(folder / "run/strip.png");
  const auto count = static_cast<int>(shots.moments.size());
  EXPECT_GE(count, 2);
  EXPECT_GE(png.width, 320 * count);
  EXPECT_LT(png.width, 320 * count + 20 * count);
}

INSTANTIATE_TEST_SUITE_P(All, ShotLists, ::testing::ValuesIn(scenario_names()),
                         [](const auto& list) { return list.param; });

// Colours that differ from the gallery's by more than this are another picture; other versions of
// Mesa differ by less than 0.5.
constexpr double kSamePicture = 2.0;

TEST(Gallery, ShowsWhatIsDrawnNow) {
  const fs::path folder = testing::temporary_path("gallery");
  const testing::Removed removed(folder);
  fs::create_directories(folder);
  ASSERT_EQ(run_program({"arm_wall_contact", "--quiet", "--duration", "32", "--out", "run"}, folder)
                .status,
            0);
  ASSERT_EQ(run_program({"breakwater", "still", "run", "--at", "30.58", "--size", "960x540",
                         "--out", "still.png"},
                        folder)
                .status,
            0);
  const testing::Png now(folder / "still.png");
  const testing::Png shown(testing::source_file("renders/gallery/arm_wall_contact.png"));
  EXPECT_LT(testing::mean_difference(now, shown), kSamePicture);
  // The measure tells pictures apart: 40 ms earlier the force and the pose are others.
  ASSERT_EQ(run_program({"breakwater", "still", "run", "--at", "30.3", "--size", "960x540", "--out",
                         "other.png"},
                        folder)
                .status,
            0);
  EXPECT_GT(testing::mean_difference(testing::Png(folder / "other.png"), shown), kSamePicture);
}

}  // namespace
}  // namespace breakwater
