"""Sweeps and tunings on a real Slurm: in spite of lost tasks and nodes, the results are
those of a local run, byte for byte.

Usage: slurm_test.py BREAKWATER ISHIGAMI_LAB [--study]
"""

import os
import pathlib
import random
import re
import shlex
import shutil
import signal
import subprocess
import sys
import unittest

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent))
import slurm_cluster  # noqa: E402
from slurm_cluster import wait_for  # noqa: E402

SKIPPED = 77
WORK = pathlib.Path("/run/work")  # only visible to the nodes of the cluster
MOST_TASKS = 10
INTERRUPTED = 130


class Study:
    """A study that is started repeatedly."""

    command = "sweep"

    def __init__(self, program, folder, *what):
        self.program, self.folder, self.what = program, WORK / folder, what

    def call(self, *options):
        return run(*self.words(*options))

    def words(self, *options):
        return [self.program, self.command, *self.what, "--out", self.folder, *options]

    def on_slurm(self, *options):
        return self.call("--slurm", *options)

    def looks(self, *options):
        return run(self.program, self.command, self.folder, *options)

    def status(self):
        return self.looks("--status").stdout

    def done(self):
        """The number of results in the shards. It exceeds the number of points if some ran
        twice."""
        return sum(text.read_text(errors="replace").count("\tasked\t")
                   for text in (self.folder / "shards").glob("*"))

    def job(self, number=1):
        return (self.folder / "slurm" / str(number) / "job").read_text().strip()

    def submissions(self):
        return len(list((self.folder / "slurm").iterdir()))

    def results(self):
        return (self.folder / "results.csv").read_bytes()

    def has_ended(self, cluster, number=1):
        wait_for(f"job {number} of {self.folder} is over",
                 lambda: not cluster.states(self.job(number)))


class Tuning(Study):
    command = "tune"

    def begun_on_slurm(self, *options):
        """Start the study. It prints to the output of this script."""
        return subprocess.Popen([str(word) for word in self.words("--slurm", *options)], cwd=WORK,
                                stdin=subprocess.DEVNULL)

    def results(self):
        """All files except the description, shards and jobs."""
        return {file.relative_to(self.folder): file.read_bytes()
                for pattern in ("*.csv", "*.html", "front/*") for file in self.folder.glob(pattern)}


def variables_of_a_task():
    """Names in the environment of a running task; None without one."""
    for process in slurm_cluster.tasks():
        try:
            told = pathlib.Path(f"/proc/{process}/environ").read_bytes()
        except OSError:  # it has ended
            continue
        return [variable.partition(b"=")[0].decode() for variable in told.split(b"\0")]
    return []


def run(*words):
    return subprocess.run([str(word) for word in words], cwd=WORK, capture_output=True, text=True,
                          stdin=subprocess.DEVNULL)


