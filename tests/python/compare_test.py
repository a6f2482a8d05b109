"""bw.compare beside the ranking of a study."""

import json
import unittest

import numpy as np

import breakwater as bw
from support import table, temporary_folder


class Compare(unittest.TestCase):
    def test_a_sweeps_table_gives_the_ranking_of_its_folder(self):
        with temporary_folder() as folder:
            runs = bw.sweep("motor_estimation", case=["idob", "stf", "kfd"], vary={"encoder.bits": [6, 8, 10]}, seeds=[1, 2],
                            duration=0.05, set={"metrics.from_s": 0.01, "metrics.to_s": 0.05},
                            goal={"rmse_velocity_rad_s": "min"}, out=folder / "study")
            theirs = json.loads((folder / "study" / "ranking.json").read_text())
        ours = bw.compare(runs, "rmse_velocity_rad_s", by="case")
        self.assertEqual(ours.data, theirs)
        self.assertEqual(len(ours.pairs), 3)

    def test_failed_runs_count_in_each_condition(self):
        with temporary_folder() as folder:
            runs = bw.sweep("motor_estimation", case=["idob", "kfd"], vary={"noise.std_rad": [0.1, 0.2, 0.3], "fault.at_s": [0, 1]},
                            duration=0.05, set={"metrics.from_s": 0.01, "metrics.to_s": 0.05, "fault.sensor": "angle"},
                            goal={"rmse_velocity_rad_s": "min"}, out=folder / "study")
            theirs = json.loads((folder / "study" / "ranking.json").read_text())
        self.assertEqual(runs.loc[runs["status"] == "failed", "state_hash"].nunique(), 1)
        ours = bw.compare(runs, "rmse_velocity_rad_s", by="case")
        self.assertEqual(ours.data, theirs)
        self.assertEqual(list(ours.table["failed"]), [3, 3])
        self.assertEqual(list(ours.table["conditions"]), [6, 6])

    def test_ranks_anybodys_runs(self):
        answer = bw.compare(table(), "y", "who", on="seed")
        self.assertEqual(list(answer.table["candidate"]), ["a", "c", "b"])
        self.assertRegex(answer.sentence, "^a has the lowest y: 5.5, .* below the next .*, in 10 of 10 conditions.$")
        self.assertIn(answer.sentence[:40], repr(answer))
        self.assertEqual(bw.compare(table(), "y", "who", on="seed", goal="max").table["candidate"][0], "b")
        late = table()
        late.loc[late["who"] == "a", "t"] += 5
        some = bw.compare(late, "y", "who", on="seed", require={"t": {"max": 1.0}})
        self.assertEqual(list(some.table["candidate"]), ["c", "b", "a"])
        self.assertEqual(list(some.table["met"]), [10, 10, 0])
        # A run without the metric is not compared, and a condition that one candidate lacks does not count.
        gap = table()
        gap.loc[0, "y"] = np.nan
        some = bw.compare(gap, "y", "who", on="seed")
        self.assertEqual(set(some.pairs["conditions"]), {9, 10})
        self.assertEqual(list(some.table["missing"]), [1, 0, 0])
        self.assertEqual(some.notes, ["y is missing: in 1 of 10 complete runs of a"])
        self.assertTrue(repr(some).endswith(some.notes[0]))
        self.assertEqual(set(bw.compare(table()[1:], "y", "who", on="seed").pairs["conditions"]), {9})


if __name__ == "__main__":
    unittest.main()
