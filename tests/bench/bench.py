"""Benchmarks. A run of arm_wall_contact is compared with a bare mj_step loop, and its video with a bare
mjr_render loop over the same frames.

Instructions are counted by callgrind on a short run, and repeat exactly. Times are medians of pairs
of alternating 100 s runs, so that a slow change of the machine affects both. The bare loop uses the
model for physics, and for comparison the whole model. Videos are compared by the processor time of
all their processes, which other load hardly changes. Further parts: the start of a program, runs
under waves with each size of estimator, the solvers of quadratic programs, and the Python module.
The end of the output is the table of docs/explanation/performance.md, without the Python module.
"""

import os
import pathlib
import re
import statistics
import subprocess
import sys
import tempfile
import time

BUILD = pathlib.Path(__file__).resolve().parents[2] / "build"
BARE = BUILD / "tests" / "bare"
PAIRS = 5
VIDEO_PAIRS = 3

# The same experiment in a tenth of the time, with an earlier wall, switch and impact.
SHORT = ["--set", "run.duration_s=10", "wall.solid_from_s=4", "force.from_s=5",
         "metrics.from_s=8", "metrics.to_s=10", "record.fine_from_s=4.9", "record.fine_to_s=8"]


TABLE = []  # name, measured, goal


def measured(what, value, goal=""):
    """Print a result, and keep it for the table at the end."""
    print(f"  {what:58} {value:>38}" + (f"   (goal: {goal})" if goal else ""), flush=True)
    TABLE.append((what, value, goal))


def passed_on(command):
    """Print the output of another benchmark line by line, and return it."""
    lines = []
    with subprocess.Popen(command, stdout=subprocess.PIPE, text=True) as process:
        for line in process.stdout:
            print(line, end="", flush=True)
            lines.append(line.rstrip())
    if process.returncode != 0:
        sys.exit(f"{command[0]} failed")
    return lines


def run_command(folder, extra):
    return [BUILD / "bin" / "arm_wall_contact", "--quiet", "--out", folder, *extra]


def replay_command(folder, *whole):
    return [BARE, "replay", folder, *whole]


def instructions(command):
    out = subprocess.run(
        ["valgrind", "--tool=callgrind", "--callgrind-out-file=/dev/null", *command],
        check=True, capture_output=True, text=True).stderr
    return int(re.search(r"Collected : (\d+)", out).group(1))


def seconds(command):
    start = time.perf_counter()
    subprocess.run(command, check=True, capture_output=True)
    return time.perf_counter() - start


def cpu_and_wall_seconds(command, copies=1):
    """Processor and wall time of some copies of a command, with their child processes."""
    start = time.perf_counter()
    processes = [subprocess.Popen(command, stdout=subprocess.DEVNULL) for _ in range(copies)]
    cpu = 0.0
    for process in processes:
        _, status, usage = os.wait4(process.pid, 0)
        if status != 0:
            sys.exit(f"{command[0]} failed")
        cpu += usage.ru_utime + usage.ru_stime
    return cpu, time.perf_counter() - start


def bench_starting(folder):
    """The smallest processor time of a nearly empty process, and its ratio to that of /bin/true."""
    print("starting up, least of 40 ...", flush=True)
    programs, out = BUILD / "bin", pathlib.Path(folder) / "brief"
    breakwater, motor, arm = (programs / name for name in
                              ("breakwater", "motor_estimation", "arm_wall_contact"))
    brief = ["--quiet", "--out", out, "--duration"]
    for what, command, goal in (
            ("a run of 0.01 s with its log", [motor, *brief, "0.01"], "13 ms"),
            ("its configuration, no log", [motor, "--print-config"], "10 ms"),
            ("breakwater --version", [breakwater, "--version"], "9 times"),
            ("breakwater ls", [breakwater, "ls", folder], "9 times"),
            ("breakwater --help", [breakwater, "--help"], "9 times"),
            ("arm_wall_contact --version", [arm, "--version"], "4 times"),
            ("one step of the arm with its log", [arm, *brief, "0.0005"], "9 times")):
        pairs = [[cpu_and_wall_seconds(one)[0] for one in (command, ["/bin/true"])]
                 for _ in range(40)]
        least, of_true = (min(column) for column in zip(*pairs))
        measured(what, f"{1e3 * least:.1f} ms, {least / of_true:.1f} times /bin/true", f"at most {goal}")


