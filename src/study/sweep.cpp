#include <breakwater/study/sweep.h>

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <optional>
#include <set>
#include <stdexcept>

#include <breakwater/record/file_hash.h>
#include <breakwater/scenario/run_manifest.h>

namespace breakwater {
namespace {

constexpr const char* kAll = "all";

Study completed(Study study, const ScenarioFile& file) {
  if (study.cases.empty()) study.cases = {file.default_case()};
  if (study.cases == std::vector<std::string>{kAll}) study.cases = file.cases();
  std::set<std::optional<double>> seeds;
  for (const std::string& name : study.cases) {
    seeds.insert(file.config(name, study.sets).number("run.seed"));
  }
  if (study.seeds.empty() && seeds.size() == 1 && *seeds.begin()) {
    study.seeds = {static_cast<std::uint64_t>(**seeds.begin())};
  }
  return study;
}

// A mistake in a value that a study gives, with the place where it gives it.
std::string blamed(const Study& study, const std::string& error) {
  const std::string set = "--set: ";
  if (!error.starts_with(set)) return error;
  for (const auto* keys : {&study.vary, &study.compare}) {
    for (const VariedKey& key : *keys) {
      if (error.starts_with(set + key.key + ": ")) {
        return key.place + error.substr(set.size() + key.key.size());
      }
    }
  }
  return error;
}

// Whose runs take longer in proportion.
double steps_of(const Config& config) {
  return config.number("run.duration_s").value_or(1.0) /
         config.number("physics.timestep_s").value_or(1.0);
}

// A source that keeps the folder of every point.
class Kept : public PointSource {
 public:
  Kept(const Sweep& sweep, const StudyFolder& folder) : sweep_(sweep), folder_(folder) {}
  PreparedRun prepare(std::size_t point) const override { return sweep_.prepare(point); }
  std::string unprepared_key(std::size_t point) const override {
    return sweep_.unprepared_key(point);
  }
  std::filesystem::path folder(std::size_t, const std::string& key, bool) const override {
    return folder_.run(key);
  }
  bool logs(std::size_t) const override { return true; }

