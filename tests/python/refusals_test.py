"""Refusals of the module: refusals.txt, a test for each of its groups."""

import pathlib
import re
import unittest

import numpy as np
import pandas

import breakwater as bw
from support import Drive, Returns, Still, table

A, B, C, PERIOD, eye = np.array([[0.0, 1.0], [0.0, -0.3]]), np.array([[0.0], [2.0]]), np.array([[1.0, 0.0]]), 0.01, np.eye(2)
u, y, t = np.sin(np.arange(20.0)), np.zeros(20), PERIOD * np.arange(20)
nan = np.where(np.arange(20) == 7, np.nan, y)
one = np.ma.array([0.1, 9e9, 0.3], mask=[False, True, False])  # a masked number is none
stf, chain = bw.Stf(A, B, C, delta=1e-3, period_s=PERIOD), bw.PlanarChain("models/arm.urdf")
sampled = bw.Stf(*bw.zero_order_hold(A, B, C, PERIOD), delta=1e-3)


class Asks(Returns):
    def update(self, t, y):
        return self.setup.reference(*self.value)


class Wrong(bw.Controller):
    def update(self, t, y):
        return 1 / int(t)


class pd(Returns):
    pass


def sweep(study="motor_estimation", **arguments):
    return bw.sweep(study, **{"duration": 0.01, **arguments})


def compare(**changed):
    return bw.compare(**{**dict(df=table(), metric="y", by="who", on="seed"), **changed})


def returns(value):
    return bw.run("arm_push", duration=0.01, controller=Returns(value))


def publishes(value):
    controller = Returns([0, 0, 0])
    controller.signals = lambda: value
    return bw.run("arm_push", duration=0.01, controller=controller)


NAMES = {**{name: getattr(bw, name) for name in bw.__all__}, **globals()}


class Refusals(unittest.TestCase):
    def refuse(self, error, rows):
        for row in rows.splitlines():
            call, line = row.split(" | ")
            with self.subTest(row):
                with self.assertRaisesRegex(error, line) as caught:
                    eval(call, NAMES)
                self.assertNotIn("\n", str(caught.exception))


rows = re.sub("^#.*\n", "", (pathlib.Path(__file__).parent / "refusals.txt").read_text(), flags=re.MULTILINE)
for name, group in re.findall(r"\[(\w+)\]\n((?:.+\n)*)", rows):
    error = TypeError if name == "arguments" else bw.InputError
    setattr(Refusals, f"test_{name}", lambda self, error=error, group=group: self.refuse(error, group))


if __name__ == "__main__":
    unittest.main()
