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
#include <breakwater/pages/svg_plot.h>
#include <breakwater/pictures/staging.h>
#include <breakwater/record/partial_file.h>
#include <breakwater/shell/child_program.h>
#include <breakwater/shell/process.h>
#include <breakwater/shell/table.h>
#include <breakwater/study/ranking_text.h>

namespace breakwater {
namespace mustache = kainjow::mustache;
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

mustache::data row_of(const std::string& name, const std::string& value) {
  mustache::data row;
  row.set("name", name);
  row.set("value", value);
  return row;
}

// The facts of the study, one per line.
mustache::data facts(const Plan& plan, const ShardIndex& index,
                     const std::vector<std::string>& labels) {
  const Study& study = plan.study();
  mustache::data rows(mustache::data::type::list);
  rows << row_of("scenario", study.scenario);
  if (!study.config.empty()) rows << row_of("scenario file", study.config);
  std::vector<std::string> some(
      labels.begin(),
      labels.begin() + static_cast<std::ptrdiff_t>(std::min(labels.size(), kMostNamed)));
  if (labels.size() > kMostNamed) some.push_back(fmt::format("… ({} in all)", labels.size()));
  rows << row_of(labels.size() == 1 ? "candidate" : "candidates",
                 fmt::format("{}", fmt::join(some, "; ")));
  for (std::size_t k = 0; k < study.vary.size(); ++k) {
    if (k == kMostNamed) {
      rows << row_of("varied", fmt::format("… ({} keys in all)", study.vary.size()));
      break;
    }
    const VariedKey& key = study.vary[k];
    std::string values = cut_to(plain_text(key.written), kMostOfText);
    if (key.values.size() > 3) values += fmt::format(" ({} values)", key.values.size());
    rows << row_of("varied " + key.key, values);
  }
  for (const KeyEffect& effect : key_effects(study)) {
    if (effect.with.empty()) continue;
    rows << row_of("varied together",
                   effect.name + ": their effects cannot be told apart, and are shown as one");
  }
  for (const std::string& set : study.sets) rows << row_of("set", cut_to(set, kMostOfText));
  rows << row_of("samples", method_in_words(study, plan.samples()));
  rows << row_of("seeds", seeds_in_words(study));
  rows << row_of("runs", fmt::format("{} of {}", index.done(), plan.size()));
  return rows;
}

// The parts of the page that depend on the machine or the folder. They stand in one place. The
// page's script reads the command from there.
mustache::data this_machine(const ShardIndex& index, const std::string& go_on) {
  mustache::data machine;
  machine.set("go_on", go_on);
  machine.set("is_unfinished", index.done() < index.points());
  if (index.done() == 0) return machine;
  const double cost_s = index.cost_s();
  machine.set("time",
              fmt::format("{:.1f} {} of processor time, {} s a run",
                          cost_s < 7200.0 ? cost_s : cost_s / 3600.0, cost_s < 7200.0 ? "s" : "h",
                          format_number(cost_s / static_cast<double>(index.done()))));
  return machine;
}

mustache::data score(const ShardIndex& index) {
  mustache::data tallies(mustache::data::type::list);
  const auto add = [&](const std::string& kind, std::size_t count, const std::string& word) {
    mustache::data tally;
    tally.set("kind", kind);
    tally.set("count", std::to_string(count));
    tally.set("word", word);
    tallies << tally;
  };
  add("good", index.count(PointStatus::complete),
      fmt::format("of {} {}", number_of(index.points(), "run"), name_of(PointStatus::complete)));
  for (const auto status : {PointStatus::failed, PointStatus::refused, PointStatus::crashed}) {
    if (index.count(status) > 0) add("off", index.count(status), name_of(status));
  }
  if (index.done() < index.points()) add("unknown", index.points() - index.done(), "not yet run");
  return tallies;
}

mustache::data failure_rows(const StudyNumbers& numbers, const ShardIndex& index,
                            const std::vector<std::string>& labels, RunList& runs) {
  mustache::data rows(mustache::data::type::list);
  for (std::size_t i = 0; i < std::min(numbers.failures.size(), kMostListedKinds); ++i) {
    const FailureKind& kind = numbers.failures[i];
    mustache::data row;
    row.set("count", std::to_string(kind.runs));
    row.set("status", name_of(kind.status));
    row.set("reason", cut_to(kind.reason, 2 * kMostOfText));
    std::vector<std::string> of;
    for (std::size_t c = 0; c < labels.size() && of.size() < kMostColumns; ++c) {
      if (kind.of_candidate[c] > 0)
        of.push_back(fmt::format("{}: {}", labels[c], kind.of_candidate[c]));
    }
    row.set("candidates", fmt::format("{}", fmt::join(of, "; ")));
    mustache::data where(mustache::data::type::list);
    for (const std::string& text : kind.where) {
      mustache::data one;
      one.set("text", text);
      where << one;
    }
    row.set("where", where);
    mustache::data points(mustache::data::type::list);
    for (const std::size_t point : kind.first) {
      mustache::data one;
      one.set("key", index.read(point).key);
      one.set("run", std::to_string(runs.add(point)));
      points << one;
    }
    row.set("points", points);
    rows << row;
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
               const StudySections& sections, std::size_t& left, mustache::data& section) {
  mustache::data turns(mustache::data::type::list);
  for (const KeyInteraction& one : comparison.interactions) {
    if (one.metric != metric || !one.turns || left == 0) continue;
    turns << turn_of(comparison, one, sections.look(one.candidate));
    --left;
  }
  section.set("turns", turns);
}

std::string label_of(const std::string& metric) {
  return metric_label_with_unit(metric, unit_of(metric));
}

mustache::data cells_of(const std::vector<std::string>& texts) {
  mustache::data cells(mustache::data::type::list);
  for (const std::string& text : texts) cells << mustache::data("text", text);
  return cells;
}

// The sentence and the table that the page begins with.
mustache::data answer(const Ranking& ranking) {
  const auto table = ranking_table(ranking);
  mustache::data answer("sentence", ranking_sentence(ranking));
  answer.set("header", cells_of(table.front()));
  mustache::data rows(mustache::data::type::list);
  for (std::size_t i = 1; i < table.size(); ++i) {
    rows << mustache::data("cells", cells_of(table[i]));
  }
  answer.set("rows", rows);
  return answer;
}

// The table of all metrics: the median for each of the first candidates.
void add_overview(mustache::data& page, const StudySections& sections, const StudyNumbers& numbers,
                  const std::vector<std::string>& labels) {
  mustache::data columns(mustache::data::type::list);
  const std::size_t shown = std::min(labels.size(), kMostColumns);
  for (std::size_t c = 0; c < shown; ++c) {
    mustache::data column;
    column.set("label", labels[c]);
    columns << column;
  }
  mustache::data rows(mustache::data::type::list);
  for (std::size_t m = 0; m < numbers.metrics.size(); ++m) {
    const std::vector<QuantileBand> all = sections.by_candidate(m);
    mustache::data row;
    row.set("name", label_of(numbers.metrics[m]));
    row.set("about", numbers.metrics[m]);
    if (m < sections.detail().metrics) row.set("href", fmt::format("metric-{}", m + 1));
    mustache::data cells(mustache::data::type::list);
    for (std::size_t c = 0; c < shown; ++c) {
      mustache::data cell;
      cell.set("value", format_number(all[c].median));
      cells << cell;
    }
    row.set("cells", cells);
    rows << row;
  }
  page.set("columns", columns);
  page.set("overview", rows);
  page.set("has_overview", !numbers.metrics.empty());
  std::string note;
  if (labels.size() > shown) {
    note += fmt::format(" The first {} of {} candidates; each metric’s table has more.", shown,
                        labels.size());
  }
  if (sections.detail().metrics < numbers.metrics.size()) {
    note += fmt::format(" The first {} of {} metrics have charts; results.csv has all.",
                        sections.detail().metrics, numbers.metrics.size());
  }
  page.set("overview_note", note);
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

  mustache::data page;
  mustache::data toc(mustache::data::type::list);
  const auto contents = [&](const std::string& href, const std::string& label) {
    mustache::data entry;
    entry.set("href", href);
    entry.set("label", label);
    toc << entry;
  };
  const std::string go_on = fmt::format("{} {} {}", own_program_name(), kSweep.command,
                                        shell_word(folder.path().string()));
  page.set("title", "Study of " + study.scenario);
  page.set("about", scenario->summary());
  page.set("score", score(index));
  page.set("facts", facts(plan, index, labels));
  page.set("machine", this_machine(index, go_on));
  page.set("study", study.print());
  if (numbers.is_sample) {
    page.set("sampled",
             fmt::format("Charts and tables are of {} runs, chosen evenly among the "
                         "study’s samples and seeds; failures are counted over all runs.",
                         numbers.runs.size()));
  }
  contents("study", "Finding");

  mustache::data legend(mustache::data::type::list);
  for (std::size_t i = 0; i < sections.drawn().size(); ++i) {
    const std::string& label = labels[sections.drawn()[i]];
    mustache::data one;
    one.set("label", label == study.baseline ? label + " (baseline)" : label);
    one.set("colour", series_class(sections.look(sections.drawn()[i])));
    legend << one;
  }
  page.set("legend", legend);
  page.set("has_legend", labels.size() > 1);
  if (labels.size() > sections.drawn().size()) {
    page.set("not_drawn", fmt::format("Charts have {} of {} candidates; tables have more.",
                                      sections.drawn().size(), labels.size()));
  }

  mustache::data metrics(mustache::data::type::list);
  std::size_t turns_left = kMostTurns;
  for (std::size_t m = 0; m < sections.detail().metrics; ++m) {
    mustache::data section = sections.section(m);
    if (comparison) {
      add_paired_metric(*comparison, numbers.metrics[m], section);
      add_turns(*comparison, numbers.metrics[m], sections, turns_left, section);
    }
    metrics << section;
    contents(fmt::format("metric-{}", m + 1), label_of(numbers.metrics[m]));
  }
  page.set("metrics", metrics);
  page.set("has_metrics", sections.detail().metrics > 0);
  const bool has_failures = !numbers.failures.empty();
  if (has_failures || study.method == Method::saltelli) {
    mustache::data failures = sections.section(std::nullopt);
    if (comparison) add_paired_failures(*comparison, failures);
    failures.set("kinds", failure_rows(numbers, index, labels, runs));
    failures.set("has_kinds", has_failures);
    if (numbers.failures.size() > kMostListedKinds) {
      failures.set("more_kinds", fmt::format("{} further kinds, of fewer runs, are not listed.",
                                             numbers.failures.size() - kMostListedKinds));
    }
    page.set("failures", failures);
    contents(kFailuresId, "Failed runs");
  }
  if (!numbers.metrics.empty()) contents("metrics", "All metrics");
  contents("set-up", "Set-up");
  if (ranking) page.set("answer", answer(*ranking));
  add_overview(page, sections, numbers, labels);
  page.set("toc", toc);
  page.set("runs", runs.json(plan, index));
  replace_file(folder.path() / "report.html", html_page("study", page, PageCharts::drawn));
}

}  // namespace breakwater
