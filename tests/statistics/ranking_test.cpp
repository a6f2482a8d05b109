// Rankings of candidates against brute force, and what they say.
#include <breakwater/statistics/ranking.h>

#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include <breakwater/math/error_function.h>
#include <breakwater/statistics/distribution.h>
#include <breakwater/statistics/signed_rank.h>
#include <breakwater/study/ranking_text.h>
#include "support.h"

namespace breakwater::ranking_test {

double deviate(testing::Random& random) {
  return normal_quantile(random.uniform(1e-12, 1.0 - 1e-12));
}

PairedResults results_of(const Eigen::MatrixXd& peaks, const Eigen::MatrixXd& times = {}) {
  PairedResults results;
  for (Eigen::Index c = 0; c < peaks.cols(); ++c) {
    results.candidates.emplace_back(1, static_cast<char>('a' + c % 26));
  }
  results.metrics = {"peak_N"};
  results.values = {peaks};
  if (times.size() > 0) {
    results.metrics.emplace_back("time_s");
    results.values.push_back(times);
  }
  results.failed = Eigen::MatrixXd::Zero(peaks.rows(), peaks.cols());
  return results;
}

Ranking ranked(const Eigen::MatrixXd& peaks, Goal goal = Goal::min) {
  return rank_candidates(results_of(peaks), "peak_N", goal);
}

// 400 conditions of five candidates, whose differences depend on the condition.
Eigen::MatrixXd world_of(testing::Random& random) {
  Eigen::MatrixXd peaks(400, 5);
  Eigen::VectorXd offset(5), slope(5);
  for (Eigen::Index c = 0; c < 5; ++c) {
    offset(c) = random.uniform(0.0, 2.0);
    slope(c) = random.uniform(-0.5, 0.5);
  }
  for (Eigen::Index i = 0; i < peaks.rows(); ++i) {
    const double hardness = random.uniform(-1.0, 1.0), common = 5.0 * deviate(random);
    for (Eigen::Index c = 0; c < 5; ++c) {
      peaks(i, c) = common + offset(c) + slope(c) * hardness + std::exp(0.5 * deviate(random));
    }
  }
  return peaks;
}

// Brute force: the candidate with the lowest pseudo-median beside each other one in all conditions.
Eigen::Index best_of(const Eigen::MatrixXd& peaks) {
  for (Eigen::Index c = 0; c < peaks.cols(); ++c) {
    bool is_best = true;
    for (Eigen::Index other = 0; other < peaks.cols(); ++other) {
      const Eigen::VectorXd d = peaks.col(c) - peaks.col(other);
      is_best = is_best && (c == other || SignedRank({d.begin(), d.end()}).pseudo_median() < 0.0);
    }
    if (is_best) return c;
  }
  return -1;  // the differences go in a circle
}

TEST(Ranking, SeldomNamesAWrongBestAsShown) {
  testing::Random random(21);
  int studies = 0, wrong = 0, right = 0;
  while (studies < 200) {
    const Eigen::MatrixXd world = world_of(random);
    const Eigen::Index best = best_of(world);
    if (best < 0) continue;
    ++studies;
    const Eigen::Index conditions = 10 + 5 * (studies % 4);
    const Ranking ranking = ranked(world.topRows(conditions));
    if (!ranking.is_shown()) continue;
    const bool is_right = ranking.rows.front().candidate == static_cast<std::size_t>(best);
    ++(is_right ? right : wrong);
  }
  RecordProperty("right", right);
  RecordProperty("wrong", wrong);
  EXPECT_LE(wrong, 10);
  EXPECT_GE(right, 40);  // it does name some
}

TEST(Ranking, OfEqualCandidatesShowsNone) {
  testing::Random random(22);
  int named = 0;
  for (int study = 0; study < 200; ++study) {
    Eigen::MatrixXd peaks(12, 4);
    for (double& peak : peaks.reshaped()) peak = std::exp(deviate(random));
    named += ranked(peaks).is_shown();
  }
  EXPECT_LE(named, 10);
}

TEST(Ranking, ComparesAllPairsAndTurnsWithTheGoal) {
  Eigen::MatrixXd peaks(10, 3);
  for (int i = 0; i < 10; ++i)
    peaks.row(i) << 8.0 + 0.1 * i, 5.0 + 0.01 * i * i, 5.0 + 0.011 * i * i;
  const Ranking low = ranked(peaks);
  ASSERT_EQ(low.comparison.metrics.size(), 3U);
  EXPECT_EQ(low.rows[0].candidate, 1U);
  EXPECT_EQ(low.rows[2].candidate, 0U);
  EXPECT_EQ(low.rows[2].place, 3U);
  EXPECT_EQ(low.rows[1].to_first->blocks, 10U);
  const Ranking high = ranked(peaks, Goal::max);
  EXPECT_EQ(high.rows[0].candidate, 0U);
  EXPECT_EQ(high.rows[0].place, 1U);
  EXPECT_TRUE(high.is_shown());
  EXPECT_EQ(
      ranking_sentence(high),
      "a has the highest peak_N: 8.45 N, 3.146 N above the next (c), 95 % 3.048 to 3.214 N, in "
      "10 of 10 conditions.");
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

TEST(Ranking, IsAmongThoseThatMeetTheBounds) {
  Eigen::MatrixXd peaks(8, 4), times(8, 4);
  for (int i = 0; i < 8; ++i) {
    peaks.row(i) << 3.0 + 0.1 * i, 6.0 + 0.1 * i, 9.0 + 0.3 * i, 1.0;
    times.row(i) << (i < 2 ? 0.7 : 0.5) + 1e-3 * i, 0.5, 0.6, kNaN;
  }
  PairedResults results = results_of(peaks, times);
  Requirement require{.bounds = {{.metric = "time_s", .max = 0.6}}};
  const auto rank = [&] { return rank_candidates(results, "peak_N", Goal::min, require); };
  EXPECT_EQ(rank().ranked, 2U);
  EXPECT_EQ(rank().rows[0].candidate, 1U);
  EXPECT_EQ(rank().rows[2].candidate, 0U);  // the others in the order of the study
  EXPECT_EQ(rank().rows[2].place, 0U);
  EXPECT_EQ(rank().rows[2].met, 6U);
  EXPECT_NEAR(rank().rows[2].share.lower, 0.349, 1e-3);
  EXPECT_NEAR(rank().rows[2].share.upper, 0.968, 1e-3);
  EXPECT_EQ(
      ranking_sentence(rank()),
      "b has the lowest peak_N: 6.35 N, 3.7 N below the next (c), 95 % 3.2 to 4.2 N, in 8 of 8 "
      "conditions. 2 of 4 candidates meet the bounds: time_s at most 0.6 s in all conditions.");
  require.share = 0.75;
  EXPECT_EQ(rank().rows[0].candidate, 0U);
  EXPECT_EQ(rank().ranked, 3U);
  results.failed(7, 0) = 1.0;  // a failed run meets nothing
  EXPECT_EQ(rank().ranked, 2U);
  require.share = 1.0;
  require.bounds[0].min = 0.55;
  EXPECT_EQ(
      ranking_sentence(rank()),
      "c alone is ranked, with peak_N 10.05 N. 1 of 4 candidates meets the bounds: time_s from "
      "0.55 s to 0.6 s in all conditions.");
  require.bounds[0].min = 0.65;
  require.bounds[0].max = 0.8;
  EXPECT_EQ(
      ranking_sentence(rank()),
      "No candidate has time_s from 0.65 s to 0.8 s in all conditions: a comes nearest, with 2 of "
      "8.");
  require.bounds[0].min = 0.75;
  EXPECT_TRUE(testing::has(ranking_sentence(rank()), ": a, b, c and d come nearest, with 0 of 8."));
}

TEST(Ranking, SaysWhatWouldShowADifference) {
  Eigen::MatrixXd peaks(8, 3);
  for (int i = 0; i < 8; ++i) {
    peaks.row(i) << 5.0 + i, 5.5 + i + (i % 3 == 0 ? -0.8 : 0.1 * i), 30.0 + 2 * i;
  }
  const std::string sentence = ranking_sentence(ranked(peaks));
  EXPECT_TRUE(sentence.starts_with("No difference in peak_N is shown between a (8.5 N) and b ("))
      << sentence;
  EXPECT_TRUE(testing::has(sentence, ": about ", " conditions would show 0.",
                           "c is shown to be higher than a."));
  EXPECT_TRUE(
      testing::has(ranking_sentence(ranked(peaks.topRows(4))),
                   "4 conditions are too few to show any difference, which needs 7 or more"));
  peaks.col(1) = peaks.col(0);
  peaks.col(2) = peaks.col(0);
  EXPECT_TRUE(
      testing::has(ranking_sentence(ranked(peaks)), "a (8.5 N) and any of b (8.5 N) and c"));
  EXPECT_TRUE(testing::has(ranking_sentence(ranked(peaks)), "they are equal in 8 conditions"));
  PairedResults results = results_of(peaks.topRows(5));
  results.failed(0, 0) = 1.0;
  const Ranking few = rank_candidates(results, "peak_N", Goal::min);
  EXPECT_FALSE(few.is_shown());
  EXPECT_FALSE(few.comparison.metrics[0].difference.interval);
  EXPECT_TRUE(testing::has(ranking_sentence(few), "a fails in 1 of 5 conditions."));
  EXPECT_EQ(ranking_sentence(ranked(Eigen::MatrixXd::Constant(8, 2, kNaN))), "No run has peak_N.");
  results.values[0].rightCols(2).setConstant(kNaN);
  results.failed.col(1).setOnes();
  EXPECT_EQ(ranking_sentence(rank_candidates(results, "peak_N", Goal::min)),
            "a alone is ranked, with peak_N 7 N. a fails in 1 of 5 conditions. b fails in all "
            "conditions. No run of c has peak_N.");
}

// a is lower than b and c in each condition that both have. c has the lowest median of its own.
TEST(Ranking, SaysThatALowerMedianIsWorseInEqualConditions) {
  Eigen::MatrixXd peaks(16, 3);
  for (int i = 0; i < 16; ++i) {
    peaks.row(i) << 1.0 + i, (i < 12 ? 1.5 + 1.01 * i : kNaN), (i < 8 ? 2.5 + 1.02 * i : kNaN);
  }
  EXPECT_TRUE(testing::has(ranking_sentence(ranked(peaks)),
                           " c has the lowest median, but is worse in equal conditions."));
  peaks.col(1) = peaks.col(0).array() - 0.1 + 0.3 * Eigen::ArrayXd::LinSpaced(16, 0.0, 1.0);
  EXPECT_TRUE(testing::lacks(ranking_sentence(ranked(peaks.leftCols(2))), "lowest median"));
}

TEST(Ranking, SaysThatABoundIsTheSameInAllConditions) {
  Eigen::MatrixXd peaks(8, 2), times(8, 2);
  for (int i = 0; i < 8; ++i) peaks.row(i) << 3.0 + 0.1 * i, 6.0 + 0.1 * i;
  times.rowwise() = Eigen::RowVector2d(0.5, 0.7);
  const Requirement require{.bounds = {{.metric = "time_s", .max = 0.6}}};
  const auto sentence = [&] {
    return ranking_sentence(
        rank_candidates(results_of(peaks, times), "peak_N", Goal::min, require));
  };
  const std::string said = "time_s is the same in all conditions, so they say nothing about others";
  EXPECT_TRUE(testing::has(sentence(), said));
  times(7, 1) = 0.70001;
  EXPECT_TRUE(testing::lacks(sentence(), said));
  times(7, 1) = kNaN;
  EXPECT_TRUE(testing::lacks(sentence(), said));
}

TEST(Ranking, HasATableOfTwentyLinesIn80Columns) {
  testing::Random random(24);
  Eigen::MatrixXd peaks(30, 40), times(30, 40);
  for (double& peak : peaks.reshaped()) peak = 123.456 + deviate(random);
  for (double& time : times.reshaped()) time = 0.5 + 0.01 * deviate(random);
  PairedResults results = results_of(peaks, times);
  for (std::size_t c = 0; c < 40; ++c) {
    results.candidates[c] = fmt::format("a-long-name-of-a-case, controller.k_position = {}", c);
  }
  const Requirement require{.bounds = {{.metric = "time_s", .max = 0.6}}};
  const Ranking ranking = rank_candidates(results, "peak_N", Goal::min, require);
  const std::string text = ranking_text(ranking, 80);
  const std::string table = text.substr(text.find("\n\n") + 2);
  EXPECT_LE(std::count(table.begin(), table.end(), '\n'), 20);
  EXPECT_TRUE(testing::has(table, "… and 23 more", "100 % [88, 100]"));
  for (const std::string& line : testing::lines_of(text)) {
    EXPECT_LE(line.size(), 80U + 4U) << line;  // "…" has three bytes
  }
  const auto json = nlohmann::json::parse(ranking_json(ranking).dump());
  EXPECT_EQ(json["pairs"].size(), 780U);
  EXPECT_EQ(json["table"].size(), 41U);
  EXPECT_EQ(json["require"]["bounds"]["time_s"]["max"], 0.6);
  EXPECT_TRUE(json["require"]["bounds"]["time_s"]["min"].is_null());
}

// Differences that overflow, or whose squares and cubes would.
TEST(Ranking, LargeValuesGiveNumbers) {
  for (const double unit : {1e104, 1e300, 1.7e308}) {
    Eigen::MatrixXd peaks(9, 2);
    for (int i = 0; i < 9; ++i) peaks.row(i) << -unit * (1.0 - 0.01 * i), unit * (1.0 - 0.02 * i);
    const MetricComparison one = ranked(peaks).rows[1].to_first.value();
    EXPECT_TRUE(std::isfinite(one.difference.value)) << unit;
    EXPECT_TRUE(std::isfinite(one.difference.interval->lower) &&
                std::isfinite(one.difference.interval->upper))
        << unit;
    EXPECT_EQ(one.verdict, ComparisonVerdict::worse);
  }
}

// Equal runs of a pair count once, so an ineffective key adds no conditions.
TEST(Ranking, CountsEqualRunsOnce) {
  PairedResults results = results_of(Eigen::MatrixXd(12, 2));
  results.runs = Eigen::MatrixXi(12, 2);
  for (int i = 0; i < 12; ++i) {
    results.values[0].row(i) << 1.0 + i % 3, 2.0 + i % 3;
    results.runs.row(i) << i % 3, 10 + i % 3;
  }
  const Ranking ranking = rank_candidates(results, "peak_N", Goal::min);
  EXPECT_EQ(ranking.rows[0].blocks, 3U);
  EXPECT_FALSE(ranking.is_shown());
  results.runs = {};
  EXPECT_TRUE(rank_candidates(results, "peak_N", Goal::min).is_shown());
}

}  // namespace breakwater::ranking_test
