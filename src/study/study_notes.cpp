#include <breakwater/study/study_notes.h>

#include <fmt/format.h>

#include <map>
#include <optional>
#include <utility>

#include <breakwater/study/key_effects.h>

namespace breakwater {
namespace {

constexpr std::size_t kMostNamed = 4;  // metrics in a line

// Counts for each metric the complete runs of each candidate that have it.
class MetricCounts {
 public:
  explicit MetricCounts(const Plan& plan) : plan_(plan), complete_(plan.candidates().size()) {}

  void add(const PointResult& run) {
    if (run.status != PointStatus::complete) return;
    const std::size_t candidate = run.number % complete_.size();
    ++complete_[candidate];
    for (const auto& [name, value] : run.metrics) {
      counts_.try_emplace(name, complete_.size()).first->second[candidate]++;
    }
  }

  // Metrics that are missing in the same runs share a line.
  std::vector<std::string> lines() const {
    std::map<std::string, std::vector<std::string>> metrics;
    for (const auto& [name, counts] : counts_) {
      const std::string where = missing(counts);
      if (!where.empty()) metrics[where].push_back(name);
    }
    std::vector<std::string> lines;
    for (auto& [where, names] : metrics) {
      const std::size_t more = names.size() > kMostNamed ? names.size() - kMostNamed : 0;
      names.resize(names.size() - more);
      lines.push_back(fmt::format("{}{} missing: in {}", fmt::join(names, ", "),
                                  more > 0 ? fmt::format(" and {} more are", more)
                                           : std::string(names.size() > 1 ? " are" : " is"),
                                  where));
    }
    return lines;
  }

 private:
  // A text such as "12 of 40 complete runs of hpfc-2N"; empty if the metric is in no run.
  std::string missing(const std::vector<std::size_t>& counts) const {
    std::vector<std::string> parts;
    for (std::size_t c = 0; c < counts.size(); ++c) {
      // A metric that no run of a candidate has does not apply to it.
      if (counts[c] == 0 || counts[c] == complete_[c]) continue;
      parts.push_back(fmt::format("{} of {} complete runs of {}", complete_[c] - counts[c],
                                  complete_[c], plan_.candidates()[c].label));
    }
    if (parts.size() > kMostNamed) {
      const std::size_t more = parts.size() - kMostNamed;
      parts.resize(kMostNamed);
      parts.push_back(fmt::format("of {} more candidates", more));
    }
    return fmt::format("{}", fmt::join(parts, ", "));
  }

  const Plan& plan_;
  std::vector<std::size_t> complete_;
  std::map<std::string, std::vector<std::size_t>> counts_;
};

// Checks whether all seeds of every sample and candidate gave the same run.
class SeedEffect {
 public:
  explicit SeedEffect(const Plan& plan) : plan_(plan), first_(plan.candidates().size()) {}

  // Adds a run, in the order of the points.
  void add(const PointResult& run) {
    const std::size_t world = run.number / first_.size();
    auto& first = first_[run.number % first_.size()];
    const std::size_t sample = world / plan_.seeds();
    if (!first || first->first != sample) {
      first.emplace(sample, run);
      return;
    }
    ++pairs_;
    differs_ = differs_ || !are_same_run(run, first->second);
  }
  bool is_none() const { return pairs_ > 0 && !differs_; }

 private:
  const Plan& plan_;
  // Per candidate: a sample and its first run.
  std::vector<std::optional<std::pair<std::size_t, PointResult>>> first_;
  std::size_t pairs_ = 0;
  bool differs_ = false;
};

}  // namespace

bool are_same_run(const PointResult& one, const PointResult& other) {
  return one.state_hash == other.state_hash && one.metrics == other.metrics;
}

std::vector<std::string> notes(const Plan& plan, const ShardIndex& index) {
  MetricCounts metrics(plan);
  SeedEffect seeds(plan);
  for (std::size_t point = 0; point < index.points(); ++point) {
    if (!index.has(point)) continue;
    const PointResult run = index.read(point);
    metrics.add(run);
    if (run.status == PointStatus::complete) seeds.add(run);
  }
  std::vector<std::string> lines = metrics.lines();
  for (const KeyEffect& effect : key_effects(plan.study())) {
    if (effect.with.empty()) continue;
    lines.push_back(fmt::format(
        "vary: {}: varied together: their effects cannot be told apart, and are one", effect.name));
  }
  if (plan.seeds() == 1 && !plan.study().goals.empty()) {
    lines.emplace_back("seeds: one, so any noise is one draw of it (--dry-run looks for noise)");
  }
  if (seeds.is_none()) {
    lines.push_back(
        fmt::format("seeds: the {} of each sample gave the same run: {}", plan.seeds(), kNoNoise));
  }
  return lines;
}

}  // namespace breakwater
