#include <breakwater/search/tuned_ranking.h>

#include <algorithm>
#include <limits>
#include <map>
#include <unordered_map>

#include <breakwater/config/toml_text.h>

namespace breakwater {
namespace {

constexpr double kEdge = 0.01;  // share of a range that counts as its bound

// The runs of the best candidates in the validation. Column i is of cases[i].
PairedResults fresh_results(const TuningPlan& plan, const TuningResult& result,
                            const std::vector<std::size_t>& cases) {
  const Objective& objective = plan.tuning().objectives.front();
  std::unordered_map<std::size_t, const PointResult*> made;
  for (const PointResult& run : result.runs) made.emplace(run.number, &run);
  const auto rows = static_cast<Eigen::Index>(plan.worlds(true).size());
  const auto columns = static_cast<Eigen::Index>(cases.size());
  PairedResults paired;
  paired.metrics = {objective.metric};
  paired.goals = {{objective.metric, objective.goal}};
  paired.values = {Eigen::MatrixXd(rows, columns)};
  paired.failed.resize(rows, columns);
  paired.runs.resize(rows, columns);
  std::map<std::string, int> numbers;  // by state hash: equal runs are repeats
  for (Eigen::Index i = 0; i < columns; ++i) {
    const std::size_t tuned = cases[static_cast<std::size_t>(i)];
    const TunedFront& best = result.fronts[tuned];
    paired.candidates.push_back(best.case_name);
    for (Eigen::Index world = 0; world < rows; ++world) {
      const PointResult& run = *made.at(plan.number(
          {tuned, best.points.front().evaluation, true, static_cast<std::size_t>(world)}));
      const std::string own = run.state_hash.empty() ? std::to_string(run.number) : run.state_hash;
      paired.runs(world, i) = numbers.emplace(own, static_cast<int>(numbers.size())).first->second;
      paired.failed(world, i) = run.status == PointStatus::complete ? 0.0 : 1.0;
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

}  // namespace

std::optional<Ranking> rank_tuned(const TuningPlan& plan, const TuningResult& result) {
  const Tuning& tuning = plan.tuning();
  const std::vector<std::size_t> cases = tuned_cases(result);
  if (tuning.has_front() || !tuning.validation || cases.size() < 2) return std::nullopt;
  const Objective& objective = tuning.objectives.front();
  return rank_candidates(fresh_results(plan, result, cases), objective.metric, objective.goal);
}

std::vector<std::size_t> tuned_order(const Tuning& tuning, const TuningResult& result,
                                     const std::optional<Ranking>& ranking) {
  const std::vector<std::size_t> cases = tuned_cases(result);
  std::vector<std::size_t> order = cases;
  if (ranking) {
    for (std::size_t i = 0; i < order.size(); ++i) order[i] = cases[ranking->rows[i].candidate];
    return order;
  }
  std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
    return minimised(tuning, result.fronts[a].points.front().tuned) <
           minimised(tuning, result.fronts[b].points.front().tuned);
  });
  return order;
}

std::vector<std::string> keys_at_bound(const TunedCase& tuned,
                                       const std::vector<std::string>& values) {
  std::vector<std::string> keys;
  for (std::size_t i = 0; i < values.size(); ++i) {
    if (is_at_bound(tuned.search[i], values[i])) keys.push_back(tuned.search[i].key);
  }
  return keys;
}

}  // namespace breakwater
