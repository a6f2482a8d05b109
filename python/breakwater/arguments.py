"""Conversion of user arguments to the programs' form."""

from __future__ import annotations

import json
import math
import operator
import os
import pathlib
from collections.abc import Mapping
from typing import Any

import numpy as np

from .errors import InputError


def toml_text(value: Any, where: str) -> str:
    """A value of `set=` as TOML."""
    if isinstance(value, np.ndarray):
        value = value.tolist()
    if isinstance(value, (bool, np.bool_)):
        return "true" if value else "false"
    if isinstance(value, str):
        return json.dumps(value, ensure_ascii=False).replace("\x7f", "\\u007f")
    if isinstance(value, (float, np.floating)):
        if not math.isfinite(value):
            raise InputError(f"{where}: must be finite, is {value}")
        return repr(float(value))
    if isinstance(value, (list, tuple, range)):
        return "[" + ", ".join(toml_text(entry, where) for entry in value) + "]"
    try:
        return str(operator.index(value))
    except TypeError:
        raise InputError(
            f"{where}: must be a number, a bool, a str or a list of them, is {type(value).__name__}"
        ) from None


def set_lines(values: Mapping[str, Any] | None) -> list[str]:
    if values is None:
        return []
    if not isinstance(values, Mapping):
        raise InputError(f"set: must be a dict of keys and values, is {type(values).__name__}")
    lines = []
    for key, value in values.items():
        if not isinstance(key, str):
            raise InputError(f"set: keys must be str, one is {type(key).__name__}")
        if "=" in _without_nul(key, "set"):
            raise InputError(f"set: there is no key {key!r}")
        lines.append(f"{key}={toml_text(value, f'set: {key}')}")
    return lines


def _without_nul(text: str, name: str) -> str:
    if "\0" in text:
        raise InputError(f"{name}: must not hold a NUL character, is {text!r}")
    return text


def text_or_none(value: Any, name: str) -> str | None:
    if value is None:
        return None
    if isinstance(value, str):
        return _without_nul(value, name)
    raise InputError(f"{name}: must be a str, is {type(value).__name__}")


def path_or_none(value: Any, name: str) -> str | None:
    if value is None:
        return None
    try:
        return _without_nul(os.fsdecode(value), name)
    except TypeError:
        raise InputError(f"{name}: must be a path, is {type(value).__name__}") from None


def folder_path(value: Any) -> pathlib.Path:
    path = path_or_none(value, "folder")
    if path is None:
        raise InputError("folder: must be a path, is NoneType")
    return pathlib.Path(path)
