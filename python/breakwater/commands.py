"""Commands of the program `breakwater`: pictures, pages and studies."""

from __future__ import annotations

import copy
import hashlib
import inspect
import os
import pathlib
import pickle
import shutil
import signal
import subprocess
import sys
import traceback
from typing import Any

from . import _core
from .arguments import checked_text
from .errors import InputError

# Exit statuses for wrong arguments, and for a file that cannot be written.
_USAGE, _NOT_WRITTEN = 2, 4


def program() -> str:
    """The program `breakwater` of this module's build or installation."""
    built = pathlib.Path(_core.__file__).resolve().parents[2] / "bin" / "breakwater"
    found = str(built) if built.exists() else shutil.which("breakwater")
    if found is None:
        raise FileNotFoundError("there is no program breakwater: install the package breakwater")
    return found


def call(words: list[str]) -> tuple[int, list[str]]:
    """Run `breakwater WORDS`. Returns its exit status and its lines on stderr.

    Other threads continue meanwhile. Ctrl-C ends the program as in a shell and raises KeyboardInterrupt here.
    A second Ctrl-C ends it at once.
    """
    with subprocess.Popen(
        [program(), *(checked_text(word, words[0]) for word in words)],
        stdin=subprocess.DEVNULL,
        stdout=subprocess.DEVNULL,
        stderr=subprocess.PIPE,
        text=True,
        errors="replace",
    ) as child:
        try:
            said = child.communicate()[1]
        except BaseException:
            # A shell or notebook interrupts the whole process group, so the child may already have a SIGINT. A
            # second one would kill it.
            child.terminate()
            try:
                child.communicate()
            except BaseException:
                child.kill()
                raise
            raise
    return child.returncode, said.splitlines()


def call_copy(words: list[str], parts: list[Any]) -> tuple[int, list[str]]:
    """The same for `sweep` and `tune`, in a copy of this process: it has the parts of your own."""
    words = [checked_text(word, words[0]) for word in words]
    part_hash = _hash_of([*parts[:2], *parts[2].values(), *parts[3].values()])
    sys.stdout.flush()
    sys.stderr.flush()
    reading, writing = os.pipe()
    child = os.fork()
    if child == 0:
        status = 1
        try:
            os.dup2(writing, 2)
            status = _core.program(words, part_hash, tuple(parts))
        except BaseException:
            traceback.print_exc()
        finally:
            os._exit(status)
    os.close(writing)
    try:
        with open(reading, errors="replace") as said:
            lines = said.read().splitlines()
    except BaseException:
        os.kill(child, signal.SIGTERM)
        os.waitpid(child, 0)
        raise
    return os.waitstatus_to_exitcode(os.waitpid(child, 0)[1]), lines


def start_copy(words: list[str], output: int) -> int:
    """Starts a copy of this process that calls the command `words`, without the name of its program. `output` becomes
    its stderr. Returns the process, or less than 0 with the error."""
    try:
        child = os.fork()
    except OSError as error:
        return -error.errno
    if child == 0:
        status = 1
        try:
            os.dup2(output, 2)
            os.closerange(3, os.sysconf("SC_OPEN_MAX"))  # the outputs of other copies
            status = _core.call(words[1:])
            sys.stdout.flush()
        finally:
            os._exit(status)
    return child


def _hash_of(parts: list[Any]) -> str:
    """A hash of the source and the data of objects. It is new each time if they cannot be read."""
    known = hashlib.sha256()
    for part in parts:
        try:
            for kind in type(part).__mro__:
                if kind.__module__ not in ("builtins", "breakwater.parts"):
                    known.update(inspect.getsource(kind).encode())
            data = copy.copy(part)
            getattr(data, "__dict__", {}).pop("setup", None)  # the run gives it
            known.update(pickle.dumps(data))
        except Exception:
            known.update(os.urandom(16))
    return known.hexdigest()


def failure_of(status: int, message: str) -> Exception:
    """The exception for the exit status of a command."""
    return {_USAGE: InputError, _NOT_WRITTEN: OSError}.get(status, RuntimeError)(message)
