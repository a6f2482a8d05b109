"""Writes stubs into a folder: _core.pyi as pybind11 has it, named_observers.pyi as the bindings' table has it."""

import inspect
import pathlib
import re
import sys

from breakwater import _core, named_observers

TYPES = {"a number": "float", "a whole number": "int", "true or false": "bool", "an array": "npt.ArrayLike"}
TABLE = {name: {key: takes for key, _, takes, _ in keys} for name, _, keys in _core.observers()}


def declaration(parameter: inspect.Parameter, keys: dict[str, str]) -> str:
    takes = keys.get(parameter.name.rstrip("_"))
    type_ = next((word for words, word in TYPES.items() if takes and takes.startswith(words)), "str")
    is_key = parameter.kind is parameter.KEYWORD_ONLY  # which a short name may replace
    default = f" = {parameter.default!r}" if parameter.default is not parameter.empty else " = ..." * is_key
    return f"{parameter.name}: {type_ if takes else parameter.annotation}{default}"


lines = ["import numpy.typing as npt", "", "from .observers import Matrix, Observer", "",
         "def Mdob(inertia: float, **arguments: object) -> Observer: ..."]
for title, value in vars(named_observers).items():
    if not inspect.isclass(value) or value is named_observers.Observer:
        continue
    plant, keys = [], []
    for parameter in inspect.signature(value).parameters.values():
        group = keys if parameter.kind is parameter.KEYWORD_ONLY else plant
        group.append(declaration(parameter, TABLE[value.name]))
    lines += ["", f"class {title}(Observer):", f'    """{value.__doc__}"""', "    name: str",
              f"    def __init__(self, {', '.join(plant)}, *, {', '.join(keys)}, **short: object) -> None: ..."]


def signatures(owner: object, indent: str) -> list[str]:
    """The functions, properties and classes of the module or of a class."""
    found = []
    for name, value in vars(owner).items():
        if inspect.isclass(value):
            found += [f"class {name}:", *signatures(value, indent + "    ")]
        elif isinstance(value, property):
            result = value.fget.__doc__.rsplit("-> ", 1)[1].strip()
            found += [f"{indent}@property", f"{indent}def {name}(self) -> {result}: ..."]
        elif inspect.isroutine(value) and (name == "__init__" or not name.startswith("_")):
            for line in re.findall(rf"^(?:\d+\. )?({name}\(.*\) -> .*)$", value.__doc__, re.MULTILINE):
                found += [f"{indent}@overload"] * value.__doc__.startswith(name + "(*args") + [f"{indent}def {line}: ..."]
    return [re.sub(r"breakwater\._core\.|(?<=ndarray)\[[^\]]*\]\]|(?<=: )handle", "", line) for line in found]


core = ["import os", "from typing import *", "", "import numpy", "", "__version__: str", *signatures(_core, "")]
for name, text in {"_core": core, "named_observers": lines}.items():
    stub = pathlib.Path(sys.argv[1], f"{name}.pyi")
    stub.unlink(missing_ok=True)  # an earlier build has a link to a source here
    stub.write_text("\n".join(text) + "\n", encoding="utf-8")
