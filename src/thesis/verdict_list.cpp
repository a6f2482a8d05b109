#include <breakwater/thesis/verdict_list.h>

#include <fmt/format.h>

#include <cmath>

#include <breakwater/record/csv.h>
#include <breakwater/thesis/thesis_report.h>

namespace breakwater {
namespace {

std::string exact(double value) {
  return std::isnan(value) ? "" : fmt::format("{}", value);
}

}  // namespace

std::string verdict_list(const Reproduction& reproduction, const Measured& measured) {
  const PrintedResults& printed = printed_results();
  std::string text = csv_line({"section",  "table",    "row",         "column",  "run",
                               "metric",   "over_run", "over_metric", "divisor", "statistic",
                               "measured", "smallest", "largest",     "runs",    "printed",
                               "says",     "holds_if", "verdict",     "cause",   "why"});
  for (const SectionSpec* section : reproduction.sections) {
    for (const TableSpec& table : section->tables) {
      for (std::size_t r = 0; r < table.rows.size(); ++r) {
        for (std::size_t c = 0; c < table.columns.size(); ++c) {
          const auto& cell = table.cells[r][c];
          if (!cell) continue;
          const Judged judged = judge_cell(*cell, measured, printed);
          const Quantity over = cell->over.value_or(Quantity{});
          const bool has_numbers = judged.numbers > 0;
          text += csv_line({section->id,
                            table.title,
                            table.rows[r],
                            table.columns[c],
                            cell->quantity.run,
                            cell->quantity.metric,
                            over.run,
                            over.metric,
                            exact(cell->divisor),
                            cell->is_share ? "share" : "median",
                            exact(judged.median),
                            has_numbers ? exact(judged.smallest) : "",
                            has_numbers ? exact(judged.largest) : "",
                            std::to_string(judged.values),
                            cell->printed.empty() ? "" : judged.printed,
                            cell->says + cell->shows,
                            judged.class_text,
                            verdict_word(judged, *cell, reproduction.experiments.is_own),
                            judged.verdict == Verdict::not_reproduced ? cell->cause : "",
                            reason_of(judged, *cell)});
        }
      }
    }
  }
  return text;
}

}  // namespace breakwater
