"""The output of a run on a terminal and into a pipe: progress, tables within the width.

Usage: terminal_test.py BIN_FOLDER
"""

import json
import re
import unittest

from called_program import Folder

WALL = ["arm_wall_contact", "--duration", "20", "--set", "wall.solid_from_s=4", "force.from_s=5",
        "metrics.from_s=7", "metrics.to_s=8", "record.fine_from_s=5", "record.fine_to_s=5.1"]


class Progress(Folder):
    def test_changes_nothing(self):
        self.assertIn(" %", self.on_terminal(*WALL, "--out", "seen"))
        out, err = self.call(*WALL, "--out", "piped")
        self.assertEqual(err, "")
        self.assertNotIn("\033", out)
        hashes = {json.loads((self.folder / run / "manifest.json").read_text())["state_hash"]
                  for run in ("seen", "piped")}
        self.assertEqual(len(hashes), 1)

    def test_stays_on_one_line_of_a_narrow_terminal(self):
        seen = self.on_terminal(*WALL, "--out", "seen", columns=40)
        lines = [line for line in re.split(r"\r\033\[K", seen.split("simulated")[0]) if "%" in line]
        self.assertTrue(lines)
        for line in lines:
            self.assertLess(len(line), 40, line)

    def test_of_a_tuning_goes_on_while_it_validates(self):
        (self.folder / "t.toml").write_text(
            'scenario = "motor_estimation"\nbudget = 16\npopulation = 8\n'
            '[set]\n"run.duration_s" = 1.0\n"metrics.from_s" = 0.5\n"metrics.to_s" = 1.0\n'
            '[search]\n"controller.kp" = { uniform = [5, 10] }\n"controller.kd" = { uniform = [1, 5] }\n'
            '[objective]\npeak_position_rad = { goal = "min" }\nrms_torque_Nm = { goal = "min" }\n'
            '[validate]\nseeds = { first = 101, count = 100 }\npoints = 4\n')
        seen = self.on_terminal("breakwater", "tune", "t.toml", "--out", "s")
        rows = (self.folder / "s/results.csv").read_text().splitlines()
        validated = sum(",validate," in row for row in rows)
        self.assertGreaterEqual(validated, 100)
        lines = [line for line in re.split(r"\r\033\[K", seen.split("front")[0]) if "%" in line]
        search = [line for line in lines if line.startswith("tune: ") and "of 16 runs" in line]
        validation = [line for line in lines if line.startswith("tune: validation: ")]
        self.assertEqual(lines, search + validation)
        done = [int(re.match(rf"tune: validation: \d+ %, (\d+) of {validated} runs", line)[1])
                for line in validation]
        self.assertTrue(done)
        self.assertEqual(done, sorted(done))

    def test_quiet_shows_none(self):
        self.assertEqual(self.on_terminal(*WALL, "--quiet", "--out", "seen"), "")


class Tables(Folder):
    ALL = ["motor_estimation", "--case", "all", "--out", "all"]

    def test_fit_the_width(self):
        out, _ = self.call(*self.ALL)
        self.assertGreater(max(map(len, out.splitlines())), 60)  # uses the width
        for text, columns in ((out, 80), (self.call(*self.ALL, COLUMNS=64)[0], 64),
                              (self.on_terminal(*self.ALL, columns=70)
                               .rpartition("\033[K")[2], 70)):
            for line in text.splitlines():
                self.assertLessEqual(len(line), columns, line)
        for case in self.call("motor_estimation", "--list-cases")[0].split():
            self.assertIn(case, out)


if __name__ == "__main__":
    unittest.main()
