// `breakwater tune --slurm` with fake Slurm programs. tests/study/slurm_test.py uses a real Slurm.
#include "environment.h"
#include "search/tuning_folder.h"

namespace breakwater::cluster_runs_test {
namespace fs = std::filesystem;
using testing::kSmall;
using testing::kTuning;
using testing::ProgramResult;

// Runs each task before it prints the job's number. It does not run the tasks in FAILS.
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

const std::string kOnSlurm = "ishigami_lab tune t.toml --slurm --out ";

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
    write("slurm/" + name, text);
    fs::permissions(folder_ / "slurm" / name, fs::perms::owner_all);
  }
  ProgramResult on_slurm(const std::string& words) const { return run(kOnSlurm + words); }
  std::size_t jobs(const std::string& study) const {
    const fs::path folder = folder_ / study / "slurm";
    return fs::exists(folder) ? static_cast<std::size_t>(std::distance(
                                    fs::directory_iterator(folder), fs::directory_iterator()))
                              : 0;
  }
  // Larger than the number of runs if some ran twice.
  std::size_t lines_of_shards(const std::string& study) const {
    return results_in_shards(study).size();
  }

  std::string path_ = std::getenv("PATH");
};

TEST_F(ClusterRuns, GiveTheSameBytesAsLocalRuns) {
  tuned("t.toml --out here --quiet");
  const ProgramResult result = done(on_slurm("there --tasks 9 --sbatch --qos=low"));
  expect_same("here", "there");
  // Eight generations of each case and its validation. Each run is made once, and the tasks print
  // nothing.
  EXPECT_EQ(jobs("there"), 2U * 8 + 2);
  EXPECT_EQ(lines_of_shards("there"), results("there").size() - 1);
  EXPECT_EQ(read("there/slurm/1/1.log"), "");
  EXPECT_TRUE(has(result.out, "plain, evaluations 9 to 16: 16 runs in 3 tasks: job 7\n",
                  "noisy, validation: 18 runs in 3 tasks: job 7\n"));
  EXPECT_EQ(lines("asked")[0].find("--parsable --qos=low "), 0U);
  EXPECT_TRUE(has(read("there/slurm/1/job.sh"), "--job-name=\"tune-there\""));
  // All runs are done, so nothing is submitted.
  done(on_slurm("there"));
  EXPECT_EQ(jobs("there"), 2U * 8 + 2);
  EXPECT_TRUE(has(tune("there --status").out,
                  "there: 256 of 256 runs of the search are done, "
                  "36 of the validation\n"));
}

TEST_F(ClusterRuns, AreSubmittedAgainWhenMissing) {
  write("t.toml", kSmall);
  tuned("t.toml --out here --quiet");
  setenv("FAILS", "2,3", 1);
  done(on_slurm("there --tasks 3 --quiet"));
  expect_same("here", "there");
  // Each job makes a third of the rest: 8, 6, 4, 3, 2, 1.
  EXPECT_EQ(jobs("there"), 2U * 6);
  EXPECT_EQ(lines_of_shards("there"), results("there").size() - 1);
}

TEST_F(ClusterRuns, StopAfterThreeJobsWithoutResult) {
  write("t.toml", kSmall);
  tuned("t.toml --out here --quiet");
  setenv("FAILS", "1,2,3", 1);
  const ProgramResult result = on_slurm("there --tasks 3");
  EXPECT_EQ(result.status, 130);
  EXPECT_EQ(result.err,
            "tune: 3 jobs in a row have brought nothing of plain, evaluations 1 to 8: 8 runs; "
            "--status says why, the same command goes on\n");
  EXPECT_EQ(jobs("there"), 3U);
  const std::string status = tune("there --status").out;
  EXPECT_TRUE(has(status, "there: 0 of 16 runs of the search are done\n",
                  "3 tasks have ended before their points were done:\n  slurm/3/1.log: "));
  // The tuning continues here and then on the cluster.
  unsetenv("FAILS");
  tune("there --quiet", has_results("there"));
  done(on_slurm("there --quiet"));
  expect_same("here", "there");
}

