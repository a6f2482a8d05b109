#include <sys/resource.h>

#include <bit>
#include <chrono>
#include <csignal>

#include <breakwater/record/file_hash.h>
#include <breakwater/study/shards.h>
#include "support.h"

namespace breakwater::shards_test {
namespace fs = std::filesystem;

PointResult result_of(std::size_t number, const std::string& key, double value = 0.1) {
  PointResult result;
  result.number = number;
  result.key = key;
  result.state_hash = "0123456789abcdef";
  result.cost_s = 0.25;
  result.metrics = {{"a_m", value}, {"b=c_N", -2.0 * value}};
  return result;
}

// Simulates a full disk: no file of this process may grow beyond a size.
class FullDisk {
 public:
  explicit FullDisk(std::uintmax_t bytes) : handler_(std::signal(SIGXFSZ, SIG_IGN)) {
    getrlimit(RLIMIT_FSIZE, &before_);
    const rlimit limit = {bytes, before_.rlim_max};
    setrlimit(RLIMIT_FSIZE, &limit);
  }
  FullDisk(const FullDisk&) = delete;
  FullDisk& operator=(const FullDisk&) = delete;
  ~FullDisk() {
    setrlimit(RLIMIT_FSIZE, &before_);
    std::signal(SIGXFSZ, handler_);
  }

 private:
  rlimit before_ = {};
  void (*handler_)(int);
};

class Shards : public ::testing::Test {
 protected:
  Shards() { fs::create_directories(folder_); }

  // Writes a shard with only these bytes.
  void write(const std::string& bytes, const std::string& name = "host-1-0.shard") {
    std::ofstream(folder_ / name, std::ios::binary) << bytes;
  }
  // The only shard in the folder.
  fs::path shard() const {
    std::vector<fs::path> files;
    for (const auto& entry : fs::directory_iterator(folder_)) files.push_back(entry.path());
    EXPECT_EQ(files.size(), 1U);
    return files.front();
  }
  // The bytes of a shard with these results. The shard is removed.
  std::string bytes_of(const std::vector<PointResult>& results) {
    {
      Shard made(folder_);
      for (const PointResult& result : results) made.add(result);
    }
    const std::string bytes = testing::text_of(shard());
    fs::remove(shard());
    return bytes;
  }
  static std::string with_checksum(const std::string& text) {
    return text_hash(text) + "\t" + text + "\n";
  }

