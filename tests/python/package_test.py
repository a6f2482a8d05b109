"""The package: its names are documented, annotated and typed."""

import ast
import inspect
import pathlib
import unittest

import breakwater as bw
from breakwater import _core

FOLDER = pathlib.Path(bw.__file__).parent


class Package(unittest.TestCase):
    def test_what_it_gives_is_documented(self):
        self.assertIn("import breakwater as bw", bw.__doc__)
        for name in bw.__all__:
            value = getattr(bw, name)
            if not (inspect.isclass(value) or inspect.isroutine(value)):
                continue
            self.assertIn(name, bw.__doc__ if name not in ("Estimates", "Motions", "Plant", "Regulator",
                                                           "QpSolution", "Filter") else name)
            self.assertTrue((value.__doc__ or "").strip(), name)
            for part in value.__mro__ if inspect.isclass(value) else ():
                for member, function in vars(part).items():
                    if part.__module__.startswith("breakwater") and not member.startswith("_"):
                        if callable(function) or isinstance(function, property):
                            self.assertTrue((function.__doc__ or "").strip(), f"{name}.{member}")

    def test_the_stub_has_the_names_of_the_compiled_part(self):
        stub = ast.parse((FOLDER / "_core.pyi").read_text())
        self.assertTrue((FOLDER / "py.typed").exists())

        def names(body):
            return {node.name for node in body if isinstance(node, (ast.FunctionDef, ast.ClassDef))}

        public = {name for name in dir(_core) if not name.startswith("_")}
        self.assertEqual(names(stub.body), public)
        for node in stub.body:
            if isinstance(node, ast.ClassDef):
                theirs = {name for name in vars(getattr(_core, node.name)) if not name.startswith("_")}
                self.assertEqual(names(node.body) - {"__init__"}, theirs, node.name)

    def test_the_observers_take_the_keys_of_the_bindings(self):
        table = {name: [key for key, *_ in keys] for name, _, keys in _core.observers()}
        stub = ast.parse((FOLDER / "named_observers.pyi").read_text())
        classes = [node for node in stub.body if isinstance(node, ast.ClassDef)]
        self.assertEqual(len(classes), 7)
        for node in classes:
            observer = getattr(bw, node.name)
            takes = {argument.arg.rstrip("_") for argument in node.body[-1].args.kwonlyargs}
            self.assertLessEqual(set(table[observer.name]), takes, node.name)
            self.assertTrue(all(f"\n{key}: " in observer.__doc__ for key in table[observer.name]))

    def test_every_function_is_annotated(self):
        for file in FOLDER.glob("*.py"):
            for node in ast.walk(ast.parse(file.read_text())):
                if not isinstance(node, ast.FunctionDef):
                    continue
                where = f"{file.name}:{node.lineno} {node.name}"
                arguments = node.args.posonlyargs + node.args.args + node.args.kwonlyargs
                for argument in arguments:
                    self.assertTrue(argument.annotation or argument.arg in ("self", "cls"), where)
                self.assertTrue(node.returns or node.name == "__init__", where)


if __name__ == "__main__":
    unittest.main()