TEST_F(ClusterRuns, FitIntoTheMinutesOfATask) {
  write("t.toml", kSmall + "[set]\n\"trouble.takes_s\" = 0.1\n");
  // 8 runs of slightly more than 0.1 s in tasks of 0.6 s.
  const ProgramResult result = done(on_slurm("there --minutes 0.01"));
  EXPECT_TRUE(has(result.out, "8 runs in 2 tasks"));
  EXPECT_EQ(lines_of_shards("there"), results("there").size() - 1);
}

TEST_F(ClusterRuns, LeaveOutTheRunMadeForTheEstimate) {
  write("t.toml",
        "scenario = \"ishigami\"\nalgorithm = \"bobyqa\"\nbudget = 5\n"
        "[search]\n\"x.first\" = { uniform = [-3, 3] }\n\"x.second\" = { uniform = [0, 1] }\n"
        "[objective]\ny_1 = { goal = \"min\" }\n");
  const ProgramResult result = done(on_slurm("s"));
  EXPECT_EQ(jobs("s"), 4U);  // the first of 5 evaluations is made here
  EXPECT_EQ(result.out.find("plain, evaluation 2: 1 run in 1 task: job 7\n"), 0U) << result.out;
  EXPECT_EQ(lines_of_shards("s"), 5U);
}

// The command may run in a job itself. Its tasks must not inherit the job's variables.
TEST_F(ClusterRuns, DoNotInheritTheSubmittingJob) {
  write("t.toml", kSmall);
  const testing::Environment job("SLURM_JOB_ID", "3"), cpus("SLURM_CPUS_PER_TASK", "64"),
      memory("SLURM_MEM_PER_CPU", "100"), conf("SLURM_CONF", "/etc/slurm.conf");
  const ProgramResult result = on_slurm("s --quiet --tasks 1");
  ASSERT_EQ(result.status, 0) << result.err;
  EXPECT_EQ(lines("told"), (std::vector<std::string>{2, "SLURM_CONF=/etc/slurm.conf"}));
}

TEST_F(ClusterRuns, MayCrash) {
  write("t.toml", kSmall + "[set]\n\"trouble.crashes_above\" = 1\n");
  tuned("t.toml --out here --quiet --isolate");
  done(on_slurm("there --quiet --tasks 2 --isolate"));
  expect_same("here", "there");
  EXPECT_TRUE(has(read("there/slurm/1/job.sh"), " tune ", " --isolate --points "));
  // The run that measures the time may crash too.
  write("t.toml", kSmall + "[set]\n\"trouble.crashes_above\" = -3\n");
  const ProgramResult crashed = on_slurm("s --quiet --isolate");
  EXPECT_EQ(crashed.status, 3)
      << crashed.err;  // no candidate survives, but the tuning ends normally
  EXPECT_EQ(results("s").size(), 1U + 16);
}

TEST_F(ClusterRuns, MayRunElsewhereInTheSameTuning) {
  write("t.toml", kSmall + "[slurm]\naccount = \"mine\"\nmodules = [\"none\"]\n");
  ASSERT_EQ(on_slurm("s --quiet --tasks 1").status, 130);  // the module does not exist
  EXPECT_TRUE(has(tune("s --status").out, "module load none has failed"));
  write("t.toml", kSmall + "[slurm]\naccount = \"ours\"\n");
  done(on_slurm("s --quiet"));
  EXPECT_TRUE(has(read("s/slurm/4/job.sh"), "--account=\"ours\""));
}

