// The pages of a study and of a tuning.
#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include <breakwater/experiment/catalogue.h>
#include <breakwater/search/tuning_outputs.h>
#include <breakwater/statistics/ranking.h>
#include <breakwater/study/results.h>
#include <breakwater/study/study_folder.h>

namespace breakwater {

/// Writes DIR/report.html: the ranking, the study, its failures, and each metric with its charts
/// and the comparison of the candidates. For a saltelli design it also writes DIR/indices.csv. The
/// page has less than 2 MB for any number of points. Equal results give equal bytes. Throws
/// OutputError.
void write_study_report(const Catalogue& catalogue, const Plan& plan, const ShardIndex& index,
                        StudyNumbers numbers, const StudyFolder& folder,
                        const std::optional<CandidateComparison>& comparison,
                        const std::optional<Ranking>& ranking);

/// Writes DIR/report.html: the Pareto fronts over the first two objectives, and each point of a
/// front with its file. Throws OutputError.
void write_tuning_report(const Catalogue& catalogue, const TuningPlan& plan,
                         const TuningResult& result, const FrontTable& table,
                         const std::filesystem::path& folder);

/// The result of a tuning for a terminal: with one objective its sentence or ranking, and a table.
std::string tuning_text(const TuningPlan& plan, const FrontTable& table, std::size_t width);

}  // namespace breakwater
