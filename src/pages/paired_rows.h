// A comparison of candidates as rows of a page.
#pragma once

#include <cstddef>
#include <string>

#include <breakwater/pages/html_page.h>
#include <breakwater/pages/study_sections.h>
#include <breakwater/statistics/paired_comparison.h>

namespace breakwater {

/// Adds the pairs of one metric to its section: `pairs` and `has_pairs`.
void add_paired_metric(const CandidateComparison& comparison, const std::string& metric,
                       PageData& section);

/// A key whose values change the sign of a difference, for the section.
PageData turn_of(const CandidateComparison& comparison, const KeyInteraction& one, Identity look,
                 RunList& runs);

/// Adds the pairs of the failures, as add_paired_metric() does.
void add_paired_failures(const CandidateComparison& comparison, PageData& section);

}  // namespace breakwater
