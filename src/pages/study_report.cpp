#include <breakwater/pages/study_report.h>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include <breakwater/experiment/saved_run.h>
#include <breakwater/pages/html_page.h>
#include <breakwater/pages/labels.h>
#include <breakwater/pages/study_sections.h>
#include <breakwater/pictures/staging.h>
#include <breakwater/record/partial_file.h>
#include <breakwater/shell/child_program.h>
#include <breakwater/shell/digits.h>
#include <breakwater/shell/process.h>
#include <breakwater/shell/table.h>
#include <breakwater/study/comparison_table.h>
#include <breakwater/study/ranking_text.h>

namespace breakwater {
namespace {

constexpr std::size_t kMostColumns = 6;       // in the table of all metrics
constexpr std::size_t kMostListedKinds = 30;  // kinds of failures in their table
constexpr std::size_t kMostOfReason = 320;    // letters

std::string shortened(const std::string& text) {
  if (text.size() <= kMostOfReason) return text;
  std::size_t end = kMostOfReason;
  while (end > 0 && (static_cast<unsigned char>(text[end]) & 0xC0U) == 0x80U) --end;
  return text.substr(0, end) + " …";
}

// The parts of the page that depend on the machine or the folder. They stand in one place. The
// page's script reads the command from there.
PageData this_machine(const ShardIndex& index, const std::string& go_on) {
  auto blocks = PageData::array();
  if (index.done() > 0) {
    const double cost_s = index.cost_s();
    add_block(blocks, "text",
              fmt::format("{:.1f} {} of processor time, {} s a run.",
                          cost_s < 7200.0 ? cost_s : cost_s / 3600.0, cost_s < 7200.0 ? "s" : "h",
                          in_digits(cost_s / static_cast<double>(index.done()))));
  }
  if (index.done() < index.points()) {
    add_block(blocks, "paragraph", "Not all runs are done. This goes on:");
    add_block(blocks, "command", go_on);
  }
  add_block(blocks, "paragraph",
            "One run again, with its log, in a folder of its own; POINT is what the charts and "
            "tables name:");
  add_block(blocks, "command", go_on + " --replay POINT");
  return {{"go_on", go_on}, {"blocks", blocks}};
}

PageData score(const ShardIndex& index) {
  auto tallies = PageData::array();
  const auto add = [&](const std::string& kind, std::size_t count, const std::string& word) {
    tallies.push_back({{"kind", kind}, {"count", std::to_string(count)}, {"word", word}});
  };
  add("good", index.count(PointStatus::complete),
      fmt::format("of {} {}", number_of(index.points(), "run"), name_of(PointStatus::complete)));
  for (const auto status : {PointStatus::failed, PointStatus::refused, PointStatus::crashed}) {
    if (index.count(status) > 0) add("off", index.count(status), name_of(status));
  }
  if (index.done() < index.points()) add("unknown", index.points() - index.done(), "not yet run");
  return tallies;
}

// The kinds of failures, before the section's charts.
PageData failure_blocks(const StudyNumbers& numbers, const ShardIndex& index,
                        const std::vector<std::string>& labels, RunList& runs) {
  auto blocks = PageData::array();
  if (numbers.failures.empty()) {
    add_block(blocks, "paragraph", "No run failed.");
    return blocks;
  }
  auto rows = PageData::array();
  for (std::size_t i = 0; i < std::min(numbers.failures.size(), kMostListedKinds); ++i) {
    const FailureKind& kind = numbers.failures[i];
    std::vector<std::string> of;
    for (std::size_t c = 0; c < labels.size() && of.size() < kMostColumns; ++c) {
      if (kind.of_candidate[c] > 0)
        of.push_back(fmt::format("{}: {}", labels[c], kind.of_candidate[c]));
    }
    auto points = PageData::array(), where = PageData::array(), what = PageData::array();
    what.push_back({{"text", shortened(kind.reason)}, {"kind", ""}});
    what.push_back({{"text", fmt::format("{}", fmt::join(of, "; "))}, {"kind", "spread"}});
    for (const std::string& text : kind.where) where.push_back({{"text", text}, {"kind", ""}});
    for (const std::size_t point : kind.first) {
      points.push_back(
          {{"text", index.read(point).key}, {"kind", "code"}, {"run", runs.add(point)}});
    }
    const auto lines = [](const std::string& value, const PageData& list) {
      return PageData{{"value", value}, {"lines", list}};
    };
    rows.push_back(PageData::array({std::to_string(kind.runs), lines(name_of(kind.status), what),
                                    lines("", where), lines("", points)}));
  }
  add_block(blocks, "table",
            {{"label", "Kinds of failures"},
             {"kind", "kinds"},
             {"columns", {"runs", "what", "where", "points"}},
             {"rows", rows}});
  if (numbers.failures.size() > kMostListedKinds) {
    add_block(blocks, "text",
              fmt::format("{} further kinds, of fewer runs, are not listed.",
                          numbers.failures.size() - kMostListedKinds));
  }
  add_block(blocks, "subheading", "Share of runs that failed");
  return blocks;
}

// Whether a varied key changes a metric of any candidate, with the same seed. Less than this part
// of the value is no change that a chart shows.
bool is_varying(const StudyNumbers& numbers, const std::vector<double>& column) {
  constexpr double kLeast = 1e-3;
  std::map<std::pair<std::uint32_t, std::uint32_t>, double> first;
  for (std::size_t i = 0; i < numbers.runs.size(); ++i) {
    const StudyRun& run = numbers.runs[i];
    if (!std::isfinite(column[i])) continue;
    const double value = first.try_emplace({run.candidate, run.seed}, column[i]).first->second;
    if (std::abs(column[i] - value) > kLeast * std::abs(value)) return true;
  }
  return false;
}

// Puts the first of `keys` that varies before the others: a page that begins with a flat line says
// little. Where all are flat, the order stays.
void begin_with_varying(StudyNumbers& numbers, const std::vector<std::string>& keys) {
  for (const std::string& key : keys) {
    const auto place = std::find(numbers.metrics.begin(), numbers.metrics.end(), key);
    if (place == numbers.metrics.end()) continue;
    const auto at = place - numbers.metrics.begin();
    const auto column = numbers.columns.begin() + at;
    if (!is_varying(numbers, *column)) continue;
    std::rotate(numbers.metrics.begin(), place, place + 1);
    std::rotate(numbers.columns.begin(), column, column + 1);
    return;
  }
}

std::string label_of(const std::string& metric) {
  return metric_label_with_unit(metric, unit_of(metric));
}

// The pairs of one metric, or of the failures.
void add_pairs(const CandidateComparison& comparison, const PageData& pairs,
               const std::string& metric, PageData& blocks) {
  const bool is_failure = metric == kFailure;
  // The verdict comes first, and the metric is that of the section.
  const auto arranged = [](PageData row) {
    std::rotate(row.begin() + 3, row.end() - 1, row.end());
    row.erase(0);
    return row;
  };
  PageData table = {{"label", pairs["label"]},
                    {"columns", arranged(pairs["columns"])},
                    {"rows", PageData::array()}};
  if (is_failure) std::ranges::replace(table["columns"], PageData("median"), PageData("failed"));
  for (const PageData& row : pairs["rows"]) {
    if (row[0] == metric) table["rows"].push_back(arranged(row));
  }
  if (table["rows"].empty()) return;
  add_block(blocks, "subheading", "Paired, in the same worlds");
  add_block(blocks, "table", table);
  add_block(
      blocks, "text",
      fmt::format(
          "{} “No difference shown” is not “equal”. comparison.csv has all digits. {}.",
          is_failure
              ? "Alone: blocks in which more of its runs failed than of the other’s. p: McNemar’s "
                "exact test of these blocks, with Holm’s correction over all pairs."
              : "A block is one combination of the varied keys, and its seeds repeat it. The "
                "median over the seeds of a block counts; medians, 95 % intervals and tests are "
                "over blocks. p: Wilcoxon’s signed-rank test of the differences. Holm’s correction "
                "is over all metrics and pairs of this study; the ranking above corrects over its "
                "own pairs. The difference is the pseudo-median, and its interval belongs to the "
                "test: it excludes 0 where p ≤ 0.05.",
          fmt::join(comparison_notes(comparison), ". ")));
}

// The table of all metrics: the median for each of the first candidates.
PageData overview(const StudySections& sections, const StudyNumbers& numbers,
                  const std::vector<std::string>& labels) {
  const std::size_t shown = std::min(labels.size(), kMostColumns);
  PageData columns = {"metric"};
  for (std::size_t c = 0; c < shown; ++c) columns.push_back(labels[c]);
  auto rows = PageData::array();
  for (std::size_t m = 0; m < numbers.metrics.size(); ++m) {
    const std::vector<QuantileBand> all = sections.by_candidate(m);
    PageData name = {{"value", label_of(numbers.metrics[m])}, {"tip", numbers.metrics[m]}};
    if (m < sections.detail().metrics) name["href"] = fmt::format("metric-{}", m + 1);
    rows.push_back(PageData::array({name}));
    for (std::size_t c = 0; c < shown; ++c) rows.back().push_back(all[c].median);
  }
  std::string note = "Medians over all runs of a candidate.";
  if (labels.size() > shown) {
    note += fmt::format(" The first {} of {} candidates; each metric’s table has more.", shown,
                        labels.size());
  }
  if (sections.detail().metrics < numbers.metrics.size()) {
    note += fmt::format(" The first {} of {} metrics have charts; results.csv has all.",
                        sections.detail().metrics, numbers.metrics.size());
  }
  auto blocks = PageData::array();
  add_block(blocks, "text", note);
  add_block(blocks, "table", {{"label", "All metrics"}, {"columns", columns}, {"rows", rows}});
  return {{"id", "metrics"}, {"heading", "All metrics"}, {"blocks", blocks}};
}

}  // namespace

void write_study_report(const Catalogue& catalogue, const Plan& plan, const ShardIndex& index,
                        const StudyFolder& folder,
                        const std::optional<CandidateComparison>& comparison,
                        const std::optional<Ranking>& ranking) {
  const Study& study = plan.study();
  const auto scenario = make_scenario(catalogue, study.scenario);
  std::vector<std::string> first = study.named_metrics();
  for (const std::string& metric : scenario->main_metrics()) first.push_back(metric);
  for (const std::string& metric : scenario->matrix().metrics) first.push_back(metric);
  StudyNumbers numbers = study_numbers(plan, index, first);
  if (study.named_metrics().empty()) begin_with_varying(numbers, scenario->main_metrics());
  std::vector<std::string> labels;
  for (const Candidate& candidate : plan.candidates()) labels.push_back(candidate.label);
  std::vector<OutputIndices> indices;
  if (study.method == Method::saltelli) {
    indices = study_indices(numbers, labels.size());
    write_indices(indices, numbers, labels, folder.path() / "indices.csv");
  }
  RunList runs;
  const std::vector<Identity> looks =
      candidate_identities(labels, cases_of(catalogue, study.scenario));
  const StudySections sections(plan, index, numbers, indices, labels, looks, runs);

  auto toc = PageData::array(), lead = PageData::array(), all = PageData::array();
  const auto contents = [&](const std::string& href, const std::string& label) {
    toc.push_back({{"href", href}, {"label", label}});
  };
  contents("content", "Finding");
  add_block(lead, "about", scenario->summary());
  if (ranking) {
    add_block(lead, "finding", ranking_sentence(*ranking));
    add_block(lead, "table", text_table("Ranking", ranking_table(*ranking)));
    add_block(lead, "text",
              "Behind: how much worse than the first, the pseudo-median over the conditions that "
              "both have, with the interval of its signed-rank test. p and interval: with Holm’s "
              "correction over all pairs of ranked candidates. Equal places: no difference is "
              "shown. “-”: not ranked. ranking.json has every pair.");
  }
  add_block(lead, "score", score(index));

  const PageData pairs = comparison ? comparison_pairs(*comparison) : PageData();
  for (std::size_t m = 0; m < sections.detail().metrics; ++m) {
    const std::string& metric = numbers.metrics[m];
    PageData section = sections.section(m);
    if (comparison) add_pairs(*comparison, pairs, metric, section["blocks"]);
    contents(section["id"], section["heading"]);
    all.push_back(std::move(section));
  }
  if (!numbers.failures.empty() || study.method == Method::saltelli) {
    PageData section = sections.section(std::nullopt);
    PageData blocks = failure_blocks(numbers, index, labels, runs);
    blocks.insert(blocks.end(), section["blocks"].begin(), section["blocks"].end());
    if (comparison) add_pairs(*comparison, pairs, kFailure, blocks);
    section["blocks"] = blocks;
    contents(section["id"], section["heading"]);
    all.push_back(std::move(section));
  }
  if (!numbers.metrics.empty()) {
    contents("metrics", "All metrics");
    all.push_back(overview(sections, numbers, labels));
  }
  contents("set-up", "Set-up");
  auto set_up = PageData::array(), last = PageData::array();
  for (const KeyEffect& effect : key_effects(study)) {
    if (effect.with.empty()) continue;
    add_block(set_up, "text",
              effect.name + ": their effects cannot be told apart, and are shown as one.");
  }
  if (numbers.is_sample) {
    add_block(set_up, "text",
              fmt::format("Charts and tables are of {} runs, chosen evenly among the study’s "
                          "samples and seeds; failures are counted over all runs.",
                          numbers.runs.size()));
  }
  add_block(set_up, "machine",
            this_machine(index, fmt::format("{} {} {}", own_program_name(), kSweep.command,
                                            shell_word(folder.path().string()))));
  add_block(set_up, "code", {{"summary", "Study file"}, {"text", study.print()}});
  add_block(last, "fold", {{"id", "set-up"}, {"summary", "Set-up"}, {"blocks", set_up}});
  all.push_back({{"id", "study"}, {"blocks", last}});
  replace_file(folder.path() / "report.html",
               html_page("study", {{"title", "Study of " + study.scenario},
                                   {"lead", lead},
                                   {"sections", all},
                                   {"toc", toc},
                                   {"runs", runs.json(plan, index)}}));
}

}  // namespace breakwater
