#include "module.h"

#include <fmt/format.h>
#include <pybind11/eigen.h>
#include <pybind11/stl.h>

#include <map>
#include <nlohmann/json.hpp>
#include <tuple>

#include <breakwater/shell/table.h>
#include <breakwater/study/ranking_text.h>
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
                    const Eigen::VectorXi& blocks, const std::vector<Place>& places,
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
  std::vector<std::size_t> complete;
  std::map<std::string, std::vector<std::size_t>> counts;
  for (Eigen::Index c = 0; c < failed.cols(); ++c) {
    const auto has_ended = failed.col(c).array() == 0.0;
    complete.push_back(static_cast<std::size_t>(has_ended.count()));
    for (const auto& [name, values] : metrics) {
      const auto there = has_ended && !values.col(c).array().isNaN();
      counts[name].push_back(static_cast<std::size_t>(there.count()));
    }
  }
  const std::vector<std::string> notes = missing_lines(candidates, counts, complete);
  nlohmann::ordered_json json = ranking_json(ranking);
  constexpr std::size_t kWidth = 100;
  std::string text = ranking_text(ranking, kWidth);
  for (const std::string& note : notes) {
    text += fmt::format("\n{}", fmt::join(wrapped(note, kWidth), "\n"));
  }
  json["text"] = text;
  json["notes"] = notes;
  return json.dump();
}

}  // namespace

void bind_comparisons(py::module_& module) {
  module.def("compare", compare, OwnCall());
}

}  // namespace breakwater::python
