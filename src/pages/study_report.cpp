#include <breakwater/pages/study_report.h>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <memory>
#include <utility>
#include <vector>

#include <breakwater/pages/html_page.h>
#include <breakwater/pages/page_chart.h>
#include <breakwater/pictures/staging.h>
#include <breakwater/record/partial_file.h>
#include <breakwater/shell/child_program.h>
#include <breakwater/shell/table.h>
#include <breakwater/study/comparison_table.h>

namespace breakwater {
namespace {

// Limits that keep the page below 2 MB.
constexpr std::size_t kMostDrawn = 12;      // candidates, each with a colour or a dash pattern
constexpr std::size_t kMostCompared = 100;  // candidates in a table
constexpr std::size_t kMostMetrics = 60;    // with charts
constexpr std::size_t kRows = 2'000;        // in the tables of candidates
constexpr std::size_t kMarks = 6'000;       // in all charts
constexpr std::size_t kOfAGroup = 8;        // smallest number of samples in a group of a drawn key

std::string range(double low, double high) {
  return in_digits(low) + " to " + in_digits(high);
}

std::string first_of(std::size_t shown, std::size_t all, const char* what) {
  return fmt::format("The first {} of {} {}", shown, all, what);
}

// A summary behind a median: "(0.1 to 0.2), 20 runs, 1 failed", with the 10 and 90 % quantiles.
std::string in_words(const RunGroup& group) {
  std::string text =
      fmt::format("({}), {}", range(group.at(0.1), group.at(0.9)), number_of(group.runs, "run"));
  if (group.failed > 0) text += fmt::format(", {} failed", group.failed);
  const std::size_t absent = group.runs - group.failed - group.values.size();
  if (absent > 0 && !group.values.empty()) text += fmt::format(", {} without it", absent);
  return text;
}

constexpr std::size_t kMostColumns = 6;       // in the table of all metrics
constexpr std::size_t kMostListedKinds = 30;  // kinds of failures in their table
constexpr std::size_t kMostOfReason = 320;    // letters

std::string shortened(const std::string& text) {
  const std::string begin = fmt::format("{:.{}}", text, kMostOfReason);
  return begin.size() == text.size() ? text : begin + " …";
}

// The page of one study. All references must outlive it.
class StudyPage {
 public:
  StudyPage(const Catalogue& catalogue, const Plan& plan, const ShardIndex& index,
            StudyNumbers numbers, const std::optional<CandidateComparison>& comparison)
      : plan_(plan),
        index_(index),
        comparison_(comparison),
        scenario_(make_scenario(catalogue, plan.study().scenario)),
        numbers_(std::move(numbers)) {
    std::vector<std::string> first = plan.study().metrics;
    for (const auto& [metric, goal] : plan.study().goals) first.push_back(metric);
    for (const std::string& metric : scenario_->main_metrics()) first.push_back(metric);
    for (const std::string& metric : scenario_->matrix().metrics) first.push_back(metric);
    put_first(first, numbers_);
    for (const Candidate& candidate : plan.candidates()) labels_.push_back(candidate.label);
    looks_ = candidate_styles(labels_, cases_of(catalogue, plan.study().scenario));
    if (plan.study().method == Method::saltelli) indices_ = study_indices(numbers_, labels_);
    shown_ = std::min(
        {numbers_.metrics.size(), kMostMetrics, kRows / std::min(labels_.size(), kMostCompared)});
    choose_candidates();
    group_keys();
  }

  // The rows of indices.csv; none unless the design is saltelli's.
  const std::vector<ResultRow>& indices() const { return indices_; }

