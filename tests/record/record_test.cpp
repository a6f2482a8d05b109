// Tracks, logs, metrics and run folders.
#include <fcntl.h>
#include <sys/stat.h>
#include <atomic>
#include <chrono>
#include <climits>
#include <nlohmann/json.hpp>
#include <thread>

#include <breakwater/record/file_hash.h>
#include <breakwater/record/hdf5_log.h>
#include <breakwater/record/loaded_library.h>
#include <breakwater/record/partial_file.h>
#include <breakwater/record/process_name.h>
#include <breakwater/record/recording.h>
#include <breakwater/record/run_folder.h>
#include <breakwater/record/text_outputs.h>
#include "support.h"

namespace breakwater::record_test {

namespace fs = std::filesystem;
using testing::text_of;

// A track with a scalar and a vector signal, whose values need all digits.
class Recorded {
 public:
  Recorded()
      : track_(
            "control",
            {{"force_N", "N", "a force, in µN", {&force_, 1}}, {"q_rad", "rad", "two angles", q_}},
            10) {
    for (int k = 0; k < 5; ++k) {
      force_ = std::sin(k) / 3;
      q_[0] = 1e-300 * k;
      q_[1] = -std::exp(k);
      track_.append(0.001 * k);
    }
  }
  const Track& track() const { return track_; }

