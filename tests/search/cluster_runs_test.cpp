// `breakwater tune --slurm` with programs of Slurm's that the test wrote; tests/study/slurm_test.py
// has a real one.
#include <algorithm>
#include <cstdlib>

#include "search/tuning_folder.h"

namespace breakwater {
namespace {
namespace fs = std::filesystem;
using testing::kTuning;
using testing::ProgramResult;

// Runs each task before it says which job it is; the task that FAILS names it does not run.
constexpr const char* kSbatch = R"bash(#!/bin/bash
echo "$@" >> asked
env | grep ^SLURM >> told
for script; do :; done
last=$(sed -n 's/^#SBATCH --array="1-\([0-9]*\).*/\1/p' "$script")
for task in $(seq "$last"); do
  [[ $FAILS = *$task* ]] || SLURM_JOB_ID=7 SLURM_ARRAY_TASK_ID=$task bash "$script" >> "$(dirname "$script")/$task.log" 2>&1
done
echo 7
)bash";

// Two generations of one case.
constexpr const char* kSmall = R"(
scenario = "ishigami"
budget = 16
population = 8
[search]
"x.first" = { uniform = [-3, 3] }
"x.second" = { uniform = [-1, 3] }
[objective]
y_1 = { goal = "min" }
positive_x_second_1 = { goal = "max" }
)";

class ClusterRuns : public testing::TuningFolder {
 protected:
  ClusterRuns() {
    write("t.toml", kTuning);
    program("scontrol", "#!/bin/sh\necho MaxArraySize = 4\necho MaxJobCount = 100\n");
    program("squeue", "#!/bin/sh\n");
    program("sbatch", kSbatch);
    setenv("PATH", ((folder_ / "slurm").string() + ":/usr/bin:/bin").c_str(), 1);
  }
  ~ClusterRuns() override {
    setenv("PATH", path_.c_str(), 1);
    unsetenv("FAILS");
  }

  void program(const std::string& name, const std::string& text) {
    fs::create_directories(folder_ / "slurm");
    write("slurm/" + name, text);
    fs::permissions(folder_ / "slurm" / name, fs::perms::owner_all);
  }
  ProgramResult on_slurm(const std::string& out, std::vector<std::string> more = {}) {
    more.insert(more.begin(), {"t.toml", "--out", out, "--slurm"});
    return tune(more);
  }
  std::size_t jobs(const std::string& study) const {
    const fs::path folder = folder_ / study / "slurm";
    return fs::exists(folder) ? static_cast<std::size_t>(std::distance(
                                    fs::directory_iterator(folder), fs::directory_iterator()))
                              : 0;
  }
  // Lines of results in all shards: more than there are runs if some were made twice.
  std::size_t lines_of_shards(const std::string& study) const {
    std::size_t count = 0;
    for (const auto& entry : fs::directory_iterator(folder_ / study / "shards")) {
      const std::string text = testing::text_of(entry.path());
      for (std::size_t at = 0; (at = text.find("\tpoint\t", at)) != std::string::npos; ++at)
        ++count;
    }
    return count;
  }
  void expect_refused(const ProgramResult& result, const std::string& message) {
    EXPECT_EQ(result.status, 2) << result.err;
    EXPECT_EQ(std::count(result.err.begin(), result.err.end(), '\n'), 1) << result.err;
    EXPECT_NE(result.err.find(message), std::string::npos) << result.err;
  }

  std::string path_ = std::getenv("PATH");
};

