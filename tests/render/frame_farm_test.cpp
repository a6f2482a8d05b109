// Frames from several processes: all arrive in order, whatever happens to a process.
#include <breakwater/render/frame_farm.h>

#include <csignal>

#include <cstring>

#include <breakwater/record/output_error.h>
#include <breakwater/render/render_error.h>
#include <breakwater/render/video_file.h>
#include "support.h"

namespace breakwater::frame_farm_test {

struct Frame {
  std::size_t number;
  pid_t process;
};

FrameFarm farm_of(std::size_t frames, unsigned processes) {
  FrameFarm farm;
  farm.frames = frames;
  farm.frame_bytes = sizeof(Frame);
  farm.processes = processes;
  return farm;
}

void write_frame(std::size_t number, std::uint8_t* memory) {
  const Frame frame{number, getpid()};
  std::memcpy(memory, &frame, sizeof(frame));
}

TEST(FrameFarm, GivesAllFramesInOrderFromAllProcesses) {
  std::vector<std::size_t> numbers;
  std::set<pid_t> processes;
  draw_frames(
      farm_of(300, 3),
      [](std::size_t) -> DrawFrame {
        return [](std::size_t number, std::uint8_t* memory) {
          usleep(static_cast<useconds_t>(200 * (number % 7)));  // they finish in a different order
          write_frame(number, memory);
        };
      },
      [&](const std::uint8_t* memory) {
        Frame frame{};
        std::memcpy(&frame, memory, sizeof(frame));
        numbers.push_back(frame.number);
        processes.insert(frame.process);
      });
  ASSERT_EQ(numbers.size(), 300U);
  for (std::size_t i = 0; i < numbers.size(); ++i) EXPECT_EQ(numbers[i], i);
  EXPECT_EQ(processes.size(), 3U);
  EXPECT_FALSE(processes.contains(getpid()));
}

TEST(FrameFarm, ASlowConsumerLosesNoFrame) {
  std::size_t taken = 0;
  draw_frames(
      farm_of(60, 2), [](std::size_t) -> DrawFrame { return write_frame; },
      [&](const std::uint8_t* memory) {
        usleep(3000);
        Frame frame{};
        std::memcpy(&frame, memory, sizeof(frame));
        EXPECT_EQ(frame.number, taken++);
      });
  EXPECT_EQ(taken, 60U);
}

TEST(FrameFarm, AnErrorOfAProcessKeepsItsMessage) {
  try {
    draw_frames(
        farm_of(20, 2),
        [](std::size_t) -> DrawFrame {
          return [](std::size_t number, std::uint8_t*) {
            if (number == 7) throw std::runtime_error("the seventh does not work");
          };
        },
        [](const std::uint8_t*) {});
    FAIL();
  } catch (const RenderError& error) {
    EXPECT_STREQ(error.what(), "the seventh does not work");
  }
}

TEST(FrameFarm, ACrashIsAnErrorToo) {
  try {
    draw_frames(
        farm_of(20, 2),
        [](std::size_t) -> DrawFrame {
          return [](std::size_t number, std::uint8_t*) {
            if (number == 5) kill(getpid(), SIGKILL);
          };
        },
        [](const std::uint8_t*) {});
    FAIL();
  } catch (const RenderError& error) {
    EXPECT_TRUE(has(std::string(error.what()), "signal 9")) << error.what();
  }
}

TEST(FrameFarm, AnErrorOfTheConsumerEndsIt) {
  EXPECT_THROW(draw_frames(
                   farm_of(1000, 2), [](std::size_t) -> DrawFrame { return write_frame; },
                   [](const std::uint8_t*) { throw OutputError("the disk is full"); }),
               OutputError);
}

TEST(FrameFarm, StopsWhenAsked) {
  std::atomic<bool> stop = false;
  FrameFarm farm = farm_of(1000000, 2);
  farm.stop = &stop;
  EXPECT_THROW(draw_frames(
                   farm, [](std::size_t) -> DrawFrame { return write_frame; },
                   [&](const std::uint8_t*) { stop = true; }),
               Stopped);
}

TEST(VideoFile, NamesAMissingEncoder) {
  const auto file = testing::temporary_path("none.mp4");
  try {
    VideoFile video(file, {.width = 64, .height = 64, .fps = 30, .encoder = "libx999"});
    FAIL();
  } catch (const RenderError& error) {
    EXPECT_STREQ(error.what(), "video: FFmpeg's libraries have no encoder libx999");
  }
  EXPECT_FALSE(std::filesystem::exists(file));
}

}  // namespace breakwater::frame_farm_test
