#include <breakwater/search/tuning.h>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <sstream>
#include <stdexcept>

#include <breakwater/config/toml_text.h>
#include <breakwater/study/study_reader.h>

namespace breakwater {
namespace {

constexpr std::int64_t kMostEvaluations = 1'000'000;
constexpr std::int64_t kUsuallyValidated = 20;
constexpr double kNine = 0.9;  // nine of ten runs

// The entry as a table. Fails with an example if it is a value.
const TomlEntry& metric_table(const TomlEntry& entry, const char* example) {
  if (!entry.node()->is_table()) entry.fail(fmt::format("must be a table: {}", example));
  return entry;
}

void read_objectives(const TomlEntry& table, Tuning& tuning) {
  for (const auto& [metric, entry] : table.entries()) {
    metric_table(entry, "{ goal = \"min\", over = \"median\" }").allow({"goal", "over"});
    if (!entry["goal"]) entry["goal"].fail("is missing: min or max");
    Objective objective;
    objective.metric = metric;
    tuning.named.push_back({entry.place(), metric});
    objective.goal = entry["goal"].choice(goal_names());
    entry["over"].choice(over_names(), objective.over);
    tuning.objectives.push_back(std::move(objective));
  }
  if (tuning.objectives.empty()) {
    throw std::invalid_argument(table.file() + ": objective: names no metric");
  }
}

void read_constraints(const TomlEntry& table, Tuning& tuning) {
  for (const auto& [metric, entry] : table.entries()) {
    metric_table(entry, "{ max = 1, over = \"worst\" }").allow({"min", "max", "over"});
    Constraint constraint;
    constraint.metric = metric;
    tuning.named.push_back({entry.place(), metric});
    if (!entry["min"] == !entry["max"]) entry.fail("must have either min or max");
    constraint.min = entry["min"].number_or_nothing().value_or(constraint.min);
    constraint.max = entry["max"].number_or_nothing().value_or(constraint.max);
    entry["over"].choice(over_names(), constraint.over);
    tuning.constraints.push_back(std::move(constraint));
  }
}

std::vector<VariedKey> read_searched(const TomlEntry& table) {
  std::vector<VariedKey> keys = read_varied(table);
  for (const VariedKey& key : keys) {
    if (key.distribution && !key.distribution->is_bounded()) {
      throw std::invalid_argument(key.place +
                                  ": a search needs ends: uniform, log_uniform or values");
    }
  }
  return keys;
}

std::vector<VariedKey> read_world(const TomlEntry& table) {
  std::vector<VariedKey> keys = read_varied(table);
  for (const VariedKey& key : keys) {
    if (!key.distribution) continue;
    throw std::invalid_argument(key.place + ": a world has values: an array, lin() or log()");
  }
  return keys;
}

void read_cases(const TomlEntry& root, Tuning& tuning) {
  const std::vector<VariedKey> common = read_searched(root["search"]);
  const TomlEntry each = root["for_each"];
  const TomlEntry one = root["case"];
  if (each && one) one.fail("stands beside for_each: leave one of them out");
  tuning.is_for_each = static_cast<bool>(each);
  std::vector<std::pair<std::string, TomlEntry>> named = each.entries();
  for (const std::string& name : one.texts()) named.emplace_back(name, one);
  if (each && named.empty()) each.fail("names no case");
  if (named.empty()) named.emplace_back("", one);
  for (const auto& [name, entry] : named) {
    TunedCase tuned{name, entry.place(), common};
    if (each) metric_table(entry, "of keys that are searched");
    for (VariedKey& searched : each ? read_searched(entry) : std::vector<VariedKey>()) {
      if (has_key(common, searched)) {
        throw std::invalid_argument(searched.place + ": is given twice");
      }
      tuned.search.push_back(std::move(searched));
    }
    if (tuned.search.empty()) {
      throw std::invalid_argument(root.file() + ": search: names no key" +
                                  (name.empty() ? "" : " for " + name));
    }
    tuning.cases.push_back(std::move(tuned));
  }
}

void read_validation(const TomlEntry& table, Tuning& tuning) {
  if (!table) return;
  table.allow({"seeds", "world", "points"});
  const TomlEntry seeds = table["seeds"], world = table["world"];
  const Study& own = tuning.worlds.study();
  Plan worlds = worlds_of(seeds ? read_seeds(seeds) : own.seeds,
                          world ? read_world(world) : own.vary, own.method == Method::list);
  if (!seeds && !world) {
    table.fail("needs seeds or a world that the tuning does not have");
  }
  for (std::size_t i = 0; i < worlds.size(); ++i) {
    for (std::size_t k = 0; k < tuning.worlds.size(); ++k) {
      if (worlds.point(i).sets == tuning.worlds.point(k).sets) {
        table.fail("has a world that the tuning has too");
      }
    }
  }
  tuning.validation = std::move(worlds);
  const TomlEntry points = table["points"];
  if (points && !tuning.has_front())
    points.fail("is of a front, which one objective does not have");
  tuning.validated_points = static_cast<std::size_t>(points ? points.whole(1, kMostEvaluations)
                                                     : tuning.has_front() ? kUsuallyValidated
                                                                          : 1);
}

void check_fits(const TomlEntry& root, const Tuning& tuning) {
  std::vector<const Study*> all = {&tuning.worlds.study()};
  if (tuning.validation) all.push_back(&tuning.validation->study());
  for (const Study* worlds : all) check_seeds(tuning.sets, worlds->seeds, tuning.places);
  for (const TunedCase& tuned : tuning.cases) {
    const std::string reason = objection(tuning.settings(tuned));
    const char* key = reason.find("budget") != std::string::npos       ? "budget"
                      : reason.find("population") != std::string::npos ? "population"
                                                                       : "algorithm";
    if (!reason.empty()) root[key].fail(reason);
    check_keys(tuned.search, tuning.sets, "searched");
    for (const Study* worlds : all) {
      check_keys(worlds->vary, tuning.sets, "varied", worlds->method == Method::list);
      for (const VariedKey& varied : worlds->vary) {
        if (!has_key(tuned.search, varied)) continue;
        throw std::invalid_argument(varied.place + ": is searched too");
      }
    }
  }
}

}  // namespace

const Names<Over>& over_names() {
  static const Names<Over> names = {
      {"median", Over::median}, {"mean", Over::mean}, {"q90", Over::q90}, {"worst", Over::worst}};
  return names;
}

double gathered(std::vector<double> values, Over over, bool large_is_bad) {
  std::sort(values.begin(), values.end());
  switch (over) {
    case Over::median:
      return sample_median(values);
    case Over::mean:
      return sample_mean(values);
    case Over::q90:
      return quantile(values, large_is_bad ? kNine : 1.0 - kNine);
    case Over::worst:
      return large_is_bad ? values.back() : values.front();
  }
  throw std::logic_error("no such rule");
}

Plan worlds_of(std::vector<std::uint64_t> seeds, std::vector<VariedKey> keys, bool is_list) {
  Study study;
  study.method = is_list ? Method::list : Method::grid;
  study.seeds = std::move(seeds);
  study.vary = std::move(keys);
  study.cases = {""};
  study.places["vary"] = "world";
  return Plan(std::move(study));
}

SearchSettings Tuning::settings(const TunedCase& tuned) const {
  return {.algorithm = algorithm,
          .dimension = tuned.search.size(),
          .objectives = objectives.size(),
          .budget = budget,
          .population = population,
          .seed = sampling_seed};
}

Tuning read_tuning(const toml::table& tables, const std::string& file) {
  const TomlEntry root = study_root(tables, file);
  if (const TomlEntry vary = root["vary"]) vary.fail("is of a sweep: breakwater sweep");
  root.allow({"scenario", "config", "case", "for_each", "set", "algorithm", "budget", "population",
              "sampling_seed", "seeds", "search", "worlds", "world", "objective", "constraint",
              "validate", "made_by"});
  Tuning tuning;
  read_base(root, tuning);
  root["algorithm"].choice(search_algorithms(), tuning.algorithm);
  tuning.budget = static_cast<std::size_t>(root["budget"].whole(1, kMostEvaluations));
  tuning.population = usual_population(tuning.algorithm);
  if (const TomlEntry population = root["population"]) {
    tuning.population = static_cast<std::size_t>(population.whole(1, kMostEvaluations));
  }
  if (const TomlEntry seed = root["sampling_seed"]) {
    tuning.sampling_seed =
        static_cast<std::uint32_t>(seed.whole(0, std::numeric_limits<std::uint32_t>::max()));
  }
  bool is_list = false;
  root["worlds"].choice<bool>({{"grid", false}, {"list", true}}, is_list);
  tuning.worlds = worlds_of(read_seeds(root["seeds"]), read_world(root["world"]), is_list);
  read_objectives(root["objective"], tuning);
  read_constraints(root["constraint"], tuning);
  read_cases(root, tuning);
  read_validation(root["validate"], tuning);
  check_fits(root, tuning);
  return tuning;
}

std::string Tuning::print() const {
  const auto over = [](Over rule) { return toml_string(name_of(over_names(), rule)); };
  std::string text = print_head(*this);
  if (!is_for_each && !cases.front().name.empty()) {
    std::vector<std::string> names;
    for (const TunedCase& tuned : cases) names.push_back(tuned.name);
    text += fmt::format("case = {}\n", toml_strings(names));
  }
  text += fmt::format("algorithm = {}\nbudget = {}\npopulation = {}\nsampling_seed = {}\n",
                      toml_string(name_of(search_algorithms(), algorithm)), budget, population,
                      sampling_seed);
  text += print_seeds(worlds.study().seeds);
  if (worlds.study().method == Method::list) text += "worlds = \"list\"\n";
  text += print_sets(*this);
  if (is_for_each) {
    for (const TunedCase& tuned : cases) {
      text += fmt::format("\n[for_each.{}]\n", toml_string(tuned.name)) + print_keys(tuned.search);
    }
  } else {
    text += "\n[search]\n" + print_keys(cases.front().search);
  }
  const auto& varied = worlds.study().vary;
  if (!varied.empty()) text += "\n[world]\n" + print_keys(varied);
  text += "\n[objective]\n";
  for (const Objective& one : objectives) {
    text += fmt::format("{} = {{ goal = {}, over = {} }}\n", toml_string(one.metric),
                        toml_string(name_of(goal_names(), one.goal)), over(one.over));
  }
  if (!constraints.empty()) text += "\n[constraint]\n";
  for (const Constraint& one : constraints) {
    text += fmt::format("{} = {{ {} = {}, over = {} }}\n", toml_string(one.metric),
                        std::isfinite(one.max) ? "max" : "min",
                        toml_number(std::isfinite(one.max) ? one.max : one.min), over(one.over));
  }
  if (validation) {
    text += "\n[validate]\n";
    if (has_front()) text += fmt::format("points = {}\n", validated_points);
    text += print_seeds(validation->study().seeds);
    const auto& fresh = validation->study().vary;
    if (!fresh.empty()) text += "\n[validate.world]\n" + print_keys(fresh);
  }
  return text;
}

std::optional<TuningCandidate> read_candidate(const std::string& line, const Tuning& tuning) {
  std::istringstream parts(line);
  TuningCandidate candidate;
  parts >> candidate.tuned >> candidate.evaluation;
  parts.ignore();
  for (std::string value; std::getline(parts, value, '\t');) candidate.values.push_back(value);
  const bool is_there = candidate.tuned < tuning.cases.size() &&
                        candidate.evaluation < tuning.budget &&
                        candidate.values.size() == tuning.cases[candidate.tuned].search.size();
  return is_there ? std::optional(std::move(candidate)) : std::nullopt;
}

}  // namespace breakwater
