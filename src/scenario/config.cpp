#include "scenario/config.h"

#include <toml++/toml.h>
#include <algorithm>
#include <filesystem>
#include <numeric>
#include <optional>
#include <stdexcept>

#include "scenario/paths.h"

namespace breakwater {
namespace {

constexpr const char* kSetOrigin = "--set";

using Entries = std::map<std::string, ConfigEntry>;

std::string at_line(const std::string& file, const toml::source_region& source) {
  return file + ":" + std::to_string(source.begin.line);
}

ConfigValue convert(const toml::node& node, const std::string& origin) {
  if (const auto* value = node.as_boolean()) return {value->get()};
  if (const auto* value = node.as_integer()) return {value->get()};
  if (const auto* value = node.as_floating_point()) return {value->get()};
  if (const auto* value = node.as_string()) return {value->get()};
  if (const auto* array = node.as_array()) {
    ConfigValue::Array values;
    for (const toml::node& element : *array) values.push_back(convert(element, origin));
    return {std::move(values)};
  }
  throw std::invalid_argument(origin + ": dates and tables in arrays are not used here");
}

// Tables become dotted keys, an array's tables by their number from 1; everything else is a value.
void flatten(const toml::table& table, const std::string& file, const std::string& prefix,
             Entries& entries) {
  for (const auto& [key, node] : table) {
    const std::string path = prefix + std::string(key.str());
    if (const auto* nested = node.as_table()) {
      flatten(*nested, file, path + ".", entries);
    } else if (node.is_array_of_tables()) {
      std::size_t number = 0;
      for (const toml::node& element : *node.as_array()) {
        const std::string element_path = path + "." + std::to_string(++number) + ".";
        flatten(*element.as_table(), file, element_path, entries);
      }
    } else {
      const std::string origin = at_line(file, node.source());
      entries[path] = {convert(node, origin), origin};
    }
  }
}

toml::table parse(const std::string& file) {
  if (!std::filesystem::is_regular_file(file)) {
    throw std::invalid_argument(file + ": cannot be read");
  }
  try {
    return toml::parse_file(file);
  } catch (const toml::parse_error& error) {
    if (error.source().begin.line == 0) throw std::invalid_argument(file + ": cannot be read");
    throw std::invalid_argument(at_line(file, error.source()) +
                                ": is not TOML: " + std::string(error.description()));
  }
}

std::size_t edit_distance(const std::string& a, const std::string& b) {
  std::vector<std::size_t> row(b.size() + 1);
  std::iota(row.begin(), row.end(), 0U);
  for (std::size_t i = 1; i <= a.size(); ++i) {
    std::size_t diagonal = std::exchange(row[0], i);
    for (std::size_t j = 1; j <= b.size(); ++j) {
      const std::size_t replaced = diagonal + (a[i - 1] == b[j - 1] ? 0 : 1);
      diagonal = std::exchange(row[j], std::min({row[j] + 1, row[j - 1] + 1, replaced}));
    }
  }
  return row.back();
}

}  // namespace

std::string did_you_mean(const std::string& word, const std::vector<std::string>& candidates) {
  const std::string* best = nullptr;
  std::size_t best_distance = std::max<std::size_t>(2, word.size() / 3) + 1;
  for (const std::string& candidate : candidates) {
    const std::size_t distance = edit_distance(word, candidate);
    if (distance < best_distance) {
      best_distance = distance;
      best = &candidate;
    }
  }
  return best != nullptr ? " (did you mean " + *best + "?)" : "";
}

void Config::set(const std::string& assignment) {
  const std::size_t equals = assignment.find('=');
  if (equals == std::string::npos || equals == 0 || equals + 1 == assignment.size()) {
    throw std::invalid_argument("--set: " + assignment + ": must be of the form key.path=value");
  }
  const std::string key = assignment.substr(0, equals);
  const std::string text = assignment.substr(equals + 1);
  try {
    const toml::table parsed = toml::parse("value = " + text);
    if (const toml::node* node = parsed.get("value"); node != nullptr && parsed.size() == 1) {
      entries_[key] = {convert(*node, "--set: " + key), kSetOrigin};
      return;
    }
  } catch (const toml::parse_error&) {
    // Not TOML, so a bare word; whether the key is a string shows when it is read.
  }
  entries_[key] = {{text}, kSetOrigin};
}

void Config::apply(const Entries& overrides) {
  for (const auto& [key, entry] : overrides) entries_[key] = entry;
}

const ConfigEntry* Config::find(const std::string& key) const {
  const auto found = entries_.find(key);
  return found != entries_.end() ? &found->second : nullptr;
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
  const bool is_set = entry != nullptr && entry->origin == kSetOrigin;
  const std::filesystem::path folder =
      is_set ? std::filesystem::path() : std::filesystem::path(file_).parent_path();
  const std::filesystem::path file = find_file(name, folder);
  std::error_code error;
  if (!std::filesystem::is_regular_file(file, error)) {
    const std::string place = folder.empty() ? "the working folder" : folder.string();
    fail(key, "there is no file " + name + " in " + place + " or " + data_root().string());
  }
  return file.string();
}

void Config::fail(const std::string& key, const std::string& message) const {
  const ConfigEntry* entry = find(key);
  throw std::invalid_argument((entry != nullptr ? entry->origin : file_) + ": " + key + ": " +
                              message);
}

Config read_config(const std::string& file) {
  Entries entries;
  flatten(parse(file), file, "", entries);
  return {file, std::move(entries)};
}

ScenarioFile::ScenarioFile(const std::string& file, const std::string& scenario) : file_(file) {
  toml::table table = parse(file);

  const auto root_text = [&](const char* key) {
    const toml::node* node = table.get(key);
    if (node == nullptr) throw std::invalid_argument(file + ": " + key + ": is missing");
    if (!node->is_string()) {
      throw std::invalid_argument(at_line(file, node->source()) + ": " + key +
                                  ": must be a string");
    }
    return std::pair(node->as_string()->get(), at_line(file, node->source()));
  };
  const auto [name, name_origin] = root_text("scenario");
  if (name != scenario) {
    throw std::invalid_argument(name_origin + ": scenario: is \"" + name + "\", not \"" + scenario +
                                "\"");
  }
  const auto [default_case, default_origin] = root_text("default_case");
  default_case_ = default_case;

  if (const toml::table* cases = table["case"].as_table()) {
    std::vector<std::pair<toml::source_index, std::string>> lines;
    for (const auto& [key, node] : *cases) {
      const std::string case_name(key.str());
      const toml::table* overrides = node.as_table();
      if (overrides == nullptr) {
        throw std::invalid_argument(at_line(file, node.source()) + ": case." + case_name +
                                    ": must be a table");
      }
      flatten(*overrides, file, "", overrides_[case_name]);
      lines.emplace_back(node.source().begin.line, case_name);
    }
    std::sort(lines.begin(), lines.end());  // TOML tables are read sorted by name
    for (const auto& line : lines) cases_.push_back(line.second);
  }
  if (!overrides_.contains(default_case_)) {
    throw std::invalid_argument(default_origin + ": default_case: there is no [case." +
                                default_case_ + "]" + did_you_mean(default_case_, cases_));
  }
  if (const toml::table* readings = table["readings"].as_table()) {
    for (const auto& [key, node] : *readings) {
      const toml::table* keys = node.as_table();
      const std::string name_of_reading(key.str());
      if (keys == nullptr) {
        throw std::invalid_argument(at_line(file, node.source()) + ": readings." + name_of_reading +
                                    ": must be a table");
      }
      flatten(*keys, file, "", readings_[name_of_reading]);
    }
    table.erase("readings");
  }
  table.erase("scenario");
  table.erase("default_case");
  table.erase("case");
  flatten(table, file, "", entries_);
}

Config ScenarioFile::config(const std::string& case_name,
                            const std::vector<std::string>& sets) const {
  const auto found = overrides_.find(case_name);
  if (found == overrides_.end()) {
    throw std::invalid_argument("--case: " + file_ + " has no case \"" + case_name + "\"" +
                                did_you_mean(case_name, cases_));
  }
  Config config(file_, entries_);
  config.apply(found->second);
  Config with_sets = config;
  for (const std::string& assignment : sets) with_sets.set(assignment);
  if (readings_.empty()) return with_sets;

  // Which reading is known only now; the sets then go on top of it.
  config.apply(reading(with_sets));
  for (const std::string& assignment : sets) config.set(assignment);
  config.remove("reading");
  return config;
}

const Entries& ScenarioFile::reading(const Config& config) const {
  const ConfigEntry* entry = config.find("reading");
  if (entry == nullptr) config.fail("reading", "is missing");
  std::vector<std::string> names;
  for (const auto& [name, keys] : readings_) names.push_back(name);
  const auto* name = std::get_if<std::string>(&entry->value.data);
  if (name == nullptr) config.fail("reading", "must be a string");
  const auto found = readings_.find(*name);
  if (found == readings_.end()) {
    config.fail("reading", "there is no [readings." + *name + "]" + did_you_mean(*name, names));
  }
  return found->second;
}

}  // namespace breakwater