  PageData data(const StudyFolder& folder, const std::optional<Ranking>& ranking) const {
    auto lead = PageData::array(), sections = PageData::array(), set_up = PageData::array();
    add_block(lead, "about", scenario_->summary());
    if (ranking) {
      add_block(lead, "finding", ranking_sentence(*ranking));
      add_block(lead, "table", text_table("Ranking", ranking_table(*ranking)));
      add_block(
          lead, "text",
          "Behind: how much worse than the first, with the interval of its test, after Holm’s "
          "correction. Equal places: no difference is shown. “-”: not ranked. ranking.json has "
          "every pair.");
    }
    add_block(lead, "score", score());
    for (std::size_t m = 0; m < shown_; ++m) add_metric(m, sections);
    if (!numbers_.failures.empty()) add_failures(sections);
    if (!numbers_.metrics.empty()) add_overview(sections);
    add_block(set_up, "machine",
              this_machine(fmt::format("{} {} {}", own_program_name(), kSweep.command,
                                       shell_word(folder.path().string()))));
    add_block(set_up, "code", {{"summary", "Study file"}, {"text", plan_.study().print()}});
    add_section(sections, "set-up", "Set-up", set_up);
    return {
        {"title", "Study of " + plan_.study().scenario}, {"lead", lead}, {"sections", sections}};
  }

 private:
  // The first ones have charts, and the baseline.
  void choose_candidates() {
    for (std::size_t c = 0; c < std::min(labels_.size(), kMostDrawn); ++c) drawn_.push_back(c);
    for (std::size_t c = kMostDrawn; c < labels_.size(); ++c) {
      if (labels_[c] == plan_.study().baseline) drawn_.back() = c;
    }
    place_of_.assign(labels_.size(), drawn_.size());
    for (std::size_t i = 0; i < drawn_.size(); ++i) place_of_[drawn_[i]] = i;
  }

  void group_keys() {
    const std::size_t keys = std::max<std::size_t>(1, numbers_.keys.size());
    const std::size_t groups = std::clamp<std::size_t>(
        kMarks / (std::max<std::size_t>(1, shown_) * drawn_.size() * keys), 5, keys > 1 ? 16 : 40);
    for (std::size_t k = 0; k < numbers_.keys.size(); ++k) {
      const StudyKey& key = numbers_.keys[k];
      const std::size_t enough = std::max<std::size_t>(4, key.values.size() / kOfAGroup);
      const bool is_drawn = plan_.study().vary[k].distribution.has_value();
      keys_.push_back(group_values(key, is_drawn ? std::min(enough, groups) : groups));
    }
  }

  void add_metric(std::size_t metric, PageData& sections) const {
    const std::string& name = numbers_.metrics[metric];
    auto blocks = PageData::array();
    if (labels_.size() > drawn_.size()) {
      add_block(blocks, "text",
                first_of(drawn_.size(), labels_.size(), "candidates") + " have charts.");
    }
    add_line_charts(metric, blocks);
    add_indices(name, blocks);
    add_candidates(metric, blocks);
    add_pairs(name, blocks);
    add_section(sections, fmt::format("metric-{}", metric + 1), name, blocks);
    sections.back()["kind"] = "metric";
  }

  // The metric over all runs of each candidate.
  std::vector<RunGroup> by_candidate(std::size_t metric) const {
    return grouped(numbers_, numbers_.columns.at(numbers_.metrics[metric]), labels_.size(),
                   [](const StudyRun& run) { return run.candidate; });
  }

  void add_indices(const std::string& output, PageData& blocks) const {
    if (indices_.empty()) return;
    const std::vector<std::string> columns = {"key",   "candidate", "first_order",
                                              "total", "rows",      "dropped_rows"};
    std::vector<std::vector<std::string>> rows = {columns};
    for (const ResultRow& row : indices_) {
      if (row.at("output") != output || row.at("total").empty()) continue;
      rows.push_back(row.in(columns));
      for (const std::size_t shown : {2, 3}) rows.back()[shown] = row.shown(columns[shown]);
    }
    add_block(blocks, "subheading", "Sensitivity");
    if (rows.size() > 1) add_block(blocks, "table", text_table("Sensitivity indices", rows));
    add_block(blocks, "text",
              "The share of variance that a key makes alone, and with all its interactions; of "
              "means over seeds, with 95 % intervals. There are none if the metric does not vary, "
              "or fewer than two rows of the design have it. indices.csv has all digits.");
  }

