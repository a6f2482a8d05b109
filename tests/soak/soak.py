"""Long work in one process: memory, descriptors and time a repetition stay flat.

Samples come from /proc, outside of the process. They are in build/soak/PART.csv. The exit status is 1 if a trend
is significant and larger than its bound. The bounds are for the growth over the whole part. They are 1 MB
of resident memory, half a descriptor, and 5 % of the processor's time a repetition. --short takes a few seconds and
does not judge times. --plant-leak runs a process with a leak instead.
"""

import argparse
import csv
import dataclasses
import math
import os
import pathlib
import shutil
import subprocess
import sys
import tempfile
import threading
import time

TICKS_PER_S = os.sysconf("SC_CLK_TCK")
BOUNDS = {"memory": 1000.0, "descriptors": 0.5, "time": 0.05}  # kB, 1, share
WARM_UP = {False: 0.2, True: 0.6}  # share of a part, by --short: caches and encoders fill


BLOCKS = 16  # means of blocks are nearly independent, unlike single samples
SIGNIFICANT = 4.0  # t value of the slope; with 14 degrees of freedom p = 0.0007


@dataclasses.dataclass
class Trend:
    """The trend of a series behind its warm-up."""

    start: float  # at the end of the warm-up
    growth: float  # extrapolated over the whole series
    t: float  # the slope over its standard error

    def exceeds(self, bound):
        """Whether the growth is significant and larger than the bound."""
        return self.growth > bound and self.t > SIGNIFICANT


def trend(counts, values, warm_up=0.2):
    """The trend of values over the number of repetitions, by least squares over means of blocks.

    warm_up is the share of the series in which caches fill. It is left out.
    """
    import numpy as np  # not before the arguments are read

    counts, values = np.asarray(counts, float), np.asarray(values, float)
    late = counts > counts[0] + warm_up * (counts[-1] - counts[0])
    x, y = counts[late], values[late]
    if len(x) < 2 * BLOCKS:
        raise ValueError(f"a trend needs {2 * BLOCKS} samples behind the warm-up, has {len(x)}")
    x = np.array([part.mean() for part in np.array_split(x, BLOCKS)])
    y = np.array([part.mean() for part in np.array_split(y, BLOCKS)])
    away = x - x.mean()
    slope = (away @ y) / (away @ away)
    start = y.mean() + slope * (x[0] - x.mean())
    residual = y - y.mean() - slope * away
    error = math.sqrt((residual @ residual) / (BLOCKS - 2) / (away @ away))
    # Rounding alone makes no trend of a constant series.
    if abs(slope) * (counts[-1] - counts[0]) < 1e-9 * max(1.0, abs(start)):
        return Trend(start, 0.0, 0.0)
    return Trend(start, slope * (counts[-1] - counts[0]), slope / error if error > 0 else math.copysign(math.inf, slope))


