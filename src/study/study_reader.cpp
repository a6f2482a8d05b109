#include <breakwater/study/study_reader.h>

#include <cmath>
#include <filesystem>
#include <limits>
#include <optional>
#include <stdexcept>

#include <breakwater/config/toml_file.h>
#include <breakwater/config/toml_text.h>
#include <breakwater/study/value_list.h>

namespace breakwater {
namespace {

constexpr std::int64_t kMostSeedsRead = 1'000'000;

// A count where it is one: a key that counts takes no 6.0.
std::string plain_number(double value) {
  const bool is_whole = std::round(value) == value && std::abs(value) < 1e15;
  return is_whole ? fmt::format("{:.0f}", value) : toml_number(value);
}

// What a key is called on the command line: "--on-failure", "--vary: wall.distance_m".
std::string option_of(std::string key) {
  for (const std::string table :
       {"compare.case", "compare.baseline", "compare.metrics", "compare.worlds"}) {
    if (key == table) return "--" + key.substr(8);
  }
  if (key.starts_with("compare.goal.")) return "--goal: " + key.substr(13);
  for (const std::string table : {"vary.", "compare.", "set."}) {
    if (key.starts_with(table)) {
      return "--" + table.substr(0, table.size() - 1) + ": " + key.substr(table.size());
    }
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

std::string toml_text(const toml::node& node) {
  if (const auto* real = node.as_floating_point()) return toml_number(real->get());
  if (const auto* string = node.as_string()) return toml_string(string->get());
  if (const auto* array = node.as_array()) {
    std::vector<std::string> parts;
    for (const toml::node& element : *array) parts.push_back(toml_text(element));
    return fmt::format("[{}]", fmt::join(parts, ", "));
  }
  if (const auto* integer = node.as_integer()) return fmt::format("{}", integer->get());
  return node.as_boolean()->get() ? "true" : "false";
}

std::string toml_text(const std::vector<std::string>& texts) {
  std::vector<std::string> all;
  for (const std::string& text : texts) all.push_back(toml_string(text));
  return fmt::format("[{}]", fmt::join(all, ", "));
}

std::string StudyReader::place(const toml::node& node, const std::string& key) const {
  return node.source().path ? at_line(file_, node.source()) + ": " + key : option_of(key);
}

void StudyReader::fail(const toml::node& node, const std::string& key,
                       const std::string& reason) const {
  throw std::invalid_argument(place(node, key) + ": " + reason);
}

void StudyReader::allow(const toml::table& table, const std::string& prefix,
                        const std::vector<std::string>& keys) const {
  for (const auto& [key, node] : table) {
    const std::string name(key.str());
    if (std::find(keys.begin(), keys.end(), name) != keys.end()) continue;
    fail(node, prefix + name, "unknown key" + did_you_mean(name, keys));
  }
}

const toml::table* StudyReader::table(const toml::table& from, const std::string& key) const {
  const toml::node* node = from.get(key);
  if (node == nullptr) return nullptr;
  if (!node->is_table()) fail(*node, key, "must be a table");
  return node->as_table();
}

std::string StudyReader::text(const toml::node& node, const std::string& key) const {
  if (!node.is_string() || node.as_string()->get().empty()) fail(node, key, "must be a text");
  return node.as_string()->get();
}

std::string StudyReader::text_or_nothing(const toml::table& from, const std::string& key,
                                         const std::string& prefix) const {
  const toml::node* node = from.get(key);
  return node == nullptr ? "" : text(*node, prefix + key);
}

std::vector<std::string> StudyReader::texts(const toml::node& node, const std::string& key) const {
  const toml::array* array = node.as_array();
  if (array == nullptr) return {text(node, key)};
  if (array->empty()) fail(node, key, "is empty");
  std::vector<std::string> all;
  for (const toml::node& element : *array) {
    all.push_back(text(element, key));
    if (std::count(all.begin(), all.end(), all.back()) > 1) {
      fail(node, key, all.back() + " is there twice");
    }
  }
  return all;
}

std::int64_t StudyReader::whole(const toml::node& node, const std::string& key, std::int64_t lower,
                                std::int64_t upper) const {
  const auto* integer = node.as_integer();
  if (integer == nullptr || integer->get() < lower || integer->get() > upper) {
    fail(node, key, fmt::format("must be a whole number of {} to {}", lower, upper));
  }
  return integer->get();
}

double StudyReader::number(const toml::node& node, const std::string& key) const {
  const auto number = node.is_number() ? node.value<double>() : std::nullopt;
  if (!number || !std::isfinite(*number)) fail(node, key, "must be a number");
  return *number;
}

std::vector<std::uint64_t> StudyReader::seeds(const toml::node& node,
                                              const std::string& key) const {
  std::vector<std::uint64_t> all;
  if (const toml::table* range = node.as_table()) {
    allow(*range, key + ".", {"first", "count"});
    const toml::node* count = range->get("count");
    if (count == nullptr) fail(node, key + ".count", "is missing");
    const toml::node* first_node = range->get("first");
    const std::int64_t first =
        first_node == nullptr ? 1 : whole(*first_node, key + ".first", 0, std::int64_t{1} << 62);
    const std::int64_t seeds = whole(*count, key + ".count", 1, kMostSeedsRead);
    for (std::int64_t i = 0; i < seeds; ++i) all.push_back(static_cast<std::uint64_t>(first + i));
    return all;
  }
  if (!node.is_array() || node.as_array()->empty()) {
    fail(node, key, "must be { first = 1, count = 20 } or an array of numbers");
  }
  for (const toml::node& seed : *node.as_array()) {
    all.push_back(
        static_cast<std::uint64_t>(whole(seed, key, 0, std::numeric_limits<std::int64_t>::max())));
  }
  const std::set<std::uint64_t> different(all.begin(), all.end());
  if (different.size() < all.size()) fail(node, key, "one is there twice");
  return all;
}

std::vector<std::string> StudyReader::sets(const toml::table& table,
                                           const std::string& name) const {
  std::vector<std::string> all;
  read_sets(table, name, "", all);
  return all;
}

void StudyReader::read_sets(const toml::table& table, const std::string& name,
                            const std::string& prefix, std::vector<std::string>& sets) const {
  for (const auto& [key, node] : table) {
    const std::string path = prefix + std::string(key.str());
    if (const toml::table* nested = node.as_table()) {
      read_sets(*nested, name, path + ".", sets);
      continue;
    }
    const bool is_value =
        node.is_string() || node.is_number() || node.is_boolean() || node.is_array();
    if (!is_value) fail(node, name + "." + path, "must be a value");
    sets.push_back(path + "=" + toml_text(node));
  }
}

std::vector<VariedKey> StudyReader::varied(const toml::table& table, const std::string& name,
                                           const std::set<std::string>& but) const {
  std::vector<std::pair<toml::source_position, VariedKey>> found;
  collect(table, name, "", but, found);
  std::stable_sort(found.begin(), found.end(), [](const auto& a, const auto& b) {
    return std::pair(a.first.line, a.first.column) < std::pair(b.first.line, b.first.column);
  });
  std::vector<VariedKey> keys;
  for (auto& [place, key] : found) {
    for (const VariedKey& other : keys) {
      if (other.key == key.key) throw std::invalid_argument(key.place + ": is given twice");
    }
    keys.push_back(std::move(key));
  }
  return keys;
}

void StudyReader::collect(const toml::table& table, const std::string& name,
                          const std::string& prefix, const std::set<std::string>& but,
                          std::vector<std::pair<toml::source_position, VariedKey>>& found) const {
  for (const auto& [key, node] : table) {
    const std::string path = prefix + std::string(key.str());
    if (prefix.empty() && but.contains(path)) continue;
    const toml::table* nested = node.as_table();
    if (nested != nullptr && !is_distribution(*nested)) {
      refuse_misspelt(*nested, name + "." + path);
      if (nested->empty()) fail(node, name + "." + path, "is empty");
      collect(*nested, name, path + ".", but, found);
      continue;
    }
    found.emplace_back(key.source().begin, varied_key(node, name, path));
  }
}

void StudyReader::refuse_misspelt(const toml::table& table, const std::string& key) const {
  const bool is_like_one = table.is_inline() && table.size() == 1 &&
                           table.begin()->second.is_array() &&
                           table.begin()->second.as_array()->size() == 2;
  if (!is_like_one) return;
  const std::string name(table.begin()->first.str());
  const std::string meant = did_you_mean(name, names_of(distributions()));
  if (!meant.empty()) fail(table, key, "there is no distribution " + name + meant);
}

VariedKey StudyReader::varied_key(const toml::node& node, const std::string& table,
                                  const std::string& path) const {
  VariedKey key;
  key.key = path;
  key.place = place(node, table + "." + path);
  const auto blame = [&](const auto& body) {
    try {
      body();
    } catch (const std::invalid_argument& error) {
      throw std::invalid_argument(key.place + ": " + error.what());
    }
  };
  if (const toml::table* distribution = node.as_table()) {
    blame([&] { read_distribution(*distribution, key); });
    return key;
  }
  if (const auto* rule = node.as_string(); rule != nullptr && is_value_list(rule->get())) {
    blame([&] {
      for (const double value : value_list(rule->get())) key.values.push_back(plain_number(value));
    });
  } else if (const toml::array* values = node.as_array()) {
    for (const toml::node& value : *values) {
      if (value.is_table() || value.is_date() || value.is_time() || value.is_date_time()) {
        fail(node, table + "." + path, "values are numbers, texts, true, false or arrays");
      }
      key.values.push_back(toml_text(value));
    }
  } else {
    fail(node, table + "." + path,
         "must be an array of values, \"lin(a,b,n)\", \"log(a,b,n)\", { uniform = [a, b] }, "
         "{ log_uniform = [a, b] } or { normal = [m, s] }");
  }
  if (key.values.empty()) fail(node, table + "." + path, "has no values");
  key.written = fmt::format("[{}]", fmt::join(key.values, ", "));
  return key;
}

}  // namespace breakwater
