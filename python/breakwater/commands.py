"""The commands of the program `breakwater`, where a room of it is not in this module: pictures, pages and
studies, which need an encoder, OpenGL and many libraries more."""

from __future__ import annotations

import pathlib
import shutil
import subprocess

from . import _core
from .errors import InputError

_USAGE = 2  # its exit status if what was given is wrong


def program() -> str:
    """The program `breakwater` that belongs to this module: of its build, or of the installation."""
    built = pathlib.Path(_core.__file__).resolve().parents[2] / "bin" / "breakwater"
    found = str(built) if built.exists() else shutil.which("breakwater")
    if found is None:
        raise FileNotFoundError("there is no program breakwater: install the package breakwater")
    return found


def call(words: list[str]) -> tuple[int, list[str]]:
    """Runs `breakwater WORDS`. Returns its exit status and the lines that it said on stderr.

    Other threads go on meanwhile. Ctrl-C ends it as it does in a shell, and then leaves here as
    KeyboardInterrupt; a second one ends it at once.
    """
    with subprocess.Popen(
        [program(), *words],
        stdin=subprocess.DEVNULL,
        stdout=subprocess.DEVNULL,
        stderr=subprocess.PIPE,
        text=True,
        errors="replace",
    ) as child:
        try:
            said = child.communicate()[1]
        except BaseException:
            # A shell and a notebook interrupt the whole process group: it may have been told already, and a
            # second SIGINT would kill it.
            child.terminate()
            try:
                child.communicate()
            except BaseException:
                child.kill()
                raise
            raise
    return child.returncode, said.splitlines()


def failure_of(status: int, message: str) -> Exception:
    """What a command's exit status is as an exception."""
    return InputError(message) if status == _USAGE else RuntimeError(message)
