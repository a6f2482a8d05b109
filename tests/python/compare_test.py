"""bw.compare beside the ranking of a study."""

import json
import unittest

import numpy as np
import pandas as pd

import breakwater as bw
from breakwater import _core
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

    def test_rounding_breaks_no_tie(self):
        """Differences of milliseconds cancel in pairs. In seconds only a rounding error is left of some sums."""
        before, change = np.array([382, 377, 176, 307, 293, 121, 319, 287]), np.array([4, 1, 5, 4, 2, -2, 4, 1])
        for unit in (1, 1e-3):
            runs = pd.DataFrame({"who": ["a"] * 8 + ["b"] * 8, "on": [*range(8)] * 2,
                                 "settling_s": unit * np.concatenate([before, before + change])})
            pair = bw.compare(runs, "settling_s", by="who", on="on").pairs.iloc[0]
            self.assertEqual(pair["p"], 14 / 256)
            self.assertEqual(pair["difference_lower"], 0.0)


def ranked(peaks, times=None, failed=None, runs=None, goal="min", bound=None, share=1.0):
    """The ranking of candidates a, b, ... by their peaks (conditions, candidates)."""
    peaks = np.array(peaks, float)
    rows, count = peaks.shape
    times = np.zeros_like(peaks) if times is None else np.array(times, float)
    bounds = [] if bound is None else [("time_s", *bound)]
    answer = _core.compare(
        [chr(ord("a") + i) for i in range(count)], {"peak_N": peaks, "time_s": times},
        np.zeros_like(peaks) if failed is None else failed,
        np.arange(peaks.size).reshape(rows, count) if runs is None else runs, np.arange(rows),
        [[i] for i in range(rows)], "peak_N", goal == "max", bounds, share, 0.95)
    return bw.Comparison(json.loads(answer))


