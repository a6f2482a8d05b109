#include <fcntl.h>
#include <sys/wait.h>
#include <csignal>

#include <breakwater/record/run_folder.h>
#include "support.h"

namespace breakwater::killed_run_test {

namespace fs = std::filesystem;
using testing::text_of;

using Settings = std::map<std::string, std::string>;

class KilledRun : public ::testing::Test {
 protected:
  KilledRun() { fs::create_directories(base_); }

  // Writes a run into target_ in a child process. Returns its exit status, or minus the signal that
  // killed it.
  int write(const std::string& content, const Settings& settings = {}) {
    fs::remove(steps_);
    const pid_t child = fork();
    if (child == 0) {
      dup2(open(errors_.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0600), STDERR_FILENO);
      setenv("LD_PRELOAD", KILL_AT_STEP, 1);
      setenv("STEPS_LOG", steps_.c_str(), 1);
      for (const auto& [name, value] : settings) setenv(name.c_str(), value.c_str(), 1);
      execl(WRITE_RUN_FOLDER, WRITE_RUN_FOLDER, target_.c_str(), content.c_str(), nullptr);
      _exit(127);
    }
    int status = 0;
    waitpid(child, &status, 0);
    return WIFSIGNALED(status) ? -WTERMSIG(status) : WEXITSTATUS(status);
  }

  std::vector<std::string> steps() const { return testing::lines_of(text_of(steps_)); }
  // The index of the first step that begins with `begin`.
  std::ptrdiff_t step(const std::string& begin) const {
    const std::vector<std::string> all = steps();
    const auto found = std::find_if(all.begin(), all.end(), [&](const std::string& step) {
      return (step + "\n").starts_with(begin);
    });
    EXPECT_NE(found, all.end()) << begin;
    return found - all.begin();
  }

  std::set<std::string> names() const {
    std::set<std::string> names;
    for (const auto& entry : fs::directory_iterator(base_)) {
      names.insert(entry.path().filename().string());
    }
    return names;
  }
  // The run that a reader finds, if it is complete.
  std::string found() const {
    restore_run(target_);
    if (!fs::exists(target_)) return "none";
    return is_run_folder(target_) ? text_of(target_ / "log.csv") : "half a run";
  }

  // Kills a run at each of its steps. A reader must then find one of `either`.
  void kill_at_each_step(const Settings& settings, bool has_earlier,
                         const std::set<std::string>& either) {
    for (const char* when : {"STEPS_KILL_BEFORE", "STEPS_KILL_AFTER"}) {
      int status = -SIGKILL;
      int number = 1;
      std::set<std::string> seen;
      for (; status == -SIGKILL; ++number) {
        SCOPED_TRACE(when + std::string(" ") + std::to_string(number));
        fs::remove_all(base_);
        fs::create_directories(base_);
        if (has_earlier) {
          ASSERT_EQ(write("earlier", settings), 0);
        }
        Settings killed = settings;
        killed[when] = std::to_string(number);
        status = write("new", killed);
        seen.insert(found());
        EXPECT_TRUE(either.contains(found())) << found();

        // The next run cleans up, whether it ends or not.
        fs::create_directories(base_);
        { const RunFolder folder(target_); }
        EXPECT_TRUE(either.contains(found())) << found();
        ASSERT_EQ(write("last", settings), 0);
        EXPECT_EQ(found(), "last");
        EXPECT_EQ(names(), std::set<std::string>{"run"});
      }
      EXPECT_EQ(status, 0) << text_of(errors_);
      EXPECT_GT(number, 6);
      EXPECT_EQ(seen, either) << "not every moment was tried";
    }
  }

