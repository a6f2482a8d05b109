#include <breakwater/study/executor.h>

#include <sys/resource.h>

#include <chrono>
#include <new>
#include <thread>

#include <breakwater/sim/engine_guard.h>
#include <breakwater/sim/model.h>
#include "support.h"

namespace breakwater::executor_test {
namespace fs = std::filesystem;

// Calls `during` and returns one number.
class Made : public Scenario {
 public:
  explicit Made(std::function<void()> during) : during_(std::move(during)) {}

  std::string name() const override { return "made"; }
  std::string summary() const override { return "made up"; }
  Fields fields() override { return {}; }
  void check(const Config&, const Fields&) override {}
  const RunSettings& run_settings() const override { return settings_; }
  Recording run(const RunControl&) const override {
    if (during_) during_();
    Recording recording;
    add(recording.metrics, "a_m", "m", 1.0);
    return recording;
  }

 private:
  std::function<void()> during_;
  RunSettings settings_;
};

// Points with one model file. Something happens while some of them run.
class Source : public PointSource {
 public:
  explicit Source(const fs::path& folder) : folder_(folder) {
    fs::create_directories(folder_);
    write(model(), "<mujoco/>");
  }

  fs::path model() const { return folder_ / "model.xml"; }
  fs::path shards() const { return folder_; }
  static void write(const fs::path& file, const std::string& text) { std::ofstream(file) << text; }

  PreparedRun prepare(std::size_t point) const override {
    if (before.contains(point)) before.at(point)();
    PreparedRun run;
    run.scenario = std::make_unique<Made>(during.contains(point) ? during.at(point) : nullptr);
    run.config_text = std::to_string(point);
    run.model_files = {model().string()};
    return run;
  }
  std::string asked(std::size_t point) const override {
    return "unprepared " + std::to_string(point);
  }
  fs::path folder(std::size_t, const std::string&, bool) const override { return {}; }

  std::map<std::size_t, std::function<void()>> before;  // called before the preparation
  std::map<std::size_t, std::function<void()>> during;

 private:
  fs::path folder_;
};

class Executor : public ::testing::Test {
 protected:
  // Runs the points in order on one thread.
  std::size_t run(const PointSource& source, KnownModels* models = nullptr) {
    Shard shard(source_.shards());
    ExecutorOptions options;
    options.threads = 1;
    options.models = models;
    return run_points({0, 1, 2, 3}, source, shard, options);
  }
  void expect_changed(const std::string& message = ": was changed while it ran: start again") {
    EXPECT_EQ(complaint_of([&] { run(source_); }), source_.model().string() + message);
  }
  std::size_t kept() const { return results_by_key(source_.shards()).size(); }

