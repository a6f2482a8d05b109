// Comma-separated values.
#pragma once

#include <string>
#include <vector>

namespace breakwater {

/// Whether a column, a metric or a signal may have this name: [A-Za-z0-9_]+. Spreadsheets read a
/// cell that begins with "=", "+", "-" or "@" as a formula.
bool is_column_name(const std::string& name);
/// The rule in words, for messages.
inline constexpr const char* kColumnName = "a name is letters from A to Z or a to z, digits and _";

/// Any text as a cell. One that a spreadsheet would read as a formula gets an apostrophe.
std::string csv_text(const std::string& text);

/// One line of a CSV file (RFC 4180).
std::string csv_line(const std::vector<std::string>& cells);

}  // namespace breakwater
