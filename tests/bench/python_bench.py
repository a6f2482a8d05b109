"""Compare Python with C++: a controller that commands a constant (the cost per sample), and the
filtering of a whole record. Each time is the smallest processor time of several alternating
repetitions. PYTHONPATH names build/python."""

import pathlib
import subprocess
import time

import numpy as np

import breakwater as bw

REFERENCE = pathlib.Path(__file__).resolve().parents[2] / "build" / "tests" / "bare"
TURNS = 7
SAMPLES = 1_000_000


class Constant(bw.Controller):
    def __init__(self, size):
        self.u = np.zeros(size)

    def update(self, t, y):
        return self.u


def theirs(*arguments):
    command = [REFERENCE, *map(str, arguments)]
    return float(subprocess.run(command, check=True, capture_output=True, text=True).stdout)


def ours(work):
    begin = time.thread_time()
    work()
    return time.thread_time() - begin


def compare(work, *arguments):
    pairs = [(ours(work), theirs(*arguments)) for _ in range(TURNS)]
    return min(pair[0] for pair in pairs), min(pair[1] for pair in pairs)


def main():
    print("a constant command from Python, beside C++ ...", flush=True)
    for scenario, size, duration in (("motor_estimation", 1, 20.0), ("arm_push", 3, 2.0)):
        samples = len(bw.run(scenario, duration=duration, controller=Constant(size)).time_s)
        python, cpp = compare(
            lambda: bw.run(scenario, duration=duration, controller=Constant(size)),
            "run", scenario, duration)
        print(f"  {scenario:18} {1e6 * (python - cpp) / samples:6.2f} us a sample   (goal: at most 3)")

    random = np.random.default_rng(1)
    u = random.normal(size=SAMPLES)
    y = np.cumsum(1e-3 * random.normal(size=SAMPLES))
    f = bw.Stf(*bw.damped_inertia(1.0), delta=1e-3, period_s=1e-3)
    f.filter(u, y)
    python, cpp = compare(lambda: f.filter(u, y), "filter", SAMPLES)
    print(f"  STF of {SAMPLES} samples: {python:.3f} s, {python / cpp:.2f} times the loop in C++   "
          "(goal: at most 1.1)")


if __name__ == "__main__":
    main()
