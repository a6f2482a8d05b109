// The parts of a study's report that there are for each metric.
#pragma once

#include <algorithm>
#include <cstddef>
#include <kainjow/mustache.hpp>
#include <optional>
#include <string>
#include <unordered_map>
#include <vector>

#include <breakwater/pages/quantile_bands.h>
#include <breakwater/pages/study_charts.h>
#include <breakwater/pages/study_indices.h>
#include <breakwater/pages/study_numbers.h>

namespace breakwater {

/// How much of each thing a page of less than 2 MB has room for.
struct StudyDetail {
  std::size_t metrics = 0;  ///< that have charts
  std::size_t groups = 24;  ///< of a key in a line chart
  std::size_t cells = 900;  ///< of a heat map
  std::size_t lines = 240;  ///< of single runs; at most half of them of such as failed
};

StudyDetail study_detail(const Plan& plan, std::size_t metrics);

/// Where the page has its failures.
inline constexpr const char* kFailuresId = "failures";

/// Whether two keys are crossed: a heat map shows them.
bool has_heat_maps(const Study& study);

/// The runs that marks of a page are about, each once.
class RunList {
 public:
  /// Its place in the list.
  std::size_t add(std::size_t point);
  /// For the page's script: "runs" (each its key, candidate, seed and varied keys' values), and the
  /// names of candidates and keys. Safe within <script>.
  std::string json(const Plan& plan, const ShardIndex& index) const;

 private:
  std::vector<std::size_t> points_;
  std::unordered_map<std::size_t, std::size_t> places_;
};

/// Makes the sections of one study's metrics.
class StudySections {
 public:
  /// `labels` and `looks` are the candidates'. All references must outlive it.
  StudySections(const Plan& plan, const ShardIndex& index, const StudyNumbers& numbers,
                const std::vector<OutputIndices>& indices, const std::vector<std::string>& labels,
                const std::vector<Identity>& looks, RunList& runs);

  /// Which candidates have lines and heat maps, in their colours' order.
  const std::vector<std::size_t>& drawn() const { return drawn_; }
  Identity look(std::size_t candidate) const { return looks_[candidate]; }
  const StudyDetail& detail() const { return detail_; }

  /// What the template shows of a metric; without one, of the failures.
  kainjow::mustache::data section(std::optional<std::size_t> metric) const;
  /// The metric over all runs of each candidate.
  std::vector<QuantileBand> by_candidate(std::size_t metric) const;

 private:
  struct Output;  // a metric, or the failures
  static std::string title_of(const Output& output);
  std::vector<QuantileBand> bands_of(const Output& output) const;
  std::string line_chart(const Output& output, const KeyGroups& key) const;
  void add_heat_maps(const Output& output, kainjow::mustache::data& section) const;
  void add_parallel(const Output& output, kainjow::mustache::data& section) const;
  kainjow::mustache::data index_rows(const Output& output) const;
  kainjow::mustache::data comparison(const Output& output) const;

  const Plan& plan_;
  const ShardIndex& index_;
  const StudyNumbers& numbers_;
  const std::vector<OutputIndices>& indices_;
  const std::vector<std::string>& labels_;
  const std::vector<Identity>& looks_;
  RunList& runs_;
  StudyDetail detail_;
  std::vector<std::size_t> drawn_;
  std::vector<std::size_t> place_of_;  // of a candidate in drawn_; drawn_.size(): it is not drawn
  std::vector<KeyGroups> keys_;        // for lines
  std::vector<KeyEffect> effects_;     // of these
  std::vector<KeyGroups> sides_;       // of heat maps
  std::vector<std::uint32_t> lines_;   // single runs that did not fail
  std::vector<FailedRun> failed_;
};

}  // namespace breakwater
