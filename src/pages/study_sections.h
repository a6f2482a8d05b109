// The parts of a study's report for each metric.
#pragma once

#include <algorithm>
#include <cstddef>
#include <optional>
#include <string>
#include <unordered_map>
#include <vector>

#include <breakwater/pages/html_page.h>
#include <breakwater/pages/study_numbers.h>

namespace breakwater {

/// Limits that keep the page below 2 MB.
struct StudyDetail {
  std::size_t metrics = 0;  ///< metrics with charts
  std::size_t groups = 24;  ///< per key in a line chart
  std::size_t cells = 900;  ///< per heat map
  std::size_t lines = 240;  ///< single runs; at most half of them failed
};

/// The id of the failures' section.
inline constexpr const char* kFailuresId = "failures";

/// The runs that the marks of a page refer to, each one once.
class RunList {
 public:
  /// Adds a point and returns its index in the list.
  std::size_t add(std::size_t point);
  /// The list for the page's script: "runs" (each with key, candidate, seed and varied values) and
  /// the names of candidates and keys.
  PageData json(const Plan& plan, const ShardIndex& index) const;
  /// A drawing with these marks: "id", and "data" for data/report/study.js.
  PageData drawing(const PageData& data);

 private:
  std::vector<std::size_t> points_;
  std::unordered_map<std::size_t, std::size_t> places_;
  std::size_t drawings_ = 0;
};

/// A block with drawings. `kind` is the class of their place: charts, key-bar or scroll.
PageData drawings(const char* kind, const PageData& all);

/// Makes the sections of one study's metrics.
class StudySections {
 public:
  /// `labels` and `looks` are the names of the candidates. All references must outlive the object.
  StudySections(const Plan& plan, const ShardIndex& index, const StudyNumbers& numbers,
                const std::vector<OutputIndices>& indices, const std::vector<std::string>& labels,
                const std::vector<Identity>& looks, RunList& runs);

  const StudyDetail& detail() const { return detail_; }

  /// The section of a metric, or of the failures without `metric`.
  PageData section(std::optional<std::size_t> metric) const;
  /// The metric over all runs of each candidate.
  std::vector<QuantileBand> by_candidate(std::size_t metric) const;

 private:
  struct Output;  // a metric or the failures
  static std::string title_of(const Output& output);
  std::vector<QuantileBand> bands_of(const Output& output) const;
  PageData line_chart(const Output& output, const KeyGroups& key, bool& has_bands,
                      bool& has_crosses) const;
  void add_legend(PageData& blocks) const;
  void add_line_charts(const Output& output, PageData& blocks) const;
  void add_heat_maps(const Output& output, PageData& blocks) const;
  void add_parallel(const Output& output, PageData& blocks) const;
  void add_indices(const Output& output, PageData& blocks) const;
  void add_candidates(const Output& output, PageData& blocks) const;

  const Plan& plan_;
  const ShardIndex& index_;
  const StudyNumbers& numbers_;
  const std::vector<OutputIndices>& indices_;
  const std::vector<std::string>& labels_;
  const std::vector<Identity>& looks_;
  RunList& runs_;
  StudyDetail detail_;
  std::vector<std::size_t> drawn_;
  std::vector<std::size_t> place_of_;  // by candidate in drawn_; drawn_.size(): not drawn
  std::vector<KeyGroups> keys_;        // for line charts
  std::vector<KeyEffect> effects_;     // one per entry of `keys_`
  std::vector<KeyGroups> sides_;       // for heat maps
  std::vector<std::uint32_t> lines_;   // single runs that did not fail
  std::vector<FailedRun> failed_;
};

}  // namespace breakwater
