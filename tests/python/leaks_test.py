"""Repeated runs and filters do not increase the resident memory. leaks_test.py --count N."""

import gc
import sys
import unittest

import numpy as np

import breakwater as bw
from support import resident_kB

COUNT = 300


class Rest(bw.Controller):
    def __init__(self):
        self.state = np.zeros(1)

    def signals(self):
        return {"state": ("1", "of nothing", self.state)}

    def update(self, t, y):
        return 0.0


class Breaks(bw.Controller):
    def update(self, t, y):
        raise ValueError("each time")


def brief_run(k):
    run = bw.run("motor_estimation", case="stf", duration=0.002)
    return run["d_hat_Nm"]


def run_of_a_python_controller(k):
    controller = Rest()
    run = bw.run("motor_estimation", duration=0.01, controller=controller)
    return run["state"], controller


def run_kept_by_its_controller(k):
    controller = Rest()
    controller.run = bw.run("motor_estimation", duration=0.01, controller=controller)


def run_that_fails(k):
    try:
        bw.run("motor_estimation", duration=0.01, controller=Breaks())
    except ValueError:
        return
    raise AssertionError("nothing was raised")


def wrong_input(k):
    try:
        bw.run("motor_estimation", set={"encoder.bit": k})
    except bw.InputError:
        return
    raise AssertionError("nothing was raised")


def filters(k):
    u = np.zeros(50)
    f = bw.Stf([[0, 1], [0, 0]], [[0], [1]], [[1, 0]], delta=1e-3, period_s=1e-3)
    f.update(0.0, 1.0)
    return f.filter(u, u + k)


def design(k):
    bw.dare([[1, 1], [0, 1]], [[0], [1]], np.eye(2), 1)
    return bw.solve_qp(np.eye(2), [1, 2], np.eye(2), [0, 0], [1, 1])


class Leaks(unittest.TestCase):
    def test_memory_is_flat(self):
        for work in (brief_run, run_of_a_python_controller, run_kept_by_its_controller, run_that_fails, wrong_input,
                     filters, design):
            with self.subTest(work.__name__):
                for k in range(COUNT // 3):  # fills caches
                    work(k)
                gc.collect()
                before = resident_kB()
                for k in range(COUNT):
                    work(k)
                gc.collect()
                grown = resident_kB() - before
                print(f"{work.__name__}: {grown} kB grown in {COUNT}", flush=True)
                # A leak of 1 kB per repetition would show. The allocator itself varies by some hundred kB.
                self.assertLess(grown, 300 + COUNT // 4, f"kB grown in {COUNT}")


if __name__ == "__main__":
    if "--count" in sys.argv:
        at = sys.argv.index("--count")
        COUNT = int(sys.argv[at + 1])
        del sys.argv[at : at + 2]
    unittest.main()
