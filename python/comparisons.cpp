#include "module.h"

#include <pybind11/eigen.h>
#include <pybind11/stl.h>

#include <map>
#include <nlohmann/json.hpp>
#include <tuple>

#include <breakwater/study/comparison_table.h>
#include <breakwater/study/results.h>
#include "interpreter.h"

namespace breakwater::python {
namespace {

// Rows of `metrics`, `failed`, `runs` and `places` are test conditions, columns candidates.
// `bounds` are (metric, min, max). Equal numbers in `runs` are equal outcomes, in `blocks` one
// block.
std::string compare(const std::vector<std::string>& candidates,
                    const std::map<std::string, Eigen::MatrixXd>& metrics,
                    const Eigen::MatrixXd& failed, const Eigen::MatrixXi& runs,
                    const Eigen::VectorXi& blocks, const std::vector<Coordinates>& places,
                    const std::string& metric, bool is_max,
                    const std::vector<std::tuple<std::string, double, double>>& bounds,
                    double share, double confidence) {
  PairedResults results{
      .candidates = candidates, .failed = failed, .samples = blocks, .runs = runs};
  for (const auto& [name, values] : metrics) {
    results.metrics.push_back(name);
    results.values.push_back(values);
  }
  number_failed_runs(places, results);
  Requirement requirement{.share = share, .confidence = confidence};
  for (const auto& [name, low, high] : bounds) requirement.bounds.push_back({name, low, high});
  const Ranking ranking =
      rank_candidates(results, metric, is_max ? Goal::max : Goal::min, requirement);
  nlohmann::ordered_json json = ranking_json(ranking);
  constexpr std::size_t kWidth = 100;
  json["text"] = ranking_text(ranking, kWidth);
  return json.dump();
}

}  // namespace

void bind_comparisons(py::module_& module) {
  module.def("compare", compare, OwnCall());
  module.def("missing_lines", missing_lines, OwnCall());
}

}  // namespace breakwater::python