TEST_F(ClusterRuns, WarnOfASearchWithOneCandidateAtATime) {
  write("t.toml",
        "scenario = \"ishigami\"\nalgorithm = \"bobyqa\"\nbudget = 5\nseeds = { count = 3 }\n"
        "[search]\n\"x.first\" = { uniform = [-3, 3] }\n\"x.second\" = { uniform = [0, 1] }\n"
        "[objective]\ny_1 = { goal = \"min\" }\n");
  const ProgramResult result = done(on_slurm("s"));
  EXPECT_EQ(result.err,
            "tune: warning: bobyqa asks for one candidate at a time: each is an array job of its "
            "own, of 3 runs\n"
            "tune: warning: search: 10 of 15 runs are the same as another one of their candidate: "
            "what differs between their conditions, such as the seed, changes nothing there\n");
  EXPECT_TRUE(has(result.out, "plain, evaluation 5: 3 runs in 1 task: job 7\n"));
  EXPECT_EQ(jobs("s"), 5U);
}

TEST_F(ClusterRuns, StayInTheQueue) {
  write("t.toml", kSmall);
  setenv("FAILS", "1,2,3", 1);
  ASSERT_EQ(on_slurm("s --quiet --tasks 1").status, 130);
  program("squeue", "#!/bin/sh\necho '7|1|PENDING|Resources'\n");
  expect_refusals(
      "ishigami_lab tune s",
      {{"",
        "without --slurm: HERE/s is still in the queue (job 7: 1 PENDING (Resources); job 7: 1 "
        "PENDING (Resources); job 7: 1 PENDING (Resources)): end it first with scancel"},
       {" --rerun",
        "--rerun: HERE/s is still in the queue (job 7: 1 PENDING (Resources); job 7: 1 PENDING "
        "(Resources); job 7: 1 PENDING (Resources)): end it first with scancel"}});
  // With --slurm it waits for the queue until it is stopped.
  const fs::path looked = folder_ / "looked";
  program("squeue", "#!/bin/sh\necho '7|1|PENDING|Resources'\n: > " + looked.string() + "\n");
  const ProgramResult waited = tune(
      "t.toml --out s --slurm", [&](int) { return fs::exists(looked); }, SIGTERM);
  EXPECT_EQ(waited.status, 130);
  EXPECT_EQ(waited.err,
            "tune: interrupted; what is in the queue goes on, and so does the same command\n");
  EXPECT_EQ(jobs("s"), 3U);
}

TEST_F(ClusterRuns, NonsenseIsOneLineAndStatus2) {
  program("sbatch", "#!/bin/sh\necho sbatch: error: invalid partition >&2\nexit 1\n");
  const ProgramResult failed = on_slurm("s --tasks 1");
  EXPECT_EQ(failed.status, 2);
  EXPECT_EQ(failed.err, "sbatch: error: invalid partition\n");
  EXPECT_EQ(jobs("s"), 0U);
  const std::string points = "ishigami_lab tune s --points ";
  expect_refusals(points, {{"0-3", "--points: 0-3: must be @FILE:LINE"},
                           {"@s/slurm/1/tasks:1",
                            "s/slurm/1/candidates: cannot be read (No such file or directory)"}});
  write("s/slurm/1/tasks", "0-3\n");
  const std::string task = points + "@" + (folder_ / "s/slurm/1/tasks").string() + ":1";
  for (const auto& [candidates, line] : Refusals{
           {"0\t0\t1\t2",
            "--points: @HERE/s/slurm/1/tasks:1: the candidate of run 2 is not beside it"},
           {"0\t64\t1\t2", "HERE/s/slurm/1/candidates: has no candidate in: 0\\x0964\\x091\\x092"},
           {"0\t0\t1", "HERE/s/slurm/1/candidates: has no candidate in: 0\\x090\\x091"}}) {
    write("s/slurm/1/candidates", candidates + "\n");
    expect_refused(task, line);
  }
  setenv("PATH", "/nowhere", 1);
  for (const char* folder : {"t", "s"}) {  // `s` exists already
    expect_refused(kOnSlurm + folder, "scontrol: cannot be called (No such file or directory)");
  }
}

}  // namespace breakwater::cluster_runs_test
