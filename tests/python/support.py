"""Common parts of the Python module's tests. PYTHONPATH names build/python."""

import contextlib
import ctypes
import functools
import pathlib
import tempfile

import numpy as np
import pandas

import breakwater as bw

near = functools.partial(np.testing.assert_allclose, rtol=0)
BIN = pathlib.Path(bw.commands.program()).parent


@contextlib.contextmanager
def temporary_folder():
    with tempfile.TemporaryDirectory(prefix="breakwater_python_") as folder:
        yield pathlib.Path(folder)


def hash_of(values):
    """The FNV-1a hash of the bits."""
    state = 14695981039346656037
    for bits in np.asarray(values, float).ravel(order="F").view(np.uint64):
        state = ((state ^ int(bits)) * 1099511628211) % 2**64
    return state


def resident_kB():
    """The resident memory of this process, after free memory has been returned."""
    ctypes.CDLL(None).malloc_trim(0)
    for line in pathlib.Path("/proc/self/status").read_text().splitlines():
        if line.startswith("VmRSS:"):
            return int(line.split()[1])
    raise RuntimeError("no VmRSS")


def table(**columns):
    """Runs of three candidates, for bw.compare()."""
    rows = [{"who": who, "seed": seed, "y": seed + 5.0 * (who == "b") + 0.1 * seed * (who == "c"), "t": 0.1 * seed}
            for who in "abc" for seed in range(1, 11)]
    return pandas.DataFrame(rows).assign(**columns)


class Drive(bw.Controller):
    """A law whose reset() forgets to forget."""

    def __init__(self, gain):
        self.gain = gain
        self.runs = 0

    def reset(self, t, y):
        self.runs += 1

    def update(self, t, y):
        return -self.gain * self.runs * (y[0] - self.setup.reference(t))


class Returns(bw.Controller):
    def __init__(self, value):
        self.value = value

    def update(self, t, y):
        return self.value


class Still(bw.Estimator):
    def __init__(self, value=None):
        self.value = value

    def update(self, u, y):
        return self.value or [y[0], 0.0, 0.0]
