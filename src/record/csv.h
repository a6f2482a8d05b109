// Comma-separated values.
#pragma once

#include <string>
#include <vector>

namespace breakwater {

/// One line of a CSV file (RFC 4180).
std::string csv_line(const std::vector<std::string>& cells);

}  // namespace breakwater
