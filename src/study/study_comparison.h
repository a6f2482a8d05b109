// What a study compares, from its results.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include <breakwater/statistics/paired_comparison.h>
#include <breakwater/study/plan.h>
#include <breakwater/study/shards.h>

namespace breakwater {

/// The candidates of a study, paired by sample and seed: each row is one world that all of them
/// have met. Metrics are those of compare.metrics, or all that any run has. The same runs have the
/// same number. A run that left no state hash is taken for another's repeat where both ended alike
/// and their worlds differ only in keys and seeds that change no outcome of the candidate. Seeds
/// repeat a sample; where no key is varied, and with `worlds = "seeds"`, each is one. Keys that are
/// varied together are one (key_effects()). Throws std::invalid_argument if that is more than
/// memory should hold.
PairedResults paired_results(const Plan& plan, const ShardIndex& index);

/// How many blocks a comparison of its candidates has, if no run fails; 0: the study compares
/// nothing, since it has one candidate, or more than 20 and no baseline.
std::size_t most_blocks(const Plan& plan);

/// compare_candidates() of them; nothing if the study compares nothing.
std::optional<CandidateComparison> compare_study(const Plan& plan, const ShardIndex& index);

struct UnknownMetric {
  std::string place;  ///< where it is asked for: "compare.goal.pea_N"
  std::string meant;  ///< did_you_mean()
};

/// The metrics that compare.metrics or compare.goal name and that are not among `known`.
std::vector<UnknownMetric> unknown_metrics(const Study& study,
                                           const std::vector<std::string>& known);

}  // namespace breakwater