class OnSlurm(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.cluster = cls.enterClassContext(slurm_cluster.Cluster(MOST_TASKS + 1))
        cls.enterClassContext(temporary_folder())

    def ok(self, result):
        self.assertEqual(result.returncode, 0, result.stderr)
        return result.stdout

    def finish(self, study):
        """Repeat the command after a job: nothing is left, or the rest is submitted."""
        study.has_ended(self.cluster, study.submissions())
        self.ok(study.on_slurm("--wait"))

    def ishigami(self, folder, points, each_s, *more):
        return Study(ISHIGAMI, folder, "ishigami", "--vary", f"x.first=lin(0,3,{points})",
                     "--set", f"trouble.takes_s={each_s}", *more)

    def same_bytes(self, study):
        here = type(study)(study.program, study.folder.name + " here", *study.what)
        self.ok(here.call("--quiet"))
        self.assertEqual(study.results(), here.results())

    def kill_tasks(self, kills, points):
        study = self.ishigami("kills", points, 0.03)
        chance = random.Random(kills)
        killed = 0
        while killed < kills:
            self.ok(study.on_slurm("--tasks", str(MOST_TASKS), "--quiet"))
            enough = study.done() + chance.randrange(20)
            tasks = wait_for("tasks run", lambda: study.done() >= enough and slurm_cluster.tasks())
            try:
                os.kill(chance.choice(tasks), signal.SIGKILL)
                killed += 1
            except ProcessLookupError:
                pass
            self.assertLess(study.looks("--status").stdout.count(f"{points} of {points}"), 1)
        while (waited := study.on_slurm("--wait")).returncode == INTERRUPTED:
            pass
        self.ok(waited)
        self.same_bytes(study)
        print(f"{kills} kills: {study.done() - points} of {points} points ran twice")


class Slurm(OnSlurm):
    def test_the_node_dies_and_the_results_are_the_same(self):
        # Long enough for a look during the run, also on a loaded machine.
        study = Study(BREAKWATER, "node", "motor_estimation", "--duration", "2",
                      "--vary", "noise.std_rad=lin(0,0.1,250)", "--case", "stf,vfakfd")
        said = self.ok(study.on_slurm("--tasks", "100"))
        self.assertIn(f"500 points in {MOST_TASKS} tasks: job {study.job()}", said)

        wait_for("some are done", lambda: study.done() > 100)
        # Between two tasks the node has only one.
        queue = rf"job {study.job()}: \d+ PENDING \(\w+\), [12] RUNNING"
        wait_for("the queue shows tasks", lambda: re.search(queue, study.status()))
        again = study.on_slurm()
        self.assertEqual(again.returncode, 0)
        self.assertRegex(again.stderr, "points are still in the queue .*; nothing else is left")
        self.assertEqual(study.submissions(), 1)
        here = study.looks()
        self.assertEqual(here.returncode, 2)
        self.assertIn("still in the queue", here.stderr)
        self.assertEqual(study.looks("--rerun").returncode, 2)

        self.cluster.kill_node()
        slurm_cluster.kill_tasks()
        self.cluster.give_up_node()
        self.assertLess(study.done(), 500)
        self.cluster.start_node()
        self.finish(study)
        self.same_bytes(study)
        self.assertEqual(study.status(), f"{study.folder}: 500 of 500 points are done\n")

    def test_slurmd_alone_dies_and_its_tasks_go_on(self):
        study = self.ishigami("slurmd", 100, 0.02)
        self.ok(study.on_slurm("--tasks", "4"))
        wait_for("some are done", lambda: study.done() > 10)
        self.cluster.kill_node()
        done = study.done()
        wait_for("it goes on", lambda: study.done() > done)
        self.cluster.start_node()
        self.ok(study.on_slurm("--wait"))
        self.same_bytes(study)

    def test_a_cancelled_task_ends_after_the_run_in_flight(self):
        # A folder with all characters that a shell or sbatch interprets.
        study = self.ishigami("it's \"50%a\" #1 $HOME", 60, 0.03)
        self.ok(study.on_slurm("--tasks", "2"))
        wait_for("both run", lambda: len(slurm_cluster.tasks()) == 2 and study.done() > 4)
        run("scancel", "--signal=USR1", "--batch", study.job() + "_1")
        run("scancel", study.job() + "_2")
        study.has_ended(self.cluster)
        self.assertLess(study.done(), 60)
        # Every line is complete, so all finished runs were written.
        self.assertIn(f"{study.done()} of 60 points are done", study.status())
        status = study.status()
        self.assertRegex(status, "2 tasks have ended before their points were done:\n"
                                 "  slurm/1/1.log: sweep: interrupted.*\n"
                                 "  slurm/1/2.log: .*(interrupted|CANCELLED)")
        self.ok(study.on_slurm("--wait", "--tasks", "2"))
        self.same_bytes(study)
        self.assertEqual(study.done(), 60)  # none twice

    def test_a_requeued_task_goes_on(self):
        study = self.ishigami("requeue", 60, 0.03)
        self.ok(study.on_slurm("--tasks", "2"))
        wait_for("both run", lambda: len(slurm_cluster.tasks()) == 2 and study.done() > 4)
        run("scontrol", "requeue", study.job())
        self.ok(study.on_slurm("--wait"))
        self.assertEqual(study.submissions(), 1)
        self.same_bytes(study)

    def test_nodes_that_do_not_find_the_program_say_so(self):
        program = WORK / "nodes-have-none"
        shutil.copy(ISHIGAMI, program)
        study = Study(program, "lost", "ishigami", "--vary", "x.first=1,2,3")
        self.ok(study.on_slurm("--sbatch", "--hold", "--tasks", "2"))
        self.assertIn("2 PENDING (JobHeldUser)", study.status())
        program.rename(WORK / "away")
        run("scontrol", "release", study.job())
        study.has_ended(self.cluster)
        (WORK / "away").rename(program)
        log = f"{slurm_cluster.NODE}: there is no {program}: it must lie where all nodes see it"
        self.assertEqual(study.status(),
                         f"{study.folder}: 0 of 3 points are done\n"
                         "2 tasks have ended before their points were done:\n"
                         f"  slurm/1/1.log: {log}\n  slurm/1/2.log: {log}\n")
        self.ok(study.on_slurm("--wait"))
        self.same_bytes(study)

    def test_a_wait_that_ends_without_results_says_so(self):
        study = self.ishigami("crash", 4, 0.0, "--set", "trouble.crashes_above=2.5")
        waited = study.on_slurm("--wait", "--tasks", "1")
        self.assertEqual(waited.returncode, INTERRUPTED)
        self.assertIn("the tasks have ended; 3 of 4 points are done; --status says why",
                      waited.stderr)
        self.assertIn("slurm/1/1.log", study.status())
        # In separate processes the crash is a result.
        self.ok(study.on_slurm("--wait", "--isolate"))
        self.assertIn("4 of 4 points are done; of these 1 crashed", study.status())

    def test_options_of_sbatch_say_what_is_asked_for(self):
        file = WORK / "table.toml"
        file.write_text('scenario = "ishigami"\n[set]\n"trouble.takes_s" = 0.3\n[vary]\n"x.first" = [1, 2, 3]\n')
        study = Study(ISHIGAMI, "table", file)
        refused = study.on_slurm("--sbatch", "--partition=nowhere")
        self.assertEqual(refused.returncode, 2)
        self.assertRegex(refused.stderr, r"\Asbatch: error: .*invalid partition.*\n\Z")
        self.assertEqual(study.submissions(), 0)

        options = "--account=control --partition=other --time=0:30:00 --nice=7"
        os.environ["PLACE"] = "under the 'roof'"
        self.addCleanup(os.environ.pop, "PLACE")
        self.ok(study.on_slurm("--tasks", "1", "--parallel", "1", "--sbatch", options))
        job = wait_for("it runs", lambda: slurm_cluster.tasks() and self.cluster.says(
            "scontrol", "show", "job", study.job(1)))
        for asked in ("Account=control", "Partition=other", "TimeLimit=00:30:00", "ArrayTaskThrottle=1",
                      "Requeue=1"):
            self.assertIn(asked, job)
        environment = pathlib.Path(f"/proc/{slurm_cluster.tasks()[0]}/environ").read_bytes()
        self.assertIn(b"PLACE=under the 'roof'", environment.split(b"\0"))
        self.ok(study.on_slurm("--wait"))
        self.same_bytes(study)

    def test_a_tuning_goes_on_whatever_dies(self):
        file = WORK / "tune.toml"
        file.write_text(
            'scenario = "ishigami"\nbudget = 64\npopulation = 16\nseeds = { count = 2 }\n'
            '[set]\n"trouble.takes_s" = 0.05\n'
            '[search]\n"x.first" = { uniform = [-3, 3] }\n"x.second" = { uniform = [-1, 3] }\n'
            '[objective]\ny_1 = { goal = "min", over = "worst" }\n'
            'positive_x_second_1 = { goal = "max" }\n'
            '[validate]\nseeds = { first = 101, count = 3 }\npoints = 4\n')
        study = Tuning(ISHIGAMI, "tuning", file)

        # The node and its tasks die during the second generation.
        front = study.begun_on_slurm("--tasks", "4")
        wait_for("the second generation", lambda: study.done() > 32 + 4)
        self.cluster.kill_node()
        slurm_cluster.kill_tasks()
        self.cluster.give_up_node()
        self.assertLess(study.done(), 64)
        self.cluster.start_node()

        # The command is interrupted in the third generation. Its tasks continue.
        wait_for("the third generation", lambda: study.done() > 64 + 4)
        third = study.job(study.submissions())
        run("scontrol", "hold", third)  # tasks that have not begun wait, also on a slow machine
        front.send_signal(signal.SIGINT)
        self.assertEqual(front.wait(), INTERRUPTED)
        self.assertIn("in the queue: job " + third, study.status())
        here = study.looks()
        self.assertEqual(here.returncode, 2)
        self.assertRegex(here.stderr, r"\Awithout --slurm: .* is still in the queue \(job .*\n\Z")
        run("scontrol", "release", third)

        # In the fourth generation it is killed, and one task is cancelled.
        front = study.begun_on_slurm("--tasks", "4")
        wait_for("the fourth generation", lambda: study.done() > 96 + 4)
        front.kill()
        front.wait()
        run("scancel", study.job(study.submissions()) + "_1")

        # Last, a job submits jobs. They must not inherit its settings.
        words = shlex.join(str(word) for word in study.words("--slurm", "--tasks", "4"))
        front = subprocess.Popen(["sbatch", "--wait", "--cpus-per-task=1", "--mem-per-cpu=1",
                                  f"--output={WORK}/front.log", "--wrap", words], cwd=WORK)
        told = wait_for("a task of a job's job", variables_of_a_task)
        self.assertIn("SLURM_ARRAY_TASK_ID", told)
        self.assertNotIn("SLURM_CPUS_PER_TASK", told)
        self.assertNotIn("SLURM_MEM_PER_CPU", told)
        self.assertEqual(front.wait(), 0)
        self.assertGreaterEqual(study.submissions(), 5)
        self.assertRegex(study.status(), r"128 of 128 runs of the search are done, \d+ of the val")
        self.same_bytes(study)

    def test_killed_tasks_leave_no_trace(self):
        self.kill_tasks(kills=2, points=240)


class SlurmStudy(OnSlurm):
    def test_ten_killed_tasks_leave_no_trace(self):
        self.kill_tasks(kills=10, points=500)

    def test_a_node_that_is_given_up_may_run_points_twice(self):
        study = self.ishigami("given up", 600, 0.1)
        self.ok(study.on_slurm("--tasks", "2"))
        wait_for("some are done", lambda: study.done() > 10)
        self.cluster.kill_node()
        self.cluster.give_up_node()
        status = study.status()
        self.assertRegex(status, "2 PENDING")
        done = study.done()
        wait_for("its tasks go on, seen by nobody", lambda: study.done() > done + 10)
        self.cluster.start_node()
        self.finish(study)
        self.same_bytes(study)


class temporary_folder:
    def __enter__(self):
        WORK.mkdir()

    def __exit__(self, *_):
        shutil.rmtree(WORK)


def main():
    global BREAKWATER, ISHIGAMI
    if reason := slurm_cluster.missing():
        print(f"skipped: {reason}")
        return SKIPPED
    slurm_cluster.enter()
    arguments = sys.argv[1:]
    suite_class = SlurmStudy if "--study" in arguments else Slurm
    BREAKWATER, ISHIGAMI = (pathlib.Path(name).resolve() for name in arguments[:2])
    # A copy of the program in another folder finds the parts of the pages.
    os.environ["BREAKWATER_PATH"] = str(pathlib.Path(__file__).resolve().parents[2])
    names = [name for name in arguments[2:] if name != "--study"]
    load = unittest.defaultTestLoader
    suite = (unittest.TestSuite(map(suite_class, names)) if names else
             load.loadTestsFromTestCase(suite_class))
    # A test that fails leaves a cluster on which the next ones would only wait.
    result = unittest.TextTestRunner(verbosity=2, failfast=True).run(suite)
    return 0 if result.wasSuccessful() else 1


if __name__ == "__main__":
    sys.exit(main())