 private:
  double force_ = 0;
  double q_[2] = {0, 0};
  Track track_;
};

TEST(Track, KeepsEveryRow) {
  const Recorded recorded;
  const Track& track = recorded.track();
  ASSERT_EQ(track.rows(), 5U);
  EXPECT_EQ(track.times()[3], 0.003);
  EXPECT_EQ(track.values("force_N")[2], std::sin(2) / 3);
  EXPECT_EQ(track.values("q_rad").size(), 10U);
  EXPECT_EQ(track.values("q_rad")[2 * 4 + 1], -std::exp(4));
  EXPECT_THROW(track.values("torque_Nm"), std::out_of_range);
}

std::string refusal(const std::string& track, std::vector<Signal> signals) {
  return complaint_of([&] { const Track made(track, std::move(signals), 0); });
}

TEST(Track, RefusesTwoSignalsOfOneName) {
  const double x = 0;
  EXPECT_EQ(refusal("control", {{"x_m", "m", "the cart's", {&x, 1}},
                                {"v_m_s", "m/s", "its speed", {&x, 1}},
                                {"x_m", "m", "the observer's", {&x, 1}}}),
            "control/x_m: two signals have this name (the cart's) (the observer's)");
  EXPECT_EQ(refusal("control", {{"x_m", "m", "", {&x, 1}}, {"x_M", "m", "", {&x, 1}}}), "");
}

TEST(Metric, RefusesANameThatIsASpreadsheetFormula) {
  for (const std::string name : {"", "=cmd|calc", "+1", "-1", "@sum", "a b", "a,b", "peak_\n"}) {
    EXPECT_EQ(complaint_of([&] { const Metric metric(name, "N", 1.0); }),
              "a metric cannot be named \"" + name +
                  "\": a name is letters from A to Z or a to z, digits and _");
  }
  EXPECT_EQ(Metric("peak_force_raw_N", "N", 1.0).name, "peak_force_raw_N");
  EXPECT_EQ(csv_text("=cmd|calc"), "'=cmd|calc");
  EXPECT_EQ(csv_text("hpfc-2N"), "hpfc-2N");
}

TEST(Track, RefusesNamesThatALogCannotStore) {
  const double x = 0;
  for (const std::string name :
       {"", ".", "/", "a/b", "time_s", "index_3", "/x_m", "d hat", "=cmd|calc"}) {
    EXPECT_EQ(refusal("control", {{name, "m", "a length", {&x, 1}}}),
              "track control: a signal cannot be named \"" + name + "\" in a log (a length)");
    EXPECT_EQ(refusal(name, {{"x_m", "m", "a length", {&x, 1}}}),
              "a track cannot be named \"" + name + "\" in a log");
  }
  EXPECT_EQ(refusal("control", {{"x_m", "m", "a length", {}}}),
            "control/x_m: the signal has no values (a length)");
}

TEST(Hdf5Log, GivesBackTheSameBits) {
  const Recorded recorded;
  const testing::TemporaryPath file{"log.h5"};
  for (const int deflate_level : {0, 6}) {
    write_hdf5_log(file, {recorded.track()}, deflate_level);
    const LoggedSignal q = read_hdf5_signal(file, "control/q_rad");
    EXPECT_EQ(q.rows, 5U);
    EXPECT_EQ(q.width, 2U);
    EXPECT_EQ(q.values, recorded.track().values("q_rad"));
    EXPECT_EQ(read_hdf5_signal(file, "control/force_N").values, recorded.track().values("force_N"));
    const std::span<const double> times = recorded.track().times();
    EXPECT_EQ(read_hdf5_signal(file, "control/time_s").values,
              std::vector<double>(times.begin(), times.end()));
  }
  EXPECT_REFUSED(read_hdf5_signal(file, "control/torque_Nm"));
  EXPECT_REFUSED(read_hdf5_signal("/etc/hostname", "control/q_rad"));
}

TEST(Hdf5Log, StoresTheUnitOfEachValue) {
  const double values[] = {1, 2, 3};
  const Track track("control", {{"pose", "m, m, rad", "", values}, {"force_N", "N", "", values}},
                    0);
  const testing::TemporaryPath file{"log.h5"};
  write_hdf5_log(file, {track}, 0);
  const std::vector<LogEntry> entries = list_hdf5_signals(file);  // by name
  ASSERT_EQ(entries.size(), 2U);
  EXPECT_EQ(entries[0].unit_of(3), "N");
  EXPECT_EQ(entries[1].unit, "m, m, rad");
  EXPECT_EQ(entries[1].unit_of(1), "m");
  EXPECT_EQ(entries[1].unit_of(2), "m");
  EXPECT_EQ(entries[1].unit_of(3), "rad");
  EXPECT_EQ(entries[1].unit_of(4), "m, m, rad") << "there is no fourth";
}

TEST(Hdf5Log, AcceptsAnEmptyTrack) {
  const double value = 0;
  const Track track("control", {{"x_m", "m", "", {&value, 1}}}, 0);
  const testing::TemporaryPath file{"log.h5"};
  write_hdf5_log(file, {track}, 3);
  EXPECT_EQ(read_hdf5_signal(file, "control/x_m").rows, 0U);
}

// h5py as a second reader.
TEST(Hdf5Log, IsReadableByH5py) {
  const Recorded recorded;
  const testing::TemporaryPath file{"log.h5"};
  write_hdf5_log(file, {recorded.track()}, 0);
  const std::string script =
      "import h5py, sys, math; f = h5py.File(sys.argv[1]); c = f['control']; "
      "assert c['q_rad'].shape == (5, 2); assert c['force_N'][2] == math.sin(2) / 3; "
      "assert c['q_rad'].attrs['unit'].decode() == 'rad'; "
      "assert c['force_N'].attrs['description'].decode() == 'a force, in µN'; "
      "assert all('unit' in d.attrs and 'description' in d.attrs for d in c.values())";
  const std::string command = "/usr/bin/python3 -c \"" + script + "\" " + file.string();
  EXPECT_EQ(std::system(command.c_str()), 0);
}

TEST(Hdf5Log, ReportsAFailedWrite) {
  const Recorded recorded;
  const auto write = [&] { write_hdf5_log("/proc/log.h5", {recorded.track()}, 0); };
  EXPECT_TRUE(complaint_of<OutputError>(write).starts_with("/proc/log.h5: "));
}

TEST(CsvLog, HasOneColumnPerValueAndAllDigits) {
  const Recorded recorded;
  const testing::TemporaryPath file{"log.csv"};
  write_csv_log(file, recorded.track());
  std::ifstream stream(file);
  std::string header, row;
  std::getline(stream, header);
  EXPECT_EQ(header, "time_s,force_N,q_rad_1,q_rad_2");
  for (int k = 0; k < 5; ++k) {
    std::getline(stream, row);
    double time, force, q1, q2;
    ASSERT_EQ(std::sscanf(row.c_str(), "%lf,%lf,%lf,%lf", &time, &force, &q1, &q2), 4) << row;
    EXPECT_EQ(force, std::sin(k) / 3);
    EXPECT_EQ(q2, -std::exp(k));
  }
}

TEST(Metrics, AreAFlatObjectOfNumbers) {
  const testing::TemporaryPath file{"metrics.json"};
  write_metrics(file, {{"peak_N", "N", 1.0 / 3}, {"count", "1", 2}});
  const auto json = nlohmann::json::parse(text_of(file));
  EXPECT_EQ(json["peak_N"].get<double>(), 1.0 / 3);
  EXPECT_EQ(json["count"].get<double>(), 2);
  EXPECT_EQ(json.size(), 2U);
  write_metrics(file, {});
  EXPECT_EQ(text_of(file), "{}\n");
}

TEST(Metrics, OmitNonFiniteValues) {
  Recording recording;
  add(recording.metrics, "nan_N", "N", kNaN);
  add(recording.metrics, "infinite_N", "N", -kInfinity);
  add(recording.metrics, "nothing_N", "N", std::nullopt);
  add(recording.metrics, "peak_N", "N", 2.0);
  EXPECT_EQ(recording.metrics.size(), 1U);
  EXPECT_EQ(recording.metric("nan_N"), std::nullopt);

  const testing::TemporaryPath file{"metrics.json"};
  write_metrics(file, {{"nan_N", "N", kNaN}, {"infinite_N", "N", kInfinity}, {"peak_N", "N", 2}});
  EXPECT_EQ(text_of(file), "{\n  \"peak_N\": 2.0\n}\n");
}

class RunFolders : public ::testing::Test {
 protected:
  RunFolders() { fs::create_directories(base_); }