class Ranking(unittest.TestCase):
    def test_it_seldom_names_a_wrong_best_as_shown(self):
        """400 conditions of five candidates, whose differences depend on the condition. The best is
        found by brute force: it has the lowest pseudo-median beside each other one."""
        random = np.random.default_rng(21)
        studies, right, wrong = 0, 0, 0
        while studies < 200:
            hardness, common = random.uniform(-1, 1, (400, 1)), 5 * random.normal(size=(400, 1))
            world = (common + random.uniform(0, 2, 5) + random.uniform(-0.5, 0.5, 5) * hardness
                     + np.exp(0.5 * random.normal(size=(400, 5))))
            i, j = np.triu_indices(400)

            def is_better(c, other):
                d = world[:, c] - world[:, other]
                return c == other or np.median((d[i] + d[j]) / 2) < 0

            best = [c for c in range(5) if all(is_better(c, other) for other in range(5))]
            if not best:  # the differences go in a circle
                continue
            studies += 1
            found = ranked(world[:10 + 5 * (studies % 4)])
            if found.data["is_shown"]:
                is_right = found.table["candidate"][0] == "abcde"[best[0]]
                right, wrong = right + is_right, wrong + (not is_right)
        print("right", right, "wrong", wrong)
        self.assertLessEqual(wrong, 10)
        self.assertGreaterEqual(right, 40)  # it does name some

    def test_of_equal_candidates_it_shows_none(self):
        random = np.random.default_rng(22)
        named = sum(ranked(np.exp(random.normal(size=(12, 4)))).data["is_shown"] for _ in range(200))
        self.assertLessEqual(named, 10)

    def test_it_compares_all_pairs_and_turns_with_the_goal(self):
        i = np.arange(10)
        peaks = np.column_stack([8 + 0.1 * i, 5 + 0.01 * i * i, 5 + 0.011 * i * i])
        low, high = ranked(peaks), ranked(peaks, goal="max")
        self.assertEqual(list(low.pairs["conditions"]), [10, 10, 10])
        self.assertEqual(list(low.table["candidate"]), ["b", "c", "a"])
        self.assertEqual(low.table["place"][2], 3)
        self.assertEqual((high.table["candidate"][0], high.table["place"][0]), ("a", 1))
        self.assertEqual(high.sentence,
                         "a has the highest peak_N: 8.45 N, 3.146 N above the next (c), 95 % 3.048 "
                         "to 3.214 N, in 10 of 10 conditions.")

    def test_it_is_among_those_that_meet_the_bounds(self):
        i = np.arange(8)
        peaks = np.column_stack([3 + 0.1 * i, 6 + 0.1 * i, 9 + 0.3 * i, 1 + 0 * i])
        times = np.column_stack([np.where(i < 2, 0.7, 0.5) + 1e-3 * i, 0.5 + 0 * i, 0.6 + 0 * i,
                                 np.nan * i])
        found = ranked(peaks, times, bound=(-np.inf, 0.6))
        self.assertEqual(list(found.table["place"]), [1, 2, 0, 0])
        self.assertEqual(list(found.table["candidate"]), ["b", "c", "a", "d"])
        self.assertEqual(found.table["met"][2], 6)
        np.testing.assert_allclose(found.table.loc[2, ["met_lower", "met_upper"]].astype(float),
                                   [0.349, 0.968], atol=1e-3)
        self.assertEqual(found.data["require"]["bounds"]["time_s"], {"min": None, "max": 0.6})
        failed = np.zeros((8, 4))
        failed[7, 0] = 1  # a failed run meets nothing
        for share, fails, first, count in ((0.75, 0, "a", 3), (0.75, failed, "b", 2)):
            some = ranked(peaks, times, fails * np.ones((8, 4)), bound=(-np.inf, 0.6), share=share)
            self.assertEqual(some.table["candidate"][0], first)
            self.assertEqual((some.table["place"] > 0).sum(), count)
        for bound, sentence in (
            ((-np.inf, 0.6), "b has the lowest peak_N: 6.35 N, 3.7 N below the next (c), 95 % 3.2 to "
             "4.2 N, in 8 of 8 conditions. 2 of 4 candidates meet the bounds: time_s at most 0.6 s "
             "in all conditions."),
            ((0.55, 0.6), "c alone is ranked, with peak_N 10.05 N. 1 of 4 candidates meets the "
             "bounds: time_s from 0.55 s to 0.6 s in all conditions."),
            ((0.65, 0.8), "No candidate has time_s from 0.65 s to 0.8 s in all conditions: a "
             "comes nearest, with 2 of 8."),
            ((0.75, 0.8), ": a, b, c and d come nearest, with 0 of 8."),
        ):
            self.assertIn(sentence, ranked(peaks, times, bound=bound).sentence)

    def test_it_says_what_would_show_a_difference(self):
        i = np.arange(8)
        near = 5.5 + i + np.where(i % 3 == 0, -0.8, 0.1 * i)
        peaks = np.column_stack([5.0 + i, near, 30 + 2 * i])
        self.assertRegex(ranked(peaks).sentence,
                         r"^No difference in peak_N is shown between a \(8.5 N\) and b \(.*: about .* "
                         r"conditions would show 0\..*c is shown to be higher than a\.")
        self.assertIn("4 conditions are too few to show any difference, which needs 7 or more",
                      ranked(peaks[:4]).sentence)
        same = np.repeat(peaks[:, :1], 3, axis=1)
        self.assertRegex(ranked(same).sentence,
                         r"a \(8.5 N\) and any of b \(8.5 N\) and c.*they are equal in 8 conditions")
        failed = np.zeros((5, 3))
        failed[0, 0] = 1
        few = ranked(same[:5], failed=failed)
        self.assertFalse(few.data["is_shown"])
        self.assertIn("a fails in 1 of 5 conditions.", few.sentence)
        self.assertEqual(ranked(np.full((8, 2), np.nan)).sentence, "No run has peak_N.")
        alone = same[:5] + [0, np.nan, np.nan]
        failed[:, 1] = 1
        self.assertEqual(ranked(alone, failed=failed).sentence,
                         "a alone is ranked, with peak_N 7 N. a fails in 1 of 5 conditions. b fails in "
                         "all conditions. No run of c has peak_N.")

    def test_it_says_that_a_lower_median_is_worse_in_equal_conditions(self):
        """a is lower than b and c in each condition that both have. c has the lowest median of its
        own."""
        i, said = np.arange(16), "c has the lowest median, but is worse in equal conditions."
        peaks = np.column_stack([1.0 + i, np.where(i < 12, 1.5 + 1.01 * i, np.nan),
                                 np.where(i < 8, 2.5 + 1.02 * i, np.nan)])
        self.assertIn(said, ranked(peaks).sentence)
        peaks[:, 1] = peaks[:, 0] - 0.1 + 0.3 * np.linspace(0, 1, 16)
        self.assertNotIn("lowest median", ranked(peaks[:, :2]).sentence)

    def test_it_says_that_a_bound_is_the_same_in_all_conditions(self):
        said = "time_s is the same in all conditions, so they say nothing about others"
        i = np.arange(8)
        peaks, times = np.column_stack([3 + 0.1 * i, 6 + 0.1 * i]), np.tile([0.5, 0.7], (8, 1))
        self.assertIn(said, ranked(peaks, times, bound=(-np.inf, 0.6)).sentence)
        for other in (0.70001, np.nan):
            times[7, 1] = other
            self.assertNotIn(said, ranked(peaks, times, bound=(-np.inf, 0.6)).sentence)

    def test_large_values_give_numbers(self):
        """Differences that overflow, or whose squares and cubes would."""
        i = np.arange(9)
        for unit in (1e104, 1e300, 1.7e308):
            peaks = np.column_stack([-unit * (1 - 0.01 * i), unit * (1 - 0.02 * i)])
            pair = ranked(peaks).data["pairs"][0]
            self.assertTrue(np.isfinite(list(pair["difference"].values())).all(), pair)
            self.assertEqual(pair["verdict"], "worse" if pair["candidate"] == "b" else "better")

    def test_equal_runs_of_a_pair_count_once(self):
        """So an ineffective key adds no conditions."""
        i = np.arange(12)
        peaks = np.column_stack([1 + i % 3, 2 + i % 3])
        once = ranked(peaks, runs=np.column_stack([i % 3, 10 + i % 3]))
        self.assertEqual((once.table["conditions"][0], once.data["is_shown"]), (3, False))
        self.assertTrue(ranked(peaks).data["is_shown"])
        many = ranked(np.random.default_rng(24).normal(size=(30, 40))).data
        self.assertEqual((len(many["pairs"]), len(many["table"])), (780, 41))


if __name__ == "__main__":
    unittest.main()
