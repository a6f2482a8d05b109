// The tables of a study's file, or of a tuning's. Whatever is wrong is said with its place.
#pragma once

#include <fmt/format.h>
#include <toml++/toml.h>

#include <algorithm>
#include <cstdint>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include <breakwater/config/config.h>
#include <breakwater/study/study.h>

namespace breakwater {

/// An enumeration's members by their names.
template <typename Enum>
using Names = std::vector<std::pair<std::string, Enum>>;

template <typename Enum>
std::vector<std::string> names_of(const Names<Enum>& names) {
  std::vector<std::string> all;
  for (const auto& [name, value] : names) all.push_back(name);
  return all;
}

template <typename Enum>
std::string name_of(const Names<Enum>& names, Enum value) {
  return std::find_if(names.begin(), names.end(), [&](const auto& n) { return n.second == value; })
      ->first;
}

const Names<DistributionKind>& distributions();

/// The tables of a study's or a tuning's file. Its `config` is made absolute where it lies beside
/// the file, as the paths of a scenario file are; what made the results of a study whose file this
/// was is left out.
toml::table study_tables(const std::string& file);

/// A value as TOML in one line; numbers as the shortest text that reads back the same.
std::string toml_text(const toml::node& node);
/// An array of strings.
std::string toml_text(const std::vector<std::string>& texts);

/// Throws std::invalid_argument `FILE:LINE: KEY: reason` for what is not as it should be. `key` is
/// how the place is named, the tables that it is in included.
class StudyReader {
 public:
  explicit StudyReader(std::string file) : file_(std::move(file)) {}

  const std::string& file() const { return file_; }

  /// Where the value of a key was written: "FILE:LINE: key", or an option, which has no file.
  std::string place(const toml::node& node, const std::string& key) const;
  [[noreturn]] void fail(const toml::node& node, const std::string& key,
                         const std::string& reason) const;

  /// Refuses other keys than these.
  void allow(const toml::table& table, const std::string& prefix,
             const std::vector<std::string>& keys) const;

  /// Null if it is not there.
  const toml::table* table(const toml::table& from, const std::string& key) const;
  std::string text(const toml::node& node, const std::string& key) const;
  std::string text_or_nothing(const toml::table& from, const std::string& key,
                              const std::string& prefix = "") const;
  /// A text, or an array of at least one.
  std::vector<std::string> texts(const toml::node& node, const std::string& key) const;
  std::int64_t whole(const toml::node& node, const std::string& key, std::int64_t lower,
                     std::int64_t upper) const;
  /// A finite number.
  double number(const toml::node& node, const std::string& key) const;
  /// { first = 1, count = 20 }, or an array.
  std::vector<std::uint64_t> seeds(const toml::node& node, const std::string& key = "seeds") const;
  /// key=value of a table of keys.
  std::vector<std::string> sets(const toml::table& table, const std::string& name) const;
  /// The keys of [vary], [compare] and the like, in the file's order.
  std::vector<VariedKey> varied(const toml::table& table, const std::string& name,
                                const std::set<std::string>& but = {}) const;

  template <typename Enum>
  Enum choice(const toml::node& node, const std::string& key, const Names<Enum>& names) const {
    const std::string name = text(node, key);
    for (const auto& [option, value] : names) {
      if (option == name) return value;
    }
    const std::vector<std::string> options = names_of(names);
    fail(node, key,
         fmt::format("must be one of {}, is \"{}\"{}", fmt::join(options, ", "), name,
                     did_you_mean(name, options)));
  }
  /// Leaves the target as it is where there is no such key.
  template <typename Enum>
  void choice(const toml::table& from, const std::string& key, const Names<Enum>& names,
              Enum& target, const std::string& prefix = "") const {
    if (const toml::node* node = from.get(key)) target = choice(*node, prefix + key, names);
  }

 private:
  void read_sets(const toml::table& table, const std::string& name, const std::string& prefix,
                 std::vector<std::string>& sets) const;
  void collect(const toml::table& table, const std::string& name, const std::string& prefix,
               const std::set<std::string>& but,
               std::vector<std::pair<toml::source_position, VariedKey>>& found) const;
  // An inline table that looks like a distribution, and is none.
  void refuse_misspelt(const toml::table& table, const std::string& key) const;
  VariedKey varied_key(const toml::node& node, const std::string& table,
                       const std::string& path) const;

  std::string file_;
};

}  // namespace breakwater
