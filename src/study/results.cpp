#include <breakwater/study/results.h>

#include <fmt/format.h>

#include <algorithm>
#include <boost/functional/hash.hpp>
#include <cerrno>
#include <cmath>
#include <cstring>
#include <fstream>
#include <limits>
#include <stdexcept>
#include <string_view>
#include <unordered_map>
#include <utility>

#include <breakwater/config/toml_text.h>
#include <breakwater/record/partial_file.h>
#include <breakwater/record/text_outputs.h>
#include <breakwater/shell/child_program.h>
#include <breakwater/shell/process.h>
#include <breakwater/shell/table.h>
#include <breakwater/statistics/sensitivity.h>

namespace breakwater {
namespace {

constexpr std::size_t kPointsOfAKind = 5;  // points named per kind of failures
constexpr double kNotMeasured = std::numeric_limits<double>::quiet_NaN();

// The varied keys without values.
std::vector<StudyKey> study_keys(const Study& study) {
  std::vector<StudyKey> keys;
  for (const VariedKey& varied : study.vary) {
    StudyKey key;
    key.name = varied.key;
    key.is_number = std::ranges::all_of(
        varied.values, [](const std::string& v) { return number_in(v).has_value(); });
    if (!key.is_number) {
      for (const std::string& value : varied.values) {
        const std::string text = plain_text(value);
        if (std::ranges::find(key.texts, text) == key.texts.end()) key.texts.push_back(text);
      }
    }
    keys.push_back(std::move(key));
  }
  return keys;
}

// A number for a key's value, given as TOML.
double key_number(const StudyKey& key, const std::string& value) {
  if (key.is_number) return *number_in(value);
  return static_cast<double>(std::ranges::find(key.texts, plain_text(value)) - key.texts.begin());
}

// "at 3.1 s: diverged" and "at 4 s: diverged" are one kind.
std::string without_numbers(std::string reason) {
  constexpr std::string_view kOfNumbers = "0123456789.e+-";
  std::erase_if(reason, [&](char c) { return kOfNumbers.find(c) != std::string_view::npos; });
  return reason;
}

std::size_t outcome_of(const PointResult& result) {
  auto outcome = static_cast<std::size_t>(result.status);
  boost::hash_combine(outcome, result.state_hash.empty() ? result.reason : result.state_hash);
  boost::hash_combine(outcome, result.metrics);
  return outcome;
}

constexpr std::size_t kMostWithoutBaseline = 20, kMostRanked = 100;
constexpr double kMostCompared = 2e8;

// Whether each seed of a sample is a block of its own.
bool counts_seeds(const Study& study) {
  return study.vary.empty() || study.are_seeds_worlds;
}

constexpr Eigen::Index kDraws = 4'000'000;  // drawn rows for the intervals of one output

// The mean of an output over the seeds, a row of the design per row; NaN if a seed has no value.
Eigen::MatrixXd design(const StudyNumbers& numbers, Eigen::Index rows, std::size_t candidate,
                       const std::vector<double>& output) {
  const auto columns = static_cast<Eigen::Index>(numbers.keys.size()) + 2;  // A, AB⁽¹⁾ … B
  Eigen::MatrixXd sum = Eigen::MatrixXd::Zero(rows, columns);
  Eigen::MatrixXd seeds = Eigen::MatrixXd::Zero(rows, columns);
  for (std::size_t i = 0; i < numbers.runs.size(); ++i) {
    const StudyRun& run = numbers.runs[i];
    if (run.candidate != candidate) continue;
    sum(run.sample / columns, run.sample % columns) += output[i];
    seeds(run.sample / columns, run.sample % columns) += 1.0;
  }
  return sum.cwiseQuotient(seeds);  // 0/0: no runs
}

}  // namespace

StudyNumbers study_numbers(const Plan& plan, const ShardIndex& index) {
  StudyNumbers numbers;
  numbers.keys = study_keys(plan.study());
  const std::size_t candidates = plan.candidates().size();
  const std::size_t points_of_a_sample = candidates * plan.seeds();
  for (std::size_t sample = 0; sample < plan.samples(); ++sample) {
    const StudyPoint point = plan.point(sample * points_of_a_sample);
    for (std::size_t k = 0; k < numbers.keys.size(); ++k) {
      numbers.keys[k].values.push_back(key_number(numbers.keys[k], point.values[k]));
    }
  }
  std::map<std::pair<PointStatus, std::string>, FailureKind> failures;
  for (std::size_t number = 0; number < index.points(); ++number) {
    if (!index.has(number)) continue;
    const PointResult result = index.read(number);
    const StudyRun run = {.number = number,
                          .sample = static_cast<std::uint32_t>(number / points_of_a_sample),
                          .candidate = static_cast<std::uint32_t>(number % candidates),
                          .failed = result.status != PointStatus::complete,
                          .outcome = outcome_of(result)};
    if (run.failed) {
      FailureKind& kind = failures[{result.status, without_numbers(result.reason)}];
      if (kind.runs++ == 0) {
        kind.status = result.status;
        kind.reason = result.reason;
        kind.of_candidate.resize(candidates);
      }
      ++kind.of_candidate[run.candidate];
      if (kind.first.size() < kPointsOfAKind) kind.first.push_back(number);
    }
    numbers.runs.push_back(run);
    for (const auto& [name, value] : result.metrics) {
      const auto [found, is_new] = numbers.columns.try_emplace(name);
      if (is_new) numbers.metrics.push_back(name);
      found->second.resize(numbers.runs.size(), kNotMeasured);
      found->second.back() = value;
    }
  }
  for (auto& [name, column] : numbers.columns) column.resize(numbers.runs.size(), kNotMeasured);
  for (const auto& [name, kind] : failures) numbers.failures.push_back(kind);
  std::ranges::stable_sort(numbers.failures, std::ranges::greater(), &FailureKind::runs);
  return numbers;
}

void put_first(const std::vector<std::string>& first, StudyNumbers& numbers) {
  std::ranges::stable_sort(numbers.metrics, std::ranges::less(), [&](const std::string& metric) {
    return std::ranges::find(first, metric) - first.begin();
  });
}

double RunGroup::at(double share) const {
  return values.empty() ? std::nan("") : quantile(values, share);
}

std::vector<RunGroup> grouped(const StudyNumbers& numbers, const std::vector<double>& column,
                              std::size_t groups,
                              const std::function<std::size_t(const StudyRun&)>& group_of) {
  std::vector<RunGroup> all(groups);
  std::vector<std::vector<std::pair<double, std::size_t>>> members(groups);  // values and points
  for (std::size_t i = 0; i < numbers.runs.size(); ++i) {
    const StudyRun& run = numbers.runs[i];
    const std::size_t g = group_of(run);
    RunGroup& group = all[g];
    ++group.runs;
    if (run.failed && group.failed++ == 0) group.first_failed = run.number;
    if (std::isfinite(column[i])) members[g].emplace_back(column[i], run.number);
  }
  for (std::size_t g = 0; g < groups; ++g) {
    std::sort(members[g].begin(), members[g].end());
    for (const auto& [value, point] : members[g]) {
      all[g].values.push_back(value);
      all[g].points.push_back(point);
    }
  }
  return all;
}

std::vector<ResultRow> study_indices(const StudyNumbers& numbers,
                                     const std::vector<std::string>& labels) {
  const auto rows_of_design =
      static_cast<Eigen::Index>(numbers.keys.front().values.size() / (numbers.keys.size() + 2));
  const auto replicates =
      static_cast<int>(std::clamp<Eigen::Index>(kDraws / rows_of_design, 200, 1000));
  std::vector<ResultRow> rows;
  const auto add = [&](const std::string& output, const std::vector<double>& values) {
    for (std::size_t c = 0; c < labels.size(); ++c) {
      const SensitivityIndices indices =
          sensitivity_indices(design(numbers, rows_of_design, c, values), replicates);
      for (std::size_t k = 0; k < numbers.keys.size(); ++k) {
        ResultRow& row = rows.emplace_back();
        row.put("candidate", labels[c]);
        row.put("output", output);
        row.put("key", numbers.keys[k].name);
        const auto put = [&](const char* column, const std::vector<EstimatedValue>& of_keys) {
          row.put(column, k < of_keys.size() ? of_keys[k] : EstimatedValue{});
        };
        put("first_order", indices.first_order);
        put("total", indices.total);
        row.put("rows", std::to_string(indices.rows));
        row.put("dropped_rows", std::to_string(indices.dropped_rows));
      }
    }
  };
  for (const std::string& metric : numbers.metrics) add(metric, numbers.columns.at(metric));
  std::vector<double> failed;
  for (const StudyRun& run : numbers.runs) failed.push_back(run.failed ? 1.0 : 0.0);
  add(kFailedOutput, failed);
  return rows;
}

void write_results(const Plan& plan, const ShardIndex& index,
                   const std::vector<std::string>& metrics, const std::filesystem::path& file) {
  std::vector<std::string> header = {"point", "case", "seed"};
  for (const VariedKey& key : plan.study().compare) header.push_back(key.key);
  for (const VariedKey& key : plan.study().vary) header.push_back(key.key);
  header.insert(header.end(), {"status", "state_hash"});
  std::unordered_map<std::string, std::size_t> columns;
  for (const std::string& metric : metrics) {
    columns.emplace(metric, header.size());
    header.push_back(metric);
  }
  PartialFile partial(file);
  std::ofstream stream(partial.path(), std::ios::binary);
  stream << csv_line(header);
  for (std::size_t number = 0; stream && number < index.points(); ++number) {
    if (!index.has(number)) continue;
    const PointResult result = index.read(number);
    const StudyPoint point = plan.point(number);
    const Candidate& candidate = plan.candidates()[point.candidate];
    std::vector<std::string> cells = {result.key, candidate.case_name,
                                      point.seed ? std::to_string(*point.seed) : ""};
    for (const std::string& value : candidate.values) cells.push_back(plain_text(value));
    for (const std::string& value : point.values) cells.push_back(plain_text(value));
    cells.push_back(name_of(result.status));
    cells.push_back(result.state_hash);
    cells.resize(header.size());
    for (const auto& [name, value] : result.metrics) {
      cells[columns.at(name)] = fmt::format("{:.17g}", value);
    }
    stream << csv_line(cells);
  }
  stream.close();
  if (!stream) {
    throw OutputError(
        fmt::format("{}: cannot be written ({})", file.string(), std::strerror(errno)));
  }
  partial.commit();
}

void write_sqlite(const std::filesystem::path& csv, const std::filesystem::path& file) {
  PartialFile partial(file);
  if (call_script("sweep", "results_sqlite.py", {csv.string(), partial.path()}) != kSuccess) {
    throw OutputError(file.string() +
                      ": cannot be written: it needs python3; install it, or remove the file");
  }
  partial.commit();
}

std::vector<std::string> missing_lines(
    const std::vector<std::string>& candidates,
    const std::map<std::string, std::vector<std::size_t>>& counts,
    const std::vector<std::size_t>& complete) {
  // Metrics that are missing in the same runs share a line.
  std::map<std::string, std::vector<std::string>> metrics;
  for (const auto& [name, of_candidates] : counts) {
    std::vector<std::string> parts;
    for (std::size_t c = 0; c < of_candidates.size(); ++c) {
      const std::size_t has = of_candidates[c];
      // It does not apply to a candidate of which no run has it.
      if (has == 0 || has == complete[c]) continue;
      parts.push_back(fmt::format("{} of {} complete runs of {}", complete[c] - has, complete[c],
                                  candidates[c]));
    }
    if (!parts.empty()) metrics[listed(std::move(parts))].push_back(name);
  }
  std::vector<std::string> lines;
  for (const auto& [where, names] : metrics) {
    lines.push_back(
        fmt::format("{} {} missing: in {}", listed(names), names.size() > 1 ? "are" : "is", where));
  }
  return lines;
}

std::vector<std::string> notes(const Plan& plan, const StudyNumbers& numbers) {
  const std::size_t candidates = plan.candidates().size();
  std::vector<std::size_t> complete(candidates);
  std::vector<const StudyRun*> first(candidates);  // in the last sample of each candidate
  std::size_t pairs = 0, different = 0;
  for (const StudyRun& run : numbers.runs) {
    if (run.failed) continue;
    ++complete[run.candidate];
    const StudyRun*& other = first[run.candidate];
    if (other == nullptr || other->sample != run.sample) {
      other = &run;
      continue;
    }
    ++pairs;
    different += run.outcome != other->outcome;
  }
  std::map<std::string, std::vector<std::size_t>> counts;  // the runs with each metric
  for (const auto& [metric, column] : numbers.columns) {
    std::vector<std::size_t>& count = counts[metric];
    count.resize(candidates);
    for (std::size_t i = 0; i < numbers.runs.size(); ++i) {
      const StudyRun& run = numbers.runs[i];
      count[run.candidate] += !run.failed && !std::isnan(column[i]);
    }
  }
  std::vector<std::string> labels;
  for (const Candidate& candidate : plan.candidates()) labels.push_back(candidate.label);
  std::vector<std::string> lines = missing_lines(labels, counts, complete);
  if (plan.seeds() == 1 && !plan.study().goals.empty()) {
    lines.emplace_back("seeds: one, so any noise is one draw of it (--dry-run looks for noise)");
  }
  if (pairs > 0 && different == 0) {
    lines.push_back(
        fmt::format("seeds: the {} of each sample gave the same run: {}", plan.seeds(), kNoNoise));
  }
  return lines;
}

PairedResults paired_results(const Plan& plan, const StudyNumbers& numbers,
                             const std::vector<std::string>& metrics) {
  const Study& study = plan.study();
  PairedResults results;
  for (const Candidate& candidate : plan.candidates()) {
    if (candidate.label == study.baseline) results.baseline = results.candidates.size();
    results.candidates.push_back(candidate.label);
  }
  results.metrics = !metrics.empty()         ? metrics
                    : !study.metrics.empty() ? study.metrics
                                             : numbers.metrics;
  results.goals = {study.goals.begin(), study.goals.end()};
  const std::size_t k = plan.candidates().size();
  if (static_cast<double>(plan.size()) * static_cast<double>(results.metrics.size()) >
      kMostCompared) {
    throw std::invalid_argument(
        fmt::format("compare.metrics: {} metrics of {} runs are too many to compare: name some",
                    results.metrics.size(), plan.size()));
  }
  // A sample waits until all its seeds have run. Earlier, repeats could not be recognised.
  const std::size_t together = counts_seeds(study) ? k : k * plan.seeds();
  const std::vector<StudyRun>& runs = numbers.runs;
  std::vector<std::size_t> worlds;  // the first run of each test condition
  for (std::size_t begin = 0, end = 0; begin < runs.size(); begin = end) {
    const std::size_t sample = runs[begin].number / together;
    while (end < runs.size() && runs[end].number / together == sample) ++end;
    if (end - begin < together) continue;
    for (std::size_t world = begin; world < end; world += k) worlds.push_back(world);
  }
  const auto rows = static_cast<Eigen::Index>(worlds.size()), width = static_cast<Eigen::Index>(k);
  results.failed.resize(rows, width);
  results.runs.resize(rows, width);
  results.samples.resize(rows);
  std::unordered_map<std::size_t, int> outcomes;  // their numbers
  std::vector<Coordinates> places;
  for (Eigen::Index row = 0; row < rows; ++row) {
    const StudyRun* const first = &runs[worlds[static_cast<std::size_t>(row)]];
    results.samples(row) = static_cast<int>(first->number / together);
    Coordinates& place = places.emplace_back();
    for (const StudyKey& key : numbers.keys) place.push_back(key.values[first->sample]);
    place.push_back(static_cast<double>(first->number / k % plan.seeds()));
    for (Eigen::Index c = 0; c < width; ++c) {
      results.failed(row, c) = first[c].failed ? 1.0 : 0.0;
      results.runs(row, c) =
          outcomes.emplace(first[c].outcome, static_cast<int>(outcomes.size())).first->second;
    }
  }
  for (const std::string& metric : results.metrics) {
    Eigen::MatrixXd& values =
        results.values.emplace_back(Eigen::MatrixXd::Constant(rows, width, kNotMeasured));
    const auto found = numbers.columns.find(metric);
    if (found == numbers.columns.end()) continue;
    const double* const column = found->second.data();
    for (Eigen::Index row = 0; row < rows; ++row) {
      values.row(row) = Eigen::Map<const Eigen::RowVectorXd>(
          column + worlds[static_cast<std::size_t>(row)], width);
    }
  }
  number_failed_runs(places, results);
  return results;
}

std::optional<CandidateComparison> compare_study(const Plan& plan, const StudyNumbers& numbers) {
  if (most_blocks(plan) == 0) return std::nullopt;
  return compare_candidates(paired_results(plan, numbers));
}

std::optional<Ranking> rank_study(const Plan& plan, const StudyNumbers& numbers) {
  const Study& study = plan.study();
  const std::size_t candidates = plan.candidates().size();
  if (study.goals.empty() || candidates < 2 || candidates > kMostRanked) return std::nullopt;
  const auto& [metric, goal] = study.goals.front();
  std::vector<std::string> metrics = {metric};
  for (const Bound& bound : study.require.bounds) {
    if (bound.metric != metric) metrics.push_back(bound.metric);
  }
  return rank_candidates(paired_results(plan, numbers, metrics), metric, goal, study.require);
}

std::size_t most_blocks(const Plan& plan) {
  const std::size_t candidates = plan.candidates().size();
  if (candidates < 2) return 0;
  if (plan.study().baseline.empty() && candidates > kMostWithoutBaseline) return 0;
  return plan.samples() * (counts_seeds(plan.study()) ? plan.seeds() : 1);
}

}  // namespace breakwater