TEST_F(ClusterRuns, ChangeNoByte) {
  ASSERT_EQ(tune({"t.toml", "--out", "here", "--quiet"}).status, 0);
  const ProgramResult result = on_slurm("there", {"--tasks", "9", "--sbatch", "--qos=low"});
  ASSERT_EQ(result.status, 0) << result.err;
  expect_same("here", "there");
  // Eight generations of each case and its validation, each run once, nothing said by a task.
  EXPECT_EQ(jobs("there"), 2U * 8 + 2);
  EXPECT_EQ(lines_of_shards("there"), results("there").size() - 1);
  EXPECT_EQ(read("there/slurm/1/1.log"), "");
  EXPECT_NE(result.out.find("plain, evaluations 9 to 16: 16 runs in 3 tasks: job 7\n"),
            std::string::npos)
      << result.out;
  EXPECT_NE(result.out.find("noisy, validation: 18 runs in 3 tasks: job 7\n"), std::string::npos);
  EXPECT_EQ(lines("asked")[0].find("--parsable --qos=low "), 0U);
  EXPECT_NE(read("there/slurm/1/job.sh").find("--job-name=\"tune-there\""), std::string::npos);
  // All is there: nothing is submitted.
  ASSERT_EQ(on_slurm("there").status, 0);
  EXPECT_EQ(jobs("there"), 2U * 8 + 2);
  EXPECT_NE(tune({"there", "--status"})
                .out.find("there: 256 of 256 runs of the search are done, "
                          "36 of the validation\n"),
            std::string::npos);
}

TEST_F(ClusterRuns, ThatAreMissingAreSubmittedAgain) {
  write("t.toml", kSmall);
  ASSERT_EQ(tune({"t.toml", "--out", "here", "--quiet"}).status, 0);
  setenv("FAILS", "2,3", 1);
  ASSERT_EQ(on_slurm("there", {"--tasks", "3", "--quiet"}).status, 0);
  expect_same("here", "there");
  // A third of what is left each time: 8, 6, 4, 3, 2, 1.
  EXPECT_EQ(jobs("there"), 2U * 6);
  EXPECT_EQ(lines_of_shards("there"), results("there").size() - 1);
}

TEST_F(ClusterRuns, ThatNobodyMakesEndIt) {
  write("t.toml", kSmall);
  ASSERT_EQ(tune({"t.toml", "--out", "here", "--quiet"}).status, 0);
  setenv("FAILS", "1,2,3", 1);
  const ProgramResult result = on_slurm("there", {"--tasks", "3"});
  EXPECT_EQ(result.status, 130);
  EXPECT_EQ(result.err,
            "tune: 3 jobs in a row have brought nothing of plain, evaluations 1 to 8: 8 runs; "
            "--status says why, the same command goes on\n");
  EXPECT_EQ(jobs("there"), 3U);
  const std::string status = tune({"there", "--status"}).out;
  EXPECT_NE(status.find("there: 0 of 16 runs of the search are done\n"), std::string::npos);
  EXPECT_NE(status.find("3 tasks have ended before their points were done:\n  slurm/3/1.log: "),
            std::string::npos)
      << status;
  // Here it goes on, and there again.
  unsetenv("FAILS");
  tune({"there", "--quiet"}, 0.1);
  ASSERT_EQ(on_slurm("there", {"--quiet"}).status, 0);
  expect_same("here", "there");
}

TEST_F(ClusterRuns, TakeTheMinutesThatTheyAreGiven) {
  write("t.toml", std::string(kSmall) + "[set]\n\"trouble.takes_s\" = 0.1\n");
  // 8 runs of 0.1 s, or a little more, in tasks of 0.6 s.
  const ProgramResult result = on_slurm("there", {"--minutes", "0.01"});
  ASSERT_EQ(result.status, 0) << result.err;
  EXPECT_NE(result.out.find("8 runs in 2 tasks"), std::string::npos) << result.out;
  EXPECT_EQ(lines_of_shards("there"), results("there").size() - 1);
}

TEST_F(ClusterRuns, OfOneRunThatToldHowLongTheyTakeAreNotSubmitted) {
  write("t.toml",
        "scenario = \"ishigami\"\nalgorithm = \"bobyqa\"\nbudget = 5\n"
        "[search]\n\"x.first\" = { uniform = [-3, 3] }\n\"x.second\" = { uniform = [0, 1] }\n"
        "[objective]\ny_1 = { goal = \"min\" }\n");
  const ProgramResult result = on_slurm("s");
  ASSERT_EQ(result.status, 0) << result.err;
  EXPECT_EQ(jobs("s"), 4U);  // of 5 evaluations the first is made here
  EXPECT_EQ(result.out.find("plain, evaluation 2: 1 run in 1 task: job 7\n"), 0U) << result.out;
  EXPECT_EQ(lines_of_shards("s"), 5U);
}