  // Ends like a run: writes a manifest and one file, and commits.
  void finish(RunFolder& folder, const std::string& content) {
    write_text_file(folder.path() / "manifest.json", R"({"scenario": "s", "state_hash": "0"})");
    write_text_file(folder.path() / "log.csv", content);
    folder.commit();
  }
  std::size_t entries() const {
    return static_cast<std::size_t>(
        std::distance(fs::directory_iterator(base_), fs::directory_iterator()));
  }

  const testing::TemporaryPath base_{"runs"};
};

TEST_F(RunFolders, AFileIsClearedOfKilledProcesses) {
  const std::string dead = process_name(2000000000), alive = process_name(getppid());
  for (const std::string& name : {dead, alive, std::string("anotherhost-2000000000")}) {
    write_text_file((base_ / (".page.partial-" + name)).string(), "half");
  }
  replace_file(base_ / "page", "whole");
  EXPECT_EQ(text_of(base_ / "page"), "whole");
  EXPECT_FALSE(fs::exists(base_ / (".page.partial-" + dead)));
  EXPECT_EQ(entries(), 3U);
}

TEST_F(RunFolders, AreAbsentUntilWhole) {
  const fs::path target = base_ / "deep" / "run";
  {
    RunFolder folder(target);
    write_text_file(folder.path() / "log.csv", "half");
    EXPECT_FALSE(fs::exists(target));
  }
  EXPECT_EQ(entries(), 0U) << "an abandoned run left something behind";
  {
    RunFolder folder(target);
    finish(folder, "whole");
  }
  EXPECT_EQ(text_of(target / "log.csv"), "whole");
}

TEST_F(RunFolders, SwapOutAnEarlierRun) {
  const fs::path target = base_ / "run/";
  for (const char* content : {"first", "second"}) {
    RunFolder folder(target);
    finish(folder, content);
  }
  EXPECT_EQ(text_of(target / "log.csv"), "second");
  EXPECT_EQ(entries(), 1U);
}

TEST_F(RunFolders, LeaveOtherThingsAlone) {
  fs::create_directory(base_ / "thesis");
  write_text_file(base_ / "thesis" / "chapter1", "years of work");
  write_text_file(base_ / "file", "");
  EXPECT_REFUSED(RunFolder(base_ / "thesis"));
  EXPECT_REFUSED(RunFolder(base_ / "file"));
  EXPECT_REFUSED(RunFolder(base_ / "file" / "run"));
  // A foreign manifest.json does not make the folder a run.
  write_text_file(base_ / "thesis" / "manifest.json", R"({"name": "a web page"})");
  EXPECT_REFUSED(RunFolder(base_ / "thesis"));
  EXPECT_EQ(entries(), 2U);
  fs::create_directory(base_ / "empty");
  EXPECT_NO_THROW(RunFolder(base_ / "empty"));
}

TEST_F(RunFolders, ARunWithOtherFilesIsNotReplaced) {
  const fs::path target = base_ / "run";
  {
    RunFolder folder(target);
    finish(folder, "first");
  }
  for (const char* ours : {"video.mp4", ".video.mp4.partial-12", "report.html"}) {
    write_text_file(target / ours, "");
  }
  {
    RunFolder folder(target);
    finish(folder, "second");
  }
  write_text_file(target / "notes.md", "what I saw");
  EXPECT_EQ(complaint_of([&] { const RunFolder folder(target); }),
            target.string() + ": holds notes.md, which is not a run's; it is left alone");
  EXPECT_EQ(text_of(target / "notes.md"), "what I saw");
  EXPECT_EQ(text_of(target / "log.csv"), "second");
}

// Another host whose name has a common beginning.
TEST_F(RunFolders, ARunOfAnotherHostIsNotAbandoned) {
  std::array<char, HOST_NAME_MAX + 1> host = {};
  gethostname(host.data(), host.size() - 1);
  const fs::path other = base_ / (".run.partial-" + std::string(host.data()) + "-4000000-17");
  fs::create_directory(other);
  {
    RunFolder folder(base_ / "run");
    finish(folder, "mine");
  }
  EXPECT_TRUE(fs::exists(other));
}

// For any spelling of the target.
TEST_F(RunFolders, AreMadeByOneThreadPerTarget) {
  const fs::path target = base_ / "run";
  fs::create_directory_symlink(base_, base_ / "link");
  {
    RunFolder first(target);
    for (const fs::path& same : {target, base_ / "link/run", base_ / "link/../run/"}) {
      EXPECT_EQ(complaint_of([&] { const RunFolder second(same); }),
                same.string() +
                    ": another thread of this process makes a run there: wait for "
                    "it, or give another folder");
    }
    RunFolder other(base_ / "other");
    finish(other, "another");
    finish(first, "first");
  }
  EXPECT_EQ(text_of(target / "log.csv"), "first");
  { const RunFolder given_up(target); }
  RunFolder next(target);
  finish(next, "next");
  EXPECT_EQ(text_of(target / "log.csv"), "next");
  EXPECT_EQ(entries(), 3U) << "run, other and link";
}

TEST_F(RunFolders, ReportAFailedCreation) {
  EXPECT_REFUSED(RunFolder("/proc/run"));
  EXPECT_REFUSED(RunFolder("/"));
}

TEST_F(RunFolders, ClearUpAfterAKilledRun) {
  // A partial folder of this host with the number of a process that does not exist.
  std::string prefix;
  {
    const RunFolder folder(base_ / "run");
    prefix = folder.path().string();
    prefix.erase(prefix.rfind('-') + 1);
  }
  const fs::path dead = prefix + "2000000000";
  const fs::path alive = prefix + std::to_string(getppid());
  const fs::path own = prefix + std::to_string(getpid());  // a process number that was used before
  const fs::path elsewhere = base_ / ".run.partial-anotherhost-2000000000";
  const fs::path unnumbered = prefix.substr(0, prefix.size() - 1);
  for (const fs::path& folder : {dead, alive, own, elsewhere, unnumbered}) {
    fs::create_directory(folder);
  }
  std::ofstream(own / "metrics.json") << "{}";
  RunFolder folder(base_ / "run");
  EXPECT_FALSE(fs::exists(dead));
  EXPECT_TRUE(fs::exists(alive));
  EXPECT_TRUE(fs::exists(elsewhere));
  EXPECT_TRUE(fs::exists(unnumbered));
  EXPECT_FALSE(fs::exists(own));
  EXPECT_TRUE(fs::is_empty(folder.path()));
}

// Two containers may have the same host name and process number. The lock tells them apart.
TEST_F(RunFolders, OfAnotherProcessWithThisNameStay) {
  const fs::path other = base_ / (".run.partial-" + unique_name());
  fs::create_directory(other);
  const fs::path page = base_ / (".page.partial-" + unique_name());
  write_text_file(page, "half");
  {
    const detail::DataFile folder_lock(other, O_RDONLY), file_lock(page, O_RDONLY);
    ASSERT_TRUE(folder_lock.lock() && file_lock.lock());
    RunFolder folder(base_ / "run");
    EXPECT_NE(folder.path(), other);
    EXPECT_TRUE(detail::is_locked(folder.path()));
    finish(folder, "mine");
    replace_file(base_ / "page", "mine");
    EXPECT_EQ(entries(), 4U);
  }
  const RunFolder next(base_ / "run");
  replace_file(base_ / "page", "mine");
  EXPECT_FALSE(fs::exists(other) || fs::exists(page));
}

TEST_F(RunFolders, HaveNamesUpToTheLongest) {
  for (const std::string& name : {std::string(255, 'n'), std::string(221, 'n')}) {
    {
      RunFolder folder(base_ / name);
      EXPECT_TRUE(is_unfinished_run(folder.path()));
      finish(folder, name);
    }
    EXPECT_EQ(text_of(base_ / name / "log.csv"), name);
  }
  std::string accents;
  while (accents.size() < 254) accents += "é";
  replace_file(base_ / accents, "page");
  EXPECT_EQ(entries(), 3U);
}

TEST_F(RunFolders, FollowLinks) {
  const testing::TemporaryPath elsewhere{"elsewhere"};
  fs::create_directories(elsewhere);
  for (const char* content : {"first", "second"}) {
    {
      RunFolder folder(elsewhere / "run");
      finish(folder, content);
    }
    fs::remove(base_ / "link");
    fs::create_directory_symlink(elsewhere / "run", base_ / "link");
    {
      RunFolder folder(base_ / "link/");
      finish(folder, "through the link");
    }
    EXPECT_TRUE(fs::is_symlink(base_ / "link"));
    EXPECT_EQ(text_of(elsewhere / "run/log.csv"), "through the link");
  }
  fs::create_symlink(elsewhere / "page", base_ / "page");
  for (const char* content : {"first", "second"}) {  // at first the link has no target
    replace_file(base_ / "page", content);
    EXPECT_TRUE(fs::is_symlink(base_ / "page"));
    EXPECT_EQ(text_of(elsewhere / "page"), content);
  }
  ASSERT_EQ(mkfifo((base_ / "pipe").c_str(), 0600), 0);
  EXPECT_THROW(replace_file(base_ / "pipe", "text"), OutputError);
  EXPECT_TRUE(fs::is_fifo(base_ / "pipe"));
}

// The files that a reader sees belong to one run, while another process replaces it all the time.
TEST_F(RunFolders, AreReadWholeWhileTheyAreReplaced) {
  const fs::path target = base_ / "run";
  std::atomic<bool> is_over = false;
  const auto write = [&](int number) {
    RunFolder folder(target);
    write_text_file(folder.path() / "config.toml", std::to_string(number));
    finish(folder, std::to_string(number));
  };
  write(0);
  std::thread writer([&] {
    for (int number = 1; !is_over; ++number) write(number);
  });
  std::set<std::string> seen;
  for (int i = 0; i < 30 || seen.size() < 2; ++i) {
    std::string first, second;
    read_whole(target, [&] {
      if (!fs::exists(target / "config.toml")) throw std::invalid_argument("is missing");
      first = text_of(target / "config.toml");
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
      second = text_of(target / "log.csv");
    });
    EXPECT_EQ(first, second);
    seen.insert(first);
  }
  is_over = true;
  writer.join();
}

// A folder with very many runs is listed only once.
TEST_F(RunFolders, ClearUpListedFolders) {
  const std::string begin = base_.string() + "/.run.partial-" + process_name();
  const std::string dead = begin.substr(0, begin.rfind('-')) + "-2000000000";
  fs::create_directory(dead);
  const std::set<std::string> left = hidden_names_in(base_);
  const std::string later = begin.substr(0, begin.rfind('-')) + "-2000000001";
  fs::create_directory(later);
  RunFolder folder(base_ / "run", &left);
  EXPECT_FALSE(fs::exists(dead));
  EXPECT_TRUE(fs::exists(later)) << "the folder was listed again";
}

TEST_F(RunFolders, KeepFilesThatAppearedMeanwhile) {
  for (const std::string kept : {"run.kept", "run.kept-2"}) {
    fs::remove_all(base_ / "run");
    RunFolder folder(base_ / "run");
    fs::create_directory(base_ / "run");
    std::ofstream(base_ / "run" / "thesis.txt") << "precious";
    EXPECT_TRUE(complaint_of<OutputError>([&] {
                  finish(folder, kept);
                }).ends_with("the new run is kept in " + (base_ / kept).string()));
    EXPECT_TRUE(fs::exists(base_ / "run" / "thesis.txt"));
    EXPECT_EQ(text_of(base_ / kept / "log.csv"), kept);
  }
  EXPECT_EQ(entries(), 3U);
}

// XXH3_64bits of no bytes, and of "abc".
TEST(FileHash, DependsOnTheBytesOfTheFile) {
  const testing::TemporaryPath file{"hashed"};
  std::ofstream(file).close();
  EXPECT_EQ(file_hash(file), "2d06800538d394c2");
  std::ofstream(file) << "abc";
  EXPECT_EQ(file_hash(file), "78af5f94892f3950");
}

TEST(FileHash, ChangesWithOneByteOfALargeFile) {
  const testing::TemporaryPath file{"hashed"};
  std::string bytes(3'500'000, 'x');
  std::ofstream(file) << bytes;
  const std::string before = file_hash(file);
  EXPECT_EQ(file_hash(file), before);
  bytes[3'200'000] = 'y';
  std::ofstream(file) << bytes;
  EXPECT_NE(file_hash(file), before);
}

TEST(Fingerprint, SeparatesItsParts) {
  EXPECT_NE(fingerprint({"a", "b"}), fingerprint({"ab", ""}));
  EXPECT_NE(fingerprint({"a", "b"}), fingerprint({"a", "c"}));
  EXPECT_EQ(fingerprint({"a", "b"}), fingerprint({"a", "b"}));
}

TEST(FileHash, NamesAnUnreadableFile) {
  for (const auto& [file, reason] :
       {std::pair("/no/such/file", "No such file or directory"),
        std::pair("/tmp", "it is a folder"), std::pair("/dev/zero", "it is not a regular file")}) {
    EXPECT_EQ(complaint_of([&] { file_hash(file); }),
              std::string(file) + ": cannot be read (" + reason + ")");
  }
}

const LoadedLibrary& libc() {
  static const LoadedLibrary library("libc.so.6", "libc6");
  return library;
}

BREAKWATER_LOADED(libc, std::invalid_argument, labs)

TEST(LoadedLibrary, GivesItsFunctions) {
  ASSERT_TRUE(libc().is_there());
  EXPECT_EQ(labs(-5L), 5L);
  const auto find = [] { libc().symbol<std::invalid_argument, void()>("glue"); };
  EXPECT_EQ(complaint_of(find), "libc.so.6 has no glue");
}

TEST(LoadedLibrary, NamesThePackageThatIsMissing) {
  const LoadedLibrary none("libnone.so.1", "libnone1");
  EXPECT_FALSE(none.is_there());
  const auto find = [&] { none.symbol<std::invalid_argument, void()>("glue"); };
  EXPECT_EQ(complaint_of(find),
            "libnone.so.1: cannot open shared object file: No such file or directory (Debian "
            "package libnone1)");
}

}  // namespace breakwater::record_test
