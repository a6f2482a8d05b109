#include <breakwater/statistics/paired_comparison.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <set>

#include <breakwater/statistics/signed_rank.h>

namespace breakwater {
namespace {

// Indices in ascending order of p.
std::vector<std::size_t> ascending(const std::vector<double>& p) {
  std::vector<std::size_t> order(p.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(),
                   [&](std::size_t a, std::size_t b) { return p[a] < p[b]; });
  return order;
}

// Pairs of candidate and reference.
std::vector<std::pair<std::size_t, std::size_t>> pairs_of(const PairedResults& results) {
  std::vector<std::pair<std::size_t, std::size_t>> pairs;
  for (std::size_t x = 0; x < results.candidates.size(); ++x) {
    if (results.baseline) {
      if (x != *results.baseline) pairs.emplace_back(x, *results.baseline);
      continue;
    }
    for (std::size_t y = 0; y < x; ++y) pairs.emplace_back(x, y);
  }
  return pairs;
}

// A pair of candidates with its blocks and those of each candidate alone.
struct Pair {
  Eigen::Index x, y;
  Blocks blocks;
  const Blocks& of_x;
  const Blocks& of_y;
};

// The median magnitude of a metric's values in two columns.
double median_size(const Eigen::MatrixXd& values, const Pair& pair) {
  std::vector<double> sizes;
  for (const Eigen::Index column : {pair.x, pair.y}) {
    for (const double value : values.col(column)) {
      if (std::isfinite(value)) sizes.push_back(std::abs(value));
    }
  }
  return sample_median(sizes);
}

Goal goal_in(const PairedResults& results, const std::string& metric) {
  const auto found = results.goals.find(metric);
  return found == results.goals.end() ? Goal::none : found->second;
}

PairComparison comparison_of(const Pair& pair, const std::string& metric, Goal goal) {
  PairComparison comparison;
  comparison.metric = metric;
  comparison.goal = goal;
  comparison.candidate = static_cast<std::size_t>(pair.x);
  comparison.reference = static_cast<std::size_t>(pair.y);
  return comparison;
}

// A comparison in a metric, and its test; nothing if the pair does not have it in common.
struct Tested {
  PairComparison comparison;
  SignedRank test;
};

std::optional<Tested> compare_metric(const PairedResults& results, std::size_t metric,
                                     const Pair& pair) {
  const std::string& name = results.metrics[metric];
  PairComparison comparison = comparison_of(pair, name, goal_in(results, name));
  const auto x = results.values[metric].col(pair.x).array();
  const auto y = results.values[metric].col(pair.y).array();
  const std::vector<double> medians = block_medians(pair.blocks, [&](Eigen::Index world) {
    constexpr double kMost = std::numeric_limits<double>::max();
    const double difference = std::clamp(x(world) - y(world), -kMost, kMost);  // NaN stays
    comparison.pairs += !std::isnan(difference);
    return difference;
  });
  if (medians.empty()) return std::nullopt;
  comparison.blocks = medians.size();
  comparison.is_test = ((x - y).abs() > 0.0).any();  // false for NaN
  const auto median_of = [](const auto& of, const auto& beside, const Blocks& blocks) {
    return estimated_median(block_medians(blocks, [&](Eigen::Index world) {
      return std::isnan(beside(world)) ? beside(world) : of(world);
    }));
  };
  comparison.median = median_of(x, y, pair.of_x);
  comparison.reference_median = median_of(y, x, pair.of_y);
  for (const double d : medians) {
    comparison.smaller += d < 0.0;
    comparison.larger += d > 0.0;
  }
  const std::size_t equal = comparison.blocks - comparison.smaller - comparison.larger;
  const double share =
      (static_cast<double>(comparison.smaller) + 0.5 * static_cast<double>(equal)) /
      static_cast<double>(comparison.blocks);
  comparison.probability_smaller = share;
  if (comparison.goal != Goal::none) {
    comparison.probability_better = comparison.goal == Goal::min ? share : 1.0 - share;
  }
  constexpr double kRounding = 1e-12;  // relative to the values
  SignedRank test(medians, kRounding * median_size(results.values[metric], pair));
  comparison.p = test.p();
  comparison.difference.value = test.pseudo_median();
  return Tested{std::move(comparison), std::move(test)};
}

PairComparison compare_failures(const PairedResults& results, const Pair& pair) {
  PairComparison comparison = comparison_of(pair, kFailure, Goal::min);
  comparison.blocks = pair.blocks.size();
  for (const std::vector<Eigen::Index>& block : pair.blocks) {
    comparison.pairs += block.size();
    std::size_t of_x = 0, of_y = 0;
    for (const Eigen::Index world : block) {
      of_x += results.failed(world, pair.x) > 0.0;
      of_y += results.failed(world, pair.y) > 0.0;
    }
    comparison.failures += of_x;
    comparison.reference_failures += of_y;
    comparison.larger += of_x > of_y;
    comparison.smaller += of_y > of_x;
  }
  comparison.is_test = comparison.larger + comparison.smaller > 0;
  comparison.p = mcnemar_exact(comparison.larger, comparison.smaller);
  return comparison;
}

ComparisonVerdict verdict_of(const PairComparison& comparison) {
  if (comparison.least_p_holm > kAlpha) return ComparisonVerdict::too_few_blocks;
  if (comparison.p_holm > kAlpha) return ComparisonVerdict::no_difference_shown;
  const bool is_smaller = comparison.metric == kFailure ? comparison.larger < comparison.smaller
                                                        : comparison.difference.value < 0.0;
  if (comparison.goal == Goal::none)
    return is_smaller ? ComparisonVerdict::smaller : ComparisonVerdict::larger;
  return is_smaller == (comparison.goal == Goal::min) ? ComparisonVerdict::better
                                                      : ComparisonVerdict::worse;
}

// Sets p_holm, its smallest value, and the verdict. Returns the level of each: Holm's, or kAlpha of
// one that is no test.
std::vector<double> set_verdicts(std::vector<PairComparison>& comparisons) {
  std::vector<double> p, least;
  for (const PairComparison& one : comparisons) {
    if (!one.is_test) continue;
    p.push_back(one.p);
    least.push_back(least_p(one.blocks));
  }
  const std::vector<double> p_holm = holm(p), least_p_holm = holm(least);
  const std::vector<double> levels_of_tests = holm_levels(p, kAlpha);
  std::vector<double> levels;
  std::size_t test = 0;
  for (PairComparison& one : comparisons) {
    one.p_holm = one.is_test ? p_holm[test] : one.p;
    one.least_p_holm = one.is_test ? least_p_holm[test] : least_p(one.blocks);
    one.verdict = verdict_of(one);
    levels.push_back(one.is_test ? levels_of_tests[test++] : kAlpha);
  }
  return levels;
}

std::vector<std::string> never_measured(const PairedResults& results, std::size_t candidate) {
  std::vector<std::string> metrics;
  const auto column = static_cast<Eigen::Index>(candidate);
  if ((results.failed.col(column).array() > 0.0).all()) return metrics;
  for (std::size_t metric = 0; metric < results.metrics.size(); ++metric) {
    const auto is_absent = results.values[metric].array().isNaN();
    const bool is_never = is_absent.col(column).all();
    if (goal_in(results, results.metrics[metric]) != Goal::none && is_never && !is_absent.all()) {
      metrics.push_back(results.metrics[metric]);
    }
  }
  return metrics;
}

// The coordinates that affect a candidate. A coordinate is left out if there are test conditions
// that differ only in it, and none of them has another outcome. Two failures do not show this.
std::vector<std::size_t> effective_coordinates(const std::vector<Coordinates>& places,
                                               const Eigen::VectorXi& outcomes,
                                               const Eigen::VectorXd& failed) {
  std::vector<std::size_t> effective;
  for (std::size_t k = 0; k < places.front().size(); ++k) {
    std::map<Coordinates, int> first;  // outcome by the other coordinates
    bool has_pair = false, differs = false;
    for (std::size_t world = 0; world < places.size(); ++world) {
      const auto row = static_cast<Eigen::Index>(world);
      Coordinates others = places[world];
      others[k] = 0.0;
      const auto [met, is_new] = first.emplace(others, outcomes(row));
      has_pair = has_pair || (!is_new && failed(row) == 0.0);
      differs = differs || met->second != outcomes(row);
    }
    if (!has_pair || differs) effective.push_back(k);
  }
  return effective;
}

}  // namespace

std::vector<double> holm(const std::vector<double>& p) {
  const std::vector<std::size_t> order = ascending(p);
  std::vector<double> adjusted(p.size());
  double largest = 0.0;
  for (std::size_t i = 0; i < order.size(); ++i) {
    const double times = static_cast<double>(p.size() - i);
    largest = std::max(largest, std::min(1.0, times * p[order[i]]));
    adjusted[order[i]] = largest;
  }
  return adjusted;
}

std::vector<double> holm_levels(const std::vector<double>& p, double alpha) {
  const std::vector<std::size_t> order = ascending(p);
  const std::vector<double> adjusted = holm(p);
  std::vector<double> levels(p.size());
  std::size_t first = 0;  // the first of equal p, in `order`
  for (std::size_t i = 0; i < order.size(); ++i) {
    const bool is_rejected = i > 0 && adjusted[order[i - 1]] <= alpha;
    if (is_rejected && p[order[i]] > p[order[first]]) first = i;
    levels[order[i]] = alpha / static_cast<double>(p.size() - first);
  }
  return levels;
}

void number_failed_runs(const std::vector<Coordinates>& places, PairedResults& results) {
  if (!(results.failed.array() > 0.0).any()) return;
  int next = results.runs.maxCoeff() + 1;
  for (Eigen::Index column = 0; column < results.runs.cols(); ++column) {
    const Eigen::VectorXi outcomes = results.runs.col(column);
    const auto effective = effective_coordinates(places, outcomes, results.failed.col(column));
    std::map<std::pair<int, Coordinates>, int> numbers;
    for (Eigen::Index world = 0; world < outcomes.size(); ++world) {
      if (results.failed(world, column) == 0.0) continue;
      Coordinates place;
      for (const std::size_t k : effective) {
        place.push_back(places[static_cast<std::size_t>(world)][k]);
      }
      const auto [found, is_new] = numbers.emplace(std::pair(outcomes(world), place), next);
      if (is_new) ++next;
      results.runs(world, column) = found->second;
    }
  }
}

EstimatedValue estimated_median(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  const auto interval = quantile_interval(values, 0.5, 1.0 - kAlpha);
  return {sample_median(values), interval};
}

std::vector<double> block_medians(const Blocks& blocks,
                                  const std::function<double(Eigen::Index)>& value) {
  std::vector<double> medians;
  for (const Blocks::value_type& block : blocks) {
    std::vector<double> values;
    for (const Eigen::Index world : block) {
      const double one = value(world);
      if (!std::isnan(one)) values.push_back(one);
    }
    if (!values.empty()) medians.push_back(sample_median(values));
  }
  return medians;
}

Blocks different_blocks(const PairedResults& results, const std::vector<std::size_t>& candidates) {
  Blocks blocks;
  std::set<std::vector<int>> met;
  for (Eigen::Index first = 0, end = 0; first < results.failed.rows(); first = end) {
    Blocks::value_type block;
    std::vector<int> runs;
    do {
      block.push_back(end);
      for (const std::size_t c : candidates) {
        if (results.runs.size() == 0) break;
        runs.push_back(results.runs(end, static_cast<Eigen::Index>(c)));
      }
      ++end;
    } while (end < results.samples.size() && results.samples(end) == results.samples(first));
    const bool is_new = results.runs.size() == 0 || met.insert(runs).second;
    if (is_new) blocks.push_back(std::move(block));
  }
  return blocks;
}

const std::string& name_of(ComparisonVerdict verdict) {
  static const std::array<std::string, 6> names = {
      "better", "worse", "smaller", "larger", "no difference shown", "too few blocks"};
  return names[static_cast<std::size_t>(verdict)];
}

double least_p(std::size_t blocks, std::size_t tests) {
  const int n = static_cast<int>(std::min<std::size_t>(blocks, 1000));
  return std::min(1.0, static_cast<double>(tests) * std::ldexp(2.0, -n));
}

CandidateComparison compare_candidates(const PairedResults& results) {
  CandidateComparison comparison;
  comparison.candidates = results.candidates;
  std::vector<std::size_t> all(results.candidates.size());
  std::iota(all.begin(), all.end(), 0);
  comparison.blocks = different_blocks(results, all).size();
  std::vector<Blocks> of_one;
  for (const std::size_t c : all) {
    of_one.push_back(different_blocks(results, {c}));
    comparison.reached.push_back(of_one.back().size());
    comparison.never.push_back(never_measured(results, c));
  }
  // The blocks of a pair need much memory, so one pair at a time has them.
  std::vector<std::vector<Tested>> of_metrics(results.metrics.size());
  for (const auto& [x, y] : pairs_of(results)) {
    const Pair pair{static_cast<Eigen::Index>(x), static_cast<Eigen::Index>(y),
                    different_blocks(results, {x, y}), of_one[x], of_one[y]};
    for (std::size_t metric = 0; metric < results.metrics.size(); ++metric) {
      auto one = compare_metric(results, metric, pair);
      if (one) of_metrics[metric].push_back(*std::move(one));
    }
    comparison.failures.push_back(compare_failures(results, pair));
  }
  set_verdicts(comparison.failures);

  std::vector<SignedRank> tests;  // one for each of comparison.metrics
  for (std::vector<Tested>& of_metric : of_metrics) {
    for (Tested& one : of_metric) {
      comparison.tests += one.comparison.is_test;
      comparison.metrics.push_back(std::move(one.comparison));
      tests.push_back(std::move(one.test));
    }
  }
  const std::vector<double> levels = set_verdicts(comparison.metrics);
  for (std::size_t i = 0; i < tests.size(); ++i) {
    comparison.metrics[i].difference.interval = tests[i].interval(levels[i]);
    comparison.metrics[i].needed = differences_needed(tests[i].share_above(), levels[i]);
  }
  return comparison;
}

}  // namespace breakwater
