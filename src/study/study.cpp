#include <breakwater/study/study.h>

#include <fmt/format.h>

#include <algorithm>
#include <boost/algorithm/string/trim.hpp>
#include <cmath>
#include <set>
#include <stdexcept>

#include <breakwater/config/fields.h>
#include <breakwater/config/toml_file.h>
#include <breakwater/config/toml_text.h>
#include <breakwater/shell/did_you_mean.h>
#include <breakwater/study/study_reader.h>

namespace breakwater {
namespace {

constexpr std::int64_t kMostSamples = 10'000'000;

const Names<Keep>& keeps() {
  static const Names<Keep> names = {
      {"metrics", Keep::metrics}, {"failed", Keep::failed}, {"all", Keep::all}};
  return names;
}

void read_compare(const TomlEntry& root, Study& study) {
  const TomlEntry compare = root["compare"];
  if (const TomlEntry cases = compare["case"]) {
    if (root["case"]) cases.fail("stands beside case: leave one of them out");
    study.cases = cases.texts();
    study.places["case"] = cases.place();
  }
  study.baseline = compare["baseline"].text_or_nothing();
  study.places["compare.baseline"] = compare["baseline"].place();
  study.metrics = compare["metrics"].texts();
  for (const std::string& metric : study.metrics) {
    study.named.push_back({"compare.metrics: " + metric, metric, false});
  }
  for (const auto& [metric, goal] : compare["goal"].entries()) {
    study.goals.emplace_back(metric, goal.choice(goal_names()));
    study.named.push_back({goal.place(), metric});
  }
  compare["worlds"].choice<bool>({{"samples", false}, {"seeds", true}}, study.are_seeds_worlds);
  study.compare = read_varied(compare, {"case", "baseline", "metrics", "goal", "worlds"});
  for (const VariedKey& key : study.compare) {
    if (!key.distribution) continue;
    throw std::invalid_argument(key.place + ": candidates are values");
  }
}

Requirement read_require(const TomlEntry& root, Study& study) {
  Requirement require;
  const TomlEntry table = root["require"];
  if (!table) return require;
  for (const auto& [key, entry] : table.entries()) {
    if (key == "share") {
      require.share = entry.number({0.0, 1.0, false, "above 0 and at most 1"});
      continue;
    }
    if (key == "confidence") {
      require.confidence = entry.number({0.5, 0.9999, true, "from 0.5 to 0.9999"});
      continue;
    }
    entry.allow({"min", "max"});
    Bound bound;
    bound.metric = key;
    bound.min = entry["min"].number_or_nothing().value_or(bound.min);
    bound.max = entry["max"].number_or_nothing().value_or(bound.max);
    if (!entry["min"] && !entry["max"]) entry.fail("has no bound: say min, max or both");
    if (bound.min > bound.max) {
      entry.fail(fmt::format("min {} is above max {}", bound.min, bound.max));
    }
    study.named.push_back({entry.place(), key});
    require.bounds.push_back(std::move(bound));
  }
  if (require.bounds.empty()) table.fail("has no bound of a metric");
  if (study.goals.empty()) table.fail("needs compare.goal: what candidates are ranked by");
  return require;
}

// Checks the study without its scenario.
void check(const TomlEntry& root, const Study& study) {
  const bool is_drawn = draws(study.method);
  if (is_drawn && study.vary.empty()) {
    root["method"].fail("there is nothing to draw: vary a key");
  }
  if (is_drawn && study.samples == 0) {
    root["method"].fail(name_of(methods(), study.method) + " needs samples");
  }
  if (!is_drawn && study.samples != 0) {
    root["samples"].fail("is of the methods that draw: random, lhs, sobol, saltelli");
  }
  for (const VariedKey& key : study.vary) {
    const auto fail = [&](const std::string& reason) {
      throw std::invalid_argument(key.place + ": " + reason);
    };
    if (!is_drawn && key.distribution) {
      fail("a distribution needs a method that draws: random, lhs, sobol or saltelli");
    }
    if (has_key(study.compare, key)) fail("is varied and compared");
    const std::set<std::string> different(key.values.begin(), key.values.end());
    if (study.method != Method::list && different.size() < key.values.size()) {
      fail("a value is there twice");
    }
  }
  check_keys(study.vary, study.sets, "varied", study.method == Method::list);
  check_keys(study.compare, {}, "compared");
}

}  // namespace

const Names<Method>& methods() {
  static const Names<Method> names = {{"grid", Method::grid},     {"list", Method::list},
                                      {"random", Method::random}, {"lhs", Method::latin_hypercube},
                                      {"sobol", Method::sobol},   {"saltelli", Method::saltelli}};
  return names;
}

bool draws(Method method) {
  return method != Method::grid && method != Method::list;
}

bool is_set(const std::vector<std::string>& sets, const std::string& key) {
  return std::any_of(sets.begin(), sets.end(),
                     [&](const std::string& set) { return set.starts_with(key + "="); });
}

double combinations(const std::vector<VariedKey>& keys, bool is_list) {
  double count = 1.0;
  for (const VariedKey& key : keys) {
    count = is_list ? static_cast<double>(key.values.size())
                    : count * static_cast<double>(key.values.size());
  }
  return count;
}

std::vector<std::string> combination(const std::vector<VariedKey>& keys, std::size_t number,
                                     bool is_list) {
  std::vector<std::string> values(keys.size());
  for (std::size_t i = keys.size(); i-- > 0;) {
    const std::size_t count = keys[i].values.size();
    values[i] = keys[i].values[number % count];
    if (!is_list) number /= count;
  }
  return values;
}

std::string value_at(const VariedKey& key, double u) {
  if (key.distribution) return toml_number(key.distribution->quantile(u));
  const auto nth = static_cast<std::size_t>(u * static_cast<double>(key.values.size()));
  return key.values[std::min(nth, key.values.size() - 1)];
}

std::string place_of(const Places& places, const std::string& key) {
  const auto found = places.find(key);
  return found == places.end() ? key : found->second;
}

std::vector<NamedMetric> unknown_metrics(const StudyBase& study,
                                         const std::vector<std::string>& known) {
  std::vector<NamedMetric> unknown;
  for (NamedMetric one : study.named) {
    if (std::find(known.begin(), known.end(), one.name) != known.end()) continue;
    one.meant = (one.is_required ? did_you_mean_or_list : did_you_mean)(one.name, known);
    unknown.push_back(std::move(one));
  }
  return unknown;
}

Study read_study(const toml::table& tables, const std::string& file) {
  const TomlEntry root = study_root(tables, file);
  if (const TomlEntry objective = root["objective"]) {
    objective.fail("is of a tuning: breakwater tune");
  }
  root.allow({"scenario", "config", "case", "set", "method", "samples", "sampling_seed", "seeds",
              "keep", "on_failure", "vary", "compare", "require", "made_by"});
  Study study;
  read_base(root, study);
  study.cases = root["case"].texts();
  study.places["case"] = root["case"].place();
  root["method"].choice(methods(), study.method);
  if (const TomlEntry samples = root["samples"]) {
    study.samples = static_cast<std::size_t>(samples.whole(1, kMostSamples));
  }
  if (const TomlEntry seed = root["sampling_seed"]) {
    study.sampling_seed =
        static_cast<std::uint64_t>(seed.whole(0, std::numeric_limits<std::int64_t>::max()));
  }
  study.seeds = read_seeds(root["seeds"]);
  root["keep"].choice(keeps(), study.keep);
  root["on_failure"].choice<bool>({{"count", false}, {"stop", true}}, study.stops_on_failure);
  study.vary = read_varied(root["vary"]);
  read_compare(root, study);
  study.require = read_require(root, study);
  check_seeds(study.sets, study.seeds, study.places);
  check(root, study);
  return study;
}

std::string Study::print() const {
  std::string text = print_head(*this);
  text += fmt::format("method = {}\n", toml_string(name_of(methods(), method)));
  if (samples > 0) {
    text += fmt::format("samples = {}\nsampling_seed = {}\n", samples, sampling_seed);
  }
  text += print_seeds(seeds);
  text += fmt::format("keep = {}\non_failure = {}\n", toml_string(name_of(keeps(), keep)),
                      toml_string(stops_on_failure ? "stop" : "count"));
  text += print_sets(*this);
  if (!vary.empty()) text += "\n[vary]\n" + print_keys(vary);
  text += "\n[compare]\n";
  if (!cases.empty()) text += fmt::format("case = {}\n", toml_strings(cases));
  if (!baseline.empty()) text += fmt::format("baseline = {}\n", toml_string(baseline));
  if (!metrics.empty()) text += fmt::format("metrics = {}\n", toml_strings(metrics));
  for (const auto& [metric, goal] : goals) {
    text +=
        fmt::format("goal.{} = {}\n", toml_key(metric), toml_string(name_of(goal_names(), goal)));
  }
  if (are_seeds_worlds) text += "worlds = \"seeds\"\n";
  text += print_keys(compare);
  if (!require.bounds.empty()) {
    text += fmt::format("\n[require]\nshare = {}\nconfidence = {}\n", toml_number(require.share),
                        toml_number(require.confidence));
  }
  for (const Bound& bound : require.bounds) {
    std::vector<std::string> ends;
    if (std::isfinite(bound.min)) ends.push_back("min = " + toml_number(bound.min));
    if (std::isfinite(bound.max)) ends.push_back("max = " + toml_number(bound.max));
    text += fmt::format("{} = {{ {} }}\n", toml_key(bound.metric), fmt::join(ends, ", "));
  }
  return text;
}

std::vector<std::string> option_parts(const std::string& text) {
  std::vector<std::string> parts(1);
  int depth = 0;
  char quote = 0;
  bool is_escaped = false;
  for (const char c : text) {
    if (quote != 0) {
      if (c == quote && !is_escaped) quote = 0;
      is_escaped = quote == '"' && c == '\\' && !is_escaped;
    } else if (c == '"' || c == '\'') {
      quote = c;
    } else if (c == '[' || c == '{' || c == '(') {
      ++depth;
    } else if (c == ']' || c == '}' || c == ')') {
      --depth;
    } else if (c == ',' && depth == 0) {
      parts.emplace_back();
      continue;
    }
    parts.back() += c;
  }
  for (std::string& part : parts) boost::trim(part);
  return parts;
}

toml::table option_value(const std::string& option, const std::string& given) {
  const std::string text = boost::trim_copy(given);
  if (is_value_list(text)) return toml::table{{"value", text}};
  for (const auto& [name, kind] : distributions()) {
    if (!text.starts_with(name + "(") || !text.ends_with(")")) continue;
    const std::string inside = text.substr(name.size() + 1, text.size() - name.size() - 2);
    if (auto table = parse_toml_value(fmt::format("{{ {} = [{}] }}", name, inside), option)) {
      return *table;
    }
    throw std::invalid_argument(option + ": " + text + ": must be " + name + "(A,B)");
  }
  toml::array values;
  for (const std::string& part : option_parts(text)) {
    if (part.empty()) throw std::invalid_argument(option + ": " + text + ": a value is missing");
    const auto parsed = parse_toml_value(part, option);
    if (parsed) {
      values.push_back(*parsed->get("value"));
    } else {
      values.push_back(part);  // a word without quotes
    }
  }
  return toml::table{{"value", std::move(values)}};
}

}  // namespace breakwater
