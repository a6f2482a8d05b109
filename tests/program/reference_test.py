"""`breakwater reference`: its pages agree with the program's output.

Usage: reference_test.py BIN_FOLDER
"""

import csv
import json
import pathlib
import re
import subprocess
import sys
import tempfile
import unittest

import h5py

ROOT = pathlib.Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "tests/cli"))
from called_program import BIN, Folder  # noqa: E402


def keys_of(config):
    """The keys in a configuration printed by --print-config: "controller.name" and so on."""
    table = ""
    for line in config.splitlines():
        if line.startswith("["):
            table = line[1:-1] + "."
        elif " = " in line and line[0] != "#" and (table or not line.startswith(("scenario =", "default_case ="))):
            yield table + line.partition(" = ")[0]


def on_page(name):
    """The page of a plant has NAME for the names that a file gives to its tables and axes."""
    return re.sub(r"^(shoulder|elbow)_", "NAME_", re.sub(r"^(axis|push|contact|metric)\.\w+\.", r"\1.NAME.", name))


class Reference(Folder):
    @classmethod
    def setUpClass(cls):
        cls.pages = pathlib.Path(cls.enterClassContext(tempfile.TemporaryDirectory())) / "pages"
        subprocess.run([BIN / "breakwater", "reference", "--out", cls.pages], check=True, capture_output=True)

    def page(self, name):
        return (self.pages / name).read_text()

    def rows(self, page, names, unit=""):
        """Expects a row for each name: a set of its forms."""
        missing = [forms for forms in names if not any(f"\n| `{form}` |{unit}" in page for form in forms)]
        self.assertEqual(missing, [])

    def scenarios(self):
        return [line.split()[0] for line in self.call("breakwater", "list")[0].splitlines()]

    def test_has_every_command_with_its_help(self):
        page = self.page("commands.md")
        names = re.findall(r"^  ([a-z]+)  ", self.call("breakwater", "--help")[0], re.M)
        self.assertGreater(len(names), 15)
        for name in names:
            with self.subTest(name):
                self.assertIn("\n" + self.call("breakwater", name, "--help")[0].rstrip("\n") + "\n", page)
                self.assertIn(f"\n| [`{name}`](#", page)

    def test_has_every_key_case_metric_and_column_of_every_scenario(self):
        for scenario in self.scenarios():
            with self.subTest(scenario):
                page = self.page(f"scenarios/{scenario}.md")
                cases = self.call("breakwater", "run", scenario, "--list-cases")[0].split()
                self.rows(page, [{case} for case in cases])
                keys = set()
                for case in cases:
                    found = list(keys_of(self.call("breakwater", "run", scenario, "--case", case, "--print-config")[0]))
                    self.assertGreater(len(found), 10)
                    keys |= set(found)
                # A key of all axes may be without their names.
                self.rows(page, [{key, on_page(key), "axis.NAME." + key} for key in keys])
                self.call("breakwater", "run", scenario, "--duration", "1", "--quiet", "--out", scenario)
                told = json.loads(self.call("breakwater", "compare", scenario, scenario, "--json", "--no-replay", "--out", "c")[0])
                for metric in told["metrics"]:
                    self.rows(page, [{metric["name"]}], f" {metric['unit'] or 1} | ")
                with h5py.File(self.folder / scenario / "log.h5") as log:
                    for name, data in log["control"].items():
                        if name != "time_s" and not name.startswith("index_"):
                            self.rows(page, [{name, on_page(name)}], f" {data.attrs['unit'].decode()} | ")

    def test_has_every_kind_of_metric(self):
        page = self.page("scenarios/plant.md")
        kinds = re.search(r"^\| `metric\.NAME\.kind` \|.*one of ([a-z_, ]+) \|", page, re.M)[1].split(", ")
        self.assertGreater(len(kinds), 25)
        self.rows(page, [{kind} for kind in kinds if kind != "rmse"])  # another name of rms

    def test_has_every_key_metric_and_column_of_estimate(self):
        self.call("breakwater", "estimate", "--csv", ROOT / "data/estimate/motor.csv", "--set", "plant.inertia=1e-3",
                  "encoder.quantum=1.5e-3", "--out", "est")
        folder = self.folder / "est"
        names = [*keys_of((folder / "config.toml").read_text()), *json.loads((folder / "metrics.json").read_text()),
                 *next(csv.reader((folder / "log.csv").open()))]
        self.assertGreater(len(names), 40)
        self.rows(self.page("estimate.md"), [{name} for name in names])


if __name__ == "__main__":
    unittest.main()
