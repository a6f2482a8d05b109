"""Damaged runs, and runs without `log_hash` in the manifest, so that their logs may have any origin.

Usage: foreign_run_test.py BIN_FOLDER [--study]
"""

import json
import random
import re
import subprocess
import sys
import unittest

MUTATIONS, PLACES_APART = (3000, 1) if "--study" in sys.argv else (12, 4)
if "--study" in sys.argv:
    sys.argv.remove("--study")

import h5py
import numpy as np

from called_program import BIN, Folder

COMMANDS = (["report", "run", "--out", "page"], ["replay", "run", "--out", "replay.html"],
            ["compare", "whole", "run", "--out", "page"],
            ["still", "run", "--at", "0.1", "--out", "still.png"], ["strip", "run", "--out", "strip.png"],
            ["video", "run", "--out", "video.mp4"])
LONGEST_S = 200  # a command takes a second, or longer beside much other work


def read(command, folder):
    """Exit status and lines on stderr."""
    done = subprocess.run([BIN / "breakwater", *command], cwd=folder, capture_output=True,
                          errors="replace", timeout=LONGEST_S)
    return done.returncode, done.stderr.splitlines()


class ForeignRun(Folder):
    def setUp(self):
        super().setUp()
        for name in ("whole", "run"):
            self.call("cart_position", "--quiet", "--duration", "0.2", "--out", name)
        manifest = self.folder / "run" / "manifest.json"
        entries = json.loads(manifest.read_text())
        del entries["log_hash"]
        manifest.write_text(json.dumps(entries))
        self.log = self.folder / "run" / "log.h5"
        self.bytes = self.log.read_bytes()

    def change(self, changes):
        self.log.write_bytes(self.bytes)
        with h5py.File(self.log, "r+") as log:
            for name, row, value in changes:
                log["control"][name][row] = value

    def test_is_read_with_a_warning(self):
        warning = "run/log.h5: may not be what the run wrote: its manifest.json has no log_hash"
        for command in COMMANDS[:3]:
            with self.subTest(command=command):
                status, lines = read(command, self.folder)
                self.assertEqual(status, 0, lines)
                self.assertEqual(lines, [f"{command[0]}: {warning}"])

    def test_times_that_are_not_finite_or_do_not_rise_are_refused_by_all_commands(self):
        for row, value in ((0, np.nan), (100, np.nan), (-1, np.nan), (-1, np.inf), (0, -np.inf),
                           (-1, 1e308), (0, -1e308), (100, 0.0), (100, 0.05), (0, 0.1)):
            self.change([("time_s", row, value)])
            for command in COMMANDS if np.isnan(value) else COMMANDS[:1]:
                with self.subTest(row=row, value=value, command=command):
                    status, lines = read(command, self.folder)
                    self.assertEqual(status, 2, lines)
                    self.assertEqual(len(lines), 1, lines)
                    self.assertIn("run/log.h5: control/time_s: must be finite and rise, is", lines[0])

    def test_times_and_values_beyond_all_reason_end(self):
        for changes in ([("time_s", -1, 1e300)], [("time_s", 0, -1e300)], [("time_s", -1, 1e15)],
                        [("time_s", slice(None), np.linspace(0, 1e-9, 201))],
                        [("time_s", slice(None), 1e9 + 1e-6 * np.arange(201))],
                        [("qpos", 3, np.nan), ("qpos", 5, np.inf)], [("qpos", 3, 1e308)],
                        [("position_measured_m", 3, np.nan), ("position_measured_m", 9, -np.inf)]):
            self.change(changes)
            for command in (COMMANDS[0], COMMANDS[4]):  # charts and a replay, a picture
                with self.subTest(changes=[c[:2] for c in changes], command=command):
                    status, lines = read(command, self.folder)
                    self.assertIn(status, (0, 2), lines)
                    self.assertTrue(status == 0 or len(lines) == 1, lines)

    def test_signals_of_another_length_than_the_times_are_refused(self):
        with h5py.File(self.log, "r+") as log:
            del log["control"]["qpos"]
            log["control"]["qpos"] = np.zeros((20, 1))
        status, lines = read(COMMANDS[0], self.folder)
        self.assertEqual((status, lines), (2, [
            "run/log.h5: control/qpos: has 20 rows, but control/time_s has 201; run it again"]))

    def test_an_attribute_that_claims_too_much_is_read_or_refused(self):
        """HDF5 1.10.8 reads beyond its memory and sometimes crashes."""
        places = [match.start() for match in re.finditer(rb"units\0", self.bytes)]
        self.assertGreater(len(places), 10)
        for place in places[::PLACES_APART]:
            damaged = bytearray(self.bytes)
            damaged[place - 3] = 255  # the size of its type, high byte
            self.log.write_bytes(damaged)
            with self.subTest(place=place):
                status, lines = read(["report", "run", "--no-replay", "--out", "page"], self.folder)
                self.assertIn(status, (0, 2), lines)
                self.assertEqual(len(lines), 1, lines)

    def test_a_mutated_log_is_read_or_refused_in_one_line(self):
        refused = 0
        for seed in range(MUTATIONS):
            source = random.Random(seed)
            damaged = bytearray(self.bytes)
            for _ in range(source.randint(1, 4)):  # most of them in the metadata of HDF5
                place = source.randrange(source.choice((2000, 16000, len(damaged))))
                damaged[place % len(damaged)] = source.choice((0, 255, source.randrange(256)))
            self.log.write_bytes(damaged)
            with self.subTest(seed=seed):
                status, lines = read(["report", "run", "--no-replay", "--out", "page"], self.folder)
                self.assertIn(status, (0, 2), lines)
                self.assertEqual(len(lines), 1, lines)
                refused += status == 2
        self.assertGreater(refused, MUTATIONS // 10, "hardly any damage was done")


class DamagedRun(Folder):
    """Each file of a run with wrong values: the line of each reader says so, and names the file."""

    def setUp(self):
        super().setUp()
        self.call("motor_estimation", "--quiet", "--duration", "0.1", "--out", "run")
        self.manifest, self.metrics = (json.loads((self.folder / f"run/{name}.json").read_text()) for name in ("manifest", "metrics"))

    def refuses(self, name, content, part, is_wrong=True, is_right=False):
        """Both readers refuse the content of a file by a line with this part, if it is wrong. They take what is right."""
        (self.folder / "run" / f"{name}.json").write_text(content if isinstance(content, str) else json.dumps(content))
        for command in (["diff", "run", "run"], ["report", "run", "--no-replay", "--out", "page"]):
            with self.subTest(command=command[0], content=content):
                status, lines = read(command, self.folder)
                self.assertIn(status, {2} if is_wrong else {0} if is_right else {0, 2}, lines)
                self.assertTrue(status == 0 or len(lines) == 1, lines)
                self.assertTrue(not is_wrong or part in lines[0], lines)

    def test_every_wrong_value_of_the_manifest(self):
        self.assertEqual([len(self.manifest["models"]["models/motor.xml"]), len(self.manifest["program"])], [16, 16])
        for key, value in self.manifest.items():
            for wrong in (None, -1.5, True, "", [], {"a": {}}, 1e300):
                is_typed = type(wrong) is not type(value) and not (isinstance(wrong, float) and isinstance(value, (int, float)))
                self.refuses("manifest", {**self.manifest, key: wrong}, "manifest.json: ",
                             is_typed and key in ("scenario", "case", "seed", "status", "program", "models"))
            left = {name: value for name, value in self.manifest.items() if name != key}
            self.refuses("manifest", left, "manifest.json: ", key in ("scenario", "case", "seed", "status", "state_hash"))
        for whole in ("", "{", "[]", "null", '{"scenario": 1, "state_hash": 2}'):
            self.refuses("manifest", whole, "run")
        failed = {**self.manifest, "status": "failed"}  # it has a time and a reason
        self.refuses("manifest", failed, "time_s: is missing or wrong")
        self.refuses("manifest", {**failed, "time_s": "soon", "reason": "x"}, "time_s: is missing or wrong")
        self.refuses("manifest", {**failed, "time_s": 1.0, "reason": "x"}, "", False, True)

    def test_every_wrong_value_of_the_metrics(self):
        self.refuses("metrics", {**self.metrics, "more_m": 1}, "metrics.json: is damaged")
        del self.manifest["metrics_hash"]  # as in runs of before
        (self.folder / "run/manifest.json").write_text(json.dumps(self.manifest))
        for key in self.metrics:
            for wrong in (True, "1", [], {}):
                self.refuses("metrics", {**self.metrics, key: wrong}, f"metrics.json: {key}: must be a number")
            self.refuses("metrics", {**self.metrics, key: None}, "", False, True)
        for whole in ("", "{", "[1]", "3", '{"a": 1e999}'):
            self.refuses("metrics", whole, "metrics.json: is no object of numbers")
        self.refuses("metrics", '{\n"a": 1,\n2}', " (line 3 is no JSON)")
        (self.folder / "run/metrics.json").unlink()
        self.assertIn("it has no metrics.json", read(["diff", "run", "run"], self.folder)[1][0])


if __name__ == "__main__":
    unittest.main()