  const testing::TemporaryPath base_{"killed"};
  const fs::path target_ = base_ / "run";
  const testing::TemporaryPath steps_{"steps"};
  const testing::TemporaryPath errors_{"errors"};
};

const Settings kNoExchange = {{"STEPS_NO_EXCHANGE", "1"}};

TEST_F(KilledRun, IsAbsentOrWhole) {
  kill_at_each_step({}, false, {"none", "new"});
}

TEST_F(KilledRun, LeavesTheOldOrTheNewRun) {
  kill_at_each_step({}, true, {"earlier", "new"});
}

TEST_F(KilledRun, LeavesTheOldOrTheNewRunWithoutExchangeOfNames) {
  kill_at_each_step(kNoExchange, true, {"earlier", "new"});
}

// The parts of the run that are on the disk at this step; "." is the folder itself.
std::set<std::string> synced_before(const std::vector<std::string>& steps, std::ptrdiff_t end,
                                    const std::string& partial) {
  std::set<std::string> synced;
  for (std::ptrdiff_t i = 0; i < end; ++i) {
    const std::string& step = steps[static_cast<std::size_t>(i)];
    if (!step.starts_with("sync " + partial)) continue;
    const std::size_t slash = step.find('/', 5 + partial.size());
    synced.insert(slash == std::string::npos ? "." : step.substr(slash + 1));
  }
  return synced;
}

TEST_F(KilledRun, IsSyncedBeforeItGetsItsName) {
  const std::set<std::string> all = {".", "log.csv", "manifest.json"};
  const std::string partial = base_.string() + "/.run.partial-";
  ASSERT_EQ(write("first"), 0);
  EXPECT_EQ(synced_before(steps(), step("rename " + partial), partial), all);
  EXPECT_GT(step("sync " + base_.string() + "\n"), step("rename " + partial));

  for (const Settings& settings : {Settings{}, kNoExchange}) {
    ASSERT_EQ(write("again", settings), 0);
    const auto placed = step((settings.empty() ? "exchange " : "rename ") + partial);
    EXPECT_EQ(synced_before(steps(), placed, partial), all);
    // The names are synced before the earlier run is removed.
    EXPECT_GT(step("sync " + base_.string() + "\n"), placed);
    EXPECT_LT(step("sync " + base_.string() + "\n"), step("unlink log.csv"));
  }
}

TEST_F(KilledRun, IsKeptUnderAnotherNameIfItsNameIsTaken) {
  for (const Settings& settings : {Settings{}, kNoExchange}) {
    fs::remove_all(base_);
    fs::create_directories(base_);
    ASSERT_EQ(write("earlier"), 0);
    Settings refusing = settings;
    refusing["STEPS_REFUSE"] = target_;
    for (const std::string kept : {"run.kept", "run.kept-2"}) {
      EXPECT_EQ(write(kept, refusing), 2);
      EXPECT_EQ(text_of(errors_), target_.string() +
                                      ": cannot be replaced (Permission denied); the new run is "
                                      "kept in " +
                                      (base_ / kept).string() + "\n");
      EXPECT_EQ(found(), "earlier");
    }
    ASSERT_EQ(write("last", settings), 0);
    EXPECT_EQ(found(), "last");
    EXPECT_EQ(names(), (std::set<std::string>{"run", "run.kept", "run.kept-2"}));
    EXPECT_EQ(text_of(base_ / "run.kept" / "log.csv"), "run.kept");
    EXPECT_EQ(text_of(base_ / "run.kept-2" / "log.csv"), "run.kept-2");
  }
}

TEST_F(KilledRun, IsKeptInPlaceIfItCannotBeMoved) {
  ASSERT_EQ(write("earlier"), 0);
  EXPECT_EQ(write("new", {{"STEPS_REFUSE", "all"}}), 2);
  const std::string error = text_of(errors_);
  const std::size_t in = error.find("the new run is kept in ");
  ASSERT_NE(in, std::string::npos) << error;
  const fs::path kept = error.substr(in + 23, error.size() - in - 24);
  EXPECT_EQ(found(), "earlier");
  ASSERT_EQ(write("last"), 0);
  EXPECT_EQ(found(), "last");
  EXPECT_EQ(text_of(kept / "log.csv"), "new");
}

TEST_F(KilledRun, LeavesNothingOnAFullDisk) {
  EXPECT_EQ(write("new", {{"STEPS_BAD_DISK", "/log.csv"}}), 2);
  EXPECT_TRUE(names().empty());
  ASSERT_EQ(write("earlier"), 0);
  EXPECT_EQ(write("new", {{"STEPS_BAD_DISK", "/log.csv"}}), 2);
  EXPECT_TRUE(
      text_of(errors_).ends_with("/log.csv: cannot be written to the disk (Input/output error)\n"))
      << text_of(errors_);
  EXPECT_EQ(found(), "earlier");
  EXPECT_EQ(names(), std::set<std::string>{"run"});
}

}  // namespace breakwater::killed_run_test
