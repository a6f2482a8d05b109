#include <breakwater/config/config.h>

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <charconv>
#include <filesystem>
#include <limits>
#include <set>
#include <stdexcept>

#include <breakwater/config/names.h>
#include <breakwater/config/toml_entry.h>
#include <breakwater/config/toml_file.h>
#include <breakwater/config/toml_text.h>
#include <breakwater/shell/did_you_mean.h>
#include <breakwater/shell/paths.h>
#include <breakwater/signals/input_file.h>

namespace breakwater {
namespace {

constexpr std::size_t kLongestWord = 200;  // longest key or name that is accepted
constexpr std::size_t kLongestShown = 40;

using Entries = std::map<std::string, ConfigEntry>;

std::string text_of(const ConfigValue& value, bool is_toml) {
  if (const auto* yes = std::get_if<bool>(&value.data)) return *yes ? "true" : "false";
  if (const auto* count = std::get_if<std::int64_t>(&value.data)) return std::to_string(*count);
  if (const auto* number = std::get_if<double>(&value.data)) {
    return is_toml ? toml_number(*number) : fmt::format("{}", *number + 0.0);
  }
  if (const auto* text = std::get_if<std::string>(&value.data)) {
    return is_toml ? toml_string(*text) : *text;
  }
  std::vector<std::string> all;
  for (const ConfigValue& one : std::get<ConfigValue::Array>(value.data)) {
    all.push_back(text_of(one, is_toml));
  }
  return fmt::format("[{}]", fmt::join(all, ", "));
}

// Returns the element that `key` of --set names. `value` is the value of the whole key.
ConfigValue& element_of(ConfigValue& value, const std::string& key) {
  const auto refuse = [&](const std::string& reason) {
    throw std::invalid_argument("--set: " + key + ": " + reason);
  };
  ConfigValue* found = &value;
  std::size_t at = whole_key(key).size();
  while (at < key.size()) {
    const std::string of = key.substr(0, at);
    const std::size_t end = key.find(']', at);
    std::size_t number = 0;
    if (end != std::string::npos && key[at] == '[') {
      std::from_chars(key.data() + at + 1, key.data() + end, number);
    }
    if (number == 0 || key.substr(at, end + 1 - at) != fmt::format("[{}]", number)) {
      refuse("elements are counted from 1: " + of + "[1] is the first");
    }
    auto* array = std::get_if<ConfigValue::Array>(&found->data);
    if (array == nullptr) refuse(of + " is no array");
    if (number > array->size()) {
      refuse(fmt::format("{} has {} element{}", of, array->size(), array->size() == 1 ? "" : "s"));
    }
    found = &(*array)[number - 1];
    at = end + 1;
  }
  return *found;
}

// Refuses an array beside one of its elements: their order would decide which one counts.
void check_elements(const std::vector<std::string>& sets) {
  std::vector<std::string> keys;
  for (const std::string& assignment : sets) {
    keys.push_back(assignment.substr(0, assignment.find('=')));
    for (const std::string& other : keys) {
      if (!is_element_of(keys.back(), other) && !is_element_of(other, keys.back())) continue;
      throw std::invalid_argument("--set: " + keys.back() + ": " + other +
                                  " is given too: give the array, or elements of it");
    }
  }
}

bool is_key_character(char c) {
  return std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '_' || c == '-' || c == '.';
}

// The beginning of a user's word, short enough for one line of a message.
std::string shown(const std::string& word) {
  std::string text = word.substr(0, kLongestShown);
  std::replace_if(
      text.begin(), text.end(), [](unsigned char c) { return std::iscntrl(c) != 0; }, '?');
  return word.size() > kLongestShown ? text + "..." : text;
}

// Folders have the names of cases and readings.
void check_name(const std::string& name, const TomlEntry& named, const std::string& what) {
  const auto refuse = [&](const std::string& why) {
    throw std::invalid_argument(at_line(named.file(), named.node()->source()) + ": " + what + "." +
                                shown(name) + ": " + why);
  };
  const bool fits =
      !name.empty() && name.size() <= kLongestWord && name != "." && name != ".." &&
      std::all_of(name.begin(), name.end(), [](char c) { return is_key_character(c) || c == '+'; });
  if (!fits) {
    refuse("a name is made of A-Z, a-z, 0-9, '.', '_', '+' and '-', and is not '.' or '..'");
  }
  if (name == "all") refuse("means all of them");
  if (!named.node()->is_table()) refuse("must be a table");
}

// Tables become dotted keys; everything else is a value.
void flatten(const toml::table& table, const std::string& file, const std::string& prefix,
             Entries& entries) {
  for (const auto& [key, node] : table) {
    const std::string path = prefix + std::string(key.str());
    const bool is_text = std::none_of(path.begin(), path.end(),
                                      [](unsigned char c) { return std::iscntrl(c) != 0; });
    if (path.size() > kLongestWord || !is_text) {
      throw std::invalid_argument(at_line(file, key.source()) + ": " + shown(path) + ": is no key");
    }
    if (const auto* nested = node.as_table()) {
      // [axis], and such as [push.NAME]: the name alone makes nothing.
      if (nested->empty() && (!prefix.empty() || path == "axis")) {
        throw std::invalid_argument(at_line(file, key.source()) + ": " + path +
                                    ": the table is empty");
      }
      flatten(*nested, file, path + ".", entries);
    } else {
      const std::string origin = at_line(file, node.source()), place = origin + ": " + path;
      // "a.b" in quotes and b in [a] are the same key here.
      if (!entries.emplace(path, ConfigEntry{config_value(node, place), origin}).second) {
        throw std::invalid_argument(place + ": is given twice");
      }
    }
  }
}

// The names of the tables [WHAT.NAME] in the file's order, and their keys.
std::vector<std::string> read_named(const TomlEntry& root, const std::string& what,
                                    std::map<std::string, Entries>& named) {
  std::vector<std::string> names;
  for (const auto& [name, entry] : root[what].entries()) {
    check_name(name, entry, what);
    flatten(*entry.node()->as_table(), root.file(), "", named[name]);
    names.push_back(name);
  }
  return names;
}

// The table [alias]: "NAME" = "KEY".
Aliases read_aliases(const TomlEntry& alias) {
  Entries named;
  if (alias.node()->is_table()) flatten(*alias.node()->as_table(), alias.file(), "", named);
  if (named.empty()) alias.fail("must be a table with \"NAME\" = \"KEY\"");
  Aliases aliases;
  for (const auto& [name, entry] : named) {
    const auto* key = std::get_if<std::string>(&entry.value.data);
    if (name.empty() || key == nullptr || *key == name) {
      throw std::invalid_argument(entry.origin + ": alias." + name + ": must be another key");
    }
    if (named.contains(*key)) {
      throw std::invalid_argument(entry.origin + ": alias." + name + ": " + *key +
                                  " is another name itself: give the key");
    }
    aliases[name] = *key;
  }
  return aliases;
}

}  // namespace

ConfigValue config_value(const toml::node& node, const std::string& place) {
  if (const auto* value = node.as_boolean()) return {value->get()};
  if (const auto* value = node.as_integer()) return {value->get()};
  if (const auto* value = node.as_floating_point()) return {value->get() + 0.0};  // -0 is 0
  if (const auto* value = node.as_string()) return {value->get()};
  const std::string kinds = "a number, a text, true, false or an array of these";
  if (!node.is_array()) throw std::invalid_argument(place + ": must be " + kinds);
  ConfigValue::Array values;
  for (const auto& element : *node.as_array()) values.push_back(config_value(element, place));
  return {std::move(values)};
}

std::string toml_value(const ConfigValue& value) {
  return text_of(value, true);
}

std::string short_value(const ConfigValue& value) {
  return text_of(value, false);
}

std::string table_of(const std::string& key) {
  const std::size_t dot = key.rfind('.');
  return dot == std::string::npos ? "" : key.substr(0, dot);
}

std::string whole_key(const std::string& key) {
  return key.substr(0, key.find('['));
}

bool is_element_of(const std::string& key, const std::string& other) {
  return key.size() > other.size() && key.starts_with(other) && key[other.size()] == '[';
}

void Config::set(const std::string& assignment) {
  const std::size_t equals = assignment.find('=');
  if (equals == std::string::npos || equals == 0 || equals + 1 == assignment.size()) {
    throw std::invalid_argument("--set: " + assignment + ": must be of the form key.path=value");
  }
  const std::string key = assignment.substr(0, equals);
  const std::string whole = whole_key(key);
  if (key.size() > kLongestWord || whole.empty() || !std::ranges::all_of(whole, is_key_character)) {
    throw std::invalid_argument("--set: " + shown(key) + ": is no key");
  }
  const std::string text = assignment.substr(equals + 1);
  const std::string origin = "--set: " + key;
  const auto parsed = parse_toml_value(text, origin);
  if (!parsed && !parse_toml_value(toml_string(text), origin)) {
    throw std::invalid_argument(origin + ": " + shown(text) + ": is not UTF-8");
  }
  // Text that is not TOML is a bare word. read() checks later whether the key takes a string.
  ConfigValue value = parsed ? config_value(*parsed->get("value"), origin) : ConfigValue{text};
  if (whole != key) {
    const ConfigEntry* array = find(whole);
    if (array == nullptr) {
      throw std::invalid_argument(origin + ": " + file_ + " has no " + shown(whole) +
                                  did_you_mean(whole, names_of(*entries_)));
    }
    ConfigValue changed = array->value;
    element_of(changed, key) = std::move(value);
    value = std::move(changed);
  }
  own_entries()[whole] = {std::move(value), kSetOrigin, true};
}

void Config::apply(const Entries& overrides) {
  Entries& entries = own_entries();
  for (const auto& [key, entry] : overrides) entries[key] = entry;
}

Config Config::under(const std::string& prefix) const {
  Config inner = *this;
  inner.prefix_ += prefix;
  return inner;
}

const ConfigEntry* Config::find(const std::string& key) const {
  const auto found = prefix_.empty() ? entries_->find(key) : entries_->find(prefix_ + key);
  return found != entries_->end() ? &found->second : nullptr;
}

std::size_t ConfigEntry::line() const {
  std::size_t number = std::numeric_limits<std::size_t>::max();
  const char* const text_end = origin.data() + origin.size();
  std::from_chars(origin.data() + (origin.rfind(':') + 1), text_end, number);
  return number;
}

std::vector<std::string> Config::names_in(const std::string& table) const {
  std::set<std::pair<std::size_t, std::string>> by_line;
  for (const auto& [key, entry] : *entries_) {
    const std::size_t end = key.find('.', table.size() + 1);
    if (!key.starts_with(table + ".") || end == std::string::npos) continue;
    const std::string name = key.substr(table.size() + 1, end - table.size() - 1);
    const bool is_plain = std::all_of(
        name.begin(), name.end(), [](unsigned char c) { return std::isalnum(c) != 0 || c == '_'; });
    if (name.empty() || !is_plain) {
      throw std::invalid_argument(entry.origin + ": " + table + "." + shown(name) +
                                  ": a name here is made of A-Z, a-z, 0-9 and '_'");
    }
    by_line.emplace(entry.line(), name);
  }
  std::vector<std::string> names;
  for (const auto& [line, name] : by_line) {
    if (std::ranges::find(names, name) == names.end()) names.push_back(name);
  }
  return names;
}

std::optional<std::string> Config::text(const std::string& key) const {
  const ConfigEntry* entry = find(key);
  const auto* text = entry != nullptr ? std::get_if<std::string>(&entry->value.data) : nullptr;
  return text != nullptr ? std::optional(*text) : std::nullopt;
}

std::optional<double> Config::number(const std::string& key) const {
  const ConfigEntry* entry = find(key);
  if (entry == nullptr) return std::nullopt;
  if (const auto* integer = std::get_if<std::int64_t>(&entry->value.data)) {
    return static_cast<double>(*integer);
  }
  if (const auto* real = std::get_if<double>(&entry->value.data)) return *real;
  return std::nullopt;
}

std::string Config::find_file_of(const std::string& key, const std::string& name) const {
  const ConfigEntry* entry = find(key);
  const bool is_set = entry != nullptr && entry->is_set();
  const std::filesystem::path folder =
      is_set ? std::filesystem::path() : std::filesystem::path(file_).parent_path();
  const auto file = find_file(name, folder);
  if (!file) {
    const std::string place = folder.empty() ? "the working folder" : folder.string();
    fail(key, "there is no file " + name + " in " + place + " or any of " + searched_places());
  }
  const std::string reason = why_unreadable(*file);
  if (!reason.empty()) fail(key, name + ": cannot be read (" + reason + ")");
  return file->string();
}

std::string Config::origin_of(const std::string& key) const {
  if (const ConfigEntry* entry = find(key)) return entry->origin;
  // A table [TABLE.NAME] may come from --set alone.
  const std::string path = prefix_ + key;
  const std::string named = path.substr(0, path.find('.', path.find('.') + 1)) + ".";
  bool is_from_set = false;
  for (const auto& [other, entry] : *entries_) {
    if (!other.starts_with(named)) continue;
    if (!entry.is_set()) return file_;
    is_from_set = true;
  }
  return is_from_set ? kSetOrigin : file_;
}

void Config::fail(const std::string& key, const std::string& message) const {
  const std::string whole = whole_key(key);
  const ConfigEntry* entry = find(whole);
  const bool is_other = entry != nullptr && !entry->given.empty();
  const std::string written = is_other ? entry->given + key.substr(whole.size()) : prefix_ + key;
  throw std::invalid_argument(origin_of(whole) + ": " + written + ": " + message);
}

ScenarioFile::ScenarioFile(const std::string& file, const std::string& scenario) : file_(file) {
  toml::table table = parse_toml_file(file, &text_);
  const TomlEntry root(table, file);
  if (const TomlEntry name = root["scenario"]; name.text() != scenario) {
    name.fail("is \"" + shown(name.text()) + "\", not \"" + scenario + "\"");
  }
  cases_ = read_named(root, "case", overrides_);
  const TomlEntry default_case = root["default_case"];
  default_case_ = cases_.size() == 1 && !default_case ? cases_.front() : default_case.text();
  if (!overrides_.contains(default_case_)) {
    default_case.fail("there is no [case." + default_case_ + "]" +
                      did_you_mean(default_case_, cases_));
  }
  for (auto& [case_name, keys] : overrides_) {
    for (auto& [key, entry] : keys) entry.is_chosen = true;
  }
  read_named(root, "readings", readings_);
  if (root["alias"]) aliases_ = read_aliases(root["alias"]);
  for (const char* key : {"scenario", "default_case", "case", "readings", "alias"}) {
    table.erase(key);
  }
  flatten(table, file, "", entries_);
  if (readings_.empty()) return;
  for (const Entries* keys : all_entries()) {
    if (keys->contains("reading")) reading(Config(file_, *keys));
  }
}

std::vector<const Entries*> ScenarioFile::all_entries() const {
  std::vector<const Entries*> all = {&entries_};
  for (const std::string& name : cases_) all.push_back(&overrides_.at(name));
  return all;
}

std::vector<Config> ScenarioFile::tables() const {
  std::vector<Config> tables;
  for (const Entries* keys : all_entries()) {
    tables.emplace_back(file_, *keys, aliases_);
    if (!readings_.empty()) tables.back().remove("reading");
  }
  for (const auto& [name, keys] : readings_) tables.emplace_back(file_, keys, aliases_);
  return tables;
}

void ScenarioFile::check_case(const std::string& name, const std::string& place) const {
  if (has_case(name)) return;
  throw std::invalid_argument(place + ": " + file_ + " has no case \"" + name + "\"" +
                              did_you_mean(name, cases_));
}

Config ScenarioFile::config(const std::string& case_name,
                            const std::vector<std::string>& sets) const {
  check_case(case_name, "--case");
  check_elements(sets);
  Config config(file_, entries_, aliases_);
  config.apply(overrides_.at(case_name));
  if (!readings_.empty()) {
    // A set may choose the reading. The sets are then applied on top of it.
    Config choosing = config;
    for (const std::string& assignment : sets) {
      if (assignment.starts_with("reading=")) choosing.set(assignment);
    }
    config.apply(reading(choosing));
  }
  for (const std::string& assignment : sets) config.set(assignment);
  if (!readings_.empty()) config.remove("reading");
  return config;
}

const Entries& ScenarioFile::reading(const Config& config) const {
  if (config.find("reading") == nullptr) config.fail("reading", "is missing");
  const auto name = config.text("reading");
  if (!name) config.fail("reading", "must be a text");
  const auto found = readings_.find(*name);
  if (found == readings_.end()) {
    config.fail("reading",
                "there is no [readings." + *name + "]" + did_you_mean(*name, names_of(readings_)));
  }
  return found->second;
}

}  // namespace breakwater