  std::string key_of(std::size_t point) const { return index_.read(point).key; }
  // The run at the median, the lower one of two.
  std::string middle_of(const RunGroup& group) const {
    return key_of(group.points[(group.points.size() - 1) / 2]);
  }

  PageChart line_chart(std::size_t metric, const KeyGroups& key, bool& has_bands,
                       bool& has_crosses) const {
    const std::vector<RunGroup> all =
        grouped(numbers_, numbers_.columns.at(numbers_.metrics[metric]),
                (drawn_.size() + 1) * key.size(), [&](const StudyRun& run) {
                  return place_of_[run.candidate] * key.size() + key.of_sample[run.sample];
                });
    PageChart chart{.title = numbers_.metrics[metric]};
    chart.id = chart.group = fmt::format("chart-{}-{}", metric, &key - keys_.data());
    chart.x_title = key.name;
    chart.is_log_x = key.is_log;
    if (!key.is_number || (!key.is_binned && key.size() <= 8)) {
      for (std::size_t g = 0; g < key.size(); ++g) {
        chart.x_labels.emplace_back(key.centre[g], key.labels[g]);
      }
    }
    double lowest = std::numeric_limits<double>::infinity();
    for (const RunGroup& group : all) lowest = std::fmin(lowest, group.at(0.1));
    for (std::size_t i = 0; i < drawn_.size(); ++i) {
      ChartSeries line{.label = labels_[drawn_[i]], .style = looks_[drawn_[i]], .marks = "dot"};
      ChartSeries crosses{.label = line.label + ", some failed",
                          .style = line.style,
                          .has_line = false,
                          .marks = "cross"};
      for (std::size_t g = 0; g < key.size(); ++g) {
        const RunGroup& group = all[i * key.size() + g];
        if (group.runs == 0) continue;  // not yet
        const auto add = [&](ChartSeries& to, double y, const std::string& text) {
          to.values.times_s.push_back(key.centre[g]);
          to.values.values.push_back(y);
          to.names.push_back(text);
        };
        const double median = group.at(0.5);
        const bool has_any = !group.values.empty();
        add(line, median, in_words(group) + (has_any ? ", run " + middle_of(group) : ""));
        line.low.push_back(group.at(0.1));
        line.high.push_back(group.at(0.9));
        has_bands |= line.low.back() < line.high.back();
        if (group.failed == 0) continue;
        add(crosses,
            has_any                 ? median
            : std::isfinite(lowest) ? lowest
                                    : 0.0,
            fmt::format("({} of {} failed), run {}", group.failed, number_of(group.runs, "run"),
                        key_of(group.first_failed)));
      }
      has_crosses |= !crosses.names.empty();
      chart.series.push_back(std::move(line));
      if (!crosses.names.empty()) chart.series.push_back(std::move(crosses));
    }
    return chart.scaled();
  }

  void add_line_charts(std::size_t metric, PageData& blocks) const {
    auto lines = PageData::array();
    bool has_bands = false, has_crosses = false;
    for (const KeyGroups& key : keys_) {
      lines.push_back(figure_of(line_chart(metric, key, has_bands, has_crosses)));
    }
    if (lines.empty()) return;
    add_block(blocks, "figures", lines);
    add_block(blocks, "text",
              fmt::format("A mark is the median of the runs with this value.{}{} It names the "
                          "nearest run for --replay.",
                          has_bands ? " The band has the runs from 10 to 90 %." : "",
                          has_crosses ? " A cross: some of the runs failed." : ""));
  }

