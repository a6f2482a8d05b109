#include <breakwater/statistics/ranking.h>

#include <algorithm>
#include <cmath>
#include <tuple>
#include <utility>

#include <breakwater/statistics/distribution.h>

namespace breakwater {
namespace {

const Eigen::MatrixXd& values_of(const PairedResults& results, const std::string& metric) {
  const auto found = std::find(results.metrics.begin(), results.metrics.end(), metric);
  return results.values.at(static_cast<std::size_t>(found - results.metrics.begin()));
}

// Counts the blocks of a candidate alone.
RankedCandidate counted(const PairedResults& results, std::size_t candidate,
                        const Requirement& requirement, const std::string& metric) {
  const auto column = static_cast<Eigen::Index>(candidate);
  const auto meets = [&](Eigen::Index world) {
    return std::all_of(requirement.bounds.begin(), requirement.bounds.end(), [&](const auto& one) {
      const double value = values_of(results, one.metric)(world, column);
      return value >= one.min && value <= one.max;  // false for NaN
    });
  };
  RankedCandidate row;
  row.candidate = candidate;
  const Blocks blocks = different_blocks(results, {candidate});
  for (const Blocks::value_type& block : blocks) {
    const bool has_failed = std::any_of(block.begin(), block.end(), [&](Eigen::Index world) {
      return results.failed(world, column) > 0.0;
    });
    ++row.blocks;
    row.failed += has_failed;
    row.met += !has_failed && std::all_of(block.begin(), block.end(), meets);
  }
  const auto values = values_of(results, metric).col(column).array();
  row.missing = static_cast<std::size_t>(
      (results.failed.col(column).array() == 0.0 && values.isNaN()).count());
  if (row.blocks > 0) row.share = share_interval(row.met, row.blocks, requirement.confidence);
  std::vector<double> medians = block_medians(blocks, [&](Eigen::Index i) { return values(i); });
  if (!medians.empty()) row.median = estimated_median(std::move(medians));
  return row;
}

// Whether each candidate with two different blocks or more has the same values in all of them.
bool is_constant(const PairedResults& results, const std::string& metric) {
  const Eigen::MatrixXd& values = values_of(results, metric);
  bool has_repeats = false;
  for (Eigen::Index column = 0; column < values.cols(); ++column) {
    const auto blocks = different_blocks(results, {static_cast<std::size_t>(column)});
    for (std::size_t i = 1; i < blocks.size(); ++i) {
      const bool is_same =
          blocks[i].size() == blocks[0].size() &&
          (values(blocks[i], column).array() == values(blocks[0], column).array()).all();
      if (!is_same) return false;  // neither are missing values
      has_repeats = true;
    }
  }
  return has_repeats;
}

// One metric of some candidates, without a baseline.
PairedResults part_of(const PairedResults& results, const std::string& metric, Goal goal,
                      const std::vector<Eigen::Index>& columns) {
  PairedResults part;
  for (const Eigen::Index column : columns) {
    part.candidates.push_back(results.candidates[static_cast<std::size_t>(column)]);
  }
  part.metrics = {metric};
  part.goals = {{metric, goal}};
  part.values = {values_of(results, metric)(Eigen::all, columns)};
  part.failed = results.failed(Eigen::all, columns);
  part.samples = results.samples;
  if (results.runs.size() > 0) part.runs = results.runs(Eigen::all, columns);
  return part;
}

// y − x of a comparison of x − y.
PairComparison turned(PairComparison one) {
  std::swap(one.candidate, one.reference);
  std::swap(one.median, one.reference_median);
  std::swap(one.smaller, one.larger);
  one.probability_smaller = 1.0 - one.probability_smaller;
  one.probability_better = 1.0 - one.probability_better;
  one.difference.value = -one.difference.value;
  if (auto& interval = one.difference.interval) *interval = {-interval->upper, -interval->lower};
  if (one.verdict == ComparisonVerdict::better) {
    one.verdict = ComparisonVerdict::worse;
  } else if (one.verdict == ComparisonVerdict::worse) {
    one.verdict = ComparisonVerdict::better;
  }
  return one;
}

}  // namespace

Ranking rank_candidates(const PairedResults& results, const std::string& metric, Goal goal,
                        const Requirement& requirement) {
  Ranking ranking{metric, goal, results.candidates, requirement, {}, 0, {}, 0, {}};
  std::vector<RankedCandidate> ranked, others;
  std::vector<Eigen::Index> columns;
  for (std::size_t c = 0; c < results.candidates.size(); ++c) {
    const RankedCandidate row = counted(results, c, requirement, metric);
    const bool meets = requirement.bounds.empty() ||
                       static_cast<double>(row.met) >=
                           requirement.share * static_cast<double>(row.blocks) * (1.0 - 1e-12);
    const bool is_ranked = meets && !std::isnan(row.median.value);
    (is_ranked ? ranked : others).push_back(row);
    if (is_ranked) columns.push_back(static_cast<Eigen::Index>(c));
  }
  for (const Bound& bound : requirement.bounds) {
    if (is_constant(results, bound.metric)) ranking.constant.push_back(bound.metric);
  }
  ranking.ranked = ranked.size();
  ranking.comparison = compare_candidates(part_of(results, metric, goal, columns));

  struct Standing {
    std::size_t better = 0;  // candidates that are shown to be better
    double sum = 0.0;        // over the differences, the smaller the better
    std::size_t index = 0;
  };
  std::vector<Standing> standings(ranked.size());
  for (std::size_t i = 0; i < ranked.size(); ++i) standings[i].index = i;
  const double sign = goal == Goal::max ? -1.0 : 1.0;
  const double share = 1.0 / static_cast<double>(std::max<std::size_t>(1, ranked.size()));
  for (const PairComparison& one : ranking.comparison.metrics) {
    standings[one.candidate].better += one.verdict == ComparisonVerdict::worse;
    standings[one.reference].better += one.verdict == ComparisonVerdict::better;
    standings[one.candidate].sum += share * sign * one.difference.value;
    standings[one.reference].sum -= share * sign * one.difference.value;
  }
  std::stable_sort(standings.begin(), standings.end(), [](const auto& a, const auto& b) {
    return std::tie(a.better, a.sum) < std::tie(b.better, b.sum);
  });
  for (const Standing& standing : standings) {
    RankedCandidate& row = ranking.rows.emplace_back(ranked[standing.index]);
    row.place = standing.better + 1;
    const std::size_t first = standings.front().index;
    for (const PairComparison& one : ranking.comparison.metrics) {
      if (one.candidate == standing.index && one.reference == first) row.to_first = one;
      if (one.candidate == first && one.reference == standing.index) row.to_first = turned(one);
    }
    const bool is_worse = row.to_first && row.to_first->verdict == ComparisonVerdict::worse;
    ranking.level += !is_worse;
  }
  ranking.rows.insert(ranking.rows.end(), others.begin(), others.end());
  return ranking;
}

}  // namespace breakwater
