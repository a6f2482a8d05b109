#include <breakwater/study/study_reader.h>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <limits>
#include <map>
#include <optional>
#include <regex>
#include <stdexcept>
#include <utility>

#include <breakwater/config/config.h>
#include <breakwater/config/toml_file.h>
#include <breakwater/config/toml_text.h>
#include <breakwater/math/functions.h>
#include <breakwater/shell/did_you_mean.h>

namespace breakwater {
namespace {

constexpr double kMostValues = 1e7;
constexpr std::size_t kLongest = 200;  // a regular expression overflows the stack for a long text

// The number of 12 digits next to x, if both differ only by rounding (a few units in the last
// place).
double without_rounding(double x) {
  const double written = *number_in(fmt::format("{:.12g}", x));
  const double rounding = 4.0 * std::numeric_limits<double>::epsilon() * std::abs(x);
  return std::abs(written - x) <= rounding ? written : x;
}

constexpr std::int64_t kMostSeedsRead = 1'000'000;

// A number as TOML. A whole one has no ".0", since keys for counts refuse it.
std::string plain_number(double value) {
  const bool is_whole = std::round(value) == value && std::abs(value) < 1e15;
  return is_whole ? fmt::format("{:.0f}", value) : toml_number(value);
}

// The name of a key on the command line: "--on-failure", "--vary: wall.distance_m".
std::string option_of(std::string key) {
  for (const auto& [table, option] : {std::pair<std::string, std::string>("vary.", "vary: "),
                                      {"set.", "set: "},
                                      {"seeds.", "seeds: "},
                                      {"require.", "require: "},
                                      {"compare.goal.", "goal: "},
                                      {"compare.", ""}}) {
    if (key.starts_with(table)) return "--" + option + key.substr(table.size());
  }
  std::replace(key.begin(), key.end(), '_', '-');
  return "--" + key;
}

bool is_distribution(const toml::table& table) {
  const auto names = names_of(distributions());
  return std::any_of(table.begin(), table.end(), [&](const auto& entry) {
    return std::find(names.begin(), names.end(), std::string(entry.first.str())) != names.end() &&
           entry.second.is_array();
  });
}

void read_distribution(const toml::table& table, VariedKey& key) {
  if (table.size() != 1) throw std::invalid_argument("must be one distribution");
  const auto entry = table.begin();
  const std::string name(entry->first.str());
  const toml::array& numbers = *entry->second.as_array();
  const auto first = numbers.size() == 2 ? numbers[0].value<double>() : std::nullopt;
  const auto second = numbers.size() == 2 ? numbers[1].value<double>() : std::nullopt;
  if (!first || !second) throw std::invalid_argument("must have two numbers");
  for (const auto& [option, kind] : distributions()) {
    if (option != name) continue;
    key.distribution.emplace(kind, *first, *second);
    key.written =
        fmt::format("{{ {} = [{}, {}] }}", option, toml_number(*first), toml_number(*second));
  }
}

// `others` are the keys beside those that are varied.
VariedKey varied_key(const TomlEntry& entry, const std::string& path,
                     const std::set<std::string>& others) {
  VariedKey key;
  key.key = path;
  key.place = entry.place();
  try {
    if (const toml::table* distribution = entry.node()->as_table()) {
      read_distribution(*distribution, key);
      return key;
    }
    if (const auto* rule = entry.node()->as_string();
        rule != nullptr && is_value_list(rule->get())) {
      for (const double value : value_list(rule->get())) key.values.push_back(plain_number(value));
    }
  } catch (const std::invalid_argument& error) {
    entry.fail(error.what());
  }
  if (entry.node()->is_array()) {
    for (const TomlEntry& value : entry.elements()) key.values.push_back(value.written());
    if (key.values.empty()) entry.fail("has no values");
  }
  if (key.values.empty()) {
    const std::string meant = did_you_mean(path, {others.begin(), others.end()});
    if (!meant.empty()) entry.fail("unknown key" + meant);
    entry.fail(
        "must be an array of values, \"lin(a,b,n)\", \"log(a,b,n)\", { uniform = [a, b] }, "
        "{ log_uniform = [a, b] } or { normal = [m, s] }");
  }
  key.written = fmt::format("[{}]", fmt::join(key.values, ", "));
  return key;
}

// Calls `body` with the path of each value in a table and its subtables, except `but`.
template <typename IsValue, typename Body>
void each_value(const TomlEntry& table, const std::string& prefix, const std::set<std::string>& but,
                const IsValue& is_value, const Body& body) {
  for (const auto& [key, entry] : table.entries()) {
    const std::string path = prefix + key;
    if (but.contains(path)) continue;
    // Sets are kept as key=value.
    if (key.empty() || key.find('=') != std::string::npos) entry.fail("is no key");
    const toml::table* nested = entry.node()->as_table();
    if (nested == nullptr || is_value(*nested)) {
      body(path, entry);
    } else if (nested->empty()) {
      entry.fail("is empty");
    } else {
      each_value(entry, path + ".", but, is_value, body);
    }
  }
}

}  // namespace

const Names<DistributionKind>& distributions() {
  static const Names<DistributionKind> names = {{"uniform", DistributionKind::uniform},
                                                {"log_uniform", DistributionKind::log_uniform},
                                                {"normal", DistributionKind::normal}};
  return names;
}

toml::table study_tables(const std::string& file) {
  toml::table tables = parse_toml_file(file);
  if (const auto config = tables["config"].value<std::string>()) {
    const auto beside = std::filesystem::absolute(file).parent_path() / *config;
    if (std::filesystem::exists(beside)) {
      tables.insert_or_assign("config", beside.lexically_normal().string());
    }
  }
  tables.erase("made_by");
  return tables;
}

TomlEntry study_root(const toml::table& tables, const std::string& file) {
  return {tables, file, option_of};
}

std::vector<std::uint64_t> read_seeds(const TomlEntry& seeds) {
  std::vector<std::uint64_t> all;
  if (!seeds) return all;
  if (seeds.node()->is_table()) {
    seeds.allow({"first", "count", "last"});
    const TomlEntry first_entry = seeds["first"];
    const std::int64_t first = first_entry ? first_entry.whole(0, std::int64_t{1} << 62) : 1;
    const TomlEntry last = seeds["last"];
    if (last && seeds["count"]) last.fail("stands beside count: leave one of them out");
    const std::int64_t count = last ? last.whole(first, first + kMostSeedsRead - 1) - first + 1
                                    : seeds["count"].whole(1, kMostSeedsRead);
    for (std::int64_t i = 0; i < count; ++i) all.push_back(static_cast<std::uint64_t>(first + i));
    return all;
  }
  if (!seeds.node()->is_array() || seeds.node()->as_array()->empty()) {
    seeds.fail("must be { first = 1, count = 20 } or an array of numbers");
  }
  for (const TomlEntry& seed : seeds.elements()) {
    all.push_back(
        static_cast<std::uint64_t>(seed.whole(0, std::numeric_limits<std::int64_t>::max())));
  }
  const std::set<std::uint64_t> different(all.begin(), all.end());
  if (different.size() < all.size()) seeds.fail("one is there twice");
  return all;
}

void read_base(const TomlEntry& root, StudyBase& base) {
  base.scenario = root["scenario"].text();
  base.config = root["config"].text_or_nothing();
  for (const char* key : {"scenario", "config"}) base.places[key] = root[key].place();
  std::map<std::string, std::string> sets;
  const auto is_value = [](const toml::table&) { return false; };
  each_value(root["set"], "", {}, is_value, [&](const std::string& key, const TomlEntry& entry) {
    if (!sets.emplace(key, entry.written()).second) entry.fail("is given twice");
    base.places["set." + key] = entry.place();
  });
  for (const auto& [key, value] : sets) base.sets.push_back(key + "=" + value);
}

std::string print_head(const StudyBase& base) {
  return fmt::format("scenario = {}\n", toml_string(base.scenario)) +
         (base.config.empty() ? "" : fmt::format("config = {}\n", toml_string(base.config)));
}

std::string print_seeds(const std::vector<std::uint64_t>& seeds) {
  if (seeds.empty()) return "";
  const bool is_range = seeds.back() - seeds.front() + 1 == seeds.size() &&
                        std::is_sorted(seeds.begin(), seeds.end());
  return is_range
             ? fmt::format("seeds = {{ first = {}, count = {} }}\n", seeds.front(), seeds.size())
             : fmt::format("seeds = [{}]\n", fmt::join(seeds, ", "));
}

std::string print_sets(const StudyBase& base) {
  std::string text = base.sets.empty() ? "" : "\n[set]\n";
  for (const std::string& set : base.sets) {
    const std::size_t equals = set.find('=');
    text += fmt::format("{} = {}\n", toml_string(set.substr(0, equals)), set.substr(equals + 1));
  }
  return text;
}

std::string print_keys(const std::vector<VariedKey>& keys) {
  std::string text;
  for (const VariedKey& key : keys) {
    text += fmt::format("{} = {}\n", toml_string(key.key), key.written);
  }
  return text;
}

void check_seeds(const std::vector<std::string>& sets, const std::vector<std::uint64_t>& seeds,
                 const Places& places) {
  if (seeds.empty() || !is_set(sets, "run.seed")) return;
  throw std::invalid_argument(place_of(places, "set.run.seed") +
                              ": stands beside seeds: leave one of them out");
}

std::vector<VariedKey> read_varied(const TomlEntry& table, const std::set<std::string>& but) {
  std::vector<std::pair<toml::source_position, VariedKey>> found;
  each_value(table, "", but, is_distribution, [&](const std::string& key, const TomlEntry& entry) {
    found.emplace_back(entry.begin(), varied_key(entry, key, but));
  });
  std::ranges::stable_sort(found, [](const auto& a, const auto& b) { return a.first < b.first; });
  std::vector<VariedKey> keys;
  for (auto& [place, key] : found) {
    if (has_key(keys, key)) throw std::invalid_argument(key.place + ": is given twice");
    keys.push_back(std::move(key));
  }
  return keys;
}

bool has_key(const std::vector<VariedKey>& keys, const VariedKey& key) {
  return std::ranges::any_of(keys, [&](const VariedKey& other) { return other.key == key.key; });
}

void check_keys(const std::vector<VariedKey>& keys, const std::vector<std::string>& sets,
                const std::string& what, bool is_list) {
  for (const VariedKey& key : keys) {
    const auto fail = [&](const std::string& reason) {
      throw std::invalid_argument(key.place + ": " + reason);
    };
    if (key.key == "run.seed") fail("say seeds instead");
    if (is_set(sets, key.key)) fail("is set and " + what);
    if (is_list && key.values.size() != keys.front().values.size()) {
      fail(fmt::format("has {} values, and {} has {}: a list needs as many of each",
                       key.values.size(), keys.front().key, keys.front().values.size()));
    }
  }
}

bool is_value_list(const std::string& text) {
  static const std::regex begin(R"(\s*(lin|log)\s*\()");
  return std::regex_search(text.substr(0, kLongest), begin, std::regex_constants::match_continuous);
}

std::vector<double> value_list(const std::string& text) {
  static const std::string number = R"(\s*([^\s,()]+)\s*)";
  static const std::regex rule(R"(\s*(lin|log)\s*\()" + number + "," + number + "," + number +
                               R"(\)\s*)");
  const auto refuse = [&](const std::string& reason) {
    throw std::invalid_argument("\"" + text + "\" " + reason);
  };
  std::smatch parts;
  if (text.size() > kLongest || !std::regex_match(text, parts, rule)) {
    refuse("is neither lin(a,b,n) nor log(a,b,n), n values from a to b");
  }
  const auto a = number_in(parts[2]), b = number_in(parts[3]), n = number_in(parts[4]);
  const bool is_log = parts[1] == "log";
  if (!a || !b || !n) refuse("has something else than three finite numbers");
  if (*n < 2.0 || *n > kMostValues || *n != std::floor(*n)) {
    refuse(fmt::format("must be an integer number of values, 2 to {:.0f}", kMostValues));
  }
  if (*a > *b) refuse(fmt::format("must rise: {} is above {}", *a, *b));
  if (*a == *b) refuse("is empty: both ends are the same");
  if (is_log && *a <= 0.0) refuse("must be positive: it is logarithmic");
  if (!std::isfinite(is_log ? *b / *a : *b - *a)) refuse("is too wide");

  const auto count = static_cast<std::size_t>(*n);
  std::vector<double> values(count);
  for (std::size_t i = 1; i + 1 < count; ++i) {
    const double share = static_cast<double>(i) / (*n - 1.0);
    values[i] = without_rounding(is_log ? *a * math::pow(*b / *a, share) : *a + (*b - *a) * share);
  }
  values.front() = *a + 0.0;  // a file has no integer -0
  values.back() = *b + 0.0;
  return values;
}

}  // namespace breakwater
