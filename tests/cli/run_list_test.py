"""`ls`: the contents of a folder.

Usage: run_list_test.py BIN_FOLDER
"""

import json
import os
import unittest

from called_program import FAILS, Folder


class RunList(Folder):
    def setUp(self):
        super().setUp()
        self.call("motor_estimation", "--quiet", "--case", "stf", "--out", "runs/arm/good")
        self.push("runs/arm/bad", *FAILS, status=3)
        self.call("breakwater", "sweep", "motor_estimation", "--case", "stf", "--seeds", "1..3",
                  "--quiet", "--out", "runs/study")
        # The study is the newest, then the failed run.
        for age, name in enumerate(["study/shards", "arm/bad/log.h5", "arm/good/log.h5"]):
            os.utime(self.folder / "runs" / name, (1e9 - 60 * age, 1e9 - 60 * age))

    def test_lists_the_newest_first_with_main_metrics(self):
        told = json.loads(self.call("breakwater", "ls", "--json")[0])
        self.assertEqual([entry["folder"] for entry in told],
                         ["runs/study", "runs/arm/bad", "runs/arm/good"])
        study, bad, good = told
        self.assertEqual((study["kind"], study["runs"], study["failed"]), ("study", 3, 0))
        self.assertEqual(study["scenario"], "motor_estimation")
        self.assertEqual((bad["status"], bad["metrics"]), ("failed", {}))
        self.assertIn("at 0.3", bad["reason"])
        self.assertEqual((good["status"], good["case"]), ("complete", "stf"))
        self.assertGreater(good["metrics"]["rmse_disturbance_Nm"], 0.0)
        self.assertEqual(good["metrics"],
                         json.loads((self.folder / "runs/arm/good/metrics.json").read_text()))
        # The median of three values is the middle one.
        rows = (self.folder / "runs/study/results.csv").read_text().splitlines()
        column = rows[0].split(",").index("rmse_disturbance_Nm")
        values = sorted(float(row.split(",")[column]) for row in rows[1:])
        self.assertEqual(study["medians"]["rmse_disturbance_Nm"], values[1])

        out, err = self.call("breakwater", "ls", TZ="UTC")
        self.assertEqual(err, "")
        self.assertIn("2001-09-09 01:46  3 runs", out)
        self.assertIn("medians: rmse_disturbance_Nm ", out)
        self.assertIn("    motor_estimation, stf\n", out)
        for line in out.splitlines():
            self.assertLessEqual(len(line), 80)
        self.assertEqual(self.call("breakwater", "ls", "runs/arm/good")[0].count("complete"), 1)

    def test_a_run_with_parts_of_its_own_is_labelled_with_them(self):
        self.call("motor_estimation", "--quiet", "--case", "stf", "--set", "observer.name=kfd", "--out", "runs/arm/other")
        out, _ = self.call("breakwater", "ls", "runs/arm/other")
        self.assertIn("motor_estimation, stf with kfd\n", out)

    def test_says_what_is_damaged_or_not_there(self):
        (self.folder / "runs/arm/good/manifest.json").write_text('{\n  "scenario": "arm",\n  oops\n}\n')
        told = json.loads(self.call("breakwater", "ls", "runs/arm/good", "--json")[0])
        self.assertEqual(told[0]["status"], "damaged")
        self.assertIn("is not a run's manifest (line 3 is no JSON)", told[0]["reason"])
        (self.folder / "runs/arm/bad/log.h5").write_bytes(b"")
        told = json.loads(self.call("breakwater", "ls", "runs/arm/bad", "--json")[0])
        self.assertIn("the run is incomplete: it has no log.h5", told[0]["reason"])
        _, err = self.call("breakwater", "ls", "nowhere", status=2)
        self.assertEqual(err, "nowhere: there is no such folder\n")
        (self.folder / "odd/shards").mkdir(parents=True)
        (self.folder / "odd/study.toml").write_text("broken = [")
        told, = json.loads(self.call("breakwater", "ls", "odd", "--json")[0])
        self.assertEqual(told["status"], "damaged")
        self.assertTrue(told["written"].startswith("20"), told)
        (self.folder / "empty").mkdir()
        self.assertEqual(self.call("breakwater", "ls", "empty")[0], "no run below empty\n")
        self.assertEqual(json.loads(self.call("breakwater", "ls", "empty", "--json")[0]), [])

    def test_one_unreadable_folder_does_not_end_the_list(self):
        # A link to itself cannot be followed, not even by root.
        for folder in ("runs/broken", "runs/arm/broken"):
            (self.folder / folder).mkdir()
            for name in ("shards", "manifest.json"):
                (self.folder / folder / name).symlink_to(name)
        told = json.loads(self.call("breakwater", "ls", "--json")[0])
        self.assertEqual(len(told), 3)


if __name__ == "__main__":
    unittest.main()
