// The streamed log equals the one from memory, and what is left of it after a kill is a part of it.
#include <breakwater/record/hdf5_log.h>
#include <breakwater/record/log_stream.h>
#include <breakwater/record/run_folder.h>
#include "support.h"

namespace breakwater::log_stream_test {

namespace fs = std::filesystem;
using testing::text_of;

constexpr double kPeriod_s = 0.3;
constexpr int kFinePerRow = 10;

// A run with two tracks, of which "physics" is there from row 3 to row 6 of "control".
struct Tracks {
  Tracks(LogStream* stream, std::size_t rows)
      : fine("physics", {{"force_N", "N", "a force, in µN", {&force, 1}}}, 3 * kFinePerRow, stream),
        control("control",
                {{"force_N", "N", "a force", {&force, 1}}, {"q_rad", "rad", "two angles", q}}, rows,
                stream) {}

  void append(int k) {
    for (int i = 0; k >= 3 && k < 6 && i < kFinePerRow; ++i) {
      force = std::sin(kFinePerRow * k + i);
      fine.append(kPeriod_s * (k + 0.1 * i));
    }
    force = std::exp(0.01 * k);
    q[0] = k;
    q[1] = -1.0 / (1.0 + k);
    control.append(kPeriod_s * k);
  }
  // As in a recording.
  std::vector<Track> recorded() {
    std::vector<Track> tracks = {std::move(control)};
    if (fine.rows() > 0) tracks.push_back(std::move(fine));
    return tracks;
  }

  double force = 0.0;
  double q[2] = {0.0, 0.0};
  Track fine;
  Track control;
};

class LogStreams : public ::testing::Test {
 protected:
  LogStreams() { fs::create_directory(folder_); }

  // The log from memory.
  std::string whole_log(int rows) {
    Tracks tracks(nullptr, 20);
    for (int k = 0; k < rows; ++k) tracks.append(k);
    const fs::path file = folder_ / "memory.h5";
    write_hdf5_log(file, tracks.recorded(), 0);
    return text_of(file);
  }

  const testing::TemporaryPath base_{"streams"};
  const fs::path folder_ = fs::path(base_.string() + "_run");
  ~LogStreams() override { fs::remove_all(folder_); }
};

TEST_F(LogStreams, GiveTheBytesOfTheLogFromMemory) {
  for (const int rows : {20, 13, 4, 2, 0}) {
    SCOPED_TRACE(rows);
    LogStream stream(folder_, "x = 1\n", "{}");
    Tracks tracks(&stream, 20);
    for (int k = 0; k < rows; ++k) tracks.append(k);
    const fs::path log = stream.finish(tracks.recorded());
    EXPECT_EQ(log == folder_ / "log.h5", rows == 20 || rows == 0);
    EXPECT_TRUE(text_of(log) == whole_log(rows));
  }
}

TEST_F(LogStreams, TakeATrackThatIsNotStreamed) {
  LogStream stream(folder_, "", "{}");
  Tracks tracks(&stream, 5), memory(nullptr, 5);
  for (int k = 0; k < 5; ++k) {
    tracks.append(k);
    memory.append(k);
  }
  std::vector<Track> mixed = {std::move(tracks.control), std::move(memory.fine)};
  EXPECT_TRUE(text_of(stream.finish(mixed)) == whole_log(5));
}

TEST_F(LogStreams, RefuseMoreRowsThanExpected) {
  LogStream stream(folder_, "", "{}");
  Tracks tracks(&stream, 2);
  tracks.append(0);
  tracks.append(1);
  EXPECT_THROW(tracks.append(2), std::logic_error);
}

// The log has its name only when all its times are NaN: a kill before that leaves none.
TEST_F(LogStreams, HaveNoLogBeforeItsTimesAreThere) {
  fs::create_directory(folder_ / "log.h5");
  LogStream stream(folder_, "", "{}");
  Tracks tracks(&stream, 5);
  EXPECT_THROW(tracks.append(0), OutputError);
  const LoggedSignal times = read_hdf5_signal(folder_ / ".log.h5.partial", "control/time_s");
  EXPECT_EQ(times.rows, 5U);
  for (const double time_s : times.values) EXPECT_TRUE(std::isnan(time_s));
}

// The number of a killed process may be that of the next one.
TEST_F(LogStreams, LeaveAFolderThatNoRunRemoves) {
  fs::create_directory(base_);
  const fs::path target = base_ / "run";
  fs::path first;
  {
    RunFolder folder(target);
    first = folder.path();
    std::ofstream(first / kKept) << "";
    EXPECT_TRUE(is_being_written(first));
  }
  EXPECT_TRUE(is_kept(first));
  EXPECT_FALSE(is_being_written(first));
  {
    RunFolder folder(target);
    EXPECT_NE(folder.path(), first);
  }
  fs::create_directory(first.string() + "+3");
  { const RunFolder folder(target); }
  EXPECT_FALSE(fs::exists(first.string() + "+3"));
  EXPECT_TRUE(is_kept(first));
}

}  // namespace breakwater::log_stream_test
