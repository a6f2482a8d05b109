#include <breakwater/study/sweep.h>

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <map>
#include <optional>
#include <set>
#include <stdexcept>
#include <utility>

#include <breakwater/record/file_hash.h>
#include <breakwater/study/study.h>

namespace breakwater {
namespace {

constexpr const char* kAll = "all";

// The keys that a study varies, compares or sets, with their places.
std::vector<std::pair<std::string, std::string>> places_of_keys(const Study& study) {
  std::vector<std::pair<std::string, std::string>> places;
  for (const auto* keys : {&study.vary, &study.compare}) {
    for (const VariedKey& key : *keys) places.emplace_back(key.key, key.place);
  }
  for (const std::string& set : study.sets) {
    const std::string key = set.substr(0, set.find('='));
    places.emplace_back(key, place_of(study.places, "set." + key));
  }
  return places;
}

// Names the place of a wrong value in the study.
std::string blamed(const Study& study, const std::string& error) {
  const std::string set = "--set: ";
  if (!error.starts_with(set)) return error;
  const std::size_t end = std::min(error.find(": ", set.size()), error.size());
  const std::string wrong = error.substr(set.size(), end - set.size());
  std::string of_array;  // the array whose element is wrong, or reverse
  for (const auto& [key, place] : places_of_keys(study)) {
    if (wrong == key || is_element_of(wrong, key)) {
      return place + error.substr(set.size() + key.size());
    }
    if (of_array.empty() && is_element_of(key, wrong)) of_array = place + error.substr(end);
  }
  return of_array.empty() ? error : of_array;
}

// Calls `body`, and names the place in the study of what it refuses.
template <typename Body>
auto in(const Study& study, const Body& body) {
  try {
    return body();
  } catch (const std::invalid_argument& error) {
    throw std::invalid_argument(blamed(study, error.what()));
  }
}

Study completed(Study study, const ScenarioFile& file) {
  if (study.cases.empty()) study.cases = {file.default_case()};
  if (study.cases == std::vector<std::string>{kAll}) study.cases = file.cases();
  std::set<std::optional<std::int64_t>> seeds;
  for (const std::string& name : study.cases) {
    file.check_case(name, place_of(study.places, "case"));
    const Config config = in(study, [&] { return file.config(name, study.sets); });
    const ConfigEntry* entry = config.find("run.seed");
    const auto* seed = entry == nullptr ? nullptr : std::get_if<std::int64_t>(&entry->value.data);
    seeds.insert(seed == nullptr ? std::nullopt : std::optional(*seed));
  }
  if (study.seeds.empty() && seeds.size() == 1 && seeds.begin()->value_or(-1) >= 0) {
    study.seeds = {static_cast<std::uint64_t>(**seeds.begin())};
    // A study's file must not have both.
    std::erase_if(study.sets, [](const std::string& set) { return set.starts_with("run.seed="); });
  }
  return study;
}

}  // namespace

std::shared_ptr<const ScenarioFile> scenario_file(const Catalogue& catalogue,
                                                  const std::string& scenario,
                                                  const std::string& config, const Places& places) {
  const ScenarioKind* kind = nullptr;
  try {
    kind = &catalogue.get<ScenarioKind>(scenario);
  } catch (const std::invalid_argument& error) {
    throw std::invalid_argument(place_of(places, "scenario") + ": " + error.what());
  }
  if (!config.empty() && !std::filesystem::exists(config)) {
    throw std::invalid_argument(place_of(places, "config") + ": there is no file " + config);
  }
  return kind->scenario_file(config);
}

Sweep::Sweep(const Catalogue& catalogue, Study study) : catalogue_(catalogue) {
  file_ = scenario_file(catalogue, study.scenario, study.config, study.places);
  plan_ = std::make_unique<Plan>(completed(std::move(study), *file_));
}

Sweep Sweep::with_next_seed() const {
  Study study = plan_->study();
  study.seeds = {study.seeds.front() + 1};
  return {catalogue_, std::move(study)};
}

PreparedRun Sweep::prepare(const StudyPoint& point,
                           const std::shared_ptr<BoundCases>& bound) const {
  return prepare_point(catalogue_, plan_->study().scenario, *file_,
                       plan_->candidates()[point.candidate].case_name, point.sets, bound);
}

PreparedRun Sweep::prepare(std::size_t point) const {
  return prepare(plan_->point(point), bound_);
}

std::vector<std::string> Sweep::defined_metrics(std::size_t point) const {
  std::vector<std::string> names;
  try {
    for (const MetricDefinition& one : prepare(point).scenario->metric_definitions()) {
      names.push_back(one.name);
    }
  } catch (const std::invalid_argument&) {
    return names;
  }
  return names;
}

std::string Sweep::asked(std::size_t number) const {
  const StudyPoint point = plan_->point(number);
  std::vector<std::string> parts = {plan_->study().scenario,
                                    plan_->candidates()[point.candidate].case_name};
  for (const std::string& set : point.sets) {
    // 1.0 is 1.
    parts.push_back(set.ends_with(".0") ? set.substr(0, set.size() - 2) : set);
  }
  std::sort(parts.begin() + 2, parts.end());  // their order changes no run
  return fingerprint(parts);
}

std::filesystem::path Sweep::folder(std::size_t, const std::string& key, bool failed) const {
  const bool keeps = keep_ == Keep::all || (keep_ == Keep::failed && failed);
  return keeps ? folder_->run(key) : std::filesystem::path();
}

void Sweep::check_metrics() const {
  const Study& study = plan_->study();
  const std::size_t candidates = plan_->candidates().size();
  std::vector<std::string> known;
  for (const std::size_t first : {std::size_t{0}, plan_->size() - candidates}) {
    for (std::size_t c = 0; c < candidates; ++c) {
      if (unknown_metrics(study, known).empty()) return;
      for (std::string& name : defined_metrics(first + c)) {
        const bool is_there = std::find(known.begin(), known.end(), name) != known.end();
        if (!is_there) known.push_back(std::move(name));
      }
    }
  }
  if (known.empty()) return;
  for (const NamedMetric& one : unknown_metrics(study, known)) {
    if (one.meant.empty()) continue;
    throw std::invalid_argument(one.place + ": there is no such metric" + one.meant);
  }
}

std::vector<std::string> Sweep::check() const {
  const SharedModels shared;
  const Study& study = plan_->study();
  const std::vector<StudyPoint> probes = plan_->probes();
  // By key: the number of probes and the reason.
  std::map<std::string, std::pair<std::size_t, std::string>> ineffective;
  in(study, [&] {
    // The first one also checks every table of the file.
    prepare_run(catalogue_, study.scenario, *file_,
                plan_->candidates()[probes.front().candidate].case_name, probes.front().sets);
    for (const StudyPoint& probe : probes) {
      for (const IneffectiveKey& key : prepare(probe, nullptr).ineffective) {
        auto& [count, reason] = ineffective[key.key];
        ++count;
        reason = key.reason;
      }
    }
  });
  check_metrics();
  std::vector<std::string> warnings;
  for (const auto& [key, place] : places_of_keys(study)) {
    const auto found = ineffective.find(whole_key(key));
    if (found == ineffective.end() || found->second.first < probes.size()) continue;
    warnings.push_back(fmt::format("{}: {}", place, found->second.second));
  }
  const bool is_even = study.method == Method::sobol || study.method == Method::saltelli;
  if (is_even && !std::has_single_bit(study.samples)) {
    warnings.push_back(fmt::format("samples: Sobol' points are even for a power of two: {} or {}",
                                   std::bit_floor(study.samples), std::bit_ceil(study.samples)));
  }
  return warnings;
}

}  // namespace breakwater
