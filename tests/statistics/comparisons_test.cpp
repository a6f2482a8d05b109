// Statistical tests, intervals and verdicts, against SciPy, the definitions, and equal
// candidates. Rankings are in tests/python/compare_test.py.
#include <breakwater/statistics/paired_comparison.h>

#include <fmt/format.h>

#include <bit>

#include <breakwater/math/error_function.h>
#include <breakwater/statistics/distribution.h>
#include <breakwater/statistics/quantile.h>
#include <breakwater/statistics/ranking.h>
#include <breakwater/statistics/signed_rank.h>
#include <breakwater/study/comparison_table.h>
#include <breakwater/study/ranking_text.h>
#include "python.h"

namespace breakwater::comparisons_test {

// Collects problems for SciPy with our results.
class Questions {
 public:
  void ask(const std::string& question, double answer, double tolerance = 1e-11) {
    ask(question, std::vector<double>{answer}, tolerance);
  }
  void ask(const std::string& question, const std::vector<double>& answers,
           double tolerance = 1e-11) {
    input_ << question << '\n';
    for (const double answer : answers) {
      ours_.push_back(answer);
      names_.push_back(question.substr(0, 60));
      tolerances_.push_back(tolerance);
    }
  }
  void expect_answers() {
    const std::vector<double> scipy =
        testing::run_python("study/scipy_comparisons.py", input_.str());
    ASSERT_EQ(scipy.size(), ours_.size());
    for (std::size_t i = 0; i < scipy.size(); ++i) {
      EXPECT_NEAR(ours_[i], scipy[i], tolerances_[i]) << names_[i];
    }
  }

