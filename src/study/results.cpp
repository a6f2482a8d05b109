#include <breakwater/study/results.h>

#include <fmt/format.h>

#include <cerrno>
#include <cstring>
#include <fstream>
#include <map>
#include <optional>
#include <set>
#include <unordered_map>

#include <breakwater/config/toml_text.h>
#include <breakwater/record/partial_file.h>
#include <breakwater/record/text_outputs.h>
#include <breakwater/shell/child_program.h>
#include <breakwater/shell/process.h>
#include <breakwater/shell/table.h>
#include <breakwater/study/plan.h>

namespace breakwater {
std::vector<std::string> metrics_of(const ShardIndex& index) {
  std::vector<std::string> metrics;
  std::set<std::string> known;
  for (std::size_t point = 0; point < index.points(); ++point) {
    if (!index.has(point)) continue;
    for (const auto& [name, value] : index.read(point).metrics) {
      if (known.insert(name).second) metrics.push_back(name);
    }
  }
  return metrics;
}

std::vector<std::string> write_results(const Plan& plan, const ShardIndex& index,
                                       const std::filesystem::path& file) {
  std::vector<std::string> header = {"point", "case", "seed"};
  for (const VariedKey& key : plan.study().compare) header.push_back(key.key);
  for (const VariedKey& key : plan.study().vary) header.push_back(key.key);
  header.insert(header.end(), {"status", "state_hash"});
  const std::vector<std::string> metrics = metrics_of(index);
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
  return metrics;
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

bool are_same_run(const PointResult& one, const PointResult& other) {
  return one.state_hash == other.state_hash && one.metrics == other.metrics;
}

std::vector<std::string> notes(const Plan& plan, const ShardIndex& index) {
  const std::size_t candidates = plan.candidates().size();
  std::vector<std::size_t> complete(candidates);
  std::map<std::string, std::vector<std::size_t>> counts;  // the runs with each metric
  std::vector<std::optional<PointResult>> first(
      candidates);  // in the last sample of each candidate
  const auto sample_of = [&](const PointResult& run) {
    return run.number / candidates / plan.seeds();
  };
  std::size_t pairs = 0, different = 0;
  for (std::size_t point = 0; point < index.points(); ++point) {
    if (!index.has(point) || index.status(point) != PointStatus::complete) continue;
    const PointResult run = index.read(point);
    const std::size_t candidate = point % candidates;
    ++complete[candidate];
    for (const auto& [name, value] : run.metrics) {
      ++counts.try_emplace(name, candidates).first->second[candidate];
    }
    std::optional<PointResult>& other = first[candidate];
    if (!other || sample_of(*other) != sample_of(run)) {
      other = run;
      continue;
    }
    ++pairs;
    different += are_same_run(run, *other) ? 0 : 1;
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

}  // namespace breakwater
