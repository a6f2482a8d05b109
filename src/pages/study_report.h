// report.html of a study.
#pragma once

#include <optional>

#include <breakwater/experiment/catalogue.h>
#include <breakwater/statistics/paired_comparison.h>
#include <breakwater/study/study_folder.h>

namespace breakwater {

/// Writes DIR/report.html: what the study is, what failed where, and each metric with its charts
/// and, where candidates are compared, what may be said of them.
/// Of a saltelli design also DIR/indices.csv. It has less than 2 MB however many points there are,
/// and the same results give the same bytes. Throws OutputError.
void write_study_report(const Catalogue& catalogue, const Plan& plan, const ShardIndex& index,
                        const StudyFolder& folder,
                        const std::optional<CandidateComparison>& comparison);

}  // namespace breakwater
