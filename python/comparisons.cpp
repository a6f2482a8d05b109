#include "module.h"

#include <pybind11/stl.h>

#include <map>
#include <nlohmann/json.hpp>
#include <utility>

#include <breakwater/study/ranking_text.h>
#include "arrays.h"

namespace breakwater::python {
namespace {

// Rows are test conditions, columns candidates.
Eigen::MatrixXd table(const py::handle& object) {
  const py::array_t<double> values = numbers(object, "values");
  return Eigen::Map<const Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>>(
      values.data(), values.shape(0), values.shape(1));
}

// `bounds` are (metric, min, max). Equal numbers in `runs` are equal runs, in `blocks` one block.
std::string compare(const std::vector<std::string>& candidates,
                    const std::map<std::string, py::object>& metrics, const py::object& failed,
                    const py::object& runs, const std::vector<int>& blocks,
                    const std::string& metric, const std::string& goal,
                    const std::vector<std::tuple<std::string, double, double>>& bounds,
                    double share, double confidence) {
  PairedResults results;
  results.candidates = candidates;
  for (const auto& [name, values] : metrics) {
    results.metrics.push_back(name);
    results.values.push_back(table(values));
  }
  results.failed = table(failed);
  results.runs = table(runs).cast<int>();
  results.samples =
      Eigen::Map<const Eigen::VectorXi>(blocks.data(), static_cast<Eigen::Index>(blocks.size()));
  Requirement requirement;
  for (const auto& [name, low, high] : bounds) requirement.bounds.push_back({name, low, high});
  requirement.share = share;
  requirement.confidence = confidence;
  const Ranking ranking =
      rank_candidates(results, metric, goal == "max" ? Goal::max : Goal::min, requirement);
  nlohmann::ordered_json json = ranking_json(ranking);
  constexpr std::size_t kWidth = 100;
  json["text"] = ranking_text(ranking, kWidth);
  return json.dump();
}

}  // namespace

void bind_comparisons(py::module_& module) {
  module.def("compare", compare, OwnCall());
}

}  // namespace breakwater::python
