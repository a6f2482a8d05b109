// The finding of a study, in sentences.
#pragma once

#include <string>

#include <breakwater/statistics/paired_comparison.h>

namespace breakwater {

/// A sentence about a metric: the candidates beside the first reference, the differences with their
/// intervals, and the keys with which a sign turns. "Peak force, filtered, beside proposed-2N:
/// hpfc-2N is larger by 1.07 N (95 %: 0.93 to 1.2)." It is empty for a metric that is not compared.
std::string finding(const CandidateComparison& comparison, const std::string& metric);

}  // namespace breakwater
