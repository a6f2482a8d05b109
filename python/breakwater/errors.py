"""An error of what was given."""


class InputError(ValueError):
    """What was given is wrong: one line, `FILE:LINE: key: what is wrong (did you mean ...?)`."""
