"""Writes named_observers.pyi: the observers' arguments as the bindings' table has them."""

import inspect
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
with open(sys.argv[1], "w", encoding="utf-8") as file:
    file.write("\n".join(lines) + "\n")