// The command may be a job itself: what it is told of that is nothing for its tasks.
TEST_F(ClusterRuns, AreNotToldOfTheJobThatSubmitsThem) {
  write("t.toml", kSmall);
  setenv("SLURM_JOB_ID", "3", 1);
  setenv("SLURM_CPUS_PER_TASK", "64", 1);
  setenv("SLURM_MEM_PER_CPU", "100", 1);
  setenv("SLURM_CONF", "/etc/slurm.conf", 1);
  const ProgramResult result = on_slurm("s", {"--quiet", "--tasks", "1"});
  for (const char* name :
       {"SLURM_JOB_ID", "SLURM_CPUS_PER_TASK", "SLURM_MEM_PER_CPU", "SLURM_CONF"})
    unsetenv(name);
  ASSERT_EQ(result.status, 0) << result.err;
  EXPECT_EQ(lines("told"), (std::vector<std::string>{2, "SLURM_CONF=/etc/slurm.conf"}));
}

TEST_F(ClusterRuns, MayCrash) {
  write("t.toml", std::string(kSmall) + "[set]\n\"trouble.crashes_above\" = 1\n");
  ASSERT_EQ(tune({"t.toml", "--out", "here", "--quiet", "--isolate"}).status, 0);
  ASSERT_EQ(on_slurm("there", {"--quiet", "--tasks", "2", "--isolate"}).status, 0);
  expect_same("here", "there");
  EXPECT_NE(read("there/slurm/1/job.sh").find(" tune "), std::string::npos);
  EXPECT_NE(read("there/slurm/1/job.sh").find(" --isolate --points "), std::string::npos);
  // The run that tells how long the others take may crash too.
  write("t.toml", std::string(kSmall) + "[set]\n\"trouble.crashes_above\" = -3\n");
  const ProgramResult crashed = on_slurm("s", {"--quiet", "--isolate"});
  EXPECT_EQ(crashed.status, 3) << crashed.err;  // nobody survives: the tuning is done all the same
  EXPECT_EQ(results("s").size(), 1U + 16);
}

TEST_F(ClusterRuns, WhereTheyRunIsNoPartOfATuning) {
  write("t.toml", std::string(kSmall) + "[slurm]\naccount = \"mine\"\nmodules = [\"none\"]\n");
  ASSERT_EQ(on_slurm("s", {"--quiet", "--tasks", "1"}).status, 130);  // there is no such module
  EXPECT_NE(tune({"s", "--status"}).out.find("module load none has failed"), std::string::npos);
  write("t.toml", std::string(kSmall) + "[slurm]\naccount = \"ours\"\n");
  ASSERT_EQ(on_slurm("s", {"--quiet"}).status, 0);
  EXPECT_NE(read("s/slurm/4/job.sh").find("--account=\"ours\""), std::string::npos);
  write("t.toml", std::string(kSmall) + "[slurm]\nacount = \"mine\"\n");
  expect_refused(on_slurm("s"), "slurm.acount: unknown key (did you mean account?)");
}

// In a script a newline would begin a command.
TEST_F(ClusterRuns, ControlCharactersGoIntoNoScript) {
  for (const char* key :
       {"account", "partition", "constraint", "modules", "environment", "options"}) {
    write("t.toml", std::string(kSmall) + "[slurm]\n" + key + " = \"a=b\\nrm -rf x\"\n");
    expect_refused(on_slurm("s"), "slurm." + std::string(key) +
                                      ": must have no newline and no other control character, is "
                                      "a=b\\nrm -rf x");
  }
  write("t.toml", kSmall);
  expect_refused(on_slurm("s\nrm -rf x"),
                 "s\\nrm -rf x: has a newline or another control character, which no script may "
                 "have: choose another folder");
  expect_refused(testing::run_program({"breakwater", "sweep", "motor_estimation", "--out",
                                       "s\nrm -rf x", "--print-tasks"},
                                      folder_),
                 "s\\nrm -rf x: has a newline or another control character, which no script may "
                 "have: choose another folder");
  EXPECT_FALSE(fs::exists(folder_ / "s"));
  EXPECT_FALSE(fs::exists(folder_ / "s\nrm -rf x"));
}

