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

from . import _core
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
    except ValueError:  # Python does not write so many digits
        raise InputError(f"{where}: is too large") from None


def set_lines(values: Mapping[str, Any] | None) -> list[str]:
    lines = []
    for key, value in mapping(values, "set").items():
        if "=" in key:
            raise InputError(f"set: there is no key {key!r}")
        lines.append(checked_text(f"{key}={toml_text(value, f'set: {key}')}", f"set: {key}"))
    return lines


def mapping(values: Mapping[str, Any] | None, name: str) -> Mapping[str, Any]:
    """A dict with texts as keys. None is an empty one."""
    if values is None:
        return {}
    if not isinstance(values, Mapping):
        raise InputError(f"{name}: must be a dict, is of type {type(values).__name__}")
    for key in values:
        if not isinstance(key, str):
            raise InputError(f"{name}: keys must be str, one is {type(key).__name__}")
        checked_text(key, name)
    return values


def checked_text(text: str, name: str) -> str:
    """A text that C++ and other programs can take."""
    if "\0" in text:
        raise InputError(f"{name}: must not hold a NUL character, is {text!r}")
    if any("\ud800" <= letter <= "\udfff" for letter in text):
        raise InputError(f"{name}: must be UTF-8, is {text!r}")
    return text


def did_you_mean(word: Any, candidates: list[str]) -> str:
    return _core.did_you_mean(str(word).encode(errors="replace"), candidates)


def finite(value: Any, name: str) -> float:
    if isinstance(value, (int, float, np.integer, np.floating)) and not isinstance(value, bool):
        try:
            if math.isfinite(value):
                return float(value)
        except OverflowError:
            raise InputError(f"{name}: must be finite, is an integer of {value.bit_length()} bits") from None
        raise InputError(f"{name}: must be finite, is {value}")
    raise InputError(f"{name}: must be a number, is {type(value).__name__}")


def filled(values: Any, dtype: type) -> np.ndarray:
    """An array with NaN where a mask is."""
    return np.ma.array(values, dtype=dtype).filled(np.nan)


def text_or_none(value: Any, name: str) -> str | None:
    if value is None:
        return None
    if isinstance(value, str):
        return checked_text(value, name)
    raise InputError(f"{name}: must be a str, is {type(value).__name__}")


def path_or_none(value: Any, name: str) -> str | None:
    if value is None:
        return None
    try:
        path = checked_text(os.fsdecode(value), name)
    except TypeError:
        raise InputError(f"{name}: must be a path, is {type(value).__name__}") from None
    if not path:
        raise InputError(f"{name}: is empty")
    return path


def folder_path(value: Any) -> pathlib.Path:
    path = path_or_none(value, "folder")
    if path is None:
        raise InputError("folder: must be a path, is NoneType")
    return pathlib.Path(path)
