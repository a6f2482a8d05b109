#include <breakwater/search/tuning_outputs.h>

#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <map>
#include <nlohmann/json.hpp>

#include <breakwater/config/toml_text.h>
#include <breakwater/record/partial_file.h>
#include <breakwater/study/comparison_table.h>

namespace breakwater {
namespace {

namespace fs = std::filesystem;

constexpr double kEdge = 0.01;  // share of a range that counts as its bound

// The runs of the best candidates in the validation. Column i is of cases[i].
PairedResults fresh_results(const TuningPlan& plan, const TuningResult& result,
                            const std::vector<std::size_t>& cases) {
  const Objective& objective = plan.tuning().objectives.front();
  const auto rows = static_cast<Eigen::Index>(plan.worlds(true).size());
  const auto columns = static_cast<Eigen::Index>(cases.size());
  PairedResults paired;
  paired.metrics = {objective.metric};
  paired.values = {Eigen::MatrixXd(rows, columns)};
  paired.failed.resize(rows, columns);
  paired.runs.resize(rows, columns);
  std::map<std::string, int> numbers;  // by state hash: equal complete runs are repeats
  for (Eigen::Index i = 0; i < columns; ++i) {
    const std::size_t tuned = cases[static_cast<std::size_t>(i)];
    const TunedFront& best = result.fronts[tuned];
    paired.candidates.push_back(best.case_name);
    for (Eigen::Index world = 0; world < rows; ++world) {
      const PointResult& run = result.runs.at(plan.number(
          {tuned, best.points.front().evaluation, true, static_cast<std::size_t>(world)}));
      const bool has_failed = run.status != PointStatus::complete;
      const std::string own = has_failed ? std::to_string(run.number) : run.state_hash;
      paired.runs(world, i) = numbers.emplace(own, static_cast<int>(numbers.size())).first->second;
      paired.failed(world, i) = has_failed ? 1.0 : 0.0;
      paired.values[0](world, i) =
          metric_of(run, objective.metric).value_or(std::numeric_limits<double>::quiet_NaN());
    }
  }
  return paired;
}

// The cases with a best candidate.
std::vector<std::size_t> tuned_cases(const TuningResult& result) {
  std::vector<std::size_t> cases;
  for (std::size_t c = 0; c < result.fronts.size(); ++c) {
    if (!result.fronts[c].points.empty()) cases.push_back(c);
  }
  return cases;
}

// Whether a value is in the outer hundredths of its range, or is the smallest or largest of its
// numbers. A better value may lie beyond.
bool is_at_bound(const VariedKey& key, const std::string& value) {
  const auto number = number_in(value);
  if (!number) return false;
  if (key.distribution) {
    return *number <= key.distribution->quantile(kEdge) ||
           *number >= key.distribution->quantile(1.0 - kEdge);
  }
  std::vector<double> values;
  for (const std::string& one : key.values) {
    if (const auto other = number_in(one)) values.push_back(*other);
  }
  const auto [least, most] = std::minmax_element(values.begin(), values.end());
  return *number == *least || *number == *most;
}

void add_new(const std::vector<VariedKey>& keys, std::vector<std::string>& names) {
  for (const VariedKey& key : keys) {
    if (std::find(names.begin(), names.end(), key.key) == names.end()) names.push_back(key.key);
  }
}

void put_values(const TuningPlan& plan, std::size_t tuned, std::size_t evaluation,
                ResultRow& cells) {
  const std::vector<VariedKey>& keys = plan.tuning().cases[tuned].search;
  const std::vector<std::string>& values = plan.values_of(tuned, evaluation);
  for (std::size_t i = 0; i < keys.size(); ++i) cells.put(keys[i].key, plain_text(values[i]));
}

std::string results_csv(const TuningPlan& plan, const TuningResult& result) {
  const Tuning& tuning = plan.tuning();
  std::vector<std::string> keys;
  for (const TunedCase& tuned : tuning.cases) add_new(tuned.search, keys);
  add_new(tuning.worlds.study().vary, keys);
  if (tuning.validation) add_new(tuning.validation->study().vary, keys);
  std::vector<ResultRow> rows;
  for (const auto& [number, run] : result.runs) {
    const TuningRun one = plan.run(number);
    const Plan& worlds = plan.worlds(one.is_validation);
    const StudyPoint world = worlds.point(one.world);
    ResultRow& cells = rows.emplace_back();
    cells.put("point", run.key);
    cells.put("case", tuning.cases[one.tuned].name);
    cells.put("evaluation", std::to_string(one.evaluation));
    cells.put("use", one.is_validation ? "validate" : "search");
    cells.put("seed", world.seed ? std::to_string(*world.seed) : "");
    for (const std::string& key : keys) cells.put(key, "");
    put_values(plan, one.tuned, one.evaluation, cells);
    for (std::size_t k = 0; k < world.values.size(); ++k) {
      cells.put(worlds.study().vary[k].key, plain_text(world.values[k]));
    }
    cells.put("status", name_of(run.status));
    cells.put("state_hash", run.state_hash);
    for (const auto& [name, value] : run.metrics) cells.put(name, value);
  }
  return csv_table(rows);
}

}  // namespace

FrontTable front_table(const TuningPlan& plan, const TuningResult& result) {
  const Tuning& tuning = plan.tuning();
  FrontTable table;
  table.columns = {"case", tuning.has_front() ? "front" : "place", "evaluation"};
  for (const TunedCase& tuned : tuning.cases) add_new(tuned.search, table.columns);
  std::vector<std::string> measured;
  for (const Objective& one : tuning.objectives) measured.push_back(one.metric);
  for (const Constraint& one : tuning.constraints) measured.push_back(one.metric + "_constraint");
  for (const std::string& name : measured) {
    table.columns.push_back(name);
    if (!tuning.validation) continue;
    for (const char* end : {"_fresh", "_fresh_lower", "_fresh_upper"}) {
      table.columns.push_back(name + end);
    }
  }
  if (tuning.validation) {
    table.columns.emplace_back("fresh_failures");
    if (!tuning.constraints.empty()) table.columns.emplace_back("fresh_violation");
  }
  if (!tuning.has_front()) table.columns.emplace_back("at_bound");

  const std::vector<std::size_t> cases = tuned_cases(result);
  std::vector<std::size_t> order = cases;
  auto& ranking = table.ranking;
  if (!tuning.has_front() && tuning.validation && cases.size() > 1) {
    const Objective& objective = tuning.objectives.front();
    ranking = rank_candidates(fresh_results(plan, result, cases), objective.metric, objective.goal);
    std::ranges::transform(ranking->rows, order.begin(),
                           [&](const RankedCandidate& row) { return cases[row.candidate]; });
  } else if (!tuning.has_front()) {
    std::ranges::stable_sort(order, {}, [&](std::size_t c) {
      return minimised(tuning, result.fronts[c].points.front().tuned);
    });
  }
  for (const std::size_t c : order) {
    for (const FrontPoint& point : result.fronts[c].points) {
      const std::string number = std::to_string(table.rows.size() + 1);
      ResultRow cells;
      cells.put("case", result.fronts[c].case_name);
      cells.put("front", number);
      if (ranking) cells.put("place", std::to_string(ranking->rows[table.rows.size()].place));
      std::vector<std::string> at_bound;
      for (std::size_t i = 0; i < tuning.cases[c].search.size(); ++i) {
        const VariedKey& key = tuning.cases[c].search[i];
        if (is_at_bound(key, plan.values_of(c, point.evaluation)[i])) at_bound.push_back(key.key);
      }
      cells.put("at_bound", fmt::format("{}", fmt::join(at_bound, " ")));
      cells.put("evaluation", std::to_string(point.evaluation));
      put_values(plan, c, point.evaluation, cells);
      const auto put_all = [&](const Evaluation& evaluation, const std::string& end) {
        std::vector<EstimatedValue> values = evaluation.objectives;  // none after a failure
        values.insert(values.end(), evaluation.constraints.begin(), evaluation.constraints.end());
        for (std::size_t i = 0; i < values.size(); ++i) cells.put(measured[i] + end, values[i]);
      };
      put_all(point.tuned, "");
      if (point.fresh) {
        put_all(*point.fresh, "_fresh");
        cells.put("fresh_failures", std::to_string(point.fresh->failures));
        if (point.fresh->failures == 0) cells.put("fresh_violation", point.fresh->violation);
      }
      table.rows.push_back({c, point.evaluation,
                            tuning.has_front() ? number : result.fronts[c].case_name,
                            std::move(cells)});
    }
  }
  return table;
}

void write_outputs(const TuningPlan& plan, const TuningResult& result, const FrontTable& table,
                   const fs::path& folder) {
  const std::string kind = plan.tuning().has_front() ? "front" : "tuned";
  replace_file(folder / "results.csv", results_csv(plan, result));
  if (table.ranking) {
    replace_file(folder / "ranking.json", ranking_json(*table.ranking).dump(1) + "\n");
  }
  fs::remove_all(folder / kind);
  fs::create_directories(folder / kind);
  std::vector<ResultRow> rows;
  for (const FrontRow& row : table.rows) {
    rows.push_back(row.cells);
    replace_file(folder / kind / (row.label + ".toml"),
                 plan.config_text(row.tuned, row.evaluation));
  }
  replace_file(folder / (kind + ".csv"), csv_table(table.columns, rows));
}

}  // namespace breakwater