  const testing::TemporaryPath folder_{"shards"};
};

TEST_F(Shards, GiveBackAllOfAResult) {
  PointResult failed = result_of(3, "failed");
  failed.status = PointStatus::failed;
  failed.reason = "at 3 s: diverged\n\tand \x01 more";
  failed.metrics.clear();
  {
    Shard made(folder_);
    made.add(result_of(2, "whole"));
    made.add(failed);
  }
  const ShardIndex index(folder_, 5);
  EXPECT_EQ(index.done(), 2U);
  EXPECT_EQ(index.cost_s(), 0.5);
  EXPECT_EQ(index.find("failed"), 3U);
  auto results = results_by_key(folder_);
  ASSERT_EQ(results.size(), 2U);
  for (const PointResult& read : {index.read(2), results.at("whole")}) {
    EXPECT_EQ(read.number, 2U);
    EXPECT_EQ(read.key, "whole");
    EXPECT_EQ(read.status, PointStatus::complete);
    EXPECT_EQ(read.state_hash, "0123456789abcdef");
    EXPECT_EQ(read.cost_s, 0.25);
    EXPECT_EQ(read.reason, "");
    EXPECT_EQ(read.metrics, result_of(2, "whole").metrics);
  }
  EXPECT_EQ(results.at("failed").status, PointStatus::failed);
  EXPECT_TRUE(results.at("failed").reason.starts_with("at 3 s: diverged"));
  EXPECT_TRUE(results.at("failed").reason.ends_with(" more"));
}

TEST_F(Shards, NameThePointThatAProcessHasBegun) {
  EXPECT_TRUE(results_of_process(folder_, getpid()).results.empty());
  EXPECT_EQ(results_of_process(folder_, getpid()).begun, std::nullopt);
  Shard made(folder_);
  made.begin(4, "fifth");
  made.add(result_of(4, "fifth"));
  write(with_checksum("point\t9\tother\tcomplete\t\t0\t"), "host-1-0.shard");
  ProcessResults found = results_of_process(folder_, getpid());
  ASSERT_EQ(found.results.size(), 1U);
  EXPECT_EQ(found.results[0].key, "fifth");
  EXPECT_EQ(found.begun, 4U);
  made.begin(7, "");
  found = results_of_process(folder_, getpid(), found);
  EXPECT_EQ(found.begun, 7U);
  EXPECT_EQ(found.begun_key, "");
  made.begin(7, "eighth");
  found = results_of_process(folder_, getpid(), found);
  EXPECT_EQ(found.results.size(), 1U);
  EXPECT_EQ(found.begun, 7U);
  EXPECT_EQ(found.begun_key, "eighth");
  EXPECT_EQ(ShardIndex(folder_, 8).done(), 1U) << "what is begun is not done";
}

TEST_F(Shards, GiveBackEveryBitOfANumber) {
  const double infinity = std::numeric_limits<double>::infinity();
  const std::vector<double> values = {
      0.1, 1.0 / 3.0, -0.0, 1e308, 5e-324, -2.2250738585072014e-308, infinity, -infinity};
  PointResult result = result_of(0, "key");
  result.metrics.clear();
  for (const double value : values) result.metrics.emplace_back("a", value);
  result.metrics.emplace_back("nan", NAN);
  result.metrics.emplace_back("minus nan", -NAN);
  Shard(folder_).add(result);
  const auto metrics = results_by_key(folder_).at("key").metrics;
  ASSERT_EQ(metrics.size(), values.size() + 2);
  for (std::size_t i = 0; i < values.size(); ++i) {
    EXPECT_EQ(std::bit_cast<std::uint64_t>(metrics[i].second),
              std::bit_cast<std::uint64_t>(values[i]));
  }
  for (std::size_t i = values.size(); i < metrics.size(); ++i) {
    EXPECT_TRUE(std::isnan(metrics[i].second));
  }
}

TEST_F(Shards, ATruncatedLineDoesNotCount) {
  const std::string bytes = bytes_of({result_of(0, "first"), result_of(1, "second")});
  const std::size_t first = bytes.find('\n') + 1;
  for (std::size_t length = first; length <= bytes.size(); ++length) {
    write(bytes.substr(0, length));
    const bool is_whole = length == bytes.size();
    const ShardIndex index(folder_, 2);
    EXPECT_TRUE(index.has(0));
    EXPECT_EQ(index.has(1), is_whole) << length;
    const auto results = results_by_key(folder_);
    EXPECT_TRUE(results.contains("first"));
    EXPECT_EQ(results.contains("second"), is_whole) << length;
  }
}

TEST_F(Shards, ADamagedByteLosesOnlyItsLine) {
  const std::vector<PointResult> all = {result_of(0, "first"), result_of(1, "second", 0.7),
                                        result_of(2, "third", 0.3)};
  const std::string bytes = bytes_of(all);
  const std::size_t begin = bytes.find('\n') + 1;
  const std::size_t end = bytes.find('\n', begin);
  for (std::size_t position = begin; position <= end; ++position) {
    for (int bit = 0; bit < 8; ++bit) {
      std::string damaged = bytes;
      damaged[position] = static_cast<char>(damaged[position] ^ (1 << bit));
      write(damaged);
      const auto results = results_by_key(folder_);
      const ShardIndex index(folder_, 3);
      // A line without its end joins the next one.
      const std::size_t kept = position == end ? 1 : 2;
      ASSERT_EQ(results.size(), kept) << position;
      ASSERT_EQ(index.done(), kept) << position;
      ASSERT_FALSE(index.has(1));
      for (const auto& [key, result] : results) {
        ASSERT_EQ(key, all[result.number].key);
        ASSERT_EQ(result.metrics, all[result.number].metrics);
      }
    }
  }
}

TEST_F(Shards, AShortWriteDoesNotSpoilTheNextLine) {
  {
    Shard made(folder_);
    made.add(result_of(0, "first"));
    const auto size = fs::file_size(shard());
    {
      const FullDisk full(size + 10);
      EXPECT_THROW(made.add(result_of(1, "torn")), OutputError);
      EXPECT_EQ(fs::file_size(shard()), size + 10) << "a part of the line was written";
      EXPECT_THROW(made.add(result_of(1, "torn")), OutputError);
      EXPECT_THROW(made.add(ModelHashes{{"arm.xml", "0"}}), OutputError);
    }
    made.add(ModelHashes{{"arm.xml", "0"}});
    made.add(result_of(2, "next"));
    made.add(result_of(3, "last"));
  }
  const auto results = results_by_key(folder_);
  EXPECT_EQ(results.size(), 3U);
  for (const char* key : {"first", "next", "last"}) EXPECT_TRUE(results.contains(key)) << key;
  EXPECT_EQ(ShardIndex(folder_, 4).models(), (ModelHashes{{"arm.xml", "0"}}));
}

TEST_F(Shards, TheLaterOfTwoLinesWithOneKeyCounts) {
  const std::string one = bytes_of({result_of(0, "key", 1.0)});
  const std::string two = bytes_of({result_of(7, "key", 2.0)});
  const auto value = [&] { return results_by_key(folder_).at("key").metrics[0].second; };
  write(one + two);
  EXPECT_EQ(value(), 2.0);
  write(two + one);
  EXPECT_EQ(value(), 1.0);
  // The newer one of two shards counts, for any names.
  const auto now = fs::file_time_type::clock::now();
  for (const auto& [later, expected] : {std::pair("a.shard", 1.0), std::pair("b.shard", 2.0)}) {
    fs::remove(folder_ / "host-1-0.shard");
    write(one, "a.shard");
    write(two, "b.shard");
    for (const char* name : {"a.shard", "b.shard"}) fs::last_write_time(folder_ / name, now);
    fs::last_write_time(folder_ / later, now + std::chrono::seconds(1));
    EXPECT_EQ(value(), expected);
  }
}

TEST_F(Shards, ForeignLinesDoNotCount) {
  const std::string own = bytes_of({result_of(0, "own")});
  const std::string point = "point\t1\tkey\tcomplete\t\t0.1\t";
  const std::vector<std::string> others = {
      "\n",
      "\t\n",
      "0123456789abcdef\t\n",
      "{\"key\":\"key\",\"values\":{\"a\":1.0}}\n",
      point + "\ta=1\n",                         // no checksum
      "0123456789abcdef\t" + point + "\ta=1\n",  // checksum of another line
      std::string("\0\xff\xfe binary\n", 11),
      std::string(100000, '[') + "\n",
      with_checksum(""),
      with_checksum("\t\t\t\t\t\t\t\t"),
      with_checksum("something\t1\tkey\tcomplete\t\t0.1\t\ta=1"),
      with_checksum("point\tone\tkey\tcomplete\t\t0.1\t\ta=1"),
      with_checksum("point\t-1\tkey\tcomplete\t\t0.1\t\ta=1"),
      with_checksum("point\t1\tkey\tperfect\t\t0.1\t\ta=1"),
      with_checksum("point\t1\tkey\tcomplete\t\tlong\t\ta=1"),
      with_checksum("point\t1\tkey"),
      with_checksum(point + "\ta=1.0x"),
      with_checksum(point + "\ta=1e999"),
      with_checksum(point + "\ta"),
  };
  for (const std::string& other : others) {
    write(other + own + other);
    const auto results = results_by_key(folder_);
    EXPECT_EQ(results.size(), 1U) << other;
    EXPECT_TRUE(results.contains("own")) << other;
    EXPECT_TRUE(ShardIndex(folder_, 2).has(0)) << other;
  }
  // The same line with a right checksum.
  write(with_checksum(point + "\ta=1") + own);
  EXPECT_EQ(results_by_key(folder_).at("key").metrics[0].second, 1.0);
}

TEST_F(Shards, ALineCountsForTheRunThatIsAskedFor) {
  const auto add = [&](std::size_t number, const std::string& asked, const std::string& hash) {
    PointResult result = result_of(number, "key of " + asked);
    result.asked = asked;
    Shard shard(folder_, "origin");
    shard.add(ModelHashes{{"a.xml", hash}});
    shard.add(result);
  };
  const auto asked = [](std::size_t point) {
    return point == 2 ? "" : asked_of("origin", "run " + std::to_string(point));
  };
  add(0, "run 1", "old");
  add(1, "run 1", "new");
  add(2, "run 7", "new");  // not known yet
  add(5, "run 5", "old");
  {
    const ShardIndex index(folder_, 3, asked);
    EXPECT_FALSE(index.has(0));
    EXPECT_TRUE(index.has(1) && index.has(2));
    EXPECT_NO_THROW(index.check_models());
  }
  add(0, "run 0", "new");
  const ShardIndex index(folder_, 3, asked);
  EXPECT_EQ(index.read(0).key, "key of run 0");
  // Another origin asks for other runs. Shards of before say nothing.
  EXPECT_EQ(ShardIndex(folder_, 3, [](std::size_t) { return "other"; }).done(), 0U);
  Shard(folder_).add(result_of(1, "before"));
  EXPECT_EQ(ShardIndex(folder_, 3, [](std::size_t) { return "other"; }).read(1).key, "before");
  EXPECT_EQ(results_by_key(folder_, &PointResult::asked).at(asked(1)).key, "key of run 1");
}

TEST_F(Shards, OtherFilesAndMissingFoldersAreEmpty) {
  const std::string own = bytes_of({result_of(0, "own")});
  write(own, "notes.txt");
  write("", "empty.shard");
  EXPECT_TRUE(results_by_key(folder_).empty());
  EXPECT_EQ(ShardIndex(folder_, 1).done(), 0U);
  EXPECT_TRUE(results_by_key(folder_ / "nowhere").empty());
  fs::create_directory(folder_ / "a.shard");
  EXPECT_THROW(results_by_key(folder_), std::invalid_argument);
}

TEST_F(Shards, AnUnreadableFolderIsNotEmpty) {
  write("text", "file");
  EXPECT_THROW(ShardIndex(folder_ / "file", 1), std::invalid_argument);
  EXPECT_THROW(results_by_key(folder_ / "file"), std::invalid_argument);
}

TEST_F(Shards, ReportsAFailedSync) {
  Shard made(folder_);
  made.finish();
  made.add(result_of(0, "key"));
  for (const auto& entry : fs::directory_iterator("/proc/self/fd")) {
    std::error_code ignored;
    if (fs::equivalent(entry.path(), shard(), ignored)) {
      close(std::stoi(entry.path().filename()));  // simulates a loss by the file system
      break;
    }
  }
  EXPECT_THROW(made.finish(), OutputError);
}

TEST_F(Shards, ModelsOfTwoVersionsAreNotMixed) {
  const auto add = [&](const std::string& hash) {
    Shard(folder_).add(ModelHashes{{"a.xml", hash}});
  };
  add("1");
  add("1");
  EXPECT_NO_THROW(ShardIndex(folder_, 1).check_models());
  add("2");
  EXPECT_TRUE(has(complaint_of([&] { ShardIndex(folder_, 1).check_models(); }),
                  "another version of a.xml"));
}

TEST_F(Shards, VeryManyShardsWork) {
  const std::string last = bytes_of({result_of(0, "last")});
  for (int i = 0; i < 66000; ++i) write("", "a-" + std::to_string(i) + ".shard");
  write(last, "b.shard");
  EXPECT_EQ(ShardIndex(folder_, 1).read(0).key, "last");
}

TEST_F(Shards, APointIsFoundByTheBeginningOfItsKey) {
  write(bytes_of({result_of(0, "abc1"), result_of(1, "abd2"), result_of(2, "abc1")}));
  const ShardIndex index(folder_, 4);
  EXPECT_EQ(index.find("abd2"), 1U);
  EXPECT_EQ(index.find("abc"), 0U);
  EXPECT_EQ(index.find("b"), 4U);
  EXPECT_THROW(index.find("ab"), std::invalid_argument);
}

TEST_F(Shards, CannotBeWrittenWithoutAFolder) {
  Shard made(folder_ / "nowhere");
  EXPECT_THROW(made.add(result_of(0, "key")), OutputError);
}

}  // namespace breakwater::shards_test
