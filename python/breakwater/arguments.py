"""Conversion of user arguments to the programs' form."""

from __future__ import annotations

import functools
import inspect
import json
import math
import operator
import os
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from . import _core
from .errors import InputError

_FLOAT = np.dtype(np.float64)


class Rebuilt:
    """A copy or a pickle is made from the same arguments, and has taken no sample."""

    def __new__(cls, *arguments: Any, **keys: Any) -> Any:
        made = super().__new__(cls)
        made._made_of = arguments, keys
        return made

    def __init_subclass__(cls) -> None:
        if "__signature__" not in vars(cls):
            _, *parameters = inspect.signature(cls.__init__).parameters.values()
            cls.__signature__ = inspect.Signature(parameters)

    def __reduce__(self) -> tuple[Any, ...]:
        arguments, keys = self._made_of
        return functools.partial(type(self), **keys), arguments


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


def not_negative(value: Any, name: str) -> float:
    number = finite(value, name)
    if number < 0.0:
        raise InputError(f"{name}: must be 0 or more")
    return number


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


def description(value: Any) -> str:
    """A value for messages: "an array of shape (2, 3)", "None", "of type str"."""
    if isinstance(value, np.ndarray):
        return f"an array of shape {value.shape} and dtype {value.dtype}"
    if isinstance(value, int) and value.bit_length() > 64:
        return f"an integer of {value.bit_length()} bits"
    if value is None or isinstance(value, (int, float)):
        return repr(value)
    kind = type(value).__name__
    return f"a {kind} of length {len(value)}" if isinstance(value, (list, tuple)) else f"of type {kind}"


def _refusal(name: str, wish: str, value: Any) -> InputError:
    return InputError(f"{name}: must be {wish}, is {description(value)}")


def numbers(value: Any, name: str) -> np.ndarray:
    """An array of float64 in C order, with NaN where a mask is."""
    masks = value if isinstance(value, (list, tuple)) else [value]
    has_mask = any(isinstance(entry, np.ma.MaskedArray) for entry in masks)
    try:
        array = np.ma.array(value) if has_mask else np.asarray(value)
        if array.dtype.kind in "fiu":
            return np.asarray(filled(array, np.float64) if has_mask else array, np.float64, order="C")
    except (TypeError, ValueError, OverflowError):
        pass
    raise _refusal(name, "an array of real numbers", value)


def _finite_numbers(value: Any, name: str) -> np.ndarray:
    values = numbers(value, name)
    if not math.isfinite(np.vdot(values, values)):  # quick, and of large numbers infinite
        for i in np.flatnonzero(~np.isfinite(values)):
            reason = "nan" if np.isnan(values.flat[i]) else "infinite"
            raise InputError(f"{name}: must be finite, entry {i} is {reason}")
    return values


def vector(value: Any, name: str, size: int | None = None) -> np.ndarray:
    """A vector of finite numbers. A single number fills all `size` entries."""
    # The usual cases need not a tenth of the time.
    if type(value) is np.ndarray and value.dtype is _FLOAT and value.shape == (size,):
        if math.isfinite(value.dot(value)):
            return value
    elif size == 1 and type(value) is float and math.isfinite(value):
        return np.array((value,))
    values = _finite_numbers(value, name)
    if values.ndim == 0 and size is not None:
        return values.repeat(size)
    if size is not None and values.shape != (size,):
        raise _refusal(name, f"of {size} numbers", value)
    if values.ndim != 1:
        raise _refusal(name, "a vector, of one dimension", value)
    return values


def matrix(value: Any, name: str) -> np.ndarray:
    """A matrix of finite numbers, from a number or from two dimensions."""
    values = numbers(value, name)
    if values.ndim not in (0, 2):
        raise _refusal(name, "a matrix, of two dimensions", value)
    return np.atleast_2d(_finite_numbers(values, name))


def record(value: Any, width: int, name: str) -> np.ndarray:
    """A finite record, rows x width."""
    values = numbers(value, name)
    if values.shape[1:] != (width,) and not (width == 1 and values.ndim == 1):
        raise _refusal(name, f"of shape (samples,{'' if width == 1 else f' {width}'})", value)
    wrong = np.argwhere(~np.isfinite(values))
    if wrong.size > 0:
        raise InputError(f"{name}: must be finite; sample {wrong[0][0]} is not")
    return values.reshape(-1, width)


def one_of(value: Any, name: str, options: Sequence[str]) -> str:
    if value in options:
        return value
    raise InputError(f"{name}: must be one of {', '.join(options)}, is {value!r}")


def whole(value: Any, name: str) -> int:
    """A whole number that fits 32 bits."""
    if isinstance(value, (int, np.integer)) and not isinstance(value, bool) and -(2**31) <= value < 2**31:
        return int(value)
    raise _refusal(name, "a whole number of 32 bits", value)


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


def checked_path(value: Any, name: str) -> str:
    path = path_or_none(value, name)
    if path is None:
        raise InputError(f"{name}: must be a path, is NoneType")
    return path