 private:
  std::ostringstream input_;
  std::vector<double> ours_, tolerances_;
  std::vector<std::string> names_;
};

std::string words(const std::vector<double>& values) {
  std::ostringstream text;
  text.precision(17);
  text << ' ' << values.size();
  for (const double value : values) text << ' ' << value;
  return text.str();
}

// A standard normal deviate.
double deviate(testing::Random& random) {
  return normal_quantile(random.uniform(1e-12, 1.0 - 1e-12));
}

std::vector<double> differences(std::size_t n, double shift, testing::Random& random) {
  std::vector<double> all;
  for (std::size_t i = 0; i < n; ++i) all.push_back(shift + deviate(random));
  return all;
}

TEST(Comparisons, TestsAndIntervalsMatchSciPy) {
  testing::Random random;
  Questions questions;
  for (const std::size_t n : {1, 2, 7, 50, 2000}) {
    for (const double p : {0.5, 0.9}) {
      questions.ask("binomial " + std::to_string(n) + " " + std::to_string(p), binomial_cdf(n, p));
    }
  }
  for (const auto& [b, c] :
       {std::pair(0, 1), std::pair(2, 8), std::pair(5, 5), std::pair(40, 90)}) {
    questions.ask("mcnemar " + std::to_string(b) + " " + std::to_string(c), mcnemar_exact(b, c));
  }
  for (const std::size_t n : {1, 2, 5, 12, 40, 200}) {
    for (const double shift : {0.0, 0.3, -1.0}) {
      const std::vector<double> d = differences(n, shift, random);
      questions.ask("wilcoxon" + words(d), SignedRank(d).p());
      if (n < 5 || n > 12) continue;
      const SignedRank test(d);
      for (const double alpha : {0.3, 0.1}) {
        const auto interval = test.interval(alpha);
        ASSERT_TRUE(interval);
        questions.ask("signed_rank " + std::to_string(alpha) + words(d),
                      {test.pseudo_median(), interval->lower, interval->upper});
      }
    }
  }
  for (const std::size_t n : {201, 1000}) {
    const std::vector<double> d = differences(n, 0.05, random);
    questions.ask("approximate" + words(d), SignedRank(d).p(), 1e-9);
  }
  for (const auto& [met, n] : {std::pair(0, 1), {0, 8}, {8, 8}, {5, 8}, {1, 40}, {970, 1000}}) {
    const auto interval = share_interval(met, n, 0.9);
    questions.ask(fmt::format("share 0.9 {} {}", met, n), {interval.lower, interval.upper}, 1e-9);
  }
  questions.expect_answers();
}

TEST(Comparisons, HolmStepsDown) {
  const std::vector<double> p = {0.01, 0.04, 0.03, 0.005};
  const std::vector<double> expected = {0.03, 0.06, 0.06, 0.02};
  for (std::size_t i = 0; i < p.size(); ++i) EXPECT_NEAR(holm(p)[i], expected[i], 1e-15);
  EXPECT_EQ(holm({0.9, 0.8}), (std::vector<double>{1.0, 1.0}));
  EXPECT_TRUE(holm({}).empty());
  testing::Random random(5);
  for (int i = 0; i < 300; ++i) {
    std::vector<double> all;
    for (int test = 0; test < 1 + i % 8; ++test) all.push_back(std::pow(random.uniform(0, 1), 4));
    const std::vector<double> adjusted = holm(all), levels = holm_levels(all, 0.05);
    for (std::size_t test = 0; test < all.size(); ++test) {
      EXPECT_EQ(all[test] <= levels[test], adjusted[test] <= 0.05);
      EXPECT_LE(levels[test], 0.05);  // so intervals are never narrower than of one test
    }
  }
}

// With zeros and equal magnitudes, of all signs of the differences a share of p at most has so
// small a p.
TEST(Comparisons, TiesNeverMakePTooSmall) {
  for (const std::vector<double>& sizes : {std::vector<double>{1, 1, 0, 2, 3, 1, 4, 2, 0},
                                           {0, 0, 0, 2, 2, 2, 2, 5, 1, 1, 4},
                                           {1, 1, 1, 1, 1, 1, 1, 1},
                                           {0, 7}}) {
    std::vector<double> all;
    for (unsigned signs = 0; signs < 1U << sizes.size(); ++signs) {
      std::vector<double> d = sizes;
      for (std::size_t i = 0; i < d.size(); ++i) d[i] *= (signs >> i & 1U) != 0 ? 1.0 : -1.0;
      all.push_back(SignedRank(d).p());
    }
    std::sort(all.begin(), all.end());
    for (std::size_t i = 0; i < all.size(); ++i) {
      const auto as_small = std::upper_bound(all.begin(), all.end(), all[i]) - all.begin();
      EXPECT_LE(static_cast<double>(as_small) / static_cast<double>(all.size()), all[i] + 1e-12);
    }
  }
}

TEST(Comparisons, TheIntervalExcludesZeroExactlyWhereTheTestRejects) {
  testing::Random random(6);
  int excluded = 0;
  for (int i = 0; i < 3000; ++i) {
    std::vector<double> d = differences(1 + static_cast<std::size_t>(i % 30), 0.6, random);
    if (i % 2 == 0)
      std::transform(d.begin(), d.end(), d.begin(), [](double x) { return std::round(x); });
    const SignedRank test(d);
    for (const double alpha : {0.05, 0.05 / 3.0}) {
      const auto interval = test.interval(alpha);
      const bool excludes = interval && (interval->lower > 0.0 || interval->upper < 0.0);
      EXPECT_EQ(excludes, test.p() <= alpha);
      if (!interval) continue;
      EXPECT_LE(interval->lower, test.pseudo_median());
      EXPECT_GE(interval->upper, test.pseudo_median());
      excluded += excludes;
    }
  }
  EXPECT_GT(excluded, 500);
  EXPECT_FALSE(SignedRank({1, 2, 3, 4, 5}).interval(0.05));
  EXPECT_TRUE(SignedRank({1, 2, 3, 4, 5, 6}).interval(0.05));
}

// The number of covered data sets, of which each is covered with 94 % or more: smaller by chance
// in one of 10 000 cells.
int least_covered(int sets) {
  const std::vector<double> cdf = binomial_cdf(static_cast<std::size_t>(sets), 0.94);
  return static_cast<int>(std::upper_bound(cdf.begin(), cdf.end(), 1e-4) - cdf.begin());
}

// The numbers of docs/explanation/statistics.md: BREAKWATER_PROPERTIES=2000.
TEST(Coverage, OfEveryIntervalOfAComparison) {
  struct Law {
    const char* name;
    double pseudo_median, median;
    double (*quantile)(double z);  // from the standard normal deviate z
  };
  const Law laws[] = {{"normal", 0.0, 0.0, [](double z) { return z; }},
                      {"cauchy", 0.0, 0.0,
                       [](double z) { return std::tan(3.14159265358979 * (normal_cdf(z) - 0.5)); }},
                      {"exponential", 0.8391734950083304, std::log(2.0),
                       [](double z) { return -std::log(normal_cdf(-z)); }},
                      {"lognormal", 1.2215829410993904, 1.0, [](double z) { return std::exp(z); }}};
  const int sets = testing::property_count(400);
  testing::Random random(12);
  for (const Law& law : laws) {
    for (const std::size_t n : {6, 15, 30}) {
      int difference = 0, median = 0;
      for (int i = 0; i < sets; ++i) {
        std::vector<double> x;
        for (std::size_t j = 0; j < n; ++j) x.push_back(law.quantile(deviate(random)));
        const auto of_difference = SignedRank(x).interval(0.05);
        const auto of_median = estimated_median(x, 0.95).interval;
        ASSERT_TRUE(of_difference && of_median);
        const auto covers = [](const ConfidenceInterval& interval, double value) {
          return interval.lower <= value && value <= interval.upper;
        };
        difference += covers(*of_difference, law.pseudo_median);
        median += covers(*of_median, law.median);
      }
      EXPECT_GE(difference, least_covered(sets)) << law.name << ' ' << n;
      EXPECT_GE(median, least_covered(sets)) << law.name << ' ' << n;
      RecordProperty(fmt::format("{}_{}_difference", law.name, n), difference);
      RecordProperty(fmt::format("{}_{}_median", law.name, n), median);
    }
  }
  for (const double p : {0.05, 0.5, 0.8, 0.97}) {
    for (const std::size_t n : {6, 15, 30}) {
      int covered = 0;
      for (int i = 0; i < sets; ++i) {
        std::size_t met = 0;
        for (std::size_t j = 0; j < n; ++j) met += random.uniform(0.0, 1.0) < p;
        const auto interval = share_interval(met, n, 0.95);
        covered += interval.lower <= p && p <= interval.upper;
      }
      EXPECT_GE(covered, least_covered(sets)) << p << ' ' << n;
      RecordProperty(fmt::format("share_{:.0f}_{}", 100.0 * p, n), covered);
    }
  }
}

// Samples of a distribution with known quantiles.
TEST(Comparisons, IntervalsHaveTheirNominalCoverage) {
  testing::Random random(3);
  for (const double p : {0.5, 0.9}) {
    int covered = 0;
    for (int i = 0; i < 2000; ++i) {
      std::vector<double> x;
      for (int j = 0; j < 40; ++j) x.push_back(random.uniform(0.0, 1.0));
      std::sort(x.begin(), x.end());
      const auto interval = quantile_interval(x, p, 0.95);
      ASSERT_TRUE(interval);
      covered += interval->lower <= p && p <= interval->upper;
    }
    EXPECT_GE(covered, 1880) << p;  // 95 % minus three standard deviations
    EXPECT_LE(covered, 1990) << p;  // the intervals are not too wide
  }
  EXPECT_FALSE(quantile_interval({1, 2, 3, 4, 5}, 0.5, 0.95));
  EXPECT_TRUE(quantile_interval({1, 2, 3, 4, 5, 6}, 0.5, 0.95));
}

TEST(Comparisons, BitsAreTheSameEverywhere) {
  testing::Random random;
  std::vector<double> x;
  for (int i = 0; i < 50; ++i) x.push_back(random.uniform(0.0, 1.0));
  const SignedRank test(x);
  const auto interval = test.interval(0.05);
  std::uint64_t hash = 14695981039346656037ULL;
  for (const double value : {interval->lower, interval->upper, test.p(),
                             share_interval(7, 17, 0.95).upper, binomial_cdf(100, 0.3)[40]}) {
    hash = (hash ^ std::bit_cast<std::uint64_t>(value)) * 1099511628211ULL;
  }
  EXPECT_EQ(hash, 0x6d903fd2f160d32bULL) << std::hex << hash;
}

TEST(Comparisons, AnIntervalHasTheUnitOfItsValues) {
  testing::Random random;
  std::vector<double> x;
  for (int i = 0; i < 9; ++i) x.push_back(random.uniform(-0.2, 1.0));
  const auto interval_in = [&](double unit) {
    std::vector<double> values = x;
    for (double& value : values) value *= unit;
    return SignedRank(values).interval(0.05);
  };
  for (const double unit : {0x1p-400, 0x1p400, 0x1p1000}) {
    EXPECT_EQ(interval_in(unit)->lower, unit * interval_in(1.0)->lower) << unit;
    EXPECT_EQ(interval_in(unit)->upper, unit * interval_in(1.0)->upper) << unit;
  }
}

// Results of candidates "a", "b", … without failures.
PairedResults results_of(const std::vector<std::string>& metrics,
                         const std::vector<Eigen::MatrixXd>& values) {
  PairedResults results;
  for (Eigen::Index c = 0; c < values.at(0).cols(); ++c) {
    results.candidates.emplace_back(1, static_cast<char>('a' + c % 26));
  }
  results.metrics = metrics;
  results.values = values;
  results.failed = Eigen::MatrixXd::Zero(values[0].rows(), values[0].cols());
  return results;
}

// One metric "y" of two candidates in n test conditions, which matter more than the candidates.
PairedResults two(std::size_t n, double shift, Goal goal, testing::Random& random) {
  Eigen::MatrixXd y(n, 2);
  for (Eigen::Index i = 0; i < y.rows(); ++i) {
    const double world = 5.0 * deviate(random);
    for (Eigen::Index k = 0; k < 2; ++k) {
      y(i, k) = world + std::exp(0.5 * deviate(random)) + (k == 0 ? shift : 0.0);
    }
  }
  PairedResults results = results_of({"y"}, {y});
  results.candidates = {"new", "old"};
  results.baseline = 1;
  results.goals = {{"y", goal}};
  return results;
}

TEST(Comparisons, TheVerdictFollowsTheGoal) {
  testing::Random random(2);
  const auto verdict = [&](double shift, Goal goal) {
    const auto comparison = compare_candidates(two(40, shift, goal, random));
    const MetricComparison& one = comparison.metrics.front();
    EXPECT_EQ(one.pairs, 40U);
    EXPECT_TRUE(one.difference.interval);
    EXPECT_EQ(one.probability_better.has_value(), goal != Goal::none);
    return one.verdict;
  };
  EXPECT_EQ(verdict(-1.0, Goal::min), ComparisonVerdict::better);
  EXPECT_EQ(verdict(1.0, Goal::min), ComparisonVerdict::worse);
  EXPECT_EQ(verdict(1.0, Goal::max), ComparisonVerdict::better);
  EXPECT_EQ(verdict(-1.0, Goal::max), ComparisonVerdict::worse);
  EXPECT_EQ(verdict(-1.0, Goal::none), ComparisonVerdict::smaller);
  EXPECT_EQ(verdict(1.0, Goal::none), ComparisonVerdict::larger);
  EXPECT_EQ(verdict(0.0, Goal::min), ComparisonVerdict::no_difference_shown);
}

TEST(Comparisons, IncompletePairsAreLeftOutAndFailuresCountedApart) {
  PairedResults results =
      results_of({"y", "never"}, {Eigen::MatrixXd(3, 3), Eigen::MatrixXd::Constant(3, 3, kNaN)});
  results.values[0] << 1, 2, 3,  //
      1, kNaN, 5,                //
      4, 4, kNaN;
  results.failed(1, 1) = results.failed(2, 2) = 1.0;
  const CandidateComparison comparison = compare_candidates(results);
  ASSERT_EQ(comparison.metrics.size(), 3U);  // b-a, c-a, c-b; no row for "never"
  EXPECT_EQ(comparison.metrics[0].pairs, 2U);
  EXPECT_EQ(comparison.metrics[0].difference.value, 0.5);
  EXPECT_EQ(comparison.metrics[0].probability_smaller, 0.25);
  EXPECT_FALSE(comparison.metrics[0].difference.interval &&
               comparison.metrics[0].difference.interval->lower > 0.0);
  EXPECT_EQ(comparison.metrics[2].pairs, 1U);
  ASSERT_EQ(comparison.failures.size(), 3U);
  EXPECT_EQ(comparison.failures[2].candidate, 2U);
  EXPECT_EQ(comparison.failures[2].alone, 1U);
  EXPECT_EQ(comparison.failures[2].reference_alone, 1U);
  EXPECT_EQ(comparison.failures[2].p, 1.0);
}

TEST(Comparisons, RowsWithFewerTestConditionsAreMarked) {
  PairedResults results =
      results_of({"gappy", "whole"}, {Eigen::MatrixXd(3, 3), Eigen::MatrixXd::Ones(3, 3)});
  results.baseline = 0;
  results.values[0] << 1, kNaN, 3,  //
      1, 2, kNaN,                   //
      4, 5, 6;
  std::size_t marked = 0;
  bool is_said = false;
  for (const std::string& line :
       testing::lines_of(comparison_text(compare_candidates(results), 200))) {
    const bool has_mark = line.find(" 2 * ") != std::string::npos;
    EXPECT_EQ(has_mark, line.starts_with("gappy")) << line;
    marked += has_mark ? 1 : 0;
    is_said = is_said || line ==
                             "* fewer than 3 blocks: in the others a run failed or lacks the "
                             "metric, or both runs equal those of another block";
  }
  EXPECT_EQ(marked, 2U);  // b and c have equally many test conditions, but different ones
  EXPECT_TRUE(is_said);
  results.values[0] = results.values[1];
  EXPECT_TRUE(lacks(comparison_text(compare_candidates(results), 200), "*"));
}

// A key that affects only "a", with nine values in each of two test conditions. "a" has eighteen
// different runs, the others two each, and their pair two.
TEST(Comparisons, EqualPairsCountOnce) {
  PairedResults results = results_of({"y"}, {Eigen::MatrixXd(18, 3)});
  results.goals = {{"y", Goal::min}};
  results.failed.col(2).head(9).setOnes();
  results.runs = Eigen::MatrixXi(18, 3);
  for (int i = 0; i < 18; ++i) {
    const int world = i / 9;
    results.values[0].row(i) << 0.1 * i, 5.0 + world, 7.0 + world;
    results.runs.row(i) << i, world, world;
  }
  const CandidateComparison comparison = compare_candidates(results);
  EXPECT_EQ(comparison.reached, (std::vector<std::size_t>{18, 2, 2}));
  ASSERT_EQ(comparison.metrics.size(), 3U);
  const MetricComparison& b_beside_a = comparison.metrics[0];
  EXPECT_EQ(b_beside_a.pairs, 18U);
  EXPECT_EQ(b_beside_a.verdict, ComparisonVerdict::worse);
  EXPECT_EQ(b_beside_a.median.value, 5.5);
  EXPECT_FALSE(b_beside_a.median.interval);  // two runs are too few
  EXPECT_TRUE(b_beside_a.reference_median.interval);
  const MetricComparison& c_beside_b = comparison.metrics[2];
  EXPECT_EQ(c_beside_b.pairs, 2U);
  EXPECT_EQ(c_beside_b.verdict, ComparisonVerdict::too_few_blocks);
  EXPECT_EQ(comparison.failures[2].pairs, 2U);
  EXPECT_EQ(comparison.failures[2].failures, 1U);
  EXPECT_TRUE(has(comparison_text(comparison, 200),
                  "In 18 blocks b has 2 different runs, c has 2 different runs: "));
}

// Samples, each repeated by seeds. The difference has a deviation of 1 between blocks. A hundredth
// of its variance is within blocks.
PairedResults blocks_and_seeds(int blocks, int seeds, double shift, testing::Random& random) {
  PairedResults results = two(static_cast<std::size_t>(blocks * seeds), 0.0, Goal::min, random);
  results.samples = Eigen::VectorXi(blocks * seeds);
  for (int block = 0; block < blocks; ++block) {
    const double world = 5.0 * deviate(random), difference = shift + deviate(random);
    for (int seed = 0; seed < seeds; ++seed) {
      const int row = block * seeds + seed;
      results.samples(row) = block;
      results.values[0](row, 1) = world + deviate(random);
      results.values[0](row, 0) =
          results.values[0](row, 1) + difference + deviate(random) / std::sqrt(99.0);
    }
  }
  return results;
}

MetricComparison compared(const PairedResults& results) {
  return compare_candidates(results).metrics.front();
}

// The number of 1000 studies with 5 seeds whose verdict is better or worse.
int shown(int blocks, double shift, bool are_seeds_worlds) {
  testing::Random random(static_cast<unsigned>(blocks));
  int count = 0;
  for (int i = 0; i < 1000; ++i) {
    PairedResults results = blocks_and_seeds(blocks, 5, shift, random);
    if (are_seeds_worlds) results.samples = {};
    const ComparisonVerdict verdict = compared(results).verdict;
    count += verdict == ComparisonVerdict::better || verdict == ComparisonVerdict::worse;
  }
  return count;
}

// The numbers of docs/explanation/statistics.md.
TEST(Blocks, EqualCandidatesSeldomDifferForAnySeeds) {
  for (const int blocks : {5, 8, 12}) {
    const int wrong = shown(blocks, 0.0, false);
    RecordProperty("of_itself_" + std::to_string(blocks), wrong);
    EXPECT_LE(wrong, 50) << blocks;
    const int of_seeds = shown(blocks, 0.0, true);
    RecordProperty("of_itself_seeds_as_worlds_" + std::to_string(blocks), of_seeds);
    EXPECT_GE(of_seeds, 250) << blocks << ": seeds that count as worlds mislead";
  }
  EXPECT_EQ(shown(5, 3.0, false), 0);  // five blocks can show nothing
}

TEST(Blocks, TheVerdictHasPower) {
  for (const auto& [blocks, deviations, least] :
       {std::tuple(8, 1.0, 500), {12, 1.0, 800}, {8, 2.0, 950}, {12, 2.0, 950}}) {
    const int right = shown(blocks, deviations, false);
    RecordProperty(fmt::format("of_{}_blocks_{}_deviations", blocks, deviations), right);
    EXPECT_GE(right, least) << blocks << " blocks, " << deviations << " deviations";
  }
}

// Six blocks are enough for one metric, but not for two: Holm's correction doubles p = 2·2⁻⁶.
TEST(Blocks, MoreTestsNeedMore) {
  testing::Random random(4);
  PairedResults results = blocks_and_seeds(6, 1, 8.0, random);
  EXPECT_EQ(compared(results).verdict, ComparisonVerdict::worse);
  results.metrics.push_back("other");
  results.values.push_back(results.values[0]);
  const CandidateComparison both = compare_candidates(results);
  EXPECT_EQ(both.metrics[1].least_p_holm, 0.0625);
  EXPECT_EQ(both.metrics[1].verdict, ComparisonVerdict::too_few_blocks);
  EXPECT_TRUE(has(comparison_text(both, 300),
                  "with 6 blocks and 2 tests (Holm's correction) p cannot be below 0.0625, and a "
                  "verdict needs at least 7, or fewer metrics (compare.metrics)"));
}

// Five walls and five seeds with small noise: 25 pairs with p = 2·2⁻²⁵, but only five blocks.
TEST(Blocks, SeedsRepeatABlock) {
  testing::Random random(3);
  PairedResults results = blocks_and_seeds(5, 5, 8.0, random);
  const MetricComparison one = compared(results);
  EXPECT_EQ(one.verdict, ComparisonVerdict::too_few_blocks);
  EXPECT_EQ(one.pairs, 25U);
  EXPECT_EQ(one.blocks, 5U);
  EXPECT_EQ(one.p, 0.0625);
  const std::string text = comparison_text(compare_candidates(results), 300);
  EXPECT_TRUE(has(text, "Too few blocks: with 5 blocks p cannot be below 0.0625"));
  const std::string csv = csv_table(comparison_rows(compare_candidates(results)));
  EXPECT_TRUE(has(csv, ",reference_failures_alone,blocks\n", ",too few blocks,"));
  results.samples = {};  // worlds = "seeds"
  EXPECT_EQ(compared(results).p, std::ldexp(1.0, -24));
  EXPECT_EQ(compared(results).verdict, ComparisonVerdict::worse);
}

// The median over the seeds of a block, then over blocks: a large block counts as much as a small
// one.
TEST(Blocks, MediansAreOverSeedsThenOverBlocks) {
  PairedResults results = results_of({"y"}, {Eigen::MatrixXd::Zero(7, 2)});
  results.baseline = 1;
  results.values[0].col(0) << 1, 2, 100, 5, 7, 30, kNaN;
  results.samples = Eigen::VectorXi(7);
  results.samples << 0, 0, 0, 1, 1, 2, 2;
  results.failed.col(0) << 1, 1, 0, 1, 0, 0, 0;
  results.failed.col(1) << 1, 0, 0, 0, 1, 0, 0;
  const CandidateComparison comparison = compare_candidates(results);
  const MetricComparison& one = comparison.metrics.front();
  EXPECT_EQ(one.difference.value, 11.0);  // pseudo-median of 2, 6, 30
  EXPECT_EQ(one.median.value, 6.0);
  EXPECT_EQ(one.blocks, 3U);
  EXPECT_EQ(one.pairs, 6U);
  EXPECT_EQ(one.probability_smaller, 0.0);
  const FailureComparison& failures = comparison.failures.front();
  EXPECT_EQ(failures.failures, 3U);
  EXPECT_EQ(failures.reference_failures, 2U);
  EXPECT_EQ(failures.alone, 1U);  // only in the first block; in the second one each failed once
  EXPECT_EQ(failures.reference_alone, 0U);
  EXPECT_EQ(failures.verdict, ComparisonVerdict::too_few_blocks);
}

// Eight values of an ineffective key in each of two samples: still two blocks.
TEST(Blocks, ValuesOfAnIneffectiveKeyAreNotBlocks) {
  testing::Random random(5);
  const PairedResults of_two = blocks_and_seeds(2, 3, 1.0, random);
  PairedResults results = of_two;
  results.values[0] = of_two.values[0].replicate(8, 1);
  results.failed = of_two.failed.replicate(8, 1);
  results.samples = Eigen::VectorXi(48);
  results.runs = Eigen::MatrixXi(48, 2);
  for (int row = 0; row < 48; ++row) {
    results.samples(row) = row / 3;
    results.runs.row(row) << row % 6, 10 + row % 6;
  }
  const CandidateComparison comparison = compare_candidates(results);
  EXPECT_EQ(comparison.metrics.front().blocks, 2U);
  EXPECT_EQ(comparison.metrics.front().pairs, 6U);
  EXPECT_EQ(comparison.metrics.front().difference.value, compared(of_two).difference.value);
}

// A candidate that never has a metric with a goal is reported.
TEST(Comparisons, ReportsMetricsThatWereNeverMeasured) {
  const Eigen::MatrixXd never = Eigen::MatrixXd::Constant(8, 2, kNaN);
  PairedResults results = results_of({"settling_s", "repairs"}, {never, never});
  results.goals = {{"settling_s", Goal::min}};
  const CandidateComparison nobody = compare_candidates(results);
  EXPECT_EQ(nobody.never, (std::vector<std::vector<std::string>>{{}, {}}));
  results.values[0].col(0).setLinSpaced(1.0, 2.0);
  results.values[1].col(0).setZero();  // without a goal: b misses nothing
  const CandidateComparison comparison = compare_candidates(results);
  EXPECT_TRUE(comparison.metrics.empty());
  EXPECT_EQ(comparison.never, (std::vector<std::vector<std::string>>{{}, {"settling_s"}}));
  EXPECT_TRUE(has(comparison_text(comparison, 200), "No run of b has settling_s\n"));
}

TEST(Comparisons, SaysThatASmallNegativeValueIsALargeMagnitude) {
  Eigen::MatrixXd values(8, 2);
  values.col(0).setLinSpaced(-3.0, -2.0);
  values.col(1).setLinSpaced(1.0, 2.0);
  PairedResults results = results_of({"drift_rad", "rms_rad"}, {values, values.cwiseAbs()});
  const auto text = [&] { return comparison_text(compare_candidates(results), 300); };
  EXPECT_TRUE(lacks(text(), "Negative medians"));
  results.goals = {{"drift_rad", Goal::min}, {"rms_rad", Goal::min}};
  EXPECT_TRUE(has(text(), "Negative medians of drift_rad: the goal min prefers the most negative"));
}

TEST(Comparisons, FewerFailuresAreBetter) {
  PairedResults results;
  results.candidates = {"a", "b"};
  results.baseline = 0;
  results.failed = Eigen::MatrixXd::Zero(12, 2);
  results.failed.col(0).head(9).setOnes();
  const FailureComparison one = compare_candidates(results).failures.front();
  EXPECT_EQ(one.verdict, ComparisonVerdict::better);
  EXPECT_EQ(one.p, std::ldexp(1.0, -8));
}

TEST(Comparisons, QuantilesOfASample) {
  EXPECT_EQ(quantile({1, 2, 3, 5}, 0.5), 2.5);
}

// Two candidates that differ with P(D + D' > 0) of a normal law.
TEST(Ranking, TheNumberThatIsNeededHasItsPower) {
  testing::Random random(23);
  for (const double shift : {0.5, 1.0}) {
    const double share = normal_cdf(std::numbers::sqrt2 * shift);
    const std::size_t needed = differences_needed(share, 0.05).value();
    int shown = 0;
    for (int i = 0; i < 1000; ++i) {
      std::vector<double> d;
      for (std::size_t j = 0; j < needed; ++j) d.push_back(shift + deviate(random));
      shown += SignedRank(d).p() <= 0.05;
    }
    EXPECT_GE(shown, 760) << needed;
    EXPECT_LE(shown, shift < 1.0 ? 880 : 1000);  // for large differences fewer are enough
  }
  EXPECT_EQ(differences_needed(1.0, 0.05).value(), 11U);
  EXPECT_FALSE(differences_needed(0.5, 0.05));
  EXPECT_NEAR(SignedRank({1, 2, -0.5, 3}).share_above(), 1.0, 1e-15);
  EXPECT_NEAR(SignedRank({1, -1, -2, 3}).share_above(), 3.5 / 6.0, 1e-15);
}

TEST(Ranking, HasATableOfTwentyLinesIn80Columns) {
  testing::Random random(24);
  Eigen::MatrixXd peaks(30, 40), times(30, 40);
  for (double& peak : peaks.reshaped()) peak = 123.456 + deviate(random);
  for (double& time : times.reshaped()) time = 0.5 + 0.01 * deviate(random);
  PairedResults results = results_of({"peak_N", "time_s"}, {peaks, times});
  for (std::size_t c = 0; c < 40; ++c) {
    results.candidates[c] = fmt::format("a-long-name-of-a-case, controller.k_position = {}", c);
  }
  const Requirement require{.bounds = {{.metric = "time_s", .max = 0.6}}};
  const std::string text = ranking_text(rank_candidates(results, "peak_N", Goal::min, require), 80);
  const std::string table = text.substr(text.find("\n\n") + 2);
  EXPECT_LE(std::count(table.begin(), table.end(), '\n'), 20);
  EXPECT_TRUE(testing::has(table, "… and 23 more", "100 % [88, 100]"));
  for (const std::string& line : testing::lines_of(text)) {
    EXPECT_LE(line.size(), 80U + 4U) << line;  // "…" has three bytes
  }
}

}  // namespace breakwater::comparisons_test