  const testing::TemporaryPath folder_{"executor"};
  Source source_{folder_};
};

TEST_F(Executor, KeepsEveryPointUnderItsKey) {
  EXPECT_EQ(run(source_), 4U);
  const auto results = results_by_key(source_.shards());
  ASSERT_EQ(results.size(), 4U);
  const ModelHashes models = model_hashes({source_.model().string()});
  EXPECT_EQ(results.at(point_key("2", models)).number, 2U);
  EXPECT_EQ(ShardIndex(source_.shards(), 4).models(), models);
}

TEST_F(Executor, AModelThatChangesGivesNoResult) {
  source_.during[2] = [&] { source_.write(source_.model(), "<mujoco><!-- other --></mujoco>"); };
  expect_changed();
  EXPECT_EQ(kept(), 2U) << "those before it";
}

TEST_F(Executor, DetectsAChangeWithEqualSizeAndTime) {
  source_.during[2] = [&] {
    std::this_thread::sleep_for(
        std::chrono::milliseconds(50));  // longer than the resolution of the file system's clock
    const auto time = fs::last_write_time(source_.model());
    source_.write(source_.model(), "<mujocO/>");
    fs::last_write_time(source_.model(), time);
  };
  expect_changed();
  EXPECT_EQ(kept(), 2U);
}

TEST_F(Executor, AnIncludedFileCountsToo) {
  source_.write(source_.model(), "<mujoco><include file=\"more.xml\"/></mujoco>");
  source_.write(folder_ / "more.xml", "<mujoco/>");
  source_.during[1] = [&] { source_.write(folder_ / "more.xml", "<mujoco><!-- --></mujoco>"); };
  EXPECT_THROW(run(source_), std::invalid_argument);
  EXPECT_EQ(kept(), 1U);
}

TEST_F(Executor, AMissingOrIncompleteModelRefusesNoPoint) {
  source_.during[1] = [&] { fs::remove(source_.model()); };
  expect_changed(": cannot be read (No such file or directory)");
  EXPECT_EQ(kept(), 1U);
  source_.write(source_.model(), "<mujoco/>");
  source_.during.clear();
  source_.before[3] = [&] {
    source_.write(source_.model(), "<muj");
    throw std::invalid_argument("a run without its model");
  };
  expect_changed();
  EXPECT_EQ(kept(), 3U);
  EXPECT_FALSE(results_by_key(source_.shards()).contains("unprepared 3"));
}

TEST_F(Executor, AModelWithTheSameBytesIsTheSame) {
  source_.during[1] = [&] {
    fs::remove(source_.model());
    source_.write(source_.model(), "<mujoco/>");
  };
  EXPECT_EQ(run(source_), 4U);
  EXPECT_EQ(kept(), 4U);
}

TEST_F(Executor, ModelsThatWereReadBeforeMustBeTheSame) {
  KnownModels models;
  models.of({source_.model().string()});
  source_.write(source_.model(), "<mujoco><!-- other --></mujoco>");
  EXPECT_THROW(run(source_, &models), std::invalid_argument);
  EXPECT_EQ(kept(), 0U);
}

// If the hash were computed after the compilation, it could belong to a newer file.
TEST_F(Executor, AHashBelongsToTheCompiledFile) {
  source_.before[0] = [&] {
    Model::load(source_.model().string());
    source_.write(source_.model(), "<mujoco><!-- other --></mujoco>");
  };
  expect_changed();
  EXPECT_EQ(kept(), 0U);
}

TEST_F(Executor, AFileOfTwoModelsHasOneHash) {
  KnownModels models;
  const std::string one = source_.model().string(), other = (folder_ / "other.xml").string();
  source_.write(other, "<mujoco><include file=\"model.xml\"/></mujoco>");
  const ModelHashes first = models.of({one});
  source_.write(source_.model(), "<mujoco><!-- other --></mujoco>");
  const ModelHashes second = models.of({other});
  EXPECT_EQ(first.begin()->second, second.at(first.begin()->first));
  EXPECT_THROW(models.check_unchanged({other}), std::invalid_argument);
  EXPECT_THROW(models.check_unchanged(), std::invalid_argument);
}

TEST_F(Executor, LackOfMemoryOrFilesIsNoResult) {
  source_.during[1] = [] { throw OutOfMemory("arm.xml: Could not allocate memory"); };
  EXPECT_THROW(run(source_), OutOfMemory);
  EXPECT_EQ(kept(), 1U);
}

TEST_F(Executor, ARefusalWithNoFileToOpenIsNoResult) {
#ifdef __SANITIZE_ADDRESS__
  GTEST_SKIP() << "the sanitizer looks at an exception's type through a pipe, and there is none";
#endif
  rlimit before = {};
  getrlimit(RLIMIT_NOFILE, &before);
  source_.during[1] = [&] {
    const rlimit none = {0, before.rlim_max};
    setrlimit(RLIMIT_NOFILE, &none);
    throw std::invalid_argument("data.csv: cannot be read");
  };
  EXPECT_THROW(run(source_), OutputError);
  setrlimit(RLIMIT_NOFILE, &before);
  EXPECT_EQ(kept(), 1U);
  EXPECT_EQ(ShardIndex(source_.shards(), 4).count(PointStatus::refused), 0U);
}

TEST_F(Executor, ARefusalThatPassesIsNoResult) {
  int tries = 0;
  source_.during[1] = [&] {
    if (++tries == 1) throw std::invalid_argument("data.csv: cannot be read");
  };
  EXPECT_EQ(run(source_), 4U);
  EXPECT_EQ(ShardIndex(source_.shards(), 4).count(PointStatus::complete), 4U);
}

TEST_F(Executor, NoMemoryNamesThePoint) {
  source_.during[1] = [] { throw std::bad_alloc(); };
  try {
    run(source_);
    FAIL();
  } catch (const OutOfMemory& error) {
    const std::string key = point_key("1", model_hashes({source_.model().string()}));
    EXPECT_EQ(error.what(), "point " + key + ": there is no memory for it");
  }
  EXPECT_EQ(kept(), 1U);
}

TEST_F(Executor, PointsWithOneKeyWriteOneFolder) {
  class Same : public Source {
   public:
    using Source::Source;
    PreparedRun prepare(std::size_t point) const override {
      PreparedRun run = Source::prepare(point);
      run.config_text = "the same";
      return run;
    }
    fs::path folder(std::size_t, const std::string& key, bool) const override {
      return shards() / "runs" / key;
    }
  };
  Same same(folder_);
  same.during[1] = [&] { fs::remove_all(folder_ / "runs"); };
  EXPECT_EQ(run(same), 4U);
  EXPECT_FALSE(fs::exists(folder_ / "runs")) << "the second point has written it again";
}

TEST_F(Executor, AMistakeIsARefusedPoint) {
  source_.before[1] = [] { throw std::invalid_argument("no such thing"); };
  source_.during[2] = [] { throw std::invalid_argument("not so"); };
  EXPECT_EQ(run(source_), 4U);
  const ShardIndex index(source_.shards(), 4);
  EXPECT_EQ(index.count(PointStatus::refused), 2U);
  EXPECT_EQ(index.read(1).key, "unprepared 1");
  EXPECT_EQ(index.read(1).reason, "no such thing");
  EXPECT_EQ(index.read(2).reason, "not so");
}

}  // namespace breakwater::executor_test
