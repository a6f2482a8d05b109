#include <breakwater/pages/study_sections.h>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <tuple>

#include <breakwater/config/toml_text.h>
#include <breakwater/experiment/saved_run.h>
#include <breakwater/pages/html_page.h>
#include <breakwater/pages/labels.h>
#include <breakwater/shell/digits.h>
#include <breakwater/shell/table.h>

namespace breakwater {
namespace {

constexpr std::size_t kMostDrawn = 12;      // candidates, each with a colour or a dash pattern
constexpr std::size_t kMostCompared = 100;  // candidates in a table
constexpr std::size_t kMostMetrics = 60;    // with charts
constexpr std::size_t kOfAGroup = 8;        // smallest number of samples in a group of a drawn key

// A summary such as "median 0.12 (0.1 to 0.2), 20 runs, 1 failed", with the 10 and 90 % quantiles
// in parentheses.
std::string in_words(const QuantileBand& band) {
  std::string text = band.measured > 0 ? fmt::format("median {} ({} to {})", in_digits(band.median),
                                                     in_digits(band.q10), in_digits(band.q90))
                                       : "not measured";
  text += ", " + number_of(band.runs, "run");
  if (band.failed > 0) text += fmt::format(", {} failed", band.failed);
  const std::size_t absent = band.runs - band.failed - band.measured;
  if (absent > 0 && band.measured > 0) text += fmt::format(", {} without it", absent);
  return text;
}

std::string share_in_words(const QuantileBand& band) {
  return fmt::format("{} of {} failed", band.failed, number_of(band.runs, "run"));
}

PageData with_interval(const SensitivityIndex& index) {
  auto values = PageData::array({index.value});
  if (index.interval) values.insert(values.end(), {index.interval->lower, index.interval->upper});
  return values;
}

std::string index_text(const SensitivityIndex& index) {
  const auto two = [](double value) { return fmt::format("{:.2f}", value == 0.0 ? 0.0 : value); };
  if (!index.interval) return two(index.value);
  return fmt::format("{} [{}, {}]", two(index.value), two(index.interval->lower),
                     two(index.interval->upper));
}

// The colours of heat maps and lines with their values.
void add_bar(RunList& runs, double low, double high, PageData& blocks) {
  blocks.push_back(drawings(
      "key-bar", PageData::array({runs.drawing({{"kind", "bar"}, {"low", low}, {"high", high}})})));
}

StudyDetail study_detail(const Plan& plan, std::size_t metrics) {
  // A page of 1 MB has about so many cells, marks and lines in all, and rows of a table.
  constexpr std::size_t kCells = 40'000, kMarks = 6'000, kLines = 8'000, kRows = 2'000;
  const std::size_t keys = std::max<std::size_t>(1, plan.study().vary.size());
  const std::size_t candidates = std::min(plan.candidates().size(), kMostDrawn);
  StudyDetail detail;
  detail.metrics =
      std::min({metrics, kMostMetrics, kRows / std::min(plan.candidates().size(), kMostCompared)});
  const std::size_t all = std::max<std::size_t>(1, detail.metrics);
  detail.cells = std::clamp<std::size_t>(kCells / (all * candidates), 64, 900);
  detail.groups =
      std::clamp<std::size_t>(kMarks / (all * candidates * keys), 5, keys > 1 ? 16 : 40);
  detail.lines = std::clamp<std::size_t>(kLines / all, 60, 240);
  return detail;
}

// Whether two keys are crossed, so that heat maps exist.
bool has_heat_maps(const Study& study) {
  return study.vary.size() == 2 && study.method == Method::grid;
}

}  // namespace

PageData drawings(const char* kind, const PageData& all) {
  return {{"drawings", all}, {"kind", kind}};
}

PageData RunList::drawing(const PageData& data) {
  PageData made = {{"id", fmt::format("drawing-{}", ++drawings_)}, {"data", data}};
  if (data.contains("x_title")) {
    made["about"] = text_of(data["y_title"]) + " over " + text_of(data["x_title"]);
  }
  return made;
}

std::size_t RunList::add(std::size_t point) {
  const auto [place, is_new] = places_.emplace(point, points_.size());
  if (is_new) points_.push_back(point);
  return place->second;
}

PageData RunList::json(const Plan& plan, const ShardIndex& index) const {
  PageData json;
  json["candidates"] = PageData::array();
  for (const Candidate& candidate : plan.candidates())
    json["candidates"].push_back(candidate.label);
  json["keys"] = PageData::array();
  for (const VariedKey& key : plan.study().vary) json["keys"].push_back(key.key);
  json["runs"] = PageData::array();
  for (const std::size_t number : points_) {
    const StudyPoint point = plan.point(number);
    PageData run = {index.read(number).key, point.candidate,
                    point.seed ? std::to_string(*point.seed) : ""};
    for (const std::string& value : point.values) {
      const auto number_of_value = number_in(value);
      run.push_back(number_of_value ? fmt::format("{:.6g}", *number_of_value) : plain_text(value));
    }
    json["runs"].push_back(std::move(run));
  }
  return {{"id", "study-runs"}, {"data", json}};
}

struct StudySections::Output {
  std::string name;
  bool is_failures = false;
  const std::vector<double>& column;
  std::vector<std::uint32_t> order;
};

std::string StudySections::title_of(const Output& output) {
  return output.is_failures ? output.name
                            : metric_label_with_unit(output.name, unit_of(output.name));
}

StudySections::StudySections(const Plan& plan, const ShardIndex& index, const StudyNumbers& numbers,
                             const std::vector<OutputIndices>& indices,
                             const std::vector<std::string>& labels,
                             const std::vector<Identity>& looks, RunList& runs)
    : plan_(plan),
      index_(index),
      numbers_(numbers),
      indices_(indices),
      labels_(labels),
      looks_(looks),
      runs_(runs),
      detail_(study_detail(plan, numbers.metrics.size())) {
  for (std::size_t c = 0; c < std::min(labels.size(), kMostDrawn); ++c) drawn_.push_back(c);
  for (std::size_t c = kMostDrawn; c < labels.size(); ++c) {
    if (plan.candidates()[c].label == plan.study().baseline) drawn_.back() = c;
  }
  place_of_.assign(labels.size(), drawn_.size());
  for (std::size_t i = 0; i < drawn_.size(); ++i) place_of_[drawn_[i]] = i;

  if (has_heat_maps(plan.study())) {
    std::size_t columns = numbers.keys[0].values.size(), rows = columns;
    for (std::size_t* side : {&columns, &rows}) {
      *side = std::min<std::size_t>(
          *side, std::max<std::size_t>(1, plan.study().vary[side == &rows ? 1 : 0].values.size()));
    }
    while (columns * rows > detail_.cells) --(columns > rows ? columns : rows);
    sides_ = {group_values(numbers.keys[0], columns), group_values(numbers.keys[1], rows)};
  } else {
    for (std::size_t k = 0; k < numbers.keys.size(); ++k) {
      const StudyKey& key = numbers.keys[k];
      const std::size_t enough = std::max<std::size_t>(4, key.values.size() / kOfAGroup);
      const bool is_drawn = plan.study().vary[k].distribution.has_value();
      keys_.push_back(
          group_values(key, is_drawn ? std::min(enough, detail_.groups) : detail_.groups));
    }
    effects_ = key_effects(plan.study());
    for (const KeyEffect& effect : effects_) keys_[effect.key].name = effect.name;
  }

  // Failures come first, with a limited share.
  failed_.assign(numbers.failed.begin(),
                 numbers.failed.begin() + static_cast<std::ptrdiff_t>(
                                              std::min(numbers.failed.size(), detail_.lines / 2)));
  std::vector<std::pair<std::uint64_t, std::uint32_t>> chosen;
  for (std::uint32_t i = 0; i < numbers.runs.size(); ++i) {
    if (numbers.runs[i].failed) continue;
    chosen.emplace_back(scattered(numbers.runs[i].number), i);
    std::push_heap(chosen.begin(), chosen.end());
    if (chosen.size() <= detail_.lines - failed_.size()) continue;
    std::pop_heap(chosen.begin(), chosen.end());
    chosen.pop_back();
  }
  for (const auto& [hash, run] : chosen) lines_.push_back(run);
  std::sort(lines_.begin(), lines_.end());
}

std::vector<QuantileBand> StudySections::bands_of(const Output& output) const {
  return bands(numbers_, output.column, output.order, labels_.size(),
               [](const StudyRun& run) { return run.candidate; });
}

std::vector<QuantileBand> StudySections::by_candidate(std::size_t metric) const {
  const std::vector<double>& column = numbers_.columns[metric];
  return bands_of({numbers_.metrics[metric], false, column, in_order(column)});
}

PageData StudySections::line_chart(const Output& output, const KeyGroups& key, bool& has_bands,
                                   bool& has_crosses) const {
  const std::vector<QuantileBand> all =
      bands(numbers_, output.column, output.order, (drawn_.size() + 1) * key.size(),
            [&](const StudyRun& run) {
              return place_of_[run.candidate] * key.size() + key.of_sample[run.sample];
            });
  auto looks = PageData::array();
  auto lines = PageData::array();
  for (std::size_t i = 0; i < drawn_.size(); ++i) {
    looks.push_back(series_class(looks_[drawn_[i]]));
    auto line = PageData::array();
    for (std::size_t g = 0; g < key.size(); ++g) {
      const QuantileBand& band = all[i * key.size() + g];
      auto runs = PageData::array();
      if (band.measured > 0) runs.push_back(runs_.add(band.at_middle));
      if (band.failed > 0) runs.push_back(runs_.add(band.first_failed));
      PageData mark = {
          {"text", fmt::format("{}, {} = {}: {}", labels_[drawn_[i]], key.name, key.labels[g],
                               output.is_failures ? share_in_words(band) : in_words(band))},
          {"runs", runs}};
      if (output.is_failures) {
        mark["y"] = band.failed_share();
      } else {
        mark.update({{"y", band.median}, {"low", band.q10}, {"high", band.q90}});
        mark["failed"] = band.failed > 0;
        has_bands |= band.q10 < band.q90;
        has_crosses |= band.failed > 0;
      }
      line.push_back(std::move(mark));
    }
    lines.push_back(std::move(line));
  }
  const bool has_labels = !key.is_number || (!key.is_binned && key.size() <= 8);
  return runs_.drawing({{"kind", "lines"},
                        {"x_title", key_label_with_unit(key.name, unit_of(key.name))},
                        {"y_title", title_of(output)},
                        {"log", key.is_log},
                        {"share", output.is_failures},
                        {"at", key.centre},
                        {"labels", has_labels ? PageData(key.labels) : PageData::array()},
                        {"looks", looks},
                        {"lines", lines}});
}

void StudySections::add_legend(PageData& blocks) const {
  auto entries = PageData::array();
  for (const std::size_t c : drawn_) {
    const bool is_baseline = labels_[c] == plan_.study().baseline;
    entries.push_back({{"entry", labels_[c] + (is_baseline ? " (baseline)" : "")},
                       {"look", series_class(looks_[c])}});
  }
  if (entries.size() > 1) add_block(blocks, "legend", {{"entries", entries}});
  if (labels_.size() > drawn_.size()) {
    add_block(blocks, "text",
              fmt::format("Charts have {} of {} candidates; tables have more.", drawn_.size(),
                          labels_.size()));
  }
}

void StudySections::add_line_charts(const Output& output, PageData& blocks) const {
  auto lines = PageData::array();
  bool has_bands = false, has_crosses = false;
  for (const KeyEffect& effect : effects_) {
    lines.push_back(line_chart(output, keys_[effect.key], has_bands, has_crosses));
  }
  if (lines.empty()) return;
  blocks.push_back(drawings("charts", lines));
  add_block(blocks, "text",
            fmt::format("{}{}{} Point at a mark to see its numbers.",
                        output.is_failures ? "The share of the runs with this value."
                                           : "A mark is the median of the runs with this value.",
                        has_bands ? " The band has the runs from 10 to 90 %." : "",
                        has_crosses ? " A cross: some of the runs failed." : ""));
}

void StudySections::add_heat_maps(const Output& output, PageData& blocks) const {
  const KeyGroups &x = sides_[0], &y = sides_[1];
  const std::size_t cells = x.size() * y.size();
  const std::vector<QuantileBand> all = bands(
      numbers_, output.column, output.order, (drawn_.size() + 1) * cells, [&](const StudyRun& run) {
        return place_of_[run.candidate] * cells + y.of_sample[run.sample] * x.size() +
               x.of_sample[run.sample];
      });
  const auto value_of_cell = [&](const QuantileBand& band) {
    return output.is_failures ? band.failed_share() : band.median;
  };
  double low = std::numeric_limits<double>::infinity(), high = -low;
  for (std::size_t i = 0; i < drawn_.size() * cells; ++i) {
    const double value = value_of_cell(all[i]);
    if (!std::isfinite(value)) continue;
    low = std::min(low, value);
    high = std::max(high, value);
  }
  if (output.is_failures) low = 0.0, high = 1.0;
  auto maps = PageData::array();
  for (std::size_t i = 0; i < drawn_.size(); ++i) {
    auto list = PageData::array();
    for (std::size_t cell = 0; cell < cells; ++cell) {
      const QuantileBand& band = all[i * cells + cell];
      const bool has_run = band.measured > 0 || band.failed > 0;
      const std::size_t point = band.measured > 0 ? band.at_middle : band.first_failed;
      list.push_back(PageData::array({value_of_cell(band), band.runs, band.failed,
                                      output.is_failures ? band.runs - band.failed : band.measured,
                                      has_run ? PageData(runs_.add(point)) : PageData()}));
    }
    PageData map = runs_.drawing({{"kind", "heat"},
                                  {"x_title", x.name},
                                  {"y_title", y.name},
                                  {"x", x.labels},
                                  {"y", y.labels},
                                  {"cells", list},
                                  {"low", low},
                                  {"high", high},
                                  {"about", fmt::format("{} of {} over {} and {}", output.name,
                                                        labels_[drawn_[i]], x.name, y.name)}});
    map["caption"] = labels_[drawn_[i]];
    maps.push_back(std::move(map));
  }
  blocks.push_back(drawings("charts", maps));
  if (low <= high) add_bar(runs_, low, high, blocks);
  add_block(blocks, "text",
            output.is_failures ? "The share of a cell’s runs that failed; a cross: all of them."
                               : "Medians over the runs of a cell. A cross: all of them failed. A "
                                 "corner: some did. A dash: no run has it. A dash at the lower "
                                 "edge: only some have it, and the median is of them.");
}

void StudySections::add_parallel(const Output& output, PageData& blocks) const {
  auto axes = PageData::array();
  auto lines = PageData::array();
  const auto add_axis = [&axes](const std::string& title, bool is_log, double low, double high,
                                const std::vector<std::string>& texts) {
    axes.push_back(
        {{"title", title}, {"log", is_log}, {"low", low}, {"high", high}, {"texts", texts}});
  };
  const bool has_candidates = labels_.size() > 1;
  if (has_candidates) {
    add_axis("candidate", false, 0.0, static_cast<double>(labels_.size() - 1), labels_);
  }
  for (std::size_t k = 0; k < numbers_.keys.size(); ++k) {
    const StudyKey& key = numbers_.keys[k];
    auto [low, high] = std::ranges::minmax(key.values);
    for (const FailedRun& run : failed_) {
      low = std::min(low, run.values[k]);
      high = std::max(high, run.values[k]);
    }
    add_axis(key.name, keys_[k].is_log, low, high, key.texts);
  }
  const auto add = [&](std::size_t number, std::size_t candidate, std::vector<double> values,
                       bool failed) {
    if (has_candidates) values.insert(values.begin(), static_cast<double>(candidate));
    lines.push_back(PageData::array({values, failed, runs_.add(number)}));
  };
  double low = std::numeric_limits<double>::infinity(), high = -low;
  for (const std::uint32_t i : lines_) {
    const StudyRun& run = numbers_.runs[i];
    std::vector<double> values;
    for (const StudyKey& key : numbers_.keys) values.push_back(key.values[run.sample]);
    values.push_back(output.is_failures ? 0.0 : output.column[i]);
    if (std::isfinite(values.back())) {
      low = std::min(low, values.back());
      high = std::max(high, values.back());
    }
    add(run.number, run.candidate, std::move(values), false);
  }
  if (output.is_failures || !(low <= high)) low = 0.0, high = 1.0;
  constexpr double kWide = 300.0;  // from the smallest value to the largest
  add_axis(
      output.name, low > 0.0 && high > kWide * low, low, high,
      output.is_failures ? std::vector<std::string>{"to the end"} : std::vector<std::string>{});
  for (const FailedRun& run : failed_) {
    std::vector<double> values = run.values;
    values.push_back(std::numeric_limits<double>::quiet_NaN());
    add(run.number, run.candidate, std::move(values), true);
  }
  add_block(blocks, "subheading", "Single runs");
  blocks.push_back(drawings(
      "scroll",
      PageData::array({runs_.drawing({{"kind", "parallel"}, {"axes", axes}, {"lines", lines}})})));
  blocks.back()["label"] = "Single runs";
  if (!output.is_failures) add_bar(runs_, low, high, blocks);
  const std::size_t failed = index_.done() - index_.count(PointStatus::complete);
  add_block(blocks, "text",
            fmt::format("{} of {} runs that ended well, chosen evenly{}.", lines_.size(),
                        index_.count(PointStatus::complete),
                        failed == 0 ? ""
                                    : fmt::format(", and {} of {} that did not (dashed)",
                                                  failed_.size(), failed)));
}

void StudySections::add_indices(const Output& output, PageData& blocks) const {
  auto rows = PageData::array();
  Eigen::Index dropped = 0, counted = 0;
  for (const OutputIndices& one : indices_) {
    if (one.output != output.name) continue;
    dropped += one.indices.dropped_rows;
    counted += one.indices.rows;
  }
  for (std::size_t k = 0; k < numbers_.keys.size(); ++k) {
    for (const OutputIndices& one : indices_) {
      if (one.output != output.name || one.indices.total.empty()) continue;
      const auto& [first, total] = std::tie(one.indices.first_order[k], one.indices.total[k]);
      const PageData bars =
          runs_.drawing({{"kind", "indices"},
                         {"look", series_class(looks_[one.candidate])},
                         {"values", {with_interval(first), with_interval(total)}}});
      rows.push_back({numbers_.keys[k].name,
                      labels_[one.candidate],
                      index_text(first),
                      index_text(total),
                      {{"value", ""}, {"drawing", bars}}});
    }
  }
  add_block(blocks, "subheading", "Sensitivity");
  if (rows.empty()) {
    add_block(blocks, "text",
              "There are no indices: it does not vary, or fewer than two rows of the design are "
              "there.");
    return;
  }
  add_block(blocks, "table",
            {{"label", "Sensitivity indices"},
             {"columns", {"key", "candidate", "first order", "total", "from 0 to 1"}},
             {"rows", rows}});
  add_block(blocks, "text",
            fmt::format("The share of variance that a key makes alone (full bar), and with all its "
                        "interactions (hollow bar), with 95 % intervals; of means over seeds. {} "
                        "rows of the design count, {} have a run without it and do not. "
                        "indices.csv has all digits.",
                        counted, dropped));
}

void StudySections::add_candidates(const Output& output, PageData& blocks) const {
  const std::vector<QuantileBand> all = bands_of(output);
  double low = std::numeric_limits<double>::infinity(), high = -low;
  for (const QuantileBand& band : all) {
    if (band.measured == 0) continue;
    low = std::min(low, band.q10);
    high = std::max(high, band.q90);
  }
  PageData columns = {"candidate", "runs", "failed"};
  if (!output.is_failures) {
    columns.insert(columns.end(),
                   {"without it", "median", "quartiles", "10 to 90 %", "", "smallest", "largest"});
  }
  auto rows = PageData::array();
  for (std::size_t c = 0; c < std::min(all.size(), kMostCompared); ++c) {
    const QuantileBand& band = all[c];
    const std::string share =
        output.is_failures ? fmt::format(" ({:.3g} %)", 100.0 * band.failed_share()) : "";
    PageData row = {
        labels_[c],
        band.runs,
        {{"value", std::to_string(band.failed) + share}, {"tone", band.failed > 0 ? "off" : ""}}};
    if (!output.is_failures) row.push_back(band.runs - band.failed - band.measured);
    if (band.measured > 0) {
      const auto run = [&](double value, std::size_t point) {
        row.push_back(
            {{"value", value}, {"tip", index_.read(point).key}, {"run", runs_.add(point)}});
      };
      run(band.median, band.at_middle);
      row.push_back(in_digits(band.q25) + " to " + in_digits(band.q75));
      row.push_back(in_digits(band.q10) + " to " + in_digits(band.q90));
      const PageData box =
          runs_.drawing({{"kind", "box"},
                         {"look", series_class(looks_[c])},
                         {"low", low},
                         {"high", high},
                         {"values", {band.q10, band.q25, band.median, band.q75, band.q90}}});
      row.push_back({{"value", ""}, {"drawing", box}});
      run(band.smallest, band.at_smallest);
      run(band.largest, band.at_largest);
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
              fmt::format("The first {} of {} candidates; results.csv has all.", kMostCompared,
                          labels_.size()));
  }
}

PageData StudySections::section(std::optional<std::size_t> metric) const {
  static const std::vector<double> kNone;
  const std::vector<double>& column = metric ? numbers_.columns[*metric] : kNone;
  const Output output = {metric ? numbers_.metrics[*metric] : kFailedOutput, !metric, column,
                         in_order(column)};
  auto blocks = PageData::array();
  add_legend(blocks);
  if (!numbers_.runs.empty() && (metric || !numbers_.failures.empty())) {
    if (!sides_.empty()) add_heat_maps(output, blocks);
    add_line_charts(output, blocks);
    if (keys_.size() > 1) add_parallel(output, blocks);
    if (plan_.study().method == Method::saltelli) add_indices(output, blocks);
  }
  add_candidates(output, blocks);
  return {{"id", metric ? fmt::format("metric-{}", *metric + 1) : kFailuresId},
          {"heading", metric ? title_of(output) : "Failed runs"},
          {"tip", metric ? output.name : ""},
          {"kind", metric ? "metric" : "metric-free"},
          {"blocks", blocks}};
}

}  // namespace breakwater
