#include "scenario/printed_results.h"

#include <toml++/toml.h>

#include <cmath>
#include <stdexcept>

#include "scenario/paths.h"

namespace breakwater {

bool PrintedValue::is_reproduced_by(double measured) const {
  if (bound) return std::abs(measured) < *bound;
  return relative && std::abs(measured - printed) <= *relative * std::abs(printed);
}

std::vector<PrintedValue> printed_values(const std::string& scenario,
                                         const std::string& case_name) {
  const auto data = data_root() / "data";
  try {
    const toml::table classes = toml::parse_file((data / "reproduced.toml").string());
    const toml::table printed = toml::parse_file((data / "printed-results.toml").string());
    std::vector<PrintedValue> values;
    const toml::table* of_case = classes[scenario][case_name].as_table();
    if (of_case == nullptr) return values;
    const auto source = (*of_case)["printed"].value<std::string>();
    if (!source) throw std::runtime_error("an entry has no `printed`");
    for (const auto& [metric, node] : *of_case) {
      const toml::table* band = node.as_table();
      if (band == nullptr) continue;
      const std::string key = (*band)["printed_as"].value_or(std::string(metric.str()));
      const auto value = printed.at_path(*source + "." + key).value<double>();
      if (!value) throw std::runtime_error("printed-results.toml has no " + *source + "." + key);
      values.push_back({std::string(metric.str()), *value, (*band)["relative"].value<double>(),
                        (*band)["bound"].value<double>()});
    }
    return values;
  } catch (const std::exception& error) {
    throw std::runtime_error(data.string() + ": " + error.what());
  }
}

}  // namespace breakwater
