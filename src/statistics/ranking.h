// The ranking of candidates by one metric, among those that meet bounds.
#pragma once

#include <cstddef>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include <breakwater/statistics/paired_comparison.h>

namespace breakwater {

/// A metric within [min, max].
struct Bound {
  std::string metric;
  double min = -std::numeric_limits<double>::infinity();
  double max = std::numeric_limits<double>::infinity();
};

/// A candidate is ranked if at least `share` of its blocks meet all bounds. A block meets them if
/// all its runs end and have these metrics within their bounds.
struct Requirement {
  std::vector<Bound> bounds;  ///< empty: nothing is required
  double share = 1.0;
  double confidence = 0.95;  ///< level of the interval of the share
};

struct RankedCandidate {
  std::size_t candidate = 0;  ///< index into Ranking::candidates
  std::size_t place = 0;      ///< 1 and the number of those shown to be better; 0: not ranked
  std::size_t blocks = 0;     ///< different blocks of the candidate
  std::size_t failed = 0;     ///< blocks in which a run failed
  std::size_t missing = 0;    ///< complete runs without the metric
  std::size_t met = 0;        ///< blocks that meet the requirement
  ConfidenceInterval share = {0.0, 1.0};  ///< share_interval() of met
  EstimatedValue median{};
  /// Its pair with the first one; nothing for the first, if it is not ranked, or if the two have no
  /// block in common.
  std::optional<PairComparison> with_first = {};
  EstimatedValue behind{};   ///< how much worse it is than the first one
  std::size_t worse_in = 0;  ///< blocks of the pair
  bool is_worse = false;     ///< whether this is shown
};

/// All pairs of ranked candidates are compared in the metric alone, with Holm's correction over
/// these pairs.
struct Ranking {
  std::string metric;
  Goal goal = Goal::min;
  std::vector<std::string> candidates;
  Requirement requirement;
  /// The ranked candidates in the order of their places, then the others. In a place the candidate
  /// with the best mean difference from all others comes first.
  std::vector<RankedCandidate> rows;
  std::size_t ranked = 0;          ///< number of ranked candidates
  CandidateComparison comparison;  ///< all pairs of them
  std::size_t level = 0;           ///< rows that are not shown to be worse than the first, with it
  /// Bounded metrics that are the same in all blocks of each candidate. The blocks are then no
  /// independent trials, and the intervals of the shares are too narrow.
  std::vector<std::string> constant;

  /// Whether the first is shown to be better than every other ranked one.
  bool is_shown() const { return ranked > 1 && level == 1; }
};

/// Ranks the candidates by a metric of `results`, which must have the metrics of all bounds too.
/// `goal` is min or max. A candidate without the metric is not ranked.
Ranking rank_candidates(const PairedResults& results, const std::string& metric, Goal goal,
                        const Requirement& requirement = {});

}  // namespace breakwater
