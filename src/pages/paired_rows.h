// A comparison of candidates as rows of a page.
#pragma once

#include <cstddef>
#include <kainjow/mustache.hpp>
#include <string>

#include <breakwater/statistics/paired_comparison.h>

namespace breakwater {

/// Adds what the template shows of one metric's pairs to its section: `pairs`, `ranks`, and whether
/// there are any (`has_pairs`, `has_ranks`).
void add_paired_metric(const CandidateComparison& comparison, const std::string& metric,
                       kainjow::mustache::data& section);

/// A key with whose values the sign of a difference turns, as the section shows it.
kainjow::mustache::data turn_of(const CandidateComparison& comparison, const KeyInteraction& one,
                                Identity look);

/// The same of the failures.
void add_paired_failures(const CandidateComparison& comparison, kainjow::mustache::data& section);

}  // namespace breakwater
