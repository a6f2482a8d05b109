"""The error for wrong input."""

import re

_COMMAND = re.compile(r"^(?:\w+: )*(?:breakwater \w+: )?(?=--)")
_OPTION = re.compile(r"(?<![\w-])--([a-z][a-z-]*)")


def as_argument(line: str) -> str:
    """The line with the arguments of Python in place of the options: "sampling_seed: ..."."""
    line = _COMMAND.sub("", line.removesuffix(" (see --help)"))
    return _OPTION.sub(lambda option: option[1].replace("-", "_"), line)


class InputError(ValueError):
    """Wrong input, in one line: `FILE:LINE: key: reason (did you mean ...?)`."""

    def __init__(self, line: str):
        super().__init__(as_argument(line))
