"""Common parts of the Python module's tests. PYTHONPATH names build/python."""

import contextlib
import ctypes
import pathlib
import tempfile

import breakwater

BIN = pathlib.Path(breakwater.commands.program()).parent


@contextlib.contextmanager
def temporary_folder():
    with tempfile.TemporaryDirectory(prefix="breakwater_python_") as folder:
        yield pathlib.Path(folder)


def resident_kB():
    """The resident memory of this process, after free memory has been returned."""
    ctypes.CDLL(None).malloc_trim(0)
    for line in pathlib.Path("/proc/self/status").read_text().splitlines():
        if line.startswith("VmRSS:"):
            return int(line.split()[1])
    raise RuntimeError("no VmRSS")
