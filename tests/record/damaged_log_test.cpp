// Logs that no run wrote: no reader may crash, hang or fill the memory.
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <csignal>
#include <cstring>

#include <breakwater/record/file_hash.h>
#include <breakwater/record/hdf5_log.h>
#include <breakwater/record/run_folder.h>
#include "support.h"

namespace breakwater::damaged_log_test {

namespace fs = std::filesystem;

constexpr std::size_t kHead = 16 * 1024;  // HDF5 keeps names, types and sizes here

void write_bytes(const fs::path& file, const std::string& bytes) {
  std::ofstream(file, std::ios::binary) << bytes;
}

// Like the log of a scenario: two time bases, scalars and vectors.
void write_small_log(const fs::path& file, int deflate_level) {
  double x = 0;
  double q[7] = {};
  std::vector<Track> tracks;
  for (const char* name : {"control", "physics"}) {
    std::vector<Signal> signals;
    for (int k = 0; k < 6; ++k) {
      signals.push_back({"force_" + std::to_string(k) + "_N",
                         "N",
                         "the force at the tip, as the sensor "
                         "gives it",
                         {&x, 1}});
      signals.push_back({"q_" + std::to_string(k) + "_rad", "rad", "the joints' angles", q});
    }
    Track track(name, std::move(signals), 100);
    for (int k = 0; k < 100; ++k) {
      x = std::sin(k);
      q[k % 7] = std::exp(-k);
      track.append(0.001 * k);
    }
    tracks.push_back(std::move(track));
  }
  write_hdf5_log(file.string(), tracks, deflate_level);
}

// Damages one to four bytes, with any values or with critical ones.
std::string damaged(std::string bytes, unsigned seed) {
  std::mt19937 random(seed);
  const std::size_t count = 1 + random() % 4;
  for (std::size_t k = 0; k < count; ++k) {
    char& byte = bytes[random() % std::min(bytes.size(), kHead)];
    const std::array<char, 4> choice = {static_cast<char>(random()), '\xff', '\0',
                                        static_cast<char>(byte ^ (1 << random() % 8))};
    byte = choice[random() % choice.size()];
  }
  return bytes;
}

void read_all(const fs::path& file) {
  const std::vector<LogEntry> entries = list_hdf5_signals(file.string());
  std::set<std::string> names;
  for (const LogEntry& entry : entries) {
    names.insert(entry.group + "/" + entry.name);
    names.insert(entry.group + "/time_s");
  }
  for (const std::string& name : names) read_hdf5_signal(file.string(), name);
}

// Calls body() in a child process with 2 s of processor time and 2 GB. Returns "read", "refused"
// (std::invalid_argument), or how the process ended.
template <typename Body>
std::string outcome(Body&& body) {
  enum { kRead, kRefused, kOther };
  const pid_t child = fork();
  if (child == 0) {
    const rlimit seconds = {2, 2};
    [[maybe_unused]] const rlimit bytes = {2UL << 30, 2UL << 30};
    const rlimit no_core = {0, 0};
    setrlimit(RLIMIT_CPU, &seconds);
#ifndef __SANITIZE_ADDRESS__  // it reserves far more memory, and refuses absurd sizes itself
    setrlimit(RLIMIT_AS, &bytes);
#endif
    setrlimit(RLIMIT_CORE, &no_core);
    try {
      body();
      _exit(kRead);
    } catch (const std::invalid_argument&) {
      _exit(kRefused);
    } catch (...) {
      _exit(kOther);
    }
  }
  int status = 0;
  waitpid(child, &status, 0);
  if (WIFSIGNALED(status)) return strsignal(WTERMSIG(status));
  switch (WEXITSTATUS(status)) {
    case kRead:
      return "read";
    case kRefused:
      return "refused";
    default:
      return "another exception";
  }
}

class DamagedLog : public ::testing::Test {
 protected:
  DamagedLog() { fs::create_directories(folder_); }

