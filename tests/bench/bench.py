"""What a run of arm_wall_contact costs beyond a bare mj_step loop that replays it, and what its video
costs beyond a bare mjr_render loop over the same frames.

Instructions are callgrind's, on a short run: they repeat exactly. Times are medians of pairs of
whole 100 s runs, run in turn, so that a drifting machine shifts both. The bare loop is of what physics
needs of the model, and for comparison of the whole. Then what starting up costs. Videos are compared by the
processors' time of all their processes: it hardly depends on who else uses the machine. Then what a
run under waves takes with each size of estimator, the solvers of quadratic programs, and the Python module.
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
PAIRS = 5
VIDEO_PAIRS = 3

# The same experiment in a tenth of the time: wall, switch and impact come earlier.
SHORT = ["--set", "run.duration_s=10", "wall.solid_from_s=4", "force.from_s=5",
         "metrics.from_s=8", "metrics.to_s=10", "record.fine_from_s=4.9", "record.fine_to_s=8"]


def run_command(folder, extra):
    return [BUILD / "bin" / "arm_wall_contact", "--quiet", "--out", folder, *extra]


def replay_command(folder, *whole):
    return [BUILD / "tests" / "bare_replay", folder, *whole]


def instructions(command):
    out = subprocess.run(
        ["valgrind", "--tool=callgrind", "--callgrind-out-file=/dev/null", *command],
        check=True, capture_output=True, text=True).stderr
    return int(re.search(r"Collected : (\d+)", out).group(1))


def seconds(command):
    start = time.perf_counter()
    subprocess.run(command, check=True, capture_output=True)
    return time.perf_counter() - start


def cpu_and_wall_seconds(command, copies=1, env=None):
    """Of a command, or so many copies at once, and all the processes that they made."""
    start = time.perf_counter()
    processes = [subprocess.Popen(command, stdout=subprocess.DEVNULL, env=env) for _ in range(copies)]
    cpu = 0.0
    for process in processes:
        _, status, usage = os.wait4(process.pid, 0)
        if status != 0:
            sys.exit(f"{command[0]} failed")
        cpu += usage.ru_utime + usage.ru_stime
    return cpu, time.perf_counter() - start


def renderer_by(library, run):
    """What draws by MUJOCO_GL=library, or why nothing does."""
    asked = subprocess.run([BUILD / "tests" / "bare_render", run, "fast", "1"], text=True,
                           capture_output=True, env={**os.environ, "MUJOCO_GL": library})
    if asked.returncode != 0:
        return None, asked.stderr.strip()
    return asked.stdout.strip().partition(", ")[2], ""


def bench_renderers(run, frames):
    """The same video by OSMesa and by EGL, in turn."""
    print(f"renderers, {frames} frames of 1280x720, look full, {VIDEO_PAIRS} rounds ...", flush=True)
    names = {}
    for library in ("osmesa", "egl"):
        name, reason = renderer_by(library, run)
        if name is None:
            print(f"  {library:6}: not measured: {reason}")
        else:
            names[library] = name
    costs = {library: [] for library in names}
    for _ in range(VIDEO_PAIRS):
        for library in names:
            costs[library].append(cpu_and_wall_seconds(
                [BUILD / "bin" / "breakwater", "video", run, "--quiet",
                 "--from", "29.9", "--to", "31.4", "--speed", str(45 / frames)],
                env={**os.environ, "MUJOCO_GL": library}))
    for library, name in names.items():
        cpu_ms = 1e3 / frames * statistics.median(cpu for cpu, _ in costs[library])
        rate = frames / statistics.median(wall for _, wall in costs[library])
        print(f"  {library:6}: {rate:6.1f} frames/s, {cpu_ms:5.1f} ms of a core per frame   ({name})")
    if len(names) == 2:
        ratio = statistics.median(o[0] / e[0] for o, e in zip(costs["osmesa"], costs["egl"]))
        print(f"  EGL draws {ratio:.2f} times as fast as OSMesa, by processor time")


def bench_starting(folder):
    """The least processor time of a process that does next to nothing."""
    print("starting up, least of 40 ...", flush=True)
    brief = ["--quiet", "--duration", "0.01", "--out", pathlib.Path(folder) / "brief"]
    motor = BUILD / "bin" / "motor_estimation"
    for what, command, goal in (("a run of 0.01 s with its log", [motor, *brief], 13),
                                ("its configuration, no log", [motor, "--print-config"], 10)):
        least = min(cpu_and_wall_seconds(command)[0] for _ in range(40))
        print(f"  {what:30} {1e3 * least:7.1f} ms   (goal: at most {goal})")


def bench_videos(run):
    frames = 900
    cores = os.cpu_count()
    bench_renderers(run, frames)
    print(f"video, {frames} frames of 1280x720 with impact, {VIDEO_PAIRS} pairs ...", flush=True)
    for look, goal in (("full", 20), ("fast", 32)):
        video = [BUILD / "bin" / "breakwater", "video", run, "--quiet", "--look", look,
                 "--from", "29.9", "--to", "31.4", "--speed", "0.05"]
        # One on each core, as the video is drawn: cores that share a cache slow each other down.
        bare = [BUILD / "tests" / "bare_render", run, look, str(frames // cores)]
        pairs = [(cpu_and_wall_seconds(video), cpu_and_wall_seconds(bare, cores))
                 for _ in range(VIDEO_PAIRS)]
        rate = frames / statistics.median(ours[1] for ours, _ in pairs)
        ours_ms = 1e3 / frames * statistics.median(ours[0] for ours, _ in pairs)
        bare_ms = 1e3 / frames * statistics.median(theirs[0] for _, theirs in pairs)
        ratio = statistics.median(ours[0] / theirs[0] for ours, theirs in pairs)
        print(f"  {look}: end to end   {rate:9.1f} frames/s (goal on 2 cores: at least {goal})")
        print(f"        bare loop    {bare_ms:9.1f} ms of a core per frame")
        print(f"        video        {ours_ms:9.1f} ms of a core per frame, "
              f"{1e3 * cores / ours_ms:.0f} frames/s if {cores} cores are free")
        print(f"        ratio        {ratio:9.3f}" +
              ("   (goal: at most 1.25)" if look == "full" else ""))


def bench_quadrotor(folder):
    print("quadrotor_waves, 100 s, processor time of a core ...", flush=True)
    for case in ("ukf-none", "ukf-zero", "ekf-second", "ukf-second", "resonator"):
        command = [BUILD / "bin" / "quadrotor_waves", "--quiet", "--case", case,
                   "--out", pathlib.Path(folder) / case,
                   "--set", "estimator.wave_frequency=estimated"]
        cpu_s = statistics.median(cpu_and_wall_seconds(command)[0] for _ in range(3))
        print(f"  {case:18} {cpu_s:6.2f} s, {100 / cpu_s:5.0f} times real time   (goal: at least 10)")


def sweep_command(folder, name, cases, *arguments):
    return [BUILD / "bin" / "breakwater", "sweep", "motor_estimation", "--case", cases, "--quiet",
            "--out", pathlib.Path(folder) / name, *arguments]


def bench_sweeps(folder):
    """A study of many runs beside the same simulations alone, and one worker beside two."""
    print(f"sweeps of motor_estimation, {PAIRS} pairs ...", flush=True)
    runs, tiny = 200, 2000
    ratios, workers, overheads = [], [], []
    for i in range(PAIRS):
        cpu, one = cpu_and_wall_seconds(
            sweep_command(folder, f"one{i}", "vfakfd", "--seeds", f"1..{runs}", "--jobs", "1"))
        bare = float(subprocess.run([BUILD / "tests" / "bare_points", "vfakfd", "10", str(runs)],
                                    check=True, capture_output=True, text=True).stdout)
        _, two = cpu_and_wall_seconds(
            sweep_command(folder, f"two{i}", "vfakfd", "--seeds", f"1..{runs}", "--jobs", "2"))
        ratios.append(cpu / bare)
        workers.append(one / two)
        cpu, _ = cpu_and_wall_seconds(
            sweep_command(folder, f"tiny{i}", "vfakfd", "--seeds", f"1..{tiny}", "--jobs", "1",
                          "--duration", "0.001"))
        bare = float(subprocess.run([BUILD / "tests" / "bare_points", "vfakfd", "0.001", str(tiny)],
                                    check=True, capture_output=True, text=True).stdout)
        overheads.append(1e3 * (cpu - bare) / tiny)
    print(f"  processor time over the simulations alone {statistics.median(ratios):6.3f}"
          "   (goal: at most 1.05)")
    print(f"  beside the simulation          {statistics.median(overheads):9.3f} ms a run"
          "   (goal: at most 1)")
    print(f"  two workers over one           {statistics.median(workers):9.3f}"
          "   (goal: at least 1.85)")
    for points, lists in ((100, ["lin(0,1,100)"]), (100_000, ["lin(0,1,1000)", "lin(0,1,100)"])):
        vary = [word for key, values in zip(("x.first", "x.second"), lists)
                for word in ("--vary", f"{key}={values}")]
        out = pathlib.Path(folder) / f"memory{points}"
        lab = [BUILD / "tests" / "ishigami_lab", "sweep", "ishigami", "--out", out, "--quiet", *vary]
        wall_s, memory = wall_and_memory(lab)
        again_s, _ = wall_and_memory([*lab[:2], out, "--status"])
        print(f"  {points:6} points of a function      {wall_s:9.2f} s, {memory:.0f} MB; "
              f"--status {again_s:.2f} s")


def wall_and_memory(command):
    """Seconds, and the largest resident memory [MB]."""
    start = time.perf_counter()
    process = subprocess.Popen(command, stdout=subprocess.DEVNULL)
    _, status, usage = os.wait4(process.pid, 0)
    if status != 0:
        sys.exit(f"{command[0]} failed")
    return time.perf_counter() - start, usage.ru_maxrss / 1024


def main():
    with tempfile.TemporaryDirectory() as folder:
        run = pathlib.Path(folder) / "run"
        print("instructions, 10 s with impact (callgrind, about two minutes) ...", flush=True)
        subprocess.run(run_command(run, SHORT), check=True)
        whole = instructions(replay_command(run, "whole"))
        bare = instructions(replay_command(run))
        ours = instructions(run_command(run, SHORT))
        steps = 100_000
        print(f"  whole model, bare   {whole / steps:10.0f} per physics step")
        print(f"  bare mj_step loop   {bare / steps:10.0f} per physics step")
        print(f"  run, logging on     {ours / steps:10.0f} per physics step")
        print(f"  ratio               {ours / bare:10.3f}   (goal: at most 1.05)")
        print(f"  over the whole one  {ours / whole:10.3f}   (goal: at most 0.65)")

        print(f"time, 100 s, {PAIRS} pairs ...", flush=True)
        subprocess.run(run_command(run, []), check=True)
        pairs = [(seconds(run_command(run, [])), seconds(replay_command(run)))
                 for _ in range(PAIRS)]
        ours_s = statistics.median(p[0] for p in pairs)
        bare_s = statistics.median(p[1] for p in pairs)
        ratio = statistics.median(p[0] / p[1] for p in pairs)
        print(f"  bare mj_step loop   {bare_s:10.2f} s")
        print(f"  run, logging on     {ours_s:10.2f} s")
        print(f"  ratio               {ratio:10.3f}   (median of pairs; goal: at most 1.05)")
        print(f"  real-time factor    {100 / ours_s:10.1f}   (one core; goal: at least 5)")

        bench_starting(folder)
        bench_videos(run)
        bench_quadrotor(folder)
        bench_sweeps(folder)
    print("quadratic programs ...", flush=True)
    subprocess.run([BUILD / "tests" / "qp_bench"], check=True)
    print("one update of an estimator ...", flush=True)
    subprocess.run([BUILD / "tests" / "estimators_bench"], check=True)
    print("the Python module ...", flush=True)
    subprocess.run(["/usr/bin/python3", pathlib.Path(__file__).with_name("python_bench.py")], check=True,
                   env={**os.environ, "PYTHONPATH": str(BUILD / "python")})
    return 0


if __name__ == "__main__":
    sys.exit(main())