def bench_videos(run):
    frames = 900
    cores = os.cpu_count()
    print(f"video, {frames} frames of 1280x720 with impact, {VIDEO_PAIRS} pairs ...", flush=True)
    for look, goal, bound in (("full", 45, "at most 1.25"), ("fast", 90, "")):
        video = [BUILD / "bin" / "breakwater", "video", run, "--quiet", "--look", look,
                 "--from", "29.9", "--to", "31.4", "--speed", "0.05"]
        # One process per core, as for a video: cores that share a cache slow each other down.
        bare = [BARE, "render", run, look, str(frames // cores)]
        pairs = [(cpu_and_wall_seconds(video), cpu_and_wall_seconds(bare, cores))
                 for _ in range(VIDEO_PAIRS)]
        rate = frames / statistics.median(ours[1] for ours, _ in pairs)
        ours_ms = 1e3 / frames * statistics.median(ours[0] for ours, _ in pairs)
        bare_ms = 1e3 / frames * statistics.median(theirs[0] for _, theirs in pairs)
        ratio = statistics.median(ours[0] / theirs[0] for ours, theirs in pairs)
        measured(f"video, {look} look", f"{rate:.1f} frames/s, {ours_ms:.1f} ms of a core each",
                 f"at least {goal} frames/s on 2 cores")
        measured(f"{look} look, a bare mjr_render loop", f"{bare_ms:.1f} ms of a core")
        measured(f"{look} look, the video over the loop", f"{ratio:.2f}", bound)


def bench_quadrotor(folder):
    print("quadrotor_waves, 100 s, processor time of a core ...", flush=True)
    for case in ("ukf-none", "ukf-zero", "ekf-second", "ukf-second", "resonator"):
        command = [BUILD / "bin" / "quadrotor_waves", "--quiet", "--case", case,
                   "--out", pathlib.Path(folder) / case,
                   "--set", "estimator.wave_frequency=estimated"]
        cpu_s = statistics.median(cpu_and_wall_seconds(command)[0] for _ in range(3))
        measured(f"quadrotor_waves --case {case}", f"{100 / cpu_s:.0f} times real time", "at least 10")


def sweep_command(folder, name, cases, *arguments):
    return [BUILD / "bin" / "breakwater", "sweep", "motor_estimation", "--case", cases, "--quiet",
            "--out", pathlib.Path(folder) / name, *arguments]


def bench_sweeps(folder):
    """Compare a study with its bare simulations, and one worker with two."""
    print(f"sweeps of motor_estimation, {PAIRS} pairs ...", flush=True)
    runs, tiny = 200, 2000
    ratios, workers, overheads = [], [], []
    for i in range(PAIRS):
        cpu, one = cpu_and_wall_seconds(
            sweep_command(folder, f"one{i}", "vfakfd", "--seeds", f"1..{runs}", "--jobs", "1"))
        bare = float(subprocess.run([BARE, "points", "vfakfd", "10", str(runs)],
                                    check=True, capture_output=True, text=True).stdout)
        _, two = cpu_and_wall_seconds(
            sweep_command(folder, f"two{i}", "vfakfd", "--seeds", f"1..{runs}", "--jobs", "2"))
        ratios.append(cpu / bare)
        workers.append(one / two)
        cpu, _ = cpu_and_wall_seconds(
            sweep_command(folder, f"tiny{i}", "vfakfd", "--seeds", f"1..{tiny}", "--jobs", "1",
                          "--duration", "0.001"))
        bare = float(subprocess.run([BARE, "points", "vfakfd", "0.001", str(tiny)],
                                    check=True, capture_output=True, text=True).stdout)
        overheads.append(1e3 * (cpu - bare) / tiny)
    measured("a sweep's processor time over its runs'", f"{statistics.median(ratios):.3f}", "at most 1.05")
    measured("a sweep's own time beside a run's", f"{statistics.median(overheads):.2f} ms", "at most 1")
    measured("two workers over one", f"{statistics.median(workers):.2f}", "at least 1.85")
    for points, lists in ((100, ["lin(0,1,100)"]), (100_000, ["lin(0,1,1000)", "lin(0,1,100)"])):
        vary = [word for key, values in zip(("x.first", "x.second"), lists)
                for word in ("--vary", f"{key}={values}")]
        out = pathlib.Path(folder) / f"memory{points}"
        lab = [BUILD / "tests" / "ishigami_lab", "sweep", "ishigami", "--out", out, "--quiet", *vary]
        wall_s, memory = wall_and_memory(lab)
        again_s, _ = wall_and_memory([*lab[:2], out, "--status"])
        measured(f"{points} points of a function", f"{wall_s:.2f} s, {memory:.0f} MB; --status {again_s:.2f} s")


def wall_and_memory(command):
    """Seconds, and the largest resident memory [MB]."""
    start = time.perf_counter()
    process = subprocess.Popen(command, stdout=subprocess.DEVNULL)
    _, status, usage = os.wait4(process.pid, 0)
    if status != 0:
        sys.exit(f"{command[0]} failed")
    return time.perf_counter() - start, usage.ru_maxrss / 1024


def bench_solvers():
    cells = [[cell.strip() for cell in line.strip("|").split("|")]
             for line in passed_on([BUILD / "tests" / "qp_bench"]) if re.match(r"\| \d+x\d+ ", line)]
    if not cells:
        sys.exit("qp_bench prints no rows that are known here")
    times = {(row[0], row[1]): (float(row[2]), float(row[3])) for row in cells}
    for size in dict.fromkeys(row[0] for row in cells):
        for solver in ("active_set", "DAQP", "DAQP, simple bounds"):
            if (size, solver) in times:
                median, largest = times[size, solver]
                measured(f"programs of {size.replace('x', '/')}, {solver}", f"{median:.3g} us, largest {largest:.3g} us")


def bench_estimators():
    goals = {("3 states, 1 output", name): "at most 52" for name in ("FAKFD", "VFAKFD", "QVFF", "STF")}
    goals["24 states, 6 outputs", "UKF, resonators"] = "at most 6 us"
    of, before = "", len(TABLE)
    for line in passed_on([BUILD / "tests" / "estimators_bench"]):
        found = re.match(r"  (.*\S) +([\d.]+ [nu]s)$", line)
        if found:
            TABLE.append((f"{of}: {found[1]}", found[2], goals.get((of, found[1]), "")))
        else:
            of = line.partition(":")[0]
    if len(TABLE) == before:
        sys.exit("estimators_bench prints no lines that are known here")


def main():
    with tempfile.TemporaryDirectory() as folder:
        run = pathlib.Path(folder) / "run"
        print("instructions, 10 s with impact (callgrind, about two minutes) ...", flush=True)
        subprocess.run(run_command(run, SHORT), check=True)
        whole = instructions(replay_command(run, "whole"))
        bare = instructions(replay_command(run))
        ours = instructions(run_command(run, SHORT))
        steps = 100_000
        measured("arm, instructions of a step, bare, whole model", f"{whole / steps:.0f}")
        measured("arm, instructions of a step, bare, what physics needs", f"{bare / steps:.0f}")
        measured("arm, instructions of a step, the run, logging on", f"{ours / steps:.0f}")
        measured("arm, instructions, the run over the bare engine", f"{ours / bare:.3f}", "at most 1.05")
        measured("arm, instructions, the run over the whole model, bare", f"{ours / whole:.3f}", "at most 0.65")

        robot = pathlib.Path(folder) / "robot"
        run_robot = [BUILD / "bin" / "robot_wall_contact", "--quiet", "--out", robot]
        subprocess.run(run_robot, check=True)
        bare = instructions(replay_command(robot))
        ours = instructions(run_robot)
        measured("seven joints, instructions, the run over the bare engine", f"{ours / bare:.3f}", "at most 1.3")

        print(f"time, 100 s, {PAIRS} pairs ...", flush=True)
        subprocess.run(run_command(run, []), check=True)
        pairs = [(seconds(run_command(run, [])), seconds(replay_command(run)))
                 for _ in range(PAIRS)]
        ours_s = statistics.median(p[0] for p in pairs)
        bare_s = statistics.median(p[1] for p in pairs)
        ratio = statistics.median(p[0] / p[1] for p in pairs)
        measured("arm, 100 s, bare, what physics needs", f"{bare_s:.2f} s")
        measured("arm, 100 s, the run, logging on", f"{ours_s:.2f} s, {100 / ours_s:.0f} times real time", "at least 5 times")
        measured("arm, 100 s, the run over the bare engine", f"{ratio:.3f}", "at most 1.05")

        bench_starting(folder)
        bench_videos(run)
        bench_quadrotor(folder)
        bench_sweeps(folder)
    print("quadratic programs ...", flush=True)
    bench_solvers()
    print("one update of an estimator ...", flush=True)
    bench_estimators()
    print("the Python module ...", flush=True)
    subprocess.run(["/usr/bin/python3", pathlib.Path(__file__).with_name("python_bench.py")], check=True,
                   env={**os.environ, "PYTHONPATH": str(BUILD / "python")})
    print("\n| | measured | goal |\n|---|---|---|")
    for row in TABLE:
        print(f"| {' | '.join(row)} |")
    return 0


if __name__ == "__main__":
    sys.exit(main())
