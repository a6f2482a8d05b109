// A row of a result by column name: CSV files and tables for readers are made from it.
#pragma once

#include <map>
#include <string>
#include <vector>

#include <breakwater/statistics/distribution.h>

namespace breakwater {

class ResultRow {
 public:
  void put(const std::string& column, const std::string& text);
  /// With 17 digits. One that is not finite has an empty text.
  void put(const std::string& column, double number);
  /// Its interval is in COLUMN_lower and COLUMN_upper.
  void put(const std::string& column, const EstimatedValue& number);

  /// Empty if there is nothing in it.
  std::string at(const std::string& column) const;
  /// For readers: a number in digits, with its interval; "-" if there is nothing in it.
  std::string shown(const std::string& column) const;
  std::vector<std::string> in(const std::vector<std::string>& columns) const;
  /// In the order in which they were put.
  const std::vector<std::string>& columns() const { return columns_; }

 private:
  std::vector<std::string> columns_;
  std::map<std::string, std::string> cells_;
  std::map<std::string, EstimatedValue> numbers_;
};

/// The rows as a CSV file.
std::string csv_table(const std::vector<std::string>& columns, const std::vector<ResultRow>& rows);
/// The same with all columns of the rows, in the order in which the rows first have them.
std::string csv_table(const std::vector<ResultRow>& rows);

/// "3 [2.1, 3.8]": a value with its interval, for readers.
std::string brief(const EstimatedValue& number);

}  // namespace breakwater
