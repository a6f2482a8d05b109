#include <breakwater/study/result_row.h>

#include <fmt/format.h>

#include <cmath>
#include <set>

#include <breakwater/config/toml_text.h>
#include <breakwater/record/text_outputs.h>
#include <breakwater/shell/table.h>

namespace breakwater {

void ResultRow::put(const std::string& column, const std::string& text) {
  if (!cells_.insert_or_assign(column, text).second) return;
  columns_.push_back(column);
}

void ResultRow::put(const std::string& column, double number) {
  put(column, std::isfinite(number) ? fmt::format("{:.17g}", number) : "");
}

void ResultRow::put(const std::string& column, const EstimatedValue& number) {
  const ConfidenceInterval interval = number.interval.value_or(ConfidenceInterval{});
  put(column, number.value);
  put(column + "_lower", interval.lower);
  put(column + "_upper", interval.upper);
  numbers_.insert_or_assign(column, number);
}

std::string ResultRow::at(const std::string& column) const {
  const auto found = cells_.find(column);
  return found == cells_.end() ? "" : found->second;
}

std::string ResultRow::shown(const std::string& column) const {
  const auto found = numbers_.find(column);
  if (found != numbers_.end()) return brief(found->second);
  const std::string text = at(column);
  const auto number = number_in(text);
  return text.empty() ? "-" : number ? in_digits(*number) : text;
}

std::vector<std::string> ResultRow::in(const std::vector<std::string>& columns) const {
  std::vector<std::string> row;
  for (const std::string& column : columns) row.push_back(at(column));
  return row;
}

std::string csv_table(const std::vector<std::string>& columns, const std::vector<ResultRow>& rows) {
  std::string text = csv_line(columns);
  for (const ResultRow& row : rows) text += csv_line(row.in(columns));
  return text;
}

std::string csv_table(const std::vector<ResultRow>& rows) {
  std::vector<std::string> columns;
  std::set<std::string> known;
  for (const ResultRow& row : rows) {
    for (const std::string& column : row.columns()) {
      if (known.insert(column).second) columns.push_back(column);
    }
  }
  return csv_table(columns, rows);
}

std::string brief(const EstimatedValue& number) {
  if (!number.interval) return in_digits(number.value);
  return fmt::format("{} [{}, {}]", in_digits(number.value), in_digits(number.interval->lower),
                     in_digits(number.interval->upper));
}

}  // namespace breakwater
