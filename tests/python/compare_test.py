"""bw.compare beside the ranking of a study, and its refusals."""

import json
import unittest

import numpy as np
import pandas

import breakwater as bw
from support import temporary_folder


def table(**columns):
    rows = [{"who": who, "seed": seed, "y": seed + 5.0 * (who == "b") + 0.1 * seed * (who == "c"), "t": 0.1 * seed}
            for who in "abc" for seed in range(1, 11)]
    return pandas.DataFrame(rows).assign(**columns)


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
        self.assertEqual(set(bw.compare(gap, "y", "who", on="seed").pairs["conditions"]), {9, 10})
        self.assertEqual(set(bw.compare(table()[1:], "y", "who", on="seed").pairs["conditions"]), {9})

    def test_nonsense_is_refused_in_one_line(self):
        whole = dict(df=table(), metric="y", by="who", on="seed")
        for pattern, changed in {
            "^df: must be a pandas.DataFrame, is of type list": dict(df=[]),
            r"^metric: there is no column 'yy' \(did you mean y\?\)": dict(metric="yy"),
            "^metric: must be the name of a column": dict(metric=["y"]),
            "^metric: the column 'who' must have numbers": dict(metric="who"),
            "^metric: the column 'y' has infinite numbers": dict(df=table(y=np.inf)),
            "^by: there is no column 'case'": dict(by="case"),
            "^by: must be a column or a list of them": dict(by=3),
            "^by: who names fewer than two candidates": dict(df=table(who="a").drop_duplicates("seed")),
            "^on: say which columns name a test condition": dict(on=None),
            "^on: a has two rows with the same seed": dict(df=pandas.concat([table(), table()])),
            "^on: no condition is common to a, b, c": dict(on=["seed", "who"]),
            "^blocks: 't' is not among on": dict(blocks="t"),
            '^goal: must be "min" or "max", is \'least\'': dict(goal="least"),
            "^require: there is no column 'u'": dict(require={"u": {"max": 1}}),
            '^require: t: must be {"min": A}': dict(require={"t": {"mx": 1}}),
            "^require: t: min 2 is above max 1": dict(require={"t": {"min": 2, "max": 1}}),
            "^share: must be above 0 and at most 1, is 0": dict(share=0),
            "^confidence: must be from 0.5 to 0.9999, is 1": dict(confidence=1),
        }.items():
            with self.subTest(pattern), self.assertRaisesRegex(bw.InputError, pattern) as caught:
                bw.compare(**{**whole, **changed})
            self.assertNotIn("\n", str(caught.exception))


if __name__ == "__main__":
    unittest.main()
