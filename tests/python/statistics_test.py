"""Statistical tests, intervals, verdicts, indices and sampling plans, beside SciPy and the definitions."""

import csv
import math
import os
import unittest

import numpy as np
import scipy.stats
from scipy.stats import qmc

import methods
from methods import Bound, DistributionKind, Goal, SamplingMethod, SignedRank
from support import hash_of, near

NAN = np.nan
SETS = int(os.environ.get("BREAKWATER_PROPERTIES", 400))
PLANS = [SamplingMethod.random, SamplingMethod.latin_hypercube, SamplingMethod.sobol, SamplingMethod.saltelli]


def bounds_of(interval):
    return (interval.lower, interval.upper)


def results_of(values, **fields):
    """Results of candidates a, b, ... without failures."""
    values = {name: np.array(array, float) for name, array in values.items()}
    rows, count = next(iter(values.values())).shape
    return methods.PairedResults(
        **{"candidates": [chr(ord("a") + c) for c in range(count)], "metrics": list(values),
           "failed": np.zeros((rows, count)), "values": list(values.values())} | fields)


def compared(results):
    return methods.compare_candidates(results).metrics[0]


def text_of(results, width=300):
    return methods.comparison_text(methods.compare_candidates(results), width)


class Comparisons(unittest.TestCase):
    def test_tests_and_intervals_match_scipy(self):
        random = np.random.default_rng(1)
        for n in (1, 2, 7, 50, 2000):
            for p in (0.5, 0.9):
                near(methods.binomial_cdf(n, p), scipy.stats.binom(n, p).cdf(np.arange(n + 1)), atol=1e-11)
        for b, c in ((0, 1), (2, 8), (5, 5), (40, 90)):
            near(methods.mcnemar_exact(b, c), scipy.stats.binomtest(b, b + c, 0.5).pvalue, atol=1e-11)
        for n in (1, 2, 5, 12, 40, 200):
            for shift in (0, 0.3, -1):
                d = shift + random.normal(size=n)
                near(SignedRank(d).p(), scipy.stats.wilcoxon(d, mode="exact").pvalue, atol=1e-11)
                if n not in (5, 12):
                    continue
                # Invert the test: its p changes at the Walsh averages alone.
                first, second = np.triu_indices(n)
                averages = np.sort((d[first] + d[second]) / 2)
                p = [scipy.stats.wilcoxon(d - at, mode="exact").pvalue for at in (averages[:-1] + averages[1:]) / 2]
                near(SignedRank(d).pseudo_median(), np.median(averages), atol=1e-11)
                for alpha in (0.3, 0.1):
                    inside = np.flatnonzero(np.array(p) > alpha)
                    near(bounds_of(SignedRank(d).interval(alpha)), averages[[inside[0], inside[-1] + 1]], atol=1e-11)
        for n in (201, 1000):
            d = 0.05 + random.normal(size=n)
            near(SignedRank(d).p(), scipy.stats.wilcoxon(d, correction=True, mode="approx").pvalue, atol=1e-9)
        for met, n in ((0, 1), (0, 8), (8, 8), (5, 8), (1, 40), (970, 1000)):
            near(bounds_of(methods.share_interval(met, n, 0.9)),
                 scipy.stats.binomtest(met, n).proportion_ci(0.9, method="exact"), atol=1e-9)
        self.assertEqual(methods.quantile([1, 2, 3, 5], 0.5), 2.5)

    def test_holm_steps_down(self):
        near(methods.holm([0.01, 0.04, 0.03, 0.005]), [0.03, 0.06, 0.06, 0.02], atol=1e-15)
        self.assertEqual(methods.holm([0.9, 0.8]), [1, 1])
        self.assertEqual(methods.holm([]), [])
        random = np.random.default_rng(5)
        for i in range(300):
            p = random.uniform(size=1 + i % 8)**4
            levels = np.array(methods.holm_levels(p, 0.05))
            np.testing.assert_array_equal(p <= levels, np.array(methods.holm(p)) <= 0.05)
            self.assertTrue((levels <= 0.05).all())  # so intervals are never narrower than of one test

    def test_ties_never_make_p_too_small(self):
        """With zeros and equal magnitudes, of all signs of the differences a share of p at most has so small a p."""
        for sizes in ([1, 1, 0, 2, 3, 1, 4, 2, 0], [0, 0, 0, 2, 2, 2, 2, 5, 1, 1, 4], [1] * 8, [0, 7]):
            signs = 2 * (np.arange(2**len(sizes))[:, None] >> np.arange(len(sizes)) & 1) - 1
            p = np.sort([SignedRank(d).p() for d in np.array(sizes) * signs])
            self.assertTrue((np.searchsorted(p, p, side="right") / len(p) <= p + 1e-12).all())

    def test_the_interval_excludes_zero_exactly_where_the_test_rejects(self):
        random, excluded = np.random.default_rng(6), 0
        for i in range(3000):
            d = 0.6 + random.normal(size=1 + i % 30)
            test = SignedRank(d if i % 2 else np.round(d))
            for alpha in (0.05, 0.05 / 3):
                interval = test.interval(alpha)
                excludes = interval is not None and (interval.lower > 0 or interval.upper < 0)
                self.assertEqual(excludes, test.p() <= alpha)
                if interval:
                    self.assertTrue(interval.lower <= test.pseudo_median() <= interval.upper)
                excluded += excludes
        self.assertGreater(excluded, 500)
        self.assertIsNone(SignedRank([1, 2, 3, 4, 5]).interval(0.05))
        self.assertIsNotNone(SignedRank([1, 2, 3, 4, 5, 6]).interval(0.05))

    def test_bits_are_the_same_everywhere(self):
        x = [(i * 0x9e3779b97f4a7c15 % 2**64 >> 11) * 2.0**-53 for i in range(50)]
        test, share = SignedRank(x), methods.share_interval(7, 17, 0.95)
        values = [*bounds_of(test.interval(0.05)), test.p(), share.upper, methods.binomial_cdf(100, 0.3)[40]]
        self.assertEqual(hash_of(values), 0xe99882664c97176)

    def test_an_interval_has_the_unit_of_its_values(self):
        x = np.random.default_rng(1).uniform(-0.2, 1, 9)
        for unit in (2.0**-400, 2.0**400, 2.0**1000):
            np.testing.assert_array_equal(bounds_of(SignedRank(unit * x).interval(0.05)),
                                          unit * np.array(bounds_of(SignedRank(x).interval(0.05))))

    def test_the_verdict_follows_the_goal(self):
        """The test conditions matter more than the candidates."""
        random = np.random.default_rng(2)
        for shift, goal, verdict in ((-1, "min", "better"), (1, "min", "worse"), (1, "max", "better"), (-1, "max", "worse"),
                                     (-1, "none", "smaller"), (1, "none", "larger"), (0, "min", "no_difference_shown")):
            y = 5 * random.normal(size=(40, 1)) + np.exp(0.5 * random.normal(size=(40, 2))) + [shift, 0]
            one = compared(results_of({"y": y}, baseline=1, goals={"y": getattr(Goal, goal)}))
            self.assertEqual((one.verdict.name, one.pairs), (verdict, 40))
            self.assertIsNotNone(one.difference.interval)
            self.assertEqual(not math.isnan(one.probability_better), goal != "none")

    def test_incomplete_pairs_are_left_out_and_failures_counted_apart(self):
        comparison = methods.compare_candidates(
            results_of({"y": [[1, 2, 3], [1, NAN, 5], [4, 4, NAN]], "never": np.full((3, 3), NAN)},
                       failed=[[0, 0, 0], [0, 1, 0], [0, 0, 1]]))
        self.assertEqual([one.pairs for one in comparison.metrics], [2, 2, 1])  # b-a, c-a, c-b; no row for "never"
        first = comparison.metrics[0]
        self.assertEqual((first.difference.value, first.probability_smaller), (0.5, 0.25))
        self.assertFalse(first.difference.interval and first.difference.interval.lower > 0)
        self.assertEqual(len(comparison.failures), 3)
        last = comparison.failures[2]
        self.assertEqual((last.candidate, last.larger, last.smaller, last.p), (2, 1, 1, 1))

    def test_rows_with_fewer_test_conditions_are_marked(self):
        """b and c have equally many test conditions, but different ones."""
        gappy, whole = [[1, NAN, 3], [1, 2, NAN], [4, 5, 6]], np.ones((3, 3))
        lines = text_of(results_of({"gappy": gappy, "whole": whole}, baseline=0), 200).splitlines()
        self.assertEqual(["gappy"] * 2, [line.split()[0] for line in lines if " 2 * " in line])
        self.assertEqual(2, sum(line.startswith("gappy") for line in lines))
        self.assertIn("* fewer than 3 blocks: in the others a run failed or lacks the metric, or both runs equal those of "
                      "another block", lines)
        self.assertNotIn("*", text_of(results_of({"gappy": whole, "whole": whole}, baseline=0), 200))

    def test_equal_pairs_count_once(self):
        """A key that affects only a, with nine values in each of two test conditions. a has eighteen different
        runs, the others two each, and their pair two."""
        i = np.arange(18)
        results = results_of({"y": np.column_stack([0.1 * i, 5 + i // 9, 7 + i // 9])}, goals={"y": Goal.min},
                             failed=(i < 9)[:, None] * [0.0, 0, 1], runs=np.column_stack([i, i // 9, i // 9]))
        comparison = methods.compare_candidates(results)
        self.assertEqual(comparison.reached, [18, 2, 2])
        b_beside_a, _, c_beside_b = comparison.metrics
        self.assertEqual((b_beside_a.pairs, b_beside_a.verdict.name, b_beside_a.median.value), (18, "worse", 5.5))
        self.assertIsNone(b_beside_a.median.interval)  # two runs are too few
        self.assertIsNotNone(b_beside_a.reference_median.interval)
        self.assertEqual((c_beside_b.pairs, c_beside_b.verdict.name), (2, "too_few_blocks"))
        self.assertEqual((comparison.failures[2].pairs, comparison.failures[2].failures), (2, 1))
        self.assertIn("In 18 blocks b has 2 different runs, c has 2 different runs: ", text_of(results))

    def test_metrics_that_were_never_measured_are_said(self):
        """If a candidate never has a metric with a goal that another one has."""
        y, never = np.column_stack([np.linspace(1, 2, 8), np.full(8, NAN)]), np.full((8, 2), NAN)
        goals = {"settling_s": Goal.min}
        nobody = methods.compare_candidates(results_of({"settling_s": never, "repairs": never}, goals=goals))
        self.assertEqual(nobody.never, [[], []])
        results = results_of({"settling_s": y, "repairs": 0 * y}, goals=goals)  # without a goal: b misses nothing
        comparison = methods.compare_candidates(results)
        self.assertEqual((comparison.metrics, comparison.never), ([], [[], ["settling_s"]]))
        self.assertIn("No run of b has settling_s\n", text_of(results))

    def test_it_says_that_a_small_negative_value_is_a_large_magnitude(self):
        values = np.column_stack([np.linspace(-3, -2, 8), np.linspace(1, 2, 8)])
        both = {"drift_rad": values, "rms_rad": abs(values)}
        self.assertNotIn("Negative medians", text_of(results_of(both)))
        self.assertIn("Negative medians of drift_rad: the goal min prefers the most negative",
                      text_of(results_of(both, goals={name: Goal.min for name in both})))

    def test_fewer_failures_are_better(self):
        failed = np.zeros((12, 2))
        failed[:9, 0] = 1
        one = methods.compare_candidates(methods.PairedResults(candidates=["a", "b"], baseline=0, failed=failed)).failures[0]
        self.assertEqual((one.verdict.name, one.p), ("better", 2.0**-8))

    def test_the_ranking_has_a_table_of_twenty_lines_in_80_columns(self):
        random = np.random.default_rng(24)
        results = results_of({"peak_N": random.normal(123.456, 10, (30, 40)), "time_s": random.normal(0.5, 0.01, (30, 40))})
        results.candidates = [f"case {c}" for c in range(40)]
        text = methods.ranking_text(results, "peak_N", Goal.min, [Bound(metric="time_s", max=0.6)], 80)
        table = text[text.index("\n\n") + 2:]
        self.assertLessEqual(table.count("\n"), 20)
        self.assertIn("… and 23 more", table)
        self.assertIn("100 % [88, 100]", table)
        self.assertLessEqual(max(map(len, text.splitlines())), 82)

    def test_the_number_that_is_needed_has_its_power(self):
        """Two candidates that differ with P(D + D' > 0) of a normal law."""
        random = np.random.default_rng(23)
        for shift in (0.5, 1.0):
            needed = methods.differences_needed(scipy.stats.norm.cdf(math.sqrt(2) * shift), 0.05)
            shown = sum(SignedRank(d).p() <= 0.05 for d in random.normal(shift, 1, (1000, needed)))
            self.assertGreaterEqual(shown, 760)
            self.assertLessEqual(shown, 880 if shift < 1 else 1000)  # for large differences fewer are enough
        self.assertEqual(methods.differences_needed(1, 0.05), 11)
        self.assertIsNone(methods.differences_needed(0.5, 0.05))
        near(SignedRank([1, 2, -0.5, 3]).share_above(), 1, atol=1e-15)
        near(SignedRank([1, -1, -2, 3]).share_above(), 3.5 / 6, atol=1e-15)


class Coverage(unittest.TestCase):
    """The numbers of docs/explanation/statistics.md: BREAKWATER_PROPERTIES=2000."""

    def assert_covered(self, covered, *what):
        """Each data set is covered with 94 % or more: smaller by chance in one of 10 000 cells."""
        print(*what, covered)
        self.assertGreaterEqual(covered, scipy.stats.binom(SETS, 0.94).ppf(1e-4), what)

    def test_of_every_interval_of_a_comparison(self):
        random = np.random.default_rng(12)
        laws = {"normal": (0, 0, random.standard_normal), "cauchy": (0, 0, random.standard_cauchy),
                "exponential": (0.8391734950083304, math.log(2), random.standard_exponential),
                "lognormal": (1.2215829410993904, 1, random.lognormal)}
        for name, (pseudo_median, median, law) in laws.items():
            for n in (6, 15, 30):
                both = [(SignedRank(x).interval(0.05), methods.estimated_median(x).interval)
                        for x in law(size=(SETS, n))]
                for which, truth in enumerate((pseudo_median, median)):
                    self.assert_covered(sum(one[which].lower <= truth <= one[which].upper for one in both),
                                        name, n, ("difference", "median")[which])
        for p in (0.05, 0.5, 0.8, 0.97):
            for n in (6, 15, 30):
                intervals = [methods.share_interval(met, n, 0.95) for met in random.binomial(n, p, SETS)]
                self.assert_covered(sum(one.lower <= p <= one.upper for one in intervals), "share", p, n)

    def test_of_quantiles_is_nominal(self):
        """Samples of a distribution with known quantiles."""
        random = np.random.default_rng(3)
        for p in (0.5, 0.9):
            intervals = [methods.quantile_interval(np.sort(x), p, 0.95) for x in random.uniform(size=(2000, 40))]
            covered = sum(one.lower <= p <= one.upper for one in intervals)
            self.assertGreaterEqual(covered, 1880)  # 95 % minus three standard deviations
            self.assertLessEqual(covered, 1990)  # the intervals are not too wide
        self.assertIsNone(methods.quantile_interval([1, 2, 3, 4, 5], 0.5, 0.95))
        self.assertIsNotNone(methods.quantile_interval([1, 2, 3, 4, 5, 6], 0.5, 0.95))


def blocks_and_seeds(blocks, seeds, shift, random):
    """Samples, each repeated by seeds. The difference has a deviation of 1 between blocks. A hundredth of its
    variance is within blocks."""
    world, difference = 5 * random.normal(size=(blocks, 1)), shift + random.normal(size=(blocks, 1))
    old = world + random.normal(size=(blocks, seeds))
    new = old + difference + random.normal(size=(blocks, seeds)) / math.sqrt(99)
    return results_of({"y": np.column_stack([new.ravel(), old.ravel()])}, candidates=["new", "old"], baseline=1,
                      goals={"y": Goal.min}, samples=np.repeat(np.arange(blocks), seeds))


class Blocks(unittest.TestCase):
    """The numbers of docs/explanation/statistics.md."""

    def shown(self, blocks, shift, are_seeds_worlds=False):
        """The number of 1000 studies with 5 seeds whose verdict is better or worse."""
        random, count = np.random.default_rng(blocks), 0
        for _ in range(1000):
            results = blocks_and_seeds(blocks, 5, shift, random)
            if are_seeds_worlds:
                results.samples = []
            count += compared(results).verdict.name in ("better", "worse")
        print(blocks, "blocks, deviation", shift, "seeds as worlds" * are_seeds_worlds, count)
        return count

    def test_equal_candidates_seldom_differ_for_any_seeds(self):
        for blocks in (5, 8, 12):
            self.assertLessEqual(self.shown(blocks, 0), 50)
            self.assertGreaterEqual(self.shown(blocks, 0, True), 250)  # seeds that count as worlds mislead
        self.assertEqual(self.shown(5, 3), 0)  # five blocks can show nothing

    def test_the_verdict_has_power(self):
        for blocks, deviations, least in ((8, 1, 500), (12, 1, 800), (8, 2, 950), (12, 2, 950)):
            self.assertGreaterEqual(self.shown(blocks, deviations), least)

    def test_more_tests_need_more(self):
        """Six blocks are enough for one metric, but not for two: Holm's correction doubles p = 2·2⁻⁶."""
        results = blocks_and_seeds(6, 1, 8, np.random.default_rng(4))
        self.assertEqual(compared(results).verdict.name, "worse")
        results.metrics, results.values = ["y", "other"], results.values * 2
        second = methods.compare_candidates(results).metrics[1]
        self.assertEqual((second.least_p_holm, second.verdict.name), (0.0625, "too_few_blocks"))
        self.assertIn("with 6 blocks and 2 tests (Holm's correction) p cannot be below 0.0625, and a verdict needs at least 7, "
                      "or fewer metrics (compare.metrics)", text_of(results))

    def test_seeds_repeat_a_block(self):
        """Five walls and five seeds with small noise: 25 pairs with p = 2·2⁻²⁵, but only five blocks."""
        results = blocks_and_seeds(5, 5, 8, np.random.default_rng(3))
        one = compared(results)
        self.assertEqual((one.verdict.name, one.pairs, one.blocks, one.p), ("too_few_blocks", 25, 5, 0.0625))
        self.assertIn("Too few blocks: with 5 blocks p cannot be below 0.0625", text_of(results))
        table = list(csv.DictReader(methods.comparison_csv(methods.compare_candidates(results)).splitlines()))
        self.assertEqual(list(table[0])[-2:], ["reference_failures_alone", "blocks"])
        self.assertEqual(table[0]["verdict"], "too few blocks")
        results.samples = []  # worlds = "seeds"
        self.assertEqual((compared(results).p, compared(results).verdict.name), (2.0**-24, "worse"))

    def test_medians_are_over_seeds_then_over_blocks(self):
        """A large block counts as much as a small one."""
        y = np.column_stack([[1, 2, 100, 5, 7, 30, NAN], np.zeros(7)])
        failed = np.column_stack([[1, 1, 0, 1, 0, 0, 0], [1, 0, 0, 0, 1, 0, 0]])
        comparison = methods.compare_candidates(
            results_of({"y": y}, baseline=1, samples=[0, 0, 0, 1, 1, 2, 2], failed=failed))
        one, failures = comparison.metrics[0], comparison.failures[0]
        # The pseudo-median and the median of 2, 6, 30.
        self.assertEqual((one.difference.value, one.median.value, one.blocks, one.pairs, one.probability_smaller),
                         (11, 6, 3, 6, 0))
        # Alone only in the first block; in the second one each failed once.
        self.assertEqual((failures.failures, failures.reference_failures, failures.larger, failures.smaller),
                         (3, 2, 1, 0))
        self.assertEqual(failures.verdict.name, "too_few_blocks")

    def test_values_of_an_ineffective_key_are_not_blocks(self):
        """Eight values in each of two samples: still two blocks."""
        of_two, row = blocks_and_seeds(2, 3, 1, np.random.default_rng(5)), np.arange(48)
        one = compared(results_of({"y": np.tile(of_two.values[0], (8, 1))}, baseline=1, samples=row // 3,
                                  runs=np.column_stack([row % 6, 10 + row % 6])))
        self.assertEqual((one.blocks, one.pairs, one.difference.value), (2, 6, compared(of_two).difference.value))


def outputs(model, n, seed):
    """The outputs of a Saltelli design of n rows in three dimensions, n × 5."""
    return model(*methods.points(SamplingMethod.saltelli, n, 3, seed).T).reshape(n, 5)


def ishigami(*u):
    """sin x₁ + a sin² x₂ + b x₃⁴ sin x₁, xᵢ uniform in [−π, π] (T. Ishigami, T. Homma, ISUMA 1990)."""
    x = np.pi * (2 * np.array(u) - 1)
    return np.sin(x[0]) + 7 * np.sin(x[1])**2 + 0.1 * x[2]**4 * np.sin(x[0])


GAINS = np.array([1, 2, 0.5])
SHARES = GAINS**2 / sum(GAINS**2)  # Sᵢ = Tᵢ = aᵢ²/Σ a² for y = Σ aᵢ xᵢ of standard normal x


def linear_outputs(random, n):
    """Rows that are independent, as the bootstrap assumes."""
    A, B = random.normal(size=(2, n, 3))
    return np.column_stack([A @ GAINS, (A @ GAINS)[:, None] + GAINS * (B - A), B @ GAINS])


def values_of(indices):
    return np.array([one.value for one in indices])


class Sensitivity(unittest.TestCase):
    def test_ishigamis_indices_match_the_closed_form(self):
        a, b, pi4 = 7, 0.1, np.pi**4
        V1, V2, V13 = 0.5 * (1 + b * pi4 / 5)**2, a * a / 8, b * b * pi4 * pi4 * (1 / 18 - 1 / 50)
        first_order, total = np.array([[V1, V2, 0], [V1 + V13, V2, V13]]) / (V1 + V2 + V13)
        near([first_order[0], total[2]], [0.3139, 0.2437], atol=5e-5)
        for seed in range(1, 6):
            found = methods.sensitivity_indices(outputs(ishigami, 8192, seed), replicates=0)
            self.assertEqual((found.rows, found.dropped_rows), (8192, 0))
            near(values_of(found.first_order), first_order, atol=0.01)
            near(values_of(found.total), total, atol=0.01)
            self.assertEqual([one.interval for one in found.total], [None] * 3)

    def test_for_a_linear_model_first_order_equals_total(self):
        found = methods.sensitivity_indices(outputs(lambda *u: 1e4 + GAINS @ scipy.stats.norm.ppf(u), 4096, 1))
        for indices in (found.first_order, found.total):
            near(values_of(indices), SHARES, atol=0.01)
            for one, truth in zip(indices, SHARES):
                self.assertTrue(one.interval.lower < truth < one.interval.upper)

    def test_a_replicate_is_the_estimate_from_resampled_rows(self):
        """The estimators as written. One replicate is drawn from 20 rows by the 64-bit Mersenne Twister with seed 1."""
        f = 3 + linear_outputs(np.random.default_rng(3), 20)
        one = methods.sensitivity_indices(f, replicates=1)
        drawn = f[[number % 20 for number in methods.mersenne_twister(1, 20)]]
        A, AB, B = drawn[:, :1], drawn[:, 1:4], drawn[:, 4:]
        mu = (A.mean() + B.mean()) / 2
        V = (((A - mu)**2).mean() + ((B - mu)**2).mean()) / 2
        near([index.interval.lower for index in one.first_order], ((B - mu) * (AB - A)).mean(axis=0) / V, atol=1e-13)
        near([index.interval.upper for index in one.total], 0.5 * ((A - AB)**2).mean(axis=0) / V, atol=1e-13)

    def test_intervals_have_their_nominal_coverage(self):
        random, trials = np.random.default_rng(5), 400
        covered = np.zeros((2, 3))
        for _ in range(trials):
            found = methods.sensitivity_indices(linear_outputs(random, 200), replicates=300)
            covered += [[one.interval.lower <= truth <= one.interval.upper for one, truth in zip(indices, SHARES)]
                        for indices in (found.first_order, found.total)]
        # 95 % with a standard error of 1.1 %. Percentiles of few rows have a slightly lower coverage.
        near(covered / trials, 0.95, atol=0.05)

    def test_for_failures_uses_their_indicator(self):
        """Failure where x₁ > 0.7 and x₂ > 0.6: p = 0.12, Vᵢ = p²(1 − pᵢ)/pᵢ, V = p(1 − p)."""
        found = methods.sensitivity_indices(outputs(lambda x, y, z: 1.0 * (x > 0.7) * (y > 0.6), 8192, 2))
        S1, S2 = 0.12 / 0.88 * 0.7 / 0.3, 0.12 / 0.88 * 0.6 / 0.4
        near(values_of(found.first_order)[:2], [S1, S2], atol=0.02)
        near(values_of(found.total)[:2], [1 - S2, 1 - S1], atol=0.02)
        self.assertEqual((found.first_order[2].value, found.total[2].value), (0, 0))  # x₃ has no effect at all

    def test_rows_with_a_missing_output_are_dropped(self):
        f = outputs(ishigami, 256, 1)
        whole = methods.sensitivity_indices(f[6:])
        f[range(5), range(5)] = NAN
        f[5, 2] = np.inf
        some = methods.sensitivity_indices(f)
        self.assertEqual((some.rows, some.dropped_rows), (250, 6))
        np.testing.assert_array_equal(values_of(some.first_order), values_of(whole.first_order))
        self.assertEqual([one.interval.upper for one in some.total], [one.interval.upper for one in whole.total])

    def test_without_variance_is_absent(self):
        ones, noise = np.ones((100, 5)), np.random.default_rng(1).uniform(-1, 1, (100, 5))
        # No run failed, every run failed, …, rounding alone.
        for f in (0 * ones, ones, 0.1 * ones, NAN * ones, np.empty((0, 5)), np.eye(1, 5), 3 * ones + 1e-15 * noise):
            found = methods.sensitivity_indices(f)
            self.assertEqual((found.first_order, found.total), ([], []))
        self.assertTrue(methods.sensitivity_indices(3 * ones + 1e-9 * noise).total)

    def test_with_one_failure_has_no_interval(self):
        """The single failed row is in two of three replicates. No interval is better than a wrong one."""
        for rest in (0, 0.1, 1 / 3, -7.7):
            f = np.full((100, 5), rest)
            f[17, [0, 2, 3]] = 1
            found = methods.sensitivity_indices(f)
            self.assertEqual([one.interval for one in found.total], [None] * 3)
            self.assertTrue(np.isfinite(values_of(found.total)).all())

    def test_does_not_depend_on_the_unit(self):
        f = outputs(ishigami, 512, 4)
        plain = methods.sensitivity_indices(f)
        for unit in (1e-200, 1e-3, 1e250):
            scaled = methods.sensitivity_indices(unit * f)
            near(values_of(scaled.first_order), values_of(plain.first_order), atol=1e-13)
            near([one.interval.lower for one in scaled.total], [one.interval.lower for one in plain.total], atol=1e-13)


# Up to both tails, as far as those of 2⁵² Sobol' points.
ARGUMENTS = [*np.arange(1, 400) / 400, *(u for k in range(9, 54) for u in (0.5**k, 1 - 0.5**k))]


class Distribution(unittest.TestCase):
    def test_quantiles_match_scipy(self):
        for kind, first, second, law in (
            ("uniform", 0.06, 0.12, scipy.stats.uniform(0.06, 0.06)), ("uniform", -3, 1e6, scipy.stats.uniform(-3, 1e6 + 3)),
            ("log_uniform", 500, 5000, scipy.stats.loguniform(500, 5000)),
            ("log_uniform", 1e-9, 1e3, scipy.stats.loguniform(1e-9, 1e3)),
            ("normal", 0, 1, scipy.stats.norm(0, 1)), ("normal", 12, 0.25, scipy.stats.norm(12, 0.25))):
            truth = law.ppf(ARGUMENTS)
            scale = abs(truth if kind == "log_uniform" else first) + abs(truth - first)
            ours = methods.quantiles(getattr(DistributionKind, kind), first, second, ARGUMENTS)
            self.assertTrue((abs(ours - truth) <= 2e-15 * scale).all())

    def test_values_stay_within_the_range(self):
        for kind in (DistributionKind.uniform, DistributionKind.log_uniform):
            for a, b in ((0.1, 0.7), (3, 3.0000000000000004), (1e-300, 1e-3)):
                values = methods.quantiles(kind, a, b, ARGUMENTS)
                self.assertTrue(a <= min(values) and max(values) <= b)

    def test_refuses_invalid_arguments(self):
        rows = [("uniform", 0.12, 0.06, "the range [0.12, 0.06] is upside down"),
                ("log_uniform", 2, 1, "the range [2, 1] is upside down"), ("uniform", 1, 1, "the range [1, 1] is empty"),
                ("log_uniform", 0, 1, "a logarithmic range must be positive, and begins at 0"),
                ("log_uniform", -1, 1, "a logarithmic range must be positive, and begins at -1"),
                ("normal", 1, 0, "the standard deviation must be positive, not 0"),
                ("normal", 1, -2, "the standard deviation must be positive, not -2"),
                ("uniform", -1e308, 1e308, "the range [-1e+308, 1e+308] is too wide"),
                ("log_uniform", 1e-200, 1e200, "the range [1e-200, 1e+200] is too wide")]
        rows += [(kind, *pair, "must be two finite numbers") for kind in ("uniform", "log_uniform", "normal")
                 for bad in (NAN, np.inf, -np.inf) for pair in ((bad, 1), (1, bad))]
        for kind, first, second, reason in rows:
            with self.assertRaises(ValueError) as refused:
                methods.quantiles(getattr(DistributionKind, kind), first, second, [])
            self.assertEqual(str(refused.exception), reason)
        for u in (0, 1, -0.1, NAN):
            self.assertRaises(ValueError, methods.quantiles, DistributionKind.normal, 1, 1, [u])

    def test_bits_are_the_same_everywhere(self):
        """On every processor: a study identifies a point by the hash of its configuration."""
        self.assertEqual(hash_of([x for kind in (DistributionKind.uniform, DistributionKind.log_uniform, DistributionKind.normal)
                                  for x in methods.quantiles(kind, 0.3, 7, ARGUMENTS)]), 0x52fcba5fbe8d7c4c)


class Sampling(unittest.TestCase):
    def assert_hits_each_interval_once(self, u):
        """Each of n equal intervals contains exactly one of the n values of each coordinate."""
        np.testing.assert_array_equal(np.sort(np.floor(u * len(u)), axis=0), np.arange(len(u))[:, None] + 0 * u)

    def test_sobol_points_match_scipy(self):
        for n, d in ((4096, 3), (1024, 40), (64, 3667)):
            np.testing.assert_array_equal(methods.sobol(d, range(n)) * 2.0**-64, qmc.Sobol(d, scramble=False).random(n))

    def test_sobol_is_the_sequence_with_a_digital_shift(self):
        """XOR with another point removes the shift of a Sobol' point."""
        which = [0, 1, 2, 77, 123456789, 2**40 - 1]
        for seed in (1, 2):
            bits = np.ldexp(methods.points(SamplingMethod.sobol, 2**40, 5, seed, which), 52).astype(np.uint64)
            np.testing.assert_array_equal(bits ^ bits[0], methods.sobol(5, which) >> np.uint64(12))

    def test_sobol_hits_each_interval_once(self):
        u = methods.points(SamplingMethod.sobol, 1024, 7, 3)
        for k in range(11):
            self.assert_hits_each_interval_once(u[:2**k])

    def test_latin_hypercube_hits_each_interval_once(self):
        for n in (1, 2, 3, 5, 16, 17, 100, 1000, 65537):
            self.assert_hits_each_interval_once(methods.points(SamplingMethod.latin_hypercube, n, 4, n))

    def test_latin_hypercube_of_many_points_stays_inside(self):
        """Also for the largest numbers, where the edges of an interval differ by few last digits."""
        u = methods.points(SamplingMethod.latin_hypercube, 2**40, 2, 1, range(100000))
        self.assertTrue(0 < u.min() and u.max() < 1)
        self.assertFalse((u[:, 0] * 2**40 % 1 == 0).any())

    def test_discrepancy_of_latin_hypercubes_matches_scipy(self):
        """The mean discrepancy is within four standard errors of SciPy's. That of random points is 6.6 times
        larger, that of Sobol' points 0.27 times."""
        scipys = [qmc.discrepancy(qmc.LatinHypercube(3, seed=seed).random(64)) for seed in range(200)]
        ours, at_random, of_sobol = (
            np.mean([qmc.discrepancy(methods.points(plan, 64, 3, seed)) for seed in range(200)])
            for plan in (SamplingMethod.latin_hypercube, SamplingMethod.random, SamplingMethod.sobol))
        near(ours, np.mean(scipys), atol=4 * math.sqrt(2) * np.std(scipys) / math.sqrt(200))
        self.assertGreater(at_random, 5 * np.mean(scipys))
        self.assertLess(of_sobol, np.mean(scipys) / 3)

    def test_all_permutations_of_latin_hypercubes_are_equally_likely(self):
        """χ² with n! − 1 degrees of freedom, at 0.1 %. Four numbers are permuted directly, five as part of sixteen."""
        sets = 48000
        for n, limit in ((4, 49.7), (5, 173.6)):
            orders = [(n * methods.points(SamplingMethod.latin_hypercube, n, 1, seed)[:, 0]).astype(int)
                      for seed in range(sets)]
            counts = np.unique(orders, axis=0, return_counts=True)[1]
            self.assertEqual(len(counts), math.factorial(n))
            self.assertLess(scipy.stats.chisquare(counts).statistic, limit)

    def test_coordinates_are_uniform_and_uncorrelated(self):
        n = 10000
        for plan in PLANS[:3]:
            u = methods.points(plan, n, 6, 11)
            self.assertTrue(0 < u.min() and u.max() < 1)
            u = (u - 0.5) * math.sqrt(12)
            near(u.T @ u / n, np.eye(6), atol=4.5 / math.sqrt(n))
            near(u.mean(axis=0), 0, atol=4.5 / math.sqrt(n))

    def test_saltelli_design_swaps_one_coordinate(self):
        u = methods.points(SamplingMethod.saltelli, 64, 3, 5).reshape(64, 5, 3)
        A, B = u[:, 0], u[:, 4]
        for i in range(3):
            np.testing.assert_array_equal(u[:, 1 + i], np.where(np.arange(3) == i, B, A))
        both = np.hstack([A, B])
        self.assert_hits_each_interval_once(both)
        np.testing.assert_array_equal(both, methods.points(SamplingMethod.sobol, 64, 6, 5))

    def test_depends_on_the_seed_and_not_on_the_order(self):
        for plan in PLANS:
            late, _, again = methods.points(plan, 50, 3, 7, [40, 3, 40])
            np.testing.assert_array_equal(late, again)
            np.testing.assert_array_equal(late, methods.points(plan, 50, 3, 7, [40])[0])
            self.assertFalse(np.array_equal(late, methods.points(plan, 50, 3, 8, [40])[0]))

    def test_a_larger_study_keeps_the_first_points(self):
        for plan in (SamplingMethod.random, SamplingMethod.sobol, SamplingMethod.saltelli):
            few = methods.points(plan, 32, 3, 7)
            np.testing.assert_array_equal(few, methods.points(plan, 64, 3, 7)[:len(few)])

    def test_refuses_invalid_arguments(self):
        wrong = [(plan, *numbers) for plan in PLANS for numbers in ((0, 3), (3, 0), (2**64 - 1, 3))]
        for plan, n, d in (*wrong, (SamplingMethod.sobol, 8, 3668), (SamplingMethod.saltelli, 8, 1834)):
            self.assertRaises(ValueError, methods.points, plan, n, d, 1)

    def test_bits_are_the_same_everywhere(self):
        """On every processor: a study identifies a point by the hash of its configuration."""
        goldens = (0xc18e11f0ce77e1eb, 0xd06a40b0c8b64ed6, 0xb33ba20fdcdf5943, 0xed0ef86c79403819)
        for plan, golden in zip(PLANS, goldens):
            self.assertEqual(hash_of(methods.points(plan, 100, 4, 42)), golden)


if __name__ == "__main__":
    unittest.main()