class Watch:
    """Samples a process while it works. It prints its repetitions so far, or makes `count` of them while it writes."""

    def __init__(self, words, count=None, interval_s=None, **options):
        self.samples = []
        self.begin = time.monotonic()
        pipe = None if count else subprocess.PIPE
        self.process = subprocess.Popen(words, text=True, bufsize=1, stdin=pipe, stdout=pipe, **options)
        if count is None:
            for line in self.process.stdout:
                self.sample(int(line))
                self.process.stdin.write("\n")
        else:
            ended = threading.Event()
            threading.Thread(target=lambda: (self.process.wait(), ended.set()), daemon=True).start()
            while not ended.wait(interval_s):
                self.sample(self.written())
        if self.process.wait() != 0:
            sys.exit(f"soak: {words[0]} ended with status {self.process.returncode}")
        if count:  # each repetition writes as many bytes; the end of the process is no repetition
            first, last = self.samples[0][0], self.samples[-1][0]
            counted = [(count * (written - first) // (last - first), *rest) for written, *rest in self.samples]
            self.samples = [sample for sample in counted if sample[0] < 0.98 * count]

    def written(self):
        try:
            return int(pathlib.Path("/proc", str(self.process.pid), "io").read_text().split()[3])
        except OSError:  # it has ended
            return 0

    def sample(self, count):
        """Append count, time [s], memory [kB], descriptors and processor's time [s]."""
        process = pathlib.Path("/proc", str(self.process.pid))
        try:
            stat = (process / "stat").read_text().rpartition(")")[2].split()
            status = (process / "status").read_text()
            memory = int(status.partition("VmRSS:")[2].split()[0])
            descriptors = len(list((process / "fd").iterdir()))
        except (OSError, IndexError):  # it has ended
            return
        used_s = (int(stat[11]) + int(stat[12])) / TICKS_PER_S
        if count > 0:
            self.samples.append((count, time.monotonic() - self.begin, memory, descriptors, used_s))


class Soak:
    def __init__(self, build, is_short):
        self.build, self.is_short = build, is_short
        self.out = build / "soak"
        self.out.mkdir(exist_ok=True)

    def steps(self, folder):
        """A motor with an observer at 10 kHz, sampled at 1 kHz."""
        count = 1_000_000 if self.is_short else 100_000_000
        return Watch([self.build / "bin/motor_estimation", "--quiet", "--case", "stf", "--out", folder / "run", "--set",
                      "record.stream=true", "physics.timestep_s=1e-4", "physics.integrator=euler",
                      f"run.duration_s={count * 1e-4}"], count, 0.01 if self.is_short else 1.0)

    def work(self, what, count, folder, *more):
        return Watch([self.build / "tests/soak_work", what, str(count), folder, *more],
                     env={**os.environ, "LP_NUM_THREADS": "0"})

    def run_for_pictures(self, folder):
        subprocess.run([self.build / "bin/cart_position", "--quiet", "--out", folder / "shown"], check=True)
        # Without it, each replay draws this picture for browsers without WebGL.
        subprocess.run([self.build / "bin/breakwater", "strip", folder / "shown", "--quiet"], check=True)
        return folder / "shown"

    def runs(self, folder):
        return self.work("runs", 300 if self.is_short else 100_000, folder)

    def leak(self, folder):
        return self.work("leak", 200, folder)

    def frames(self, folder):
        return self.work("frames", 400 if self.is_short else 10_000, folder, self.run_for_pictures(folder))

    def replays(self, folder):
        return self.work("replays", 100 if self.is_short else 10_000, folder, self.run_for_pictures(folder))

    def part(self, name):
        """Run a part, write its samples, and return whether it is flat."""
        # Files in memory: the disk of a shared machine is no part of this.
        on_disk = name == "steps" or not os.access("/dev/shm", os.W_OK)
        folder = pathlib.Path(tempfile.mkdtemp(prefix="soak-", dir=self.out if on_disk else "/dev/shm"))
        try:
            samples = getattr(self, name)(folder).samples
        finally:
            shutil.rmtree(folder)
        with open(self.out / f"{name}.csv", "w", newline="") as file:
            table = csv.writer(file)
            table.writerow(["count", "wall_s", "resident_kB", "descriptors", "processor_s"])
            table.writerows(samples)
        warm_up = WARM_UP[self.is_short]
        if len(samples) * (1 - warm_up) < 2 * BLOCKS + 2:
            sys.exit(f"soak: {name}: has {len(samples)} samples, too few for a trend")
        counts, walls, memories, descriptors, used = zip(*samples)
        found = {"memory": trend(counts, memories, warm_up), "descriptors": trend(counts, descriptors, warm_up)}
        bounds = dict(BOUNDS)
        if not self.is_short:
            each = [(n, 1e6 * (b - a) / (n - m)) for a, b, m, n in zip(used, used[1:], counts, counts[1:]) if n > m]
            found["time"] = trend(*zip(*each), warm_up)
            bounds["time"] *= found["time"].start
        grown = [what for what, series in found.items() if series.exceeds(bounds[what])]
        print(
            f"{name:<8} {counts[-1]:>10}  {walls[-1]:8.0f} s  {max(memories) / 1000:7.1f} MB "
            f"{found['memory'].growth:+8.0f} kB (t {found['memory'].t:+.1f})  {max(descriptors):3} fd "
            f"{found['descriptors'].growth:+.1f}", end="")
        if "time" in found:
            time_us = found["time"]
            print(f"  {time_us.start:10.2f} us {100 * time_us.growth / time_us.start:+6.1f} % (t {time_us.t:+.1f})", end="")
        print(f"{'  GROWS: ' + ', '.join(grown) if grown else ''}", flush=True)
        return not grown


def main():
    parser = argparse.ArgumentParser(prog="./dev soak", allow_abbrev=False, description=__doc__,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("build", type=pathlib.Path, help=argparse.SUPPRESS)
    parser.add_argument("--short", action="store_true", help="a few seconds, without judging times")
    parser.add_argument("--only", choices=["steps", "runs", "frames", "replays"], help="this part alone")
    parser.add_argument("--plant-leak", action="store_true", help="a process that leaks instead: must end with 1")
    parser.add_argument("--check", action="store_true", help=argparse.SUPPRESS)  # the arguments alone
    arguments = parser.parse_args()
    if arguments.check:
        return
    soak = Soak(arguments.build.resolve(), arguments.short or arguments.plant_leak)
    names = ["leak"] if arguments.plant_leak else [arguments.only] if arguments.only else [
        "steps", "runs", "frames", "replays"]
    print("part      repetitions      time   largest memory, growth      descriptors  time of each, growth", flush=True)
    try:
        sys.exit(0 if all([soak.part(name) for name in names]) else 1)
    except KeyboardInterrupt:
        print("interrupted", file=sys.stderr)
        sys.exit(130)


if __name__ == "__main__":
    main()
