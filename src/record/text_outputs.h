// log.csv, metrics.json and plain text files of a run folder.
#pragma once

#include <string>
#include <vector>

#include <breakwater/record/output_error.h>
#include <breakwater/record/recording.h>

namespace breakwater {

/// Each function throws OutputError `FILE: cannot be written …` if it cannot write the whole file.

void write_text_file(const std::string& file, const std::string& text);

/// One line per row and one column per value. The header has the names: NAME, or NAME_1, NAME_2, ….
void write_csv_log(const std::string& file, const Track& track);

/// Writes a flat JSON object with finite numbers only.
void write_metrics(const std::string& file, const std::vector<Metric>& metrics);

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
