// Comma-separated values.
#pragma once

#include <string>
#include <vector>

namespace breakwater {

/// Whether a column, so a metric or a signal, may be called so: [A-Za-z0-9_]+. Spreadsheets take
/// what begins with "=", "+", "-" or "@" for a formula.
bool is_column_name(const std::string& name);
/// The rule in words, for messages.
inline constexpr const char* kColumnName = "a name is letters from A to Z or a to z, digits and _";

/// A text for a cell that may be anything, a folder's name say: what a spreadsheet would take for a
/// formula has an apostrophe before it.
std::string csv_text(const std::string& text);

/// One line of a CSV file (RFC 4180).
std::string csv_line(const std::vector<std::string>& cells);

}  // namespace breakwater
