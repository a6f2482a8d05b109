// The streamed log equals the one from memory, and what is left of it after a kill is a part of it.
#include <cmath>

#include <breakwater/record/cut_run.h>
#include <breakwater/record/hdf5_log.h>
#include <breakwater/record/log_stream.h>
#include <breakwater/record/process_name.h>
#include <breakwater/record/run_folder.h>
#include "support.h"

namespace breakwater {
namespace {
namespace fs = std::filesystem;
using testing::text_of;

constexpr double kPeriod_s = 0.3;
constexpr int kFinePerRow = 10;

constexpr const char* kManifest = R"({"scenario":"s","case":"c","seed":1})";

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
  // Streams `rows` of 20 rows, and is not finished.
  void leave(int rows) {
    LogStream stream(folder_, "x = 1\n", kManifest);
    Tracks tracks(&stream, 20);
    for (int k = 0; k < rows; ++k) tracks.append(k);
  }
  std::string recovered() {
    const CutRun cut(folder_);
    const fs::path file = folder_ / "recovered.h5";
    cut.write_log(file);
    return text_of(file);
  }
  void overwrite(const char* file, std::streamoff place, const std::string& bytes) {
    std::fstream stream(folder_ / file, std::ios::in | std::ios::out | std::ios::binary);
    stream.seekp(place, place < 0 ? std::ios::end : std::ios::beg);
    stream << bytes;
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
    forget_stream(folder_);
    EXPECT_FALSE(fs::exists(folder_ / kRunning));
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

bool is_beginning(const LoggedSignal& part, const LoggedSignal& whole) {
  return part.width == whole.width && part.rows <= whole.rows &&
         std::equal(part.values.begin(), part.values.end(), whole.values.begin());
}

TEST_F(LogStreams, LeaveAllButTheLastSecond) {
  for (int rows = 1; rows <= 20; ++rows) {
    SCOPED_TRACE(rows);
    leave(rows);
    const double end_s = CutRun(folder_).end_s();
    EXPECT_GT(end_s, kPeriod_s * (rows - 1) - 1.0);
    whole_log(rows);
    recovered();
    const std::string whole = folder_ / "memory.h5", part = folder_ / "recovered.h5";
    std::vector<LogEntry> signals = list_hdf5_signals(part);
    EXPECT_EQ(signals.size(), rows > 3 ? 3U : 2U);
    for (const LogEntry& entry : signals) {
      for (const std::string& name : {entry.name, std::string("time_s")}) {
        const std::string path = entry.group + "/" + name;
        EXPECT_TRUE(is_beginning(read_hdf5_signal(part, path), read_hdf5_signal(whole, path)))
            << path;
      }
    }
    EXPECT_EQ(CutRun(folder_).manifest(), kManifest);
    EXPECT_EQ(text_of(folder_ / "config.toml"), "x = 1\n");
  }
}

// A block counts only if the journal lists it and all its rows are in the log.
TEST_F(LogStreams, LeaveOutWhatIsNotWhole) {
  constexpr std::streamoff kEntry = 16;
  leave(20);
  const fs::path journal = folder_ / "log.journal";
  const std::string all = text_of(journal);
  const auto entries = static_cast<std::streamoff>(all.size()) / kEntry;
  ASSERT_GT(entries, 4);
  fs::resize_file(journal, static_cast<std::uintmax_t>(kEntry * entries - 1));
  const double end_s = CutRun(folder_).end_s();
  EXPECT_FALSE(CutRun(folder_).is_damaged());
  EXPECT_LT(end_s, kPeriod_s * 19);

  // Damage of the last block of the journal, of a row of the log, and of a number of rows.
  std::ofstream(journal, std::ios::binary) << all;
  overwrite("log.journal", -1, "x");
  EXPECT_TRUE(CutRun(folder_).is_damaged());
  EXPECT_EQ(CutRun(folder_).end_s(), end_s);
  std::ofstream(journal, std::ios::binary) << all;
  overwrite("log.journal", -12, "\xff\xff\xff\x7f");
  EXPECT_EQ(CutRun(folder_).end_s(), end_s);
  std::ofstream(journal, std::ios::binary) << all;
  fs::resize_file(folder_ / "log.h5", 3000);
  EXPECT_EQ(complaint_of([&] { const CutRun cut(folder_); }),
            (folder_ / "log.h5").string() +
                ": is smaller than running.json says: the run cannot be recovered");
}

TEST_F(LogStreams, AreRefusedIfNothingCanBeRecovered) {
  const auto complaint = [&] { return complaint_of([&] { const CutRun cut(folder_); }); };
  const std::string running = (folder_ / kRunning).string();
  EXPECT_TRUE(has(complaint(), "it has no running.json"));
  {
    LogStream stream(folder_, "", kManifest);
    Tracks tracks(&stream, 20);
    tracks.append(0);
    EXPECT_TRUE(is_being_written(folder_));
    EXPECT_EQ(complaint(), folder_.string() + ": a process still writes this run: stop it first");
  }
  EXPECT_FALSE(is_being_written(folder_));
  EXPECT_EQ(complaint(), "");
  const std::string damaged = ": is damaged: the run cannot be recovered";
  const std::string text = text_of(running);
  for (const std::string& wrong :
       {std::string(), text.substr(0, 200),
        testing::replaced(text, "\"width\": 1", "\"width\": -1"),
        testing::replaced(text, "\"seed\"", "\"sede\""), testing::replaced(text, "\"s\"", "5"),
        std::string(R"({"manifest": {}, "log": []})")}) {
    std::ofstream(running) << wrong;
    EXPECT_EQ(complaint(), running + damaged);
  }
  std::ofstream(running) << testing::replaced(text, "\"rows\": 20", "\"rows\": 20000");
  EXPECT_TRUE(has(complaint(), "log.h5: is smaller than running.json says"));
  std::ofstream(running) << text;
  fs::resize_file(folder_ / "log.journal", 0);
  EXPECT_EQ(complaint(),
            (folder_ / "log.journal").string() + ": lists no rows: the run cannot be recovered");
  std::ofstream(folder_ / "manifest.json") << R"({"scenario": "s", "state_hash": "0"})";
  EXPECT_EQ(complaint(), folder_.string() + ": is a finished run: there is nothing to recover");
  EXPECT_TRUE(has(complaint_of([&] { const CutRun cut(folder_ / "nowhere"); }), "no such folder"));
}

// The number of a killed process may be that of the next one.
TEST_F(LogStreams, LeaveAFolderThatNoRunRemoves) {
  fs::create_directory(base_);
  const fs::path target = base_ / "run";
  fs::path first;
  {
    RunFolder folder(target);
    first = folder.path();
    fs::copy_file(testing::source_file("README.md"), first / kRunning);
  }
  EXPECT_TRUE(is_recoverable(first));
  EXPECT_EQ(finished_name(first.string() + "/"), fs::canonical(base_) / "run");
  EXPECT_TRUE(has(why_not_removable(first), "recover"));
  {
    RunFolder folder(target);
    EXPECT_NE(folder.path(), first);
    EXPECT_EQ(finished_name(folder.path()), finished_name(first));
  }
  fs::create_directory(first.string() + "+3");
  { const RunFolder folder(target); }
  EXPECT_FALSE(fs::exists(first.string() + "+3"));
  EXPECT_TRUE(is_recoverable(first));
}

}  // namespace
}  // namespace breakwater
