// The results that the thesis prints, beside which ours are put.
#pragma once

#include <optional>
#include <string>
#include <vector>

namespace breakwater {

/// One printed number, and what counts as having reproduced it.
struct PrintedValue {
  std::string metric;  ///< our name for it
  double printed;
  std::optional<double> relative;  ///< reproduced within ± this part of the printed value
  std::optional<double> bound;     ///< reproduced if |measured| is below this

  bool is_reproduced_by(double measured) const;
};

/// The printed numbers of one case of a scenario: data/printed-results.toml as data/reproduced.toml
/// maps it. Empty if the thesis prints none. Throws std::runtime_error if the files are damaged.
std::vector<PrintedValue> printed_values(const std::string& scenario, const std::string& case_name);

}  // namespace breakwater
