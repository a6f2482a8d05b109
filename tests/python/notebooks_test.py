"""The notebooks of docs/notebooks run from top to bottom, and have only small pictures."""

import os
import pathlib
import tempfile
import unittest

import nbformat
from nbconvert.preprocessors import ExecutePreprocessor

FOLDER = pathlib.Path(__file__).resolve().parents[2] / "docs" / "notebooks"
LARGEST_PICTURE = 30_000


class Notebooks(unittest.TestCase):
    def test_run_from_top_to_bottom(self):
        files = sorted(FOLDER.glob("*.ipynb"))
        self.assertGreater(len(files), 3)
        with tempfile.TemporaryDirectory() as home:
            os.environ.update(HOME=home, IPYTHONDIR=home, MPLCONFIGDIR=home, MPLBACKEND="module://matplotlib_inline.backend_inline")
            for file in files:
                with self.subTest(file.name):
                    notebook = nbformat.read(file, as_version=4)
                    nbformat.validate(notebook)
                    runner = ExecutePreprocessor(timeout=240, kernel_name="python3")
                    runner.preprocess(notebook, {"metadata": {"path": str(FOLDER)}})

    def test_hold_no_output_but_small_pictures(self):
        for file in FOLDER.glob("*.ipynb"):
            for cell in nbformat.read(file, as_version=4).cells:
                for output in cell.get("outputs", []):
                    self.assertEqual(list(output.get("data", {})), ["image/png"], file.name)
                    self.assertLess(len(output["data"]["image/png"]), LARGEST_PICTURE, file.name)
                self.assertIsNone(cell.get("execution_count"), file.name)


if __name__ == "__main__":
    unittest.main()
