// The one reader of tables: of studies, tunings, experiments, printed results and shot lists.
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

struct Range;

/// A place in a TOML file, and what stands there: a table, another value, or nothing. Whatever is
/// wrong is said with its place: each function that reads throws std::invalid_argument `FILE:LINE:
/// KEY: reason`, KEY with the tables that it is in. The parsed file must outlive it.
class TomlEntry {
 public:
  /// How a key is called that stands in no file: as an option of the command line.
  using OptionName = std::string (*)(std::string key);

  /// A file's root. Options may lie on it where `option` is given.
  TomlEntry(const toml::table& root, std::string file, OptionName option = nullptr);

  /// Whether anything stands there.
  explicit operator bool() const { return node_ != nullptr; }
  /// Null if nothing does.
  const toml::node* node() const { return node_; }
  const std::string& file() const { return file_; }
  /// Where nothing stands, its table's.
  std::size_t line() const { return source_->begin.line; }
  /// Where its key was written; options keep their order by it.
  const toml::source_position& begin() const { return begin_; }
  /// "FILE:LINE: KEY", an option's name, or "FILE: KEY" of what a root or a missing table lacks.
  std::string place() const;
  [[noreturn]] void fail(const std::string& reason) const;

  /// An entry of a table; of nothing, nothing.
  TomlEntry operator[](const std::string& key) const;
  /// All entries of a table, in the file's order of keys; of nothing, none.
  std::vector<std::pair<std::string, TomlEntry>> entries() const;
  /// Refuses other entries of a table than these.
  void allow(const std::vector<std::string>& keys) const;
  /// An array's, under the array's name; of nothing, none.
  std::vector<TomlEntry> elements() const;

  /// The text, which must not be empty.
  std::string text() const;
  /// The same; "" where nothing stands.
  std::string text_or_nothing() const;
  /// A text that may be empty; "" of nothing.
  std::string text_or_empty() const;
  /// A text, or an array of at least one, each once; of nothing, none.
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
  /// Leaves the target as it is where nothing stands.
  template <typename Enum>
  void choice(const Names<Enum>& names, Enum& target) const {
    if (*this) target = choice(names);
  }

  /// A value as TOML in one line; numbers as the shortest text that reads back the same.
  std::string written() const;

 private:
  TomlEntry with(const toml::node* node, const toml::source_region& source, std::string key) const;
  const toml::table* table() const;  // null of nothing
  std::size_t choice_of(const std::vector<std::string>& names) const;

  const toml::node* node_;
  const toml::source_region* source_;  // of its value, or of the last table that is there
  bool has_line_ = true;               // whether it, or its own table, stands in the file
  toml::source_position begin_ = {};
  std::string file_;
  std::string key_ = {};  // with the tables that it is in; empty: the root
  OptionName option_;
};

}  // namespace breakwater