  void add_candidates(std::size_t metric, PageData& blocks) const {
    const std::vector<RunGroup> all = by_candidate(metric);
    const PageData columns = {"candidate", "runs",       "failed",   "without it", "median",
                              "quartiles", "10 to 90 %", "smallest", "largest"};
    auto rows = PageData::array();
    for (std::size_t c = 0; c < std::min(all.size(), kMostCompared); ++c) {
      const RunGroup& group = all[c];
      PageData row = {labels_[c],
                      group.runs,
                      {{"value", group.failed}, {"tone", group.failed > 0 ? "off" : ""}},
                      group.runs - group.failed - group.values.size()};
      if (!group.values.empty()) {
        const auto run = [](double value, const std::string& key) -> PageData {
          return {{"value", value}, {"tip", key}};
        };
        row.insert(row.end(),
                   {run(group.at(0.5), middle_of(group)), range(group.at(0.25), group.at(0.75)),
                    range(group.at(0.1), group.at(0.9)),
                    run(group.values.front(), key_of(group.points.front())),
                    run(group.values.back(), key_of(group.points.back()))});
      }
      while (row.size() < columns.size()) row.push_back(nullptr);
      rows.push_back(row);
    }
    add_block(blocks, "subheading", "Candidates");
    add_block(blocks, "table",
              {{"label", "Candidates"},
               {"kind", "numbers candidates"},
               {"columns", columns},
               {"rows", rows}});
    if (labels_.size() > kMostCompared) {
      add_block(blocks, "text",
                first_of(kMostCompared, labels_.size(), "candidates") + "; results.csv has all.");
    }
  }

  // The parts of the page that depend on the machine or the folder. They stand in one place.
  PageData this_machine(const std::string& go_on) const {
    auto blocks = PageData::array();
    if (index_.done() > 0) {
      const double cost_s = index_.cost_s();
      add_block(blocks, "text",
                fmt::format("{} of processor time, {} s a run.", duration_text(cost_s),
                            in_digits(cost_s / static_cast<double>(index_.done()))));
    }
    if (index_.done() < index_.points()) {
      add_block(blocks, "paragraph", "Not all runs are done. This goes on:");
      add_block(blocks, "command", go_on);
    }
    add_block(blocks, "paragraph",
              "One run again, with its log, in a folder of its own; POINT is what the charts and "
              "tables name:");
    add_block(blocks, "command", go_on + " --replay POINT");
    return {{"blocks", blocks}};
  }

  PageData score() const {
    auto tallies = PageData::array();
    const auto add = [&](const std::string& kind, std::size_t count, const std::string& word) {
      tallies.push_back({{"kind", kind}, {"count", std::to_string(count)}, {"word", word}});
    };
    add("good", index_.count(PointStatus::complete),
        fmt::format("of {} {}", number_of(index_.points(), "run"), name_of(PointStatus::complete)));
    for (const auto status : {PointStatus::failed, PointStatus::refused, PointStatus::crashed}) {
      if (index_.count(status) > 0) add("off", index_.count(status), name_of(status));
    }
    if (index_.done() < index_.points())
      add("unknown", index_.points() - index_.done(), "not yet run");
    return tallies;
  }

  // The kinds of failures.
  void add_failures(PageData& sections) const {
    auto blocks = PageData::array();
    std::vector<std::vector<std::string>> rows = {{"runs", "status", "reason", "of", "points"}};
    for (const FailureKind& kind : numbers_.failures) {
      if (rows.size() > kMostListedKinds) break;
      std::vector<std::string> of, points;
      for (std::size_t c = 0; c < labels_.size() && of.size() < kMostColumns; ++c) {
        if (kind.of_candidate[c] > 0)
          of.push_back(fmt::format("{}: {}", labels_[c], kind.of_candidate[c]));
      }
      for (const std::size_t point : kind.first) points.push_back(index_.read(point).key);
      rows.push_back({std::to_string(kind.runs), name_of(kind.status), shortened(kind.reason),
                      fmt::format("{}", fmt::join(of, "; ")),
                      fmt::format("{}", fmt::join(points, " "))});
    }
    PageData table = text_table("Kinds of failures", rows);
    table["kind"] = "kinds";
    add_block(blocks, "table", table);
    if (numbers_.failures.size() > kMostListedKinds) {
      add_block(blocks, "text",
                fmt::format("{} further kinds, of fewer runs, are not listed.",
                            numbers_.failures.size() - kMostListedKinds));
    }
    add_indices(kFailedOutput, blocks);
    add_pairs(kFailure, blocks);
    add_section(sections, "failures", "Failed runs", blocks);
  }

