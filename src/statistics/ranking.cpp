#include <breakwater/statistics/ranking.h>

#include <algorithm>
#include <cmath>
#include <numeric>
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

  std::vector<double> sums(ranked.size());  // over the differences, the smaller the better
  for (RankedCandidate& row : ranked) row.place = 1;
  const double sign = goal == Goal::max ? -1.0 : 1.0;
  const double share = 1.0 / static_cast<double>(std::max<std::size_t>(1, ranked.size()));
  for (const PairComparison& one : ranking.comparison.metrics) {
    ranked[one.candidate].place += one.verdict == ComparisonVerdict::worse;
    ranked[one.reference].place += one.verdict == ComparisonVerdict::better;
    sums[one.candidate] += share * sign * one.difference.value;
    sums[one.reference] -= share * sign * one.difference.value;
  }
  std::vector<std::size_t> order(ranked.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::ranges::stable_sort(order, {},
                           [&](std::size_t i) { return std::pair(ranked[i].place, sums[i]); });
  for (const std::size_t i : order) {
    RankedCandidate& row = ranking.rows.emplace_back(ranked[i]);
    for (const PairComparison& one : ranking.comparison.metrics) {
      const bool is_turned = one.candidate == order.front() && one.reference == i;
      const bool is_pair = one.candidate == i && one.reference == order.front();
      if (!is_turned && !is_pair) continue;
      row.with_first = one;
      row.behind = one.difference;
      row.worse_in = one.larger;
      row.is_worse =
          one.verdict == (is_turned ? ComparisonVerdict::better : ComparisonVerdict::worse);
      if (is_turned == (goal == Goal::max)) continue;
      row.worse_in = one.smaller;
      row.behind.value = -row.behind.value;
      if (auto& interval = row.behind.interval) *interval = {-interval->upper, -interval->lower};
    }
    ranking.level += !row.is_worse;
  }
  ranking.rows.insert(ranking.rows.end(), others.begin(), others.end());
  return ranking;
}

}  // namespace breakwater
