"""What can go wrong."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from .runs import Run


class InputError(ValueError):
    """What was given is wrong: one line, `FILE:LINE: key: what is wrong (did you mean ...?)`."""


class RunFailed(RuntimeError):
    """A run that did not reach its end: the plant diverged, a sensor failed, a command was not finite.

    time_s: when [s]; reason: one line; run: the run with its log so far, and without metrics.
    """

    time_s: float
    reason: str
    run: Run

    def __init__(self, time_s: float, reason: str, run: Run):
        super().__init__(f"failed at t = {time_s:.6g} s: {reason}")
        self.time_s = time_s
        self.reason = reason
        self.run = run
