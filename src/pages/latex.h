// Tables for papers.
#pragma once

#include <string>
#include <vector>

namespace breakwater {

/// A text with all that LaTeX would take for its own made harmless.
std::string latex_escaped(const std::string& text);

/// "$1.1 \times 10^{-13}$", "6.046".
std::string latex_number(double value);

/// A metric's name and unit as people write them: "Peak force raw [N]", "RMSE velocity
/// [rad/s$^2$]".
std::string latex_name(const std::string& metric, const std::string& unit);

/// A booktabs table, the first column set left and the others right; cells are LaTeX already.
std::string latex_table(const std::vector<std::vector<std::string>>& rows);

}  // namespace breakwater
