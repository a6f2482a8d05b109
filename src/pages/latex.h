// Tables for papers.
#pragma once

#include <string>
#include <vector>

namespace breakwater {

/// Escapes the characters that LaTeX interprets.
std::string latex_escaped(const std::string& text);

/// "$1.1 \times 10^{-13}$", "6.046".
std::string latex_number(double value);

/// The name and unit of a metric for readers: "Peak force raw [N]", "RMSE velocity [rad/s$^2$]".
std::string latex_name(const std::string& metric, const std::string& unit);

/// A booktabs table: the first column is left-aligned, the others right-aligned. The cells are
/// LaTeX.
std::string latex_table(const std::vector<std::vector<std::string>>& rows);

}  // namespace breakwater
