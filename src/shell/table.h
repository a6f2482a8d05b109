// Plain text: tables, and counts in sentences.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

namespace breakwater {

using TextRows = std::vector<std::vector<std::string>>;

/// Rows of cells under a header, the first one, than which none is longer. The first `labels`
/// columns identify the rows and are aligned left, the others right. Splits a table wider than
/// `width` characters into several, each with the labels and without rows that have nothing in it.
/// A table with one label is transposed before if that takes fewer lines.
std::string in_columns(TextRows rows, std::size_t width, std::size_t labels = 1);

/// Breaks the text at spaces into lines of at most `width` characters. A longer word has its own
/// line. Returns at least one line.
std::vector<std::string> wrapped(const std::string& text, std::size_t width);

/// A number with four significant digits, a whole one below 1e9 with all. Files have all digits.
std::string in_digits(double value);

/// "1 run", "2 runs".
std::string number_of(std::size_t count, const std::string& what);

/// "A, B and C"; of five or more the first three: "A, B, C and 2 more".
std::string listed(std::vector<std::string> names);

/// "12.3 s", "20 min", "3.4 h", "2.0 days".
std::string duration_text(double seconds);

}  // namespace breakwater
