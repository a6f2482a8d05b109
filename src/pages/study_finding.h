// What a study found, in sentences.
#pragma once

#include <string>

#include <breakwater/statistics/paired_comparison.h>

namespace breakwater {

/// Who is smaller or larger in a metric than the first reference that it is compared with, by how
/// much and how sure, and where the sign turns: "Peak force, filtered: hpfc-2N is larger than
/// proposed-2N by 1.07 N (95 %: 0.93 to 1.2). …". Empty for a metric that is not compared.
std::string finding(const CandidateComparison& comparison, const std::string& metric);

}  // namespace breakwater
