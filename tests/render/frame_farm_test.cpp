// Frames from several processes: all arrive in order, whatever happens to a process.
#include <breakwater/render/frame_farm.h>

#include <csignal>
#include <cstdio>
#include <memory>

#include <breakwater/record/interrupted.h>
#include <breakwater/record/output_error.h>
#include <breakwater/render/render_error.h>
#include <breakwater/render/video_file.h>
#include "environment.h"
#include "shell.h"
#include "support.h"

namespace breakwater::frame_farm_test {

struct Frame {
  std::size_t number;
  pid_t process;
};

// The frames of a farm, as its processes have passed them on.
std::vector<Frame> drawn(const FrameFarm& farm, useconds_t draws_us, useconds_t takes_us) {
  const std::unique_ptr<std::FILE, int (*)(std::FILE*)> taken(std::tmpfile(), std::fclose);
  draw_frames(
      farm,
      [=](std::size_t) -> Drawer {
        const auto frame = std::make_shared<Frame>();
        return {[=](std::size_t number) {
          usleep(static_cast<useconds_t>(draws_us * (number % 7)));  // not in their order
          *frame = {number, getpid()};
          return reinterpret_cast<const std::uint8_t*>(frame.get());
        }};
      },
      [&](const std::uint8_t* frame) {
        usleep(takes_us);
        EXPECT_EQ(write(fileno(taken.get()), frame, sizeof(Frame)), ssize_t{sizeof(Frame)});
      });
  std::rewind(taken.get());
  std::vector<Frame> frames(farm.frames + 1);
  frames.resize(std::fread(frames.data(), sizeof(Frame), frames.size(), taken.get()));
  return frames;
}

TEST(FrameFarm, GivesAllFramesInOrderFromAllProcesses) {
  const std::vector<Frame> frames = drawn({.frames = 300, .processes = 3}, 200, 0);
  std::set<pid_t> processes;
  ASSERT_EQ(frames.size(), 300U);
  for (std::size_t i = 0; i < frames.size(); ++i) {
    EXPECT_EQ(frames[i].number, i);
    processes.insert(frames[i].process);
  }
  EXPECT_EQ(processes.size(), 3U);
  EXPECT_FALSE(processes.contains(getpid()));
}

TEST(FrameFarm, ASlowConsumerLosesNoFrame) {
  const std::vector<Frame> frames = drawn({.frames = 60, .processes = 2}, 0, 3000);
  ASSERT_EQ(frames.size(), 60U);
  for (std::size_t i = 0; i < frames.size(); ++i) EXPECT_EQ(frames[i].number, i);
}

// A farm of two processes in which `draw` draws each frame.
void draw_with(
    void (*draw)(std::size_t number), const FrameFarm& farm = {20, 2}, void (*take)() = [] {}) {
  draw_frames(
      farm,
      [=](std::size_t) -> Drawer {
        return {[=](std::size_t number) {
          draw(number);
          return static_cast<const std::uint8_t*>(nullptr);
        }};
      },
      [=](const std::uint8_t*) { take(); });
}

TEST(FrameFarm, AnErrorOfAProcessKeepsItsMessage) {
  try {
    draw_with([](std::size_t number) {
      if (number == 7) throw std::runtime_error("the seventh does not work");
    });
    FAIL();
  } catch (const RenderError& error) {
    EXPECT_STREQ(error.what(), "the seventh does not work");
  }
}

TEST(FrameFarm, ACrashIsAnErrorToo) {
  try {
    draw_with([](std::size_t number) {
      if (number == 5) kill(getpid(), SIGKILL);
    });
    FAIL();
  } catch (const RenderError& error) {
    EXPECT_TRUE(has(std::string(error.what()), "signal 9")) << error.what();
  }
}

TEST(FrameFarm, AnErrorOfTheConsumerEndsIt) {
  EXPECT_THROW(
      draw_with([](std::size_t) {}, {1000, 2}, [] { throw OutputError("the disk is full"); }),
      OutputError);
}

TEST(FrameFarm, StopsWhenAsked) {
  std::atomic<bool> stop = false;
  const FrameFarm farm = {1000000, 2, &stop, [&](double done) { stop = done > 0.0; }};
  EXPECT_THROW(draw_with([](std::size_t) {}, farm), Interrupted);
}

TEST(VideoFile, NeedsFfmpeg) {
  const auto file = testing::temporary_path("none.mp4");
  const breakwater::testing::Environment nowhere("PATH", "/nowhere");
  try {
    VideoFile video(file, {.width = 64, .height = 64});
    FAIL();
  } catch (const RenderError& error) {
    EXPECT_STREQ(error.what(), "videos need ffmpeg: No such file or directory");
  }
  EXPECT_FALSE(std::filesystem::exists(file));
}

struct Ycbcr {
  double y, cb, cr;
};

// Rec. ITU-R BT.709-6, 3 and 4, eight bits.
Ycbcr rec709(double red, double green, double blue) {
  const double y = (0.2126 * red + 0.7152 * green + 0.0722 * blue) / 255.0;
  return {16.0 + 219.0 * y, 128.0 + 224.0 * (blue / 255.0 - y) / 1.8556,
          128.0 + 224.0 * (red / 255.0 - y) / 1.5748};
}

// A frame for each corner of the colour cube, and for some greys.
TEST(VideoFile, HasTheColoursOfTheRecommendation) {
  constexpr int kSide = 64;
  constexpr std::size_t kPixels = kSide * kSide, kFrame = kPixels * 3 / 2;
  std::vector<std::array<std::uint8_t, 3>> colours;  // blue, green, red
  for (int k = 0; k < 8; ++k) {
    const auto part = [k](int c) { return static_cast<std::uint8_t>(255 * (k >> c & 1)); };
    colours.push_back({part(0), part(1), part(2)});
  }
  for (int grey = 5; grey < 256; grey += 10) {
    const auto all = static_cast<std::uint8_t>(grey);
    colours.push_back({all, all, all});
  }
  const testing::TemporaryPath file("colours.mp4");
  VideoFile video(file, {.width = kSide, .height = kSide});
  for (const auto& [blue, green, red] : colours) {
    std::vector<std::uint8_t> pixels;
    for (std::size_t i = 0; i < kPixels; ++i) pixels.insert(pixels.end(), {blue, green, red, 0});
    video.append(pixels.data());
  }
  video.finish();
  EXPECT_EQ(
      testing::output_of("ffprobe -v error -of csv=p=0 -show_entries stream=pix_fmt,color_range,"
                         "color_space,color_transfer,color_primaries,chroma_location " +
                         file.string()),
      "yuv420p,tv,bt709,bt709,bt709,center\n");
  const std::string decoded =
      testing::output_of("ffmpeg -v error -i " + file.string() + " -f rawvideo -pix_fmt yuv420p -");
  ASSERT_EQ(decoded.size(), colours.size() * kFrame);
  for (std::size_t k = 0; k < colours.size(); ++k) {
    const auto& [blue, green, red] = colours[k];
    const Ycbcr exact = rec709(red, green, blue);
    const auto at = [&](std::size_t i) {
      return static_cast<double>(static_cast<std::uint8_t>(decoded[k * kFrame + i]));
    };
    EXPECT_NEAR(at(kPixels / 2), exact.y, 1.0) << k;
    EXPECT_NEAR(at(kPixels + kPixels / 8), exact.cb, 2.0) << k;
    EXPECT_NEAR(at(kPixels + kPixels * 3 / 8), exact.cr, 2.0) << k;
  }
}

}  // namespace breakwater::frame_farm_test
