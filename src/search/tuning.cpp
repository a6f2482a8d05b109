#include <breakwater/search/tuning.h>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include <breakwater/config/toml_text.h>
#include <breakwater/statistics/bootstrap.h>
#include <breakwater/statistics/quantile.h>
#include <breakwater/study/study_reader.h>

namespace breakwater {
namespace {

constexpr std::int64_t kMostEvaluations = 1'000'000;
constexpr std::int64_t kUsuallyValidated = 20;
constexpr double kNine = 0.9;  // of ten runs

Goal read_goal(const StudyReader& reader, const toml::table& from, const std::string& key) {
  const toml::node* node = from.get("goal");
  if (node == nullptr) reader.fail(from, key + ".goal", "is missing: min or max");
  return reader.choice(*node, key + ".goal", goal_names());
}

const toml::table& metric_table(const StudyReader& reader, const toml::node& node,
                                const std::string& key, const char* example) {
  if (!node.is_table()) reader.fail(node, key, fmt::format("must be a table: {}", example));
  return *node.as_table();
}

// The entries of a table in the file's order.
std::vector<std::pair<std::string, const toml::node*>> in_order(const toml::table& table) {
  std::vector<std::pair<std::string, const toml::node*>> entries;
  for (const auto& [key, node] : table) entries.emplace_back(key.str(), &node);
  std::stable_sort(entries.begin(), entries.end(), [](const auto& a, const auto& b) {
    const auto place = [](const toml::node* node) {
      return std::pair(node->source().begin.line, node->source().begin.column);
    };
    return place(a.second) < place(b.second);
  });
  return entries;
}

std::vector<Objective> read_objectives(const StudyReader& reader, const toml::table& tables) {
  const toml::table* table = reader.table(tables, "objective");
  if (table == nullptr || table->empty()) {
    throw std::invalid_argument(reader.file() + ": objective: names no metric");
  }
  std::vector<Objective> objectives;
  for (const auto& [metric, node] : in_order(*table)) {
    const std::string key = "objective." + metric;
    const toml::table& from =
        metric_table(reader, *node, key, "{ goal = \"min\", over = \"median\" }");
    reader.allow(from, key + ".", {"goal", "over", "reference"});
    Objective objective;
    objective.metric = metric;
    objective.place = reader.place(*node, key);
    objective.goal = read_goal(reader, from, key);
    reader.choice(from, "over", over_names(), objective.over);
    if (const toml::node* reference = from.get("reference")) {
      objective.reference = reader.number(*reference, key + ".reference");
    }
    objectives.push_back(std::move(objective));
  }
  return objectives;
}

std::vector<Constraint> read_constraints(const StudyReader& reader, const toml::table& tables) {
  std::vector<Constraint> constraints;
  const toml::table* table = reader.table(tables, "constraint");
  if (table == nullptr) return constraints;
  for (const auto& [metric, node] : in_order(*table)) {
    const std::string key = "constraint." + metric;
    const toml::table& from = metric_table(reader, *node, key, "{ max = 1, over = \"worst\" }");
    reader.allow(from, key + ".", {"min", "max", "over"});
    Constraint constraint;
    constraint.metric = metric;
    constraint.place = reader.place(*node, key);
    const toml::node* min = from.get("min");
    const toml::node* max = from.get("max");
    if ((min == nullptr) == (max == nullptr)) reader.fail(*node, key, "must have min or max");
    if (min != nullptr) constraint.min = reader.number(*min, key + ".min");
    if (max != nullptr) constraint.max = reader.number(*max, key + ".max");
    reader.choice(from, "over", over_names(), constraint.over);
    constraints.push_back(std::move(constraint));
  }
  return constraints;
}

std::vector<VariedKey> read_searched(const StudyReader& reader, const toml::table& table,
                                     const std::string& name) {
  std::vector<VariedKey> keys = reader.varied(table, name);
  for (const VariedKey& key : keys) {
    if (key.distribution && !key.distribution->is_bounded()) {
      throw std::invalid_argument(key.place +
                                  ": a search needs ends: uniform, log_uniform or values");
    }
    if (key.key == "run.seed") throw std::invalid_argument(key.place + ": say seeds instead");
  }
  return keys;
}

const std::vector<std::pair<std::string, WorldMethod>>& world_methods() {
  static const std::vector<std::pair<std::string, WorldMethod>> names = {
      {"grid", WorldMethod::grid}, {"list", WorldMethod::list}};
  return names;
}

std::vector<VariedKey> read_world(const StudyReader& reader, const toml::table& table,
                                  const std::string& name, WorldMethod method) {
  std::vector<VariedKey> keys = reader.varied(table, name);
  for (const VariedKey& key : keys) {
    if (key.distribution) {
      throw std::invalid_argument(key.place + ": a world has values: an array, lin() or log()");
    }
    if (method == WorldMethod::list && key.values.size() != keys.front().values.size()) {
      throw std::invalid_argument(
          fmt::format("{}: has {} values, {} has {}: in a list all have as "
                      "many",
                      key.place, key.values.size(), keys.front().key, keys.front().values.size()));
    }
  }
  return keys;
}

void read_cases(const StudyReader& reader, const toml::table& tables, Tuning& tuning) {
  std::vector<VariedKey> common;
  if (const toml::table* search = reader.table(tables, "search")) {
    common = read_searched(reader, *search, "search");
  }
  const toml::table* each = reader.table(tables, "for_each");
  const toml::node* one = tables.get("case");
  if (each != nullptr && one != nullptr) {
    reader.fail(*one, "case", "stands beside for_each: leave one of them out");
  }
  if (each != nullptr) {
    tuning.is_for_each = true;
    if (each->empty()) reader.fail(*each, "for_each", "names no case");
    for (const auto& [name, node] : in_order(*each)) {
      const std::string key = "for_each." + name;
      const toml::table& own = metric_table(reader, *node, key, "of keys that are searched");
      TunedCase tuned{name, reader.place(*node, key), common};
      for (VariedKey& searched : read_searched(reader, own, key)) {
        tuned.search.push_back(std::move(searched));
      }
      tuning.cases.push_back(std::move(tuned));
    }
  } else {
    TunedCase tuned{.search = common};
    if (one != nullptr) {
      tuned.name = reader.text(*one, "case");
      tuned.place = reader.place(*one, "case");
    }
    tuning.cases.push_back(std::move(tuned));
  }
  for (const TunedCase& tuned : tuning.cases) {
    if (tuned.search.empty()) {
      throw std::invalid_argument(reader.file() + ": search: names no key" +
                                  (tuned.name.empty() ? "" : " for " + tuned.name));
    }
    for (std::size_t i = 0; i < tuned.search.size(); ++i) {
      for (std::size_t k = 0; k < i; ++k) {
        if (tuned.search[i].key == tuned.search[k].key) {
          throw std::invalid_argument(tuned.search[i].place + ": is given twice");
        }
      }
    }
  }
}

void read_validation(const StudyReader& reader, const toml::table& tables, Tuning& tuning) {
  const toml::table* table = reader.table(tables, "validate");
  if (table == nullptr) return;
  reader.allow(*table, "validate.", {"seeds", "world", "points"});
  Worlds worlds = tuning.worlds;
  if (const toml::node* seeds = table->get("seeds")) {
    worlds.seeds = reader.seeds(*seeds, "validate.seeds");
  }
  if (const toml::node* world = table->get("world")) {
    if (!world->is_table()) reader.fail(*world, "validate.world", "must be a table");
    worlds.keys = read_world(reader, *world->as_table(), "validate.world", worlds.method);
  }
  if (!table->contains("seeds") && !table->contains("world")) {
    reader.fail(*table, "validate", "needs seeds or a world that the tuning does not have");
  }
  for (std::size_t i = 0; i < worlds.size(); ++i) {
    for (std::size_t k = 0; k < tuning.worlds.size(); ++k) {
      if (worlds.sets(i) == tuning.worlds.sets(k)) {
        reader.fail(*table, "validate", "has a world that the tuning has too");
      }
    }
  }
  tuning.validation = std::move(worlds);
  const toml::node* points = table->get("points");
  tuning.validated_points = static_cast<std::size_t>(
      points == nullptr ? kUsuallyValidated
                        : reader.whole(*points, "validate.points", 1, kMostEvaluations));
}

void check_fits(const StudyReader& reader, const toml::table& tables, const Tuning& tuning) {
  for (const TunedCase& tuned : tuning.cases) {
    const std::string reason = objection(tuning.settings(tuned));
    if (reason.empty()) continue;
    const char* key = reason.find("budget") != std::string::npos       ? "budget"
                      : reason.find("population") != std::string::npos ? "population"
                                                                       : "algorithm";
    const toml::node* node = tables.get(key);
    if (node == nullptr) node = tables.get("budget");
    reader.fail(*node, key, reason);
  }
  const auto is_searched = [](const TunedCase& tuned, const VariedKey& key) {
    return std::any_of(tuned.search.begin(), tuned.search.end(),
                       [&](const VariedKey& other) { return other.key == key.key; });
  };
  for (const TunedCase& tuned : tuning.cases) {
    for (const VariedKey& key : tuned.search) {
      if (key.is_in(tuning.sets)) {
        throw std::invalid_argument(key.place + ": is set and searched");
      }
    }
    for (const Worlds* worlds :
         {&tuning.worlds, tuning.validation ? &*tuning.validation : nullptr}) {
      if (worlds == nullptr) continue;
      for (const VariedKey& key : worlds->keys) {
        if (is_searched(tuned, key)) throw std::invalid_argument(key.place + ": is searched too");
        if (key.is_in(tuning.sets)) {
          throw std::invalid_argument(key.place + ": is set and varied");
        }
      }
    }
  }
}

std::string print_seeds(const std::vector<std::uint64_t>& seeds) {
  return fmt::format("seeds = [{}]\n", fmt::join(seeds, ", "));
}

std::string print_keys(const std::vector<VariedKey>& keys) {
  std::string text;
  for (const VariedKey& key : keys) {
    text += fmt::format("{} = {}\n", toml_string(key.key), key.written);
  }
  return text;
}

}  // namespace

const std::vector<std::pair<std::string, Over>>& over_names() {
  static const std::vector<std::pair<std::string, Over>> names = {
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

std::size_t Worlds::size() const {
  std::size_t count = std::max<std::size_t>(1, seeds.size());
  if (method == WorldMethod::list) return keys.empty() ? count : count * keys[0].values.size();
  for (const VariedKey& key : keys) count *= key.values.size();
  return count;
}

std::vector<std::string> Worlds::values(std::size_t i) const {
  const std::size_t count = std::max<std::size_t>(1, seeds.size());
  std::vector<std::string> all(keys.size() + 1);
  all[0] = seeds.empty() ? "" : std::to_string(seeds[i % count]);
  i /= count;
  for (std::size_t k = keys.size(); k-- > 0;) {
    all[k + 1] = keys[k].values[i % keys[k].values.size()];
    if (method == WorldMethod::grid) i /= keys[k].values.size();
  }
  return all;
}

std::vector<std::string> Worlds::sets(std::size_t i) const {
  const std::vector<std::string> all = values(i);
  std::vector<std::string> sets;
  for (std::size_t k = 0; k < keys.size(); ++k) sets.push_back(keys[k].key + "=" + all[k + 1]);
  if (!seeds.empty()) sets.push_back("run.seed=" + all[0]);
  return sets;
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
  const StudyReader reader(file);
  if (const toml::node* vary = tables.get("vary")) {
    reader.fail(*vary, "vary", "is of a sweep: breakwater sweep");
  }
  reader.allow(tables, "",
               {"scenario", "config", "case", "for_each", "set", "algorithm", "budget",
                "population", "sampling_seed", "seeds", "search", "worlds", "world", "objective",
                "constraint", "validate", "slurm", "made_by"});
  Tuning tuning;
  const toml::node* scenario = tables.get("scenario");
  if (scenario == nullptr) throw std::invalid_argument(file + ": scenario: is missing");
  tuning.scenario = reader.text(*scenario, "scenario");
  tuning.config = reader.text_or_nothing(tables, "config");
  if (const toml::table* set = reader.table(tables, "set")) tuning.sets = reader.sets(*set, "set");
  reader.choice(tables, "algorithm", search_algorithms(), tuning.algorithm);
  const toml::node* budget = tables.get("budget");
  if (budget == nullptr) throw std::invalid_argument(file + ": budget: is missing");
  tuning.budget = static_cast<std::size_t>(reader.whole(*budget, "budget", 1, kMostEvaluations));
  tuning.population = usual_population(tuning.algorithm);
  if (const toml::node* node = tables.get("population")) {
    tuning.population =
        static_cast<std::size_t>(reader.whole(*node, "population", 1, kMostEvaluations));
  }
  if (const toml::node* node = tables.get("sampling_seed")) {
    tuning.sampling_seed = static_cast<std::uint32_t>(
        reader.whole(*node, "sampling_seed", 0, std::numeric_limits<std::uint32_t>::max()));
  }
  if (const toml::node* node = tables.get("seeds")) tuning.worlds.seeds = reader.seeds(*node);
  reader.choice(tables, "worlds", world_methods(), tuning.worlds.method);
  if (const toml::table* world = reader.table(tables, "world")) {
    tuning.worlds.keys = read_world(reader, *world, "world", tuning.worlds.method);
  }
  tuning.objectives = read_objectives(reader, tables);
  tuning.constraints = read_constraints(reader, tables);
  read_cases(reader, tables, tuning);
  read_validation(reader, tables, tuning);
  tuning.slurm = read_slurm(reader, tables);
  check_fits(reader, tables, tuning);
  return tuning;
}

std::string Tuning::print() const {
  const auto over = [](Over rule) { return toml_string(name_of(over_names(), rule)); };
  std::string text = fmt::format("scenario = {}\n", toml_string(scenario));
  if (!config.empty()) text += fmt::format("config = {}\n", toml_string(config));
  if (!is_for_each && !cases.front().name.empty()) {
    text += fmt::format("case = {}\n", toml_string(cases.front().name));
  }
  text += fmt::format("algorithm = {}\nbudget = {}\npopulation = {}\nsampling_seed = {}\n",
                      toml_string(name_of(search_algorithms(), algorithm)), budget, population,
                      sampling_seed);
  if (!worlds.seeds.empty()) text += print_seeds(worlds.seeds);
  if (worlds.method == WorldMethod::list) text += "worlds = \"list\"\n";
  if (!sets.empty()) text += "\n[set]\n";
  for (const std::string& set : sets) {
    const std::size_t equals = set.find('=');
    text += fmt::format("{} = {}\n", toml_string(set.substr(0, equals)), set.substr(equals + 1));
  }
  if (is_for_each) {
    for (const TunedCase& tuned : cases) {
      text += fmt::format("\n[for_each.{}]\n", toml_string(tuned.name)) + print_keys(tuned.search);
    }
  } else {
    text += "\n[search]\n" + print_keys(cases.front().search);
  }
  if (!worlds.keys.empty()) text += "\n[world]\n" + print_keys(worlds.keys);
  text += "\n[objective]\n";
  for (const Objective& one : objectives) {
    text += fmt::format("{} = {{ goal = {}, over = {}{} }}\n", toml_string(one.metric),
                        toml_string(name_of(goal_names(), one.goal)), over(one.over),
                        one.reference ? ", reference = " + toml_number(*one.reference) : "");
  }
  if (!constraints.empty()) text += "\n[constraint]\n";
  for (const Constraint& one : constraints) {
    text += fmt::format("{} = {{ {} = {}, over = {} }}\n", toml_string(one.metric),
                        std::isfinite(one.max) ? "max" : "min",
                        toml_number(std::isfinite(one.max) ? one.max : one.min), over(one.over));
  }
  if (validation) {
    text += fmt::format("\n[validate]\npoints = {}\n", validated_points);
    if (!validation->seeds.empty()) text += print_seeds(validation->seeds);
    if (!validation->keys.empty()) text += "\n[validate.world]\n" + print_keys(validation->keys);
  }
  return text + slurm.print();
}

}  // namespace breakwater
