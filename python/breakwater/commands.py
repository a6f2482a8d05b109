"""Commands of the program `breakwater` that this module lacks: pictures, pages and studies.

They need an encoder, OpenGL and many further libraries."""

from __future__ import annotations

import pathlib
import shutil
import subprocess

from . import _core
from .arguments import checked_text
from .errors import InputError

_USAGE = 2  # exit status for wrong arguments


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


def failure_of(status: int, message: str) -> Exception:
    """The exception for the exit status of a command."""
    return InputError(message) if status == _USAGE else RuntimeError(message)