 private:
  const Sweep& sweep_;
  const StudyFolder& folder_;
};

}  // namespace

Sweep::Sweep(const Catalogue& catalogue, Study study) : catalogue_(catalogue) {
  const ScenarioKind& kind = catalogue.get<ScenarioKind>(study.scenario);
  const std::string file = study.config.empty() ? kind.file().string() : study.config;
  file_ = std::make_unique<ScenarioFile>(file, study.scenario);
  plan_ = std::make_unique<Plan>(completed(std::move(study), *file_));
}

PreparedRun Sweep::prepare(const StudyPoint& point) const {
  return prepare_point(catalogue_, plan_->study().scenario, *file_,
                       plan_->candidates()[point.candidate].case_name, point.sets);
}

PreparedRun Sweep::prepare(std::size_t point) const {
  return prepare(plan_->point(point));
}

std::string Sweep::unprepared_key(std::size_t number) const {
  const StudyPoint point = plan_->point(number);
  std::vector<std::string> parts = {plan_->study().scenario,
                                    plan_->candidates()[point.candidate].case_name};
  parts.insert(parts.end(), point.sets.begin(), point.sets.end());
  return fingerprint(parts);
}

std::filesystem::path Sweep::folder(std::size_t, const std::string& key, bool failed) const {
  const Keep keep = plan_->study().keep;
  const bool keeps = keep == Keep::all || (keep == Keep::failed && failed);
  return keeps && folder_ ? folder_->run(key) : std::filesystem::path();
}

bool Sweep::logs(std::size_t) const {
  return plan_->study().keep == Keep::all && folder_;
}

void Sweep::check() const {
  const SharedModels shared;
  const Study& study = plan_->study();
  const std::vector<StudyPoint> probes = plan_->probes();
  try {
    // The first one checks every table of the file too.
    prepare_run(catalogue_, study.scenario, *file_,
                plan_->candidates()[probes.front().candidate].case_name, probes.front().sets);
    for (const StudyPoint& probe : probes) prepare(probe);
  } catch (const std::invalid_argument& error) {
    throw std::invalid_argument(blamed(study, error.what()));
  }
}

std::vector<std::size_t> parse_points(const std::string& text, std::size_t size) {
  const auto fail = [&]() -> std::vector<std::size_t> {
    throw std::invalid_argument(
        fmt::format("--points: {}: must be ranges of 0 to {}: 0-99,120", text, size - 1));
  };
  std::vector<std::size_t> points;
  const char* at = text.data();
  const char* const end = at + text.size();
  while (true) {
    std::size_t first = 0;
    auto read = std::from_chars(at, end, first);
    if (read.ec != std::errc()) return fail();
    std::size_t last = first;
    if (read.ptr != end && *read.ptr == '-') read = std::from_chars(read.ptr + 1, end, last);
    if (read.ec != std::errc() || last < first || last >= size) return fail();
    for (std::size_t point = first; point <= last; ++point) points.push_back(point);
    if (read.ptr == end) break;
    if (*read.ptr != ',') return fail();
    at = read.ptr + 1;
  }
  std::sort(points.begin(), points.end());
  points.erase(std::unique(points.begin(), points.end()), points.end());
  return points;
}

std::string print_points(const std::vector<std::size_t>& points) {
  std::string text;
  for (std::size_t i = 0; i < points.size();) {
    std::size_t end = i + 1;
    while (end < points.size() && points[end] == points[end - 1] + 1) ++end;
    if (!text.empty()) text += ',';
    text += std::to_string(points[i]);
    if (end - i > 1) text += fmt::format("-{}", points[end - 1]);
    i = end;
  }
  return text;
}

std::vector<std::size_t> pending(const ShardIndex& index) {
  std::vector<std::size_t> points;
  for (std::size_t point = 0; point < index.points(); ++point) {
    if (!index.has(point)) points.push_back(point);
  }
  return points;
}

Estimate estimate(const Sweep& sweep, const std::atomic<bool>& stop) {
  const Plan& plan = sweep.plan();
  const auto varies = [&](const std::string& key) {
    const auto is_key = [&](const VariedKey& varied) { return varied.key == key; };
    return std::any_of(plan.study().vary.begin(), plan.study().vary.end(), is_key) ||
           std::any_of(plan.study().compare.begin(), plan.study().compare.end(), is_key);
  };
  const auto steps = [&](std::size_t number) {
    const StudyPoint point = plan.point(number);
    return steps_of(sweep.file().config(plan.candidates()[point.candidate].case_name, point.sets));
  };
  std::vector<double> first_steps;
  for (std::size_t c = 0; c < plan.candidates().size(); ++c) {
    first_steps.push_back(steps(plan.first_of(c)));
  }
  const std::size_t candidates = plan.candidates().size();
  std::vector<double> weights(candidates, static_cast<double>(plan.size() / candidates));
  if (varies("run.duration_s") || varies("physics.timestep_s")) {
    std::fill(weights.begin(), weights.end(), 0.0);
    for (std::size_t point = 0; point < plan.size(); ++point) {
      const std::size_t candidate = point % candidates;
      weights[candidate] += steps(point) / first_steps[candidate];
    }
  }
  Estimate estimate;
  RunControl control;
  control.stop = &stop;
  for (std::size_t c = 0; c < candidates; ++c) {
    const PointResult result = run_point(plan.first_of(c), sweep, control);
    estimate.of_candidate.push_back(result.cost_s);
    estimate.seconds += result.cost_s * weights[c];
  }
  return estimate;
}

PointResult replay(const Sweep& sweep, const StudyFolder& folder, const ShardIndex& index,
                   const std::string& key, const std::atomic<bool>& stop) {
  const std::size_t point = index.find(key);
  if (point == index.points()) {
    throw std::invalid_argument(
        fmt::format("--replay: no point of {} that ran is {}: the column `point` of results.csv "
                    "names them",
                    folder.path().string(), key));
  }
  RunControl control;
  control.stop = &stop;
  return run_point(point, Kept(sweep, folder), control);
}

}  // namespace breakwater
