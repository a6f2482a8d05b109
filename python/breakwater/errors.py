"""The error for wrong input."""


class InputError(ValueError):
    """Wrong input, in one line: `FILE:LINE: key: reason (did you mean ...?)`."""
