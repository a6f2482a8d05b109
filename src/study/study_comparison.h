// The comparison of a study's candidates.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include <breakwater/statistics/paired_comparison.h>
#include <breakwater/statistics/ranking.h>
#include <breakwater/study/plan.h>
#include <breakwater/study/results.h>

namespace breakwater {

/// The results of a study's candidates, paired by sample and seed. Each row is a test condition
/// that all candidates have finished. Without `metrics` they are those of compare.metrics, or all.
/// Seeds repeat a sample; without varied keys, or with `worlds = "seeds"`, each seed is a block.
/// Equal runs have the same number, failed ones that of number_failed_runs(). Throws
/// std::invalid_argument if the table would be too large for memory.
PairedResults paired_results(const Plan& plan, const StudyNumbers& numbers,
                             const std::vector<std::string>& metrics = {});

/// The number of blocks in a comparison of the candidates, if no run fails. 0: the study compares
/// nothing, since it has one candidate, or more than 20 and no baseline.
std::size_t most_blocks(const Plan& plan);

/// compare_candidates() of them; nothing if the study compares nothing.
std::optional<CandidateComparison> compare_study(const Plan& plan, const StudyNumbers& numbers);

/// rank_candidates() by the first metric with a goal; nothing without a goal, with one candidate or
/// with more than a hundred.
std::optional<Ranking> rank_study(const Plan& plan, const StudyNumbers& numbers);

}  // namespace breakwater