TEST_F(ClusterRuns, OneCandidateAtATimeIsWarnedOf) {
  write("t.toml",
        "scenario = \"ishigami\"\nalgorithm = \"bobyqa\"\nbudget = 5\nseeds = { count = 3 }\n"
        "[search]\n\"x.first\" = { uniform = [-3, 3] }\n\"x.second\" = { uniform = [0, 1] }\n"
        "[objective]\ny_1 = { goal = \"min\" }\n");
  const ProgramResult result = on_slurm("s");
  ASSERT_EQ(result.status, 0) << result.err;
  EXPECT_EQ(result.err,
            "tune: warning: bobyqa asks for one candidate at a time: each is an array job of its "
            "own, of 3 runs\n"
            "tune: warning: search: 10 of 15 runs are the same as another one of their candidate: "
            "without noise seeds change nothing\n");
  EXPECT_NE(result.out.find("plain, evaluation 5: 3 runs in 1 task: job 7\n"), std::string::npos)
      << result.out;
  EXPECT_EQ(jobs("s"), 5U);
}

TEST_F(ClusterRuns, InTheQueueAreLeftThere) {
  write("t.toml", kSmall);
  setenv("FAILS", "1,2,3", 1);
  ASSERT_EQ(on_slurm("s", {"--quiet", "--tasks", "1"}).status, 130);
  program("squeue", "#!/bin/sh\necho '7|1|PENDING|Resources'\n");
  const std::string queue = "/s is still in the queue (job 7: 1 PENDING (Resources)";
  expect_refused(tune({"s"}), queue);
  expect_refused(tune({"s", "--rerun"}), queue);
  // With --slurm it waits for them until it is stopped.
  const ProgramResult waited = testing::run_program(
      {ISHIGAMI_LAB, "tune", "t.toml", "--out", "s", "--slurm"}, folder_, 1.5, SIGTERM);
  EXPECT_EQ(waited.status, 130);
  EXPECT_EQ(waited.err,
            "tune: interrupted; what is in the queue goes on, and so does the same command\n");
  EXPECT_EQ(jobs("s"), 3U);
}

TEST_F(ClusterRuns, NonsenseIsOneLineAndStatus2) {
  expect_refused(on_slurm("s", {"--minutes", "0"}), "--minutes");
  expect_refused(on_slurm("s", {"--minutes", "soon"}), "--minutes");
  expect_refused(on_slurm("s", {"--parallel", "0"}), "--parallel");
  expect_refused(on_slurm("s", {"--jobs", "2"}), "--jobs");
  expect_refused(tune({"t.toml", "--minutes", "3"}), "--slurm");
  expect_refused(tune({"t.toml", "--out", "s", "--status"}), "has no tune.toml");
  EXPECT_FALSE(fs::exists(folder_ / "s"));

  program("sbatch", "#!/bin/sh\necho sbatch: error: invalid partition >&2\nexit 1\n");
  expect_refused(on_slurm("s", {"--tasks", "1"}), "sbatch: error: invalid partition\n");
  EXPECT_EQ(jobs("s"), 0U);
  expect_refused(tune({"s", "--points", "0-3"}), "--points: 0-3: must be @FILE:LINE");
  expect_refused(tune({"s", "--points", "@s/slurm/1/tasks:1"}), "candidates: cannot be read");
  fs::create_directories(folder_ / "s/slurm/1");
  write("s/slurm/1/tasks", "0-3\n");
  write("s/slurm/1/candidates", "0\t0\t1\t2\n");
  const std::string task = "@" + (folder_ / "s/slurm/1/tasks").string() + ":1";
  expect_refused(tune({"s", "--points", task}), "the candidate of run 2 is not beside it");
  write("s/slurm/1/candidates", "0\t64\t1\t2\n");
  expect_refused(tune({"s", "--points", task}), "candidates: has no candidate in: ");
  write("s/slurm/1/candidates", "0\t0\t1\n");
  expect_refused(tune({"s", "--points", task}), "candidates: has no candidate in: ");

  setenv("PATH", "/nowhere", 1);
  expect_refused(on_slurm("t"), "scontrol");
  EXPECT_FALSE(fs::exists(folder_ / "t"));
}

}  // namespace
}  // namespace breakwater
