#include <breakwater/pages/study_report.h>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include <breakwater/config/toml_text.h>
#include <breakwater/experiment/saved_run.h>
#include <breakwater/pages/html_page.h>
#include <breakwater/pages/labels.h>
#include <breakwater/pages/paired_rows.h>
#include <breakwater/pages/study_sections.h>
#include <breakwater/pictures/staging.h>
#include <breakwater/record/partial_file.h>
#include <breakwater/shell/child_program.h>
#include <breakwater/shell/process.h>
#include <breakwater/shell/table.h>
#include <breakwater/study/ranking_text.h>

namespace breakwater {
namespace {

constexpr std::size_t kMostColumns = 6;       // in the table of all metrics
constexpr std::size_t kMostListedKinds = 30;  // kinds of failures in their table
constexpr std::size_t kMostTurns = 40;        // changes of sign, each with a figure
constexpr std::size_t kMostNamed = 40;        // candidates and keys in the head
constexpr std::size_t kMostOfText = 160;      // letters of a key's values; half of a reason's

std::string cut_to(const std::string& text, std::size_t most) {
  if (text.size() <= most) return text;
  std::size_t end = most;
  while (end > 0 && (static_cast<unsigned char>(text[end]) & 0xC0U) == 0x80U) --end;
  return text.substr(0, end) + " …";
}

std::string method_in_words(const Study& study, std::size_t samples) {
  const std::string drawn = fmt::format(", sampling seed {}", study.sampling_seed);
  switch (study.method) {
    case Method::grid:
      return study.vary.empty()
                 ? "nothing is varied"
                 : number_of(samples, "sample") + ", every combination of the values";
    case Method::list:
      return number_of(samples, "sample") + ", a list";
    case Method::random:
      return number_of(samples, "sample") + ", drawn independently" + drawn;
    case Method::latin_hypercube:
      return number_of(samples, "sample") + ", a Latin hypercube" + drawn;
    case Method::sobol:
      return number_of(samples, "sample") + ", Sobol’ points" + drawn;
    case Method::saltelli:
      return fmt::format("{}, a Saltelli design of {} rows{}", number_of(samples, "sample"),
                         study.samples, drawn);
  }
  return "";
}

std::string seeds_in_words(const Study& study) {
  if (study.seeds.empty()) return "the scenario file’s";
  const bool is_range = study.seeds.back() - study.seeds.front() + 1 == study.seeds.size() &&
                        std::is_sorted(study.seeds.begin(), study.seeds.end());
  if (is_range && study.seeds.size() > 1) {
    return fmt::format("{} to {}, the same for each sample and candidate", study.seeds.front(),
                       study.seeds.back());
  }
  return cut_to(fmt::format("{}", fmt::join(study.seeds, ", ")), kMostOfText);
}

PageData row_of(const std::string& name, const std::string& value) {
  PageData row;
  row["name"] = name;
  row["value"] = value;
  return row;
}

// The facts of the study, one per line.
PageData facts(const Plan& plan, const ShardIndex& index, const std::vector<std::string>& labels) {
  const Study& study = plan.study();
  auto rows = PageData::array();
  rows.push_back(row_of("scenario", study.scenario));
  if (!study.config.empty()) rows.push_back(row_of("scenario file", study.config));
  std::vector<std::string> some(
      labels.begin(),
      labels.begin() + static_cast<std::ptrdiff_t>(std::min(labels.size(), kMostNamed)));
  if (labels.size() > kMostNamed) some.push_back(fmt::format("… ({} in all)", labels.size()));
  rows.push_back(row_of(labels.size() == 1 ? "candidate" : "candidates",
                        fmt::format("{}", fmt::join(some, "; "))));
  for (std::size_t k = 0; k < study.vary.size(); ++k) {
    if (k == kMostNamed) {
      rows.push_back(row_of("varied", fmt::format("… ({} keys in all)", study.vary.size())));
      break;
    }
    const VariedKey& key = study.vary[k];
    std::string values = cut_to(plain_text(key.written), kMostOfText);
    if (key.values.size() > 3) values += fmt::format(" ({} values)", key.values.size());
    rows.push_back(row_of("varied " + key.key, values));
  }
  for (const KeyEffect& effect : key_effects(study)) {
    if (effect.with.empty()) continue;
    rows.push_back(
        row_of("varied together",
               effect.name + ": their effects cannot be told apart, and are shown as one"));
  }
  for (const std::string& set : study.sets) rows.push_back(row_of("set", cut_to(set, kMostOfText)));
  rows.push_back(row_of("samples", method_in_words(study, plan.samples())));
  rows.push_back(row_of("seeds", seeds_in_words(study)));
  rows.push_back(row_of("runs", fmt::format("{} of {}", index.done(), plan.size())));
  return rows;
}

// The parts of the page that depend on the machine or the folder. They stand in one place. The
// page's script reads the command from there.
PageData this_machine(const ShardIndex& index, const std::string& go_on) {
  PageData machine;
  machine["go_on"] = go_on;
  machine["is_unfinished"] = index.done() < index.points();
  if (index.done() == 0) return machine;
  const double cost_s = index.cost_s();
  machine["time"] = fmt::format(
      "{:.1f} {} of processor time, {} s a run", cost_s < 7200.0 ? cost_s : cost_s / 3600.0,
      cost_s < 7200.0 ? "s" : "h", format_number(cost_s / static_cast<double>(index.done())));
  return machine;
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

PageData failure_rows(const StudyNumbers& numbers, const ShardIndex& index,
                      const std::vector<std::string>& labels, RunList& runs) {
  auto rows = PageData::array();
  for (std::size_t i = 0; i < std::min(numbers.failures.size(), kMostListedKinds); ++i) {
    const FailureKind& kind = numbers.failures[i];
    PageData row;
    row["count"] = std::to_string(kind.runs);
    row["status"] = name_of(kind.status);
    row["reason"] = cut_to(kind.reason, 2 * kMostOfText);
    std::vector<std::string> of;
    for (std::size_t c = 0; c < labels.size() && of.size() < kMostColumns; ++c) {
      if (kind.of_candidate[c] > 0)
        of.push_back(fmt::format("{}: {}", labels[c], kind.of_candidate[c]));
    }
    row["candidates"] = fmt::format("{}", fmt::join(of, "; "));
    auto where = PageData::array();
    for (const std::string& text : kind.where) {
      where.push_back({{"text", text}});
    }
    row["where"] = where;
    auto points = PageData::array();
    for (const std::size_t point : kind.first) {
      points.push_back({{"key", index.read(point).key}, {"run", std::to_string(runs.add(point))}});
    }
    row["points"] = points;
    rows.push_back(row);
  }
  return rows;
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

// Adds the keys that change the sign of a difference. `left` is the number of figures that the page
// may still have.
void add_turns(const CandidateComparison& comparison, const std::string& metric,
               const StudySections& sections, std::size_t& left, RunList& runs, PageData& section) {
  auto turns = PageData::array();
  for (const KeyInteraction& one : comparison.interactions) {
    if (one.metric != metric || !one.turns || left == 0) continue;
    turns.push_back(turn_of(comparison, one, sections.look(one.candidate), runs));
    --left;
  }
  section["turns"] = turns;
}

std::string label_of(const std::string& metric) {
  return metric_label_with_unit(metric, unit_of(metric));
}

PageData cells_of(const std::vector<std::string>& texts) {
  auto cells = PageData::array();
  for (const std::string& text : texts) cells.push_back(PageData{{"text", text}});
  return cells;
}

// The sentence and the table that the page begins with.
PageData answer(const Ranking& ranking) {
  const auto table = ranking_table(ranking);
  PageData answer = {{"sentence", ranking_sentence(ranking)}};
  answer["header"] = cells_of(table.front());
  auto rows = PageData::array();
  for (std::size_t i = 1; i < table.size(); ++i) {
    rows.push_back(PageData{{"cells", cells_of(table[i])}});
  }
  answer["rows"] = rows;
  return answer;
}

// The table of all metrics: the median for each of the first candidates.
void add_overview(PageData& page, const StudySections& sections, const StudyNumbers& numbers,
                  const std::vector<std::string>& labels) {
  auto columns = PageData::array();
  const std::size_t shown = std::min(labels.size(), kMostColumns);
  for (std::size_t c = 0; c < shown; ++c) {
    columns.push_back({{"label", labels[c]}});
  }
  auto rows = PageData::array();
  for (std::size_t m = 0; m < numbers.metrics.size(); ++m) {
    const std::vector<QuantileBand> all = sections.by_candidate(m);
    PageData row;
    row["name"] = label_of(numbers.metrics[m]);
    row["about"] = numbers.metrics[m];
    if (m < sections.detail().metrics) row["href"] = fmt::format("metric-{}", m + 1);
    auto cells = PageData::array();
    for (std::size_t c = 0; c < shown; ++c) {
      cells.push_back({{"value", format_number(all[c].median)}});
    }
    row["cells"] = cells;
    rows.push_back(row);
  }
  page["columns"] = columns;
  page["overview"] = rows;
  page["has_overview"] = !numbers.metrics.empty();
  std::string note;
  if (labels.size() > shown) {
    note += fmt::format(" The first {} of {} candidates; each metric’s table has more.", shown,
                        labels.size());
  }
  if (sections.detail().metrics < numbers.metrics.size()) {
    note += fmt::format(" The first {} of {} metrics have charts; results.csv has all.",
                        sections.detail().metrics, numbers.metrics.size());
  }
  page["overview_note"] = note;
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

  PageData page;
  auto toc = PageData::array();
  const auto contents = [&](const std::string& href, const std::string& label) {
    toc.push_back({{"href", href}, {"label", label}});
  };
  const std::string go_on = fmt::format("{} {} {}", own_program_name(), kSweep.command,
                                        shell_word(folder.path().string()));
  page["title"] = "Study of " + study.scenario;
  page["about"] = scenario->summary();
  page["score"] = score(index);
  page["facts"] = facts(plan, index, labels);
  page["machine"] = this_machine(index, go_on);
  page["study"] = study.print();
  if (numbers.is_sample) {
    page["sampled"] = fmt::format(
        "Charts and tables are of {} runs, chosen evenly among the "
        "study’s samples and seeds; failures are counted over all runs.",
        numbers.runs.size());
  }
  contents("study", "Finding");

  auto legend = PageData::array();
  for (std::size_t i = 0; i < sections.drawn().size(); ++i) {
    const std::string& label = labels[sections.drawn()[i]];
    legend.push_back({{"label", label == study.baseline ? label + " (baseline)" : label},
                      {"colour", series_class(sections.look(sections.drawn()[i]))}});
  }
  page["legend"] = legend;
  page["has_legend"] = labels.size() > 1;
  if (labels.size() > sections.drawn().size()) {
    page["not_drawn"] = fmt::format("Charts have {} of {} candidates; tables have more.",
                                    sections.drawn().size(), labels.size());
  }

  auto metrics = PageData::array();
  std::size_t turns_left = kMostTurns;
  for (std::size_t m = 0; m < sections.detail().metrics; ++m) {
    PageData section = sections.section(m);
    if (comparison) {
      add_paired_metric(*comparison, numbers.metrics[m], section);
      add_turns(*comparison, numbers.metrics[m], sections, turns_left, runs, section);
    }
    metrics.push_back(section);
    contents(fmt::format("metric-{}", m + 1), label_of(numbers.metrics[m]));
  }
  page["metrics"] = metrics;
  const bool has_failures = !numbers.failures.empty();
  if (has_failures || study.method == Method::saltelli) {
    PageData failures = sections.section(std::nullopt);
    if (comparison) add_paired_failures(*comparison, failures);
    failures["kinds"] = failure_rows(numbers, index, labels, runs);
    failures["has_kinds"] = has_failures;
    if (numbers.failures.size() > kMostListedKinds) {
      failures["more_kinds"] = fmt::format("{} further kinds, of fewer runs, are not listed.",
                                           numbers.failures.size() - kMostListedKinds);
    }
    page["failures"] = failures;
    contents(kFailuresId, "Failed runs");
  }
  if (!numbers.metrics.empty()) contents("metrics", "All metrics");
  contents("set-up", "Set-up");
  if (ranking) page["answer"] = answer(*ranking);
  add_overview(page, sections, numbers, labels);
  page["toc"] = toc;
  page["runs"] = runs.json(plan, index);
  replace_file(folder.path() / "report.html", html_page("study", page));
}

}  // namespace breakwater
