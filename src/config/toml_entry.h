// Reads tables: of studies, tunings, experiments, printed results and shot lists.
#pragma once

#include <toml++/toml.h>

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <breakwater/config/names.h>

namespace breakwater {

struct ConfigValue;
struct Range;

/// The value of a key or of an element. Throws std::invalid_argument `PLACE: reason` for a date,
/// and for a table, also if an array has one.
ConfigValue config_value(const toml::node& node, const std::string& place);

/// A place in a TOML file with a table, another value, or nothing. The functions that read throw
/// std::invalid_argument `FILE:LINE: KEY: reason`, where KEY includes the names of its tables. The
/// parsed file must outlive it.
class TomlEntry {
 public:
  /// The name of the option that sets a key on the command line.
  using OptionName = std::string (*)(std::string key);

  /// The root of a file. `option` is for tables in which options may override the file.
  TomlEntry(const toml::table& root, std::string file, OptionName option = nullptr);

  /// Whether anything stands there.
  explicit operator bool() const { return node_ != nullptr; }
  /// Null if nothing is there.
  const toml::node* node() const { return node_; }
  const std::string& file() const { return file_; }
  /// If nothing is there, the line of its table.
  std::size_t line() const { return source_->begin.line; }
  /// The position of the key. It keeps options in their order.
  const toml::source_position& begin() const { return begin_; }
  /// "FILE:LINE: KEY", the name of an option, or "FILE: KEY" if the key or its table is missing.
  std::string place() const;
  [[noreturn]] void fail(const std::string& reason) const;

  /// An entry of a table. It is empty if the table is missing.
  TomlEntry operator[](const std::string& key) const;
  /// All entries of a table in the file's order; none if the table is missing.
  std::vector<std::pair<std::string, TomlEntry>> entries() const;
  /// Refuses entries with other keys.
  void allow(const std::vector<std::string>& keys) const;
  /// The elements of an array, each under the name of the array; none if it is missing.
  std::vector<TomlEntry> elements() const;

  /// The text. An empty one is refused.
  std::string text() const;
  /// The same, but "" if nothing is there.
  std::string text_or_nothing() const;
  /// A text that may be empty, and "" if nothing is there.
  std::string text_or_empty() const;
  /// A text, or an array of different texts with at least one element; none if nothing is there.
  std::vector<std::string> texts() const;
  std::int64_t whole(std::int64_t lower, std::int64_t upper) const;
  /// A finite number.
  double number() const;
  double number(const Range& range) const;
  std::optional<double> number_or_nothing() const;
  template <typename Enum>
  Enum choice(const Names<Enum>& names) const {
    return names[choice_of(names_of(names))].second;
  }
  /// Leaves the target as it is if nothing is there.
  template <typename Enum>
  void choice(const Names<Enum>& names, Enum& target) const {
    if (*this) target = choice(names);
  }

  /// A value as TOML in one line. A number has the fewest digits that read back to the same value.
  std::string written() const;

 private:
  TomlEntry with(const toml::node* node, const toml::source_region& source, std::string key) const;
  const toml::table* table() const;  // null if nothing is there
  std::size_t choice_of(const std::vector<std::string>& names) const;

  const toml::node* node_;
  const toml::source_region* source_;  // its value, or the innermost table that is there
  bool has_line_ = true;               // whether it or its own table is in the file
  toml::source_position begin_ = {};
  std::string file_;
  std::string key_ = {};  // with the names of its tables; empty for the root
  OptionName option_;
};

}  // namespace breakwater
