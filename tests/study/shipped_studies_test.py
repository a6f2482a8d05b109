"""The shipped studies can run, and the tables of docs/studies are theirs.

Usage: shipped_studies_test.py BIN_FOLDER
"""

import csv
import pathlib
import re
import sys
import unittest

ROOT = pathlib.Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "tests/cli"))
from called_program import Folder  # noqa: E402

TEXTS = {file.stem: file.read_text() for file in (ROOT / "studies").glob("*.toml")}
BRIEF_S = 0.02


def conditions(file):
    """The cells of each run before its status, but for its hash and its duration."""
    head, *rows = csv.reader(file.read_text().splitlines())
    kept = [i for i in range(1, head.index("status")) if head[i] != "run.duration_s"]
    return [[row[i] for i in kept] for row in ([head] + rows)]


class ShippedStudies(Folder):
    def test_each_study_can_run_and_its_table_is_from_it(self):
        """Very short runs: all of a study with a table, otherwise the first, one in the middle and the last."""
        for name, text in TEXTS.items():
            if "\nbudget" in text:
                continue
            with self.subTest(name):
                varied = re.search(r'^"?run\.duration_s"? *= *\[([^]]*)\]', text, re.M)
                if varied:
                    brief = [str(BRIEF_S + 1e-3 * i) for i in range(len(re.findall(r"[\d.]+", varied[1])))]
                    text = text.replace(varied[0], f'"run.duration_s" = [{", ".join(brief)}]')
                (self.folder / f"{name}.toml").write_text(text)
                words = ["breakwater", "sweep", f"{name}.toml", "--quiet", "--out", name, *([] if varied else ["--duration", str(BRIEF_S)])]
                table = ROOT / "docs/studies" / f"{name}.csv"
                if not table.exists():
                    runs = int(re.search(r"(\d+) runs", self.call(*(word for word in words if word != "--quiet"), "--dry-run")[0])[1])
                    self.call(*words, "--print-tasks")
                    self.call("breakwater", "sweep", name, "--points", f"0,{runs // 2},{runs - 1}")
                    words = ["breakwater", "sweep", name, "--collect"]
                self.call(*words)
                rows = list(csv.DictReader((self.folder / name / "results.csv").read_text().splitlines()))
                self.assertEqual({row["status"] for row in rows}, {"complete"})
                self.assertGreaterEqual(len(rows), 3)
                if table.exists():
                    self.assertEqual(conditions(self.folder / name / "results.csv"), conditions(table))

    def test_each_tuning_can_run_and_uses_all_its_keys(self):
        for name, text in TEXTS.items():
            if "\nbudget" not in text:
                continue
            with self.subTest(name):
                _, err = self.call("breakwater", "tune", ROOT / f"studies/{name}.toml", "--out", name, "--dry-run")
                # All controllers of published-impact-tuning.toml meet its conditions; only one is told a place.
                self.assertEqual([line for line in err.splitlines()
                                  if "world.controller.wall_error_m: has an effect only" not in line], [])
                # The results of NAME-tuning.toml are tested in the conditions of NAME.toml.
                self.assertEqual("[validate]" in text, not name.endswith("-tuning"))


if __name__ == "__main__":
    unittest.main()