  // Writes the log with h5py: `f` is the file, `c` its group control, `folder` its folder.
  void write(const std::string& script) {
    fs::remove(log_);
    const std::string command =
        "/usr/bin/python3 -c \"import h5py, numpy as np, sys; folder = sys.argv[1]; "
        "f = h5py.File(folder + '/log.h5', 'w'); c = f.create_group('control'); "
        "c['time_s'] = [0.0, 1.0]; " +
        script + "; f.close()\" " + folder_.string();
    EXPECT_EQ(std::system(command.c_str()), 0);
  }
  // The result of reading the whole log.
  std::string outcome_of(const std::string& script) {
    write(script);
    return outcome([&] { read_all(log_); });
  }

  const testing::TemporaryPath folder_{"damaged"};
  const fs::path log_ = folder_ / "log.h5";
};

// Some bytes crash HDF5. A child process finds out which.
TEST_F(DamagedLog, IsReadOrRefusedForAnyBytesInItsHead) {
  for (const int deflate_level : {0, 6}) {
    write_small_log(log_, deflate_level);
    ASSERT_EQ(outcome([&] { read_all(log_); }), "read");
    EXPECT_NO_THROW(check_foreign_log(log_.string(), true));
    const std::string whole = testing::text_of(log_);
    int refused = 0, refused_in_a_child = 0;
    for (unsigned seed = 0; seed < 250; ++seed) {
      write_bytes(log_, damaged(whole, seed));
      const std::string is = outcome([&] { read_all(log_); });
      EXPECT_TRUE(is == "read" || is == "refused") << is << ": " << deflate_level << ", " << seed;
      refused += is == "refused";
      const std::string said = complaint_of([&] { check_foreign_log(log_.string(), true); });
      if (said.empty()) continue;
      EXPECT_EQ(said, log_.string() + ": is not a log, or one that is damaged");
      ++refused_in_a_child;
    }
    EXPECT_GT(std::min(refused, refused_in_a_child), 25) << "hardly any damage was done";
  }
}

// A pipe without a writer never ends.
TEST(EndlessLog, ItsReaderEndsWithItsParent) {
  const testing::TemporaryPath log("endless_log");
  ASSERT_EQ(mkfifo(log.c_str(), 0600), 0);
  prctl(PR_SET_CHILD_SUBREAPER, 1);  // the reader becomes our child when its parent ends
  const pid_t parent = fork();
  if (parent == 0) {
    check_foreign_log(log.string(), true);
    _exit(0);
  }
  const std::string process = "/proc/" + std::to_string(parent);
  const std::string children = process + "/task/" + std::to_string(parent) + "/children";
  while (testing::text_of(children).empty()) usleep(1000);
  kill(parent, SIGTERM);
  for (int ended = 0; ended < 2; ++ended) EXPECT_GT(waitpid(-1, nullptr, 0), 0);
  prctl(PR_SET_CHILD_SUBREAPER, 0);
}

TEST_F(DamagedLog, IsDetectedByTheManifest) {
  const std::string manifest = R"({"scenario": "s", "state_hash": "0")";
  for (const int deflate_level : {0, 6}) {
    write_small_log(log_, deflate_level);
    write_bytes(folder_ / "manifest.json",
                manifest + R"(, "log_hash": ")" + file_hash(log_) + R"("})");
    EXPECT_TRUE(check_file(folder_, "log.h5"));
    const std::string whole = testing::text_of(log_);
    for (unsigned seed = 0; seed < 400; ++seed) {
      const std::string bytes = damaged(whole, seed);
      if (bytes == whole) continue;
      write_bytes(log_, bytes);
      EXPECT_REFUSED(check_file(folder_, "log.h5")) << seed;
    }
    write_bytes(log_, whole.substr(0, whole.size() - 1));
    EXPECT_REFUSED(check_file(folder_, "log.h5"));
  }
  EXPECT_EQ(complaint_of([&] { check_file(folder_, "log.h5"); }),
            log_.string() + ": is damaged: it is not what the run wrote; run it again");
  for (const char* hash : {"null", "1", "{}", R"("")"}) {
    write_bytes(folder_ / "manifest.json", manifest + R"(, "log_hash": )" + hash + "}");
    EXPECT_REFUSED(check_file(folder_, "log.h5")) << hash;
  }
  // A run of an older version.
  write_bytes(folder_ / "manifest.json", manifest + "}");
  EXPECT_FALSE(check_file(folder_, "log.h5"));
}

TEST_F(DamagedLog, IsRefusedIfItClaimsMoreDataThanItHas) {
  EXPECT_EQ(outcome_of("c.create_dataset('x', (10**18,), 'f8')"), "refused");
  EXPECT_EQ(outcome_of("c.create_dataset('x', (2, 10**9), 'f8')"), "refused");
  for (const char* rows : {"10**18", "10**9"}) {
    EXPECT_EQ(outcome_of("d = c.create_dataset('x', (" + std::string(rows) +
                         ",), 'f8', chunks=True, compression=4); d[0] = 1"),
              "refused")
        << rows;
  }
  EXPECT_EQ(outcome_of("c.create_dataset('x', (2,), 'f8', maxshape=(None,), chunks=(2**27,))"),
            "refused");
}

TEST_F(DamagedLog, IsRefusedWithOtherTypesAndRanks) {
  EXPECT_EQ(outcome_of("c['x'] = [1.0, 2.0]"), "read");
  for (const char* data : {"1.0", "[[[1.0]]]", "[1, 2]", "np.float32([1])", "'text'", "['a', 'b']",
                           "np.zeros(2, 'f8,f8')", "h5py.Empty('f8')", "np.array([1.0], '>f8')"}) {
    EXPECT_EQ(outcome_of("c['x'] = " + std::string(data)), "refused") << data;
  }
  EXPECT_EQ(outcome_of("c.create_group('x')"), "refused");
  EXPECT_EQ(outcome_of("c.create_dataset('x', (9,), 'f8', data=range(9), compression='lzf')"),
            "refused");
}

TEST_F(DamagedLog, DoesNotOpenOtherFiles) {
  write_small_log(folder_ / "other.h5", 0);
  for (const char* link : {"c['x'] = h5py.ExternalLink('other.h5', '/control/time_s')",
                           "f['x'] = h5py.ExternalLink('other.h5', '/control')",
                           "c['x'] = h5py.SoftLink('/control/time_s')"}) {
    EXPECT_EQ(outcome_of(link), "read");
    EXPECT_TRUE(list_hdf5_signals(log_.string()).empty()) << link;
    for (const char* name : {"control/x", "x/time_s", "x/force_0_N", "x", "control/./x", ""}) {
      EXPECT_REFUSED(read_hdf5_signal(log_.string(), name)) << name;
    }
  }
  EXPECT_EQ(
      outcome_of("c.create_dataset('x', (4,), 'f8', external=[(folder + '/other.h5', 0, 32)])"),
      "refused");
  EXPECT_EQ(outcome_of("v = h5py.VirtualLayout((2,), 'f8'); "
                       "v[:] = h5py.VirtualSource(folder + '/other.h5', 'control/time_s', (2,)); "
                       "c.create_virtual_dataset('x', v)"),
            "refused");
}

// Texts of variable length, as in version 0.1.
TEST_F(DamagedLog, ReadsTextsOfVariableLengthAsEmpty) {
  ASSERT_EQ(outcome_of("c['x_m'] = [1.0, 2.0]; c['x_m'].attrs['unit'] = 'm'; "
                       "c['x_m'].attrs['description'] = 'a length'"),
            "read");
  const std::vector<LogEntry> entries = list_hdf5_signals(log_.string());
  ASSERT_EQ(entries.size(), 1U);
  EXPECT_EQ(entries[0].name, "x_m");
  EXPECT_EQ(entries[0].unit, "");
  EXPECT_EQ(read_hdf5_signal(log_.string(), "control/x_m").values, (std::vector<double>{1, 2}));

  for (const char* text : {"1", "['m', 'm']", "np.array([b'm', b'm'])", "h5py.Empty('S5')"}) {
    ASSERT_EQ(outcome_of("c['x_m'] = [1.0]; c['x_m'].attrs['unit'] = " + std::string(text)),
              "read");
    EXPECT_EQ(list_hdf5_signals(log_.string())[0].unit, "") << text;
  }
  ASSERT_EQ(outcome_of("c['x_m'] = [1.0]; c['x_m'].attrs['unit'] = np.bytes_(b'rad/s')"), "read");
  EXPECT_EQ(list_hdf5_signals(log_.string())[0].unit, "rad/s");
}

}  // namespace breakwater::damaged_log_test
