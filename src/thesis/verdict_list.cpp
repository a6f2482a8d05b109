#include <breakwater/thesis/verdict_list.h>

#include <fmt/format.h>

#include <cmath>
#include <vector>

#include <breakwater/record/csv.h>
#include <breakwater/thesis/thesis_report.h>

namespace breakwater {
namespace {

std::string exact(double value) {
  return std::isnan(value) ? "" : fmt::format("{}", value);
}

// Calls `use(section, table, row, column, cell, judged)` for each cell of the sections.
template <typename Use>
void for_each_cell(const Reproduction& reproduction, const Measured& measured, const Use& use) {
  const PrintedResults& printed = printed_results();
  for (const SectionSpec* section : reproduction.sections) {
    for (const TableSpec& table : section->tables) {
      for (std::size_t r = 0; r < table.rows.size(); ++r) {
        for (std::size_t c = 0; c < table.columns.size(); ++c) {
          const auto& cell = table.cells[r][c];
          if (cell) use(*section, table, r, c, *cell, judge_cell(*cell, measured, printed));
        }
      }
    }
  }
}

}  // namespace

std::string verdict_list(const Reproduction& reproduction, const Measured& measured) {
  std::string text = csv_line({"section",  "table",    "row",         "column",  "run",
                               "metric",   "over_run", "over_metric", "divisor", "statistic",
                               "measured", "smallest", "largest",     "runs",    "printed",
                               "says",     "holds_if", "verdict",     "cause",   "why"});
  for_each_cell(reproduction, measured,
                [&](const SectionSpec& section, const TableSpec& table, std::size_t r,
                    std::size_t c, const CellSpec& cell, const Judged& judged) {
                  const Quantity over = cell.over.value_or(Quantity{});
                  const bool has_numbers = judged.numbers > 0;
                  text += csv_line({section.id,
                                    table.title,
                                    table.rows[r],
                                    table.columns[c],
                                    cell.quantity.run,
                                    cell.quantity.metric,
                                    over.run,
                                    over.metric,
                                    exact(cell.divisor),
                                    cell.is_share ? "share" : "median",
                                    exact(judged.median),
                                    has_numbers ? exact(judged.smallest) : "",
                                    has_numbers ? exact(judged.largest) : "",
                                    std::to_string(judged.values),
                                    cell.printed.empty() ? "" : judged.printed,
                                    cell.says + cell.shows,
                                    judged.class_text,
                                    verdict_word(judged, cell, reproduction.experiments.is_own),
                                    judged.verdict == Verdict::not_reproduced ? cell.cause : "",
                                    reason_of(judged, cell)});
                });
  return text;
}

std::string failure_list(const Reproduction& reproduction, const Measured& measured) {
  constexpr std::size_t kFew = 15;
  std::vector<std::string> entries, counts;
  std::vector<std::pair<std::string, std::size_t>> by_section;
  for_each_cell(
      reproduction, measured,
      [&](const SectionSpec& section, const TableSpec& table, std::size_t r, std::size_t c,
          const CellSpec& cell, const Judged& judged) {
        const bool is_counted = cell.shows.empty() && cell.reading.empty();
        if (!is_counted || judged.verdict != Verdict::not_reproduced) return;
        if (by_section.empty() || by_section.back().first != section.id) {
          by_section.emplace_back(section.id, 0);
        }
        ++by_section.back().second;
        entries.push_back(fmt::format("  {}, {}{}: {}, {} ({})\n", section.id, table.rows[r],
                                      table.columns.size() > 1 ? ", " + table.columns[c] : "",
                                      judged.measured, judged.printed, judged.class_text));
      });
  if (entries.empty()) return "";
  const std::string verdict = reproduction.experiments.is_own ? "did not hold" : "not reproduced";
  if (entries.size() <= kFew) return fmt::format("{}:\n{}", verdict, fmt::join(entries, ""));
  for (const auto& [section, number] : by_section) {
    counts.push_back(fmt::format("{}: {}", section, number));
  }
  return fmt::format("{}, by section: {}\n", verdict, fmt::join(counts, ", "));
}

}  // namespace breakwater
