// Pictures and videos of runs: they are right and repeatable, and their failure does not harm the
// run.
#include <nlohmann/json.hpp>

#include <breakwater/pictures/staging.h>
#include <breakwater/sim/model.h>
#include "catalogue.h"
#include "environment.h"
#include "render/media.h"
#include "tables.h"

namespace breakwater::pictures_test {
namespace fs = std::filesystem;
using testing::Environment;
using testing::Png;
using testing::probe;

// The wall experiment in 6 s: contact at about 5.53 s.
const std::string kShortWall =
    "arm_wall_contact --quiet --duration 6 --set wall.solid_from_s=4 force.from_s=5 "
    "metrics.from_s=5.5 metrics.to_s=6 record.fine_from_s=5 record.fine_to_s=6 ";

class Pictures : public testing::ProgramTest {
 protected:
  nlohmann::json json(const std::string& file) const { return nlohmann::json::parse(read(file)); }
  // A run of the wall experiment in folder NAME.
  void wall(const std::string& name, const std::string& case_name = "proposed-2N") {
    ran(kShortWall + "--case " + case_name + " --out " + name);
  }
  // A quick run: half a second of arm_push.
  void push(const std::string& name) { ran("arm_push --quiet --duration 0.5 --out " + name); }
};

TEST_F(Pictures, PicturesOfOneMomentAreAlike) {
  push("run");
  // The software renderer, also where a GPU is the first device.
  const Environment software("LIBGL_ALWAYS_SOFTWARE", "1");
  for (const std::string asked : {"osmesa", "egl"}) {
    const Environment library("MUJOCO_GL", asked);
    ran("breakwater still run --at 0.3 --size 320x180 --look full");
    const std::string said = ran("breakwater video run --from 0.1 --to 0.3 --size 320x180");
    EXPECT_TRUE(has(said, " by llvmpipe", ", EGL: ")) << said;
    testing::output_of("cd " + folder_.string() + " && ffmpeg -v error -i run/video.mp4 " +
                       "-vf 'select=eq(n\\,0)+eq(n\\,4)' -vsync 0 " + asked + "%d.png");
    fs::rename(folder_ / "run/still.png", folder_ / (asked + ".png"));
  }
  for (const char* picture : {".png", "1.png", "2.png"}) {
    EXPECT_EQ(mean_difference(Png(folder_ / ("osmesa" + std::string(picture))),
                              Png(folder_ / ("egl" + std::string(picture)))),
              0.0)
        << picture;
  }
  // Different pictures differ.
  ran("breakwater still run --at 0.3 --size 320x180 --look full --camera top");
  EXPECT_GT(mean_difference(Png(folder_ / "run/still.png"), Png(folder_ / "egl.png")), 3.0);
}

TEST_F(Pictures, RunsStandSideBySide) {
  wall("a");
  wall("b", "drac-2N");
  ran("breakwater video a b a --from 5.5 --to 5.55 --speed 0.1 --size 640x360 --look fast");
  EXPECT_EQ(probe(folder_ / "a/video.mp4", "width"), "640");
  EXPECT_EQ(probe(folder_ / "a/video.mp4", "nb_read_frames"), "15");
  // The first and the third run are equal, so these thirds of the picture are equal.
  ran("breakwater still a b a --at 5.6 --size 720x360 --look fast --out s.png");
  const Png png(folder_ / "s.png");
  ASSERT_EQ(png.width, 720);
  const auto difference = [&](int column_a, int column_b) {
    double sum = 0.0;
    for (int y = 0; y < png.height; ++y) {
      for (int i = 4 * 4; i < 4 * (240 - 4); ++i) {  // without the lines in between
        const auto row = static_cast<std::size_t>(4 * y * png.width);
        sum += std::abs(png.pixels[row + static_cast<std::size_t>(4 * column_a + i)] -
                        png.pixels[row + static_cast<std::size_t>(4 * column_b + i)]);
      }
    }
    return sum / (4.0 * 232 * png.height);
  };
  EXPECT_LT(difference(0, 480), 0.05);
  EXPECT_GT(difference(0, 240), 0.5);
}

// The columns with the tip's red, right of the middle.
struct Columns {
  int first = 100000;
  int last = -1;
};

Columns red_columns(const std::uint8_t* pixels, int width, int height) {
  Columns columns;
  for (int i = 0; i < width * height; ++i) {
    const std::uint8_t* p = pixels + static_cast<std::ptrdiff_t>(4 * i);
    if (p[2] > p[1] + 90 && p[2] > p[0] + 90) {
      columns.first = std::min(columns.first, i % width);
      columns.last = std::max(columns.last, i % width);
    }
  }
  return columns;
}

// A long caption fits beside the chart in a small picture too.
TEST_F(Pictures, ALongCaptionStandsBesideTheChart) {
  ran(kShortWall + "controller.name=hpfc --out run");
  const FinishedRun finished(testing::catalogue(), SavedRun(folder_ / "run"));
  PictureStage stage =
      stage_pictures({&finished, 1}, shot_list(finished.shots_file()), "", {5.0, 6.0, 0.1});
  EXPECT_EQ(stage.runs.front().caption, "proposed-2N with hpfc") << "the controller is said";
  constexpr int kWidth = 480, kHeight = 270;
  stage.style.width = kWidth;
  stage.style.height = kHeight;
  stage.style.look = kFastLook;
  const auto pixels = [&](const std::string& caption) {
    stage.runs.front().caption = caption;
    Picture picture(stage.runs, stage.style);
    const std::uint8_t* const first = picture.draw(5.0);
    return std::vector<std::uint8_t>(first, first + 4 * kWidth * kHeight);
  };
  const auto with_short = pixels("a");
  const auto with_long = pixels("hpfc-2N with a_controller_of_a_very_long_name");
  // The chart takes 250 columns on the right and a margin of 12. The rest is between it and the
  // box.
  std::size_t differing = 0;
  for (int y = 0; y < kHeight; ++y) {
    for (int x = 0; x < kWidth; ++x) {
      const auto at = static_cast<std::size_t>(4 * (y * kWidth + x));
      if (std::equal(&with_short[at], &with_short[at] + 4, &with_long[at])) continue;
      ++differing;
      EXPECT_LT(x, kWidth - 250 - 2 * 12) << "in line " << y;
    }
  }
  EXPECT_GT(differing, 500U) << "the caption is there";
}

TEST_F(Pictures, TheTipTouchesTheWallInTheImpactStill) {
  wall("run");
  const FinishedRun run(testing::catalogue(), SavedRun(folder_ / "run"));
  ShotList shots = shot_list(run.shots_file());
  const auto impact = std::find_if(shots.moments.begin(), shots.moments.end(),
                                   [](const ShotMoment& m) { return m.caption == "impact"; });
  ASSERT_NE(impact, shots.moments.end());
  ShotMoment moment = *impact;
  moment.at_s = 5.0;  // force control begins earlier in this run
  const auto impact_s = time_of(moment, run);
  ASSERT_TRUE(impact_s);
  EXPECT_NEAR(*impact_s, 5.0 + json("run/metrics.json")["free_motion_time_s"].get<double>(), 1e-3);

  shots.arrows.clear();  // only the tip is red now
  shots.lines.clear();
  std::vector<PictureRun> runs;
  runs.push_back(stage(run, shots, "top"));
  const Model& model = runs.front().model;
  const PictureStyle style{.width = 1280, .height = 720, .look = kFastLook, .captions = false};

  // The place where the camera, which looks straight down, sees the wall's face at the tip's
  // height.
  const int camera = runs.front().camera;
  const double face_x = 0.45 + 0.089;
  const double per_m = 360.0 / (model->cam_pos[3 * camera + 2] *
                                std::tan(0.5 * model->cam_fovy[camera] * 3.14159265358979 / 180));
  const double face_px = 640.0 + per_m * (face_x - model->cam_pos[3 * camera]);

  Picture picture(runs, style);
  const Columns touching = red_columns(picture.draw(*impact_s), 1280, 720);
  EXPECT_NEAR(touching.last + 1, face_px, 3.0);
  const Columns before = red_columns(picture.draw(*impact_s - 0.1), 1280, 720);
  EXPECT_LT(before.last + 1, face_px - 0.012 * per_m);  // at 0.19 m/s
}

TEST_F(Pictures, AWallOfATableStandsWhereItsTableSays) {
  write("wall.csv", "time_s,position_m\n5,0\n6,0.04\n");
  ran(kShortWall + "wall.motion=csv wall.file=wall.csv --out run");
  ran("breakwater still run --at 5.5 --size 320x180 --out still.png");
  const FinishedRun run(testing::catalogue(), SavedRun(folder_ / "run"));
  PictureRun staged = stage(run, shot_list(run.shots_file()), "top");
  const int wall = geom_id(staged.model, "wall");
  for (const auto& [time_s, moved_m] : {std::pair(4.0, 0.0), {5.25, 0.01}, {6.0, 0.04}}) {
    staged.animate(staged.model, time_s);
    EXPECT_NEAR(staged.model->geom_pos[3 * wall], 0.45 + 0.089 + moved_m, 1e-12) << time_s;
  }
}

TEST_F(Pictures, TheChartEndsWhereTheLogSays) {
  wall("run");
  const FinishedRun run(testing::catalogue(), SavedRun(folder_ / "run"));
  const ShotList shots = shot_list(run.shots_file());
  std::vector<PictureRun> runs;
  runs.push_back(stage(run, shots, ""));
  PictureStyle style{.width = 1280, .height = 720, .look = kFastLook};
  style.chart_range = {5.4, 6.0, 0.0, 10.0};
  Picture picture(runs, style);
  const LoggedSignal times = read_hdf5_signal((folder_ / "run/log.h5").string(), "control/time_s");
  const LoggedSignal force =
      read_hdf5_signal((folder_ / "run/log.h5").string(), "control/force_true_N");
  int charged = 0;
  for (const std::size_t row : {5450U, 5560U, 5600U, 5900U}) {
    const double time_s = times.values[row];
    const std::uint8_t* pixels = picture.draw(time_s);
    const Point dot = picture.chart(0).place(time_s, force.values[row]);
    const Rectangle& area = picture.chart_area(0);
    const int x = static_cast<int>(std::lround(area.left + dot.x - 0.5));
    const int y = static_cast<int>(std::lround(area.top + dot.y - 0.5));
    const Colour colour = on_paper(0);
    for (int dy = -2; dy <= 2; ++dy) {
      const std::uint8_t* p = pixels + static_cast<std::ptrdiff_t>(4 * ((y + dy) * 1280 + x));
      EXPECT_NEAR(p[2], 255.0 * colour.red, 3.0) << time_s;
      EXPECT_NEAR(p[1], 255.0 * colour.green, 3.0) << time_s;
    }
    charged += force.values[row] > 1.0 ? 1 : 0;
  }
  EXPECT_GT(charged, 0) << "the test looks at no contact";
}

TEST_F(Pictures, AScenarioWithoutAShotListIsDrawnToo) {
  push("run");
  const ShotList shots = shot_list("no_such_file.toml");
  std::vector<FinishedRun> finished;
  finished.emplace_back(testing::catalogue(), SavedRun(folder_ / "run"));
  const Window window = choose_window(finished, shots, {});
  EXPECT_DOUBLE_EQ(window.from_s, 0.0);
  EXPECT_NEAR(window.to_s, 0.5, 1e-9);
  EXPECT_EQ(window.frames(30), 15U);
  std::vector<PictureRun> runs;
  runs.push_back(stage(finished.front(), shots, ""));
  Picture picture(runs, {.width = 320, .height = 240, .look = kFastLook});
  const std::uint8_t* pixels = picture.draw(0.2);
  // The arm's orange caps are visible.
  int orange = 0;
  for (int i = 0; i < 320 * 240; ++i) {
    const std::uint8_t* p = pixels + static_cast<std::ptrdiff_t>(4 * i);
    orange += p[2] > 180 && p[0] < 90 && p[1] > 90 && p[1] < 190 ? 1 : 0;
  }
  EXPECT_GT(orange, 20);
}

TEST_F(Pictures, ShotListsAreCheckedLikeScenarioFiles) {
  const std::string text =
      testing::text_of(testing::source_file("scenarios/arm_wall_contact/shots.toml"));
  const std::string file = folder_ / "shots.toml";
  for (const auto& row : testing::rows_of("ShotLists")) {
    write("shots.toml", testing::replaced(text, row.at(0), row.at(1)));
    EXPECT_EQ(testing::complaint_of([&] { shot_list(file); }),
              file + ":" + testing::line_of(text, row.at(0)) + ": " + row.at(2));
  }
}

}  // namespace breakwater::pictures_test