  // The pairs of one metric, or of the failures.
  void add_pairs(const std::string& metric, PageData& blocks) const {
    if (!comparison_) return;
    const auto rows = comparison_table(*comparison_, metric);
    if (rows.size() == 1) return;
    add_block(blocks, "subheading", "Paired, in the same worlds");
    add_block(blocks, "table", text_table("Paired comparison", rows));
    std::string text =
        "“No difference shown” is not “equal”. comparison.csv has all digits, and "
        "docs/how-to/comparing.md says what the columns are. Holm’s correction is over all metrics "
        "and pairs of this study.";
    for (const std::string& note : comparison_notes(*comparison_)) text += " " + note + ".";
    add_block(blocks, "text", text);
  }

  // The table of all metrics: the median for each of the first candidates.
  void add_overview(PageData& sections) const {
    const std::size_t shown = std::min(labels_.size(), kMostColumns);
    PageData columns = {"metric"};
    for (std::size_t c = 0; c < shown; ++c) columns.push_back(labels_[c]);
    auto rows = PageData::array();
    for (std::size_t m = 0; m < numbers_.metrics.size(); ++m) {
      const std::vector<RunGroup> all = by_candidate(m);
      PageData name = {{"value", numbers_.metrics[m]}};
      if (m < shown_) name["href"] = fmt::format("metric-{}", m + 1);
      rows.push_back(PageData::array({name}));
      for (std::size_t c = 0; c < shown; ++c) rows.back().push_back(all[c].at(0.5));
    }
    std::string note = "Medians over all runs of a candidate.";
    if (labels_.size() > shown) {
      note += " " + first_of(shown, labels_.size(), "candidates; each metric’s table has more.");
    }
    if (shown_ < numbers_.metrics.size()) {
      note += " " + first_of(shown_, numbers_.metrics.size(),
                             "metrics have charts; results.csv has all.");
    }
    auto blocks = PageData::array();
    add_block(blocks, "text", note);
    add_block(blocks, "table", {{"label", "All metrics"}, {"columns", columns}, {"rows", rows}});
    add_section(sections, "metrics", "All metrics", blocks);
  }

  const Plan& plan_;
  const ShardIndex& index_;
  const std::optional<CandidateComparison>& comparison_;
  std::unique_ptr<Scenario> scenario_;
  StudyNumbers numbers_;
  std::vector<std::string> labels_;  // names of the candidates
  std::vector<LineStyle> looks_;
  std::vector<ResultRow> indices_;
  std::size_t shown_ = 0;  // the number of metrics with charts
  std::vector<std::size_t> drawn_;
  std::vector<std::size_t> place_of_;  // by candidate in drawn_; drawn_.size(): not drawn
  std::vector<KeyGroups> keys_;        // for line charts
};

}  // namespace

void write_study_report(const Catalogue& catalogue, const Plan& plan, const ShardIndex& index,
                        StudyNumbers numbers, const StudyFolder& folder,
                        const std::optional<CandidateComparison>& comparison,
                        const std::optional<Ranking>& ranking) {
  const StudyPage page(catalogue, plan, index, std::move(numbers), comparison);
  if (!page.indices().empty())
    replace_file(folder.path() / "indices.csv", csv_table(page.indices()));
  replace_file(folder.path() / "report.html", html_page("study", page.data(folder, ranking)));
}

}  // namespace breakwater
