// Scenario files and --set: the source of each value of a run.
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <utility>
#include <variant>
#include <vector>

namespace breakwater {

/// A TOML value of the kinds that scenarios use.
struct ConfigValue {
  // Its own type: std::variant of GCC 12 expects that a copy of a std::vector never throws. Where
  // memory ends, it then destroys a value that is not there.
  struct Array : std::vector<ConfigValue> {
    using std::vector<ConfigValue>::vector;
  };
  std::variant<bool, std::int64_t, double, std::string, Array> data;
};

/// The value as TOML.
std::string toml_value(const ConfigValue& value);
/// The value as a user writes it: without quotes, and equal numbers alike (1, 1.0; -0, 0).
std::string short_value(const ConfigValue& value);

inline constexpr const char* kSetOrigin = "--set";

/// A value and where it was written.
struct ConfigEntry {
  ConfigValue value;
  std::string origin;      ///< "FILE:LINE" or "--set"
  bool is_chosen = false;  ///< set by the case or --set, not by the root of the file
  /// The key as it was written: without the name of its table, or by an alias. Empty: as it is.
  std::string given = {};

  bool is_set() const { return origin == kSetOrigin; }
  /// The line in its file; of --set, the largest number.
  std::size_t line() const;
  /// Higher for an entry that overrides others: that of a case, and that of --set.
  int rank() const { return is_set() ? 2 : is_chosen ? 1 : 0; }
};

/// Thrown by settings that cannot be used, such as those of a part. It names the wrong key.
class WrongKey : public std::invalid_argument {
 public:
  WrongKey(std::string key, const std::string& reason)
      : std::invalid_argument(reason), key_(std::move(key)) {}

  const std::string& key() const { return key_; }

 private:
  std::string key_;
};

/// Calls `body`. If it throws std::invalid_argument, throws a WrongKey for `key` instead.
template <typename Body>
auto blame(const std::string& key, Body&& body) {
  try {
    return std::forward<Body>(body)();
  } catch (const WrongKey&) {
    throw;
  } catch (const std::invalid_argument& error) {
    throw WrongKey(key, error.what());
  }
}

/// Further names of keys: {name, key}.
using Aliases = std::map<std::string, std::string>;

/// The keys of one run, dotted ("contact.stiffness_N_m"), with their origins.
class Config {
 public:
  Config(std::string file, std::map<std::string, ConfigEntry> entries, Aliases aliases = {})
      : file_(std::move(file)),
        entries_(std::make_shared<Entries>(std::move(entries))),
        aliases_(std::make_shared<const Aliases>(std::move(aliases))) {}

  /// Applies one `key.path=value`. A value that is not TOML is taken as a string. The key may name
  /// an element of an array that is there (whole_key()). Throws std::invalid_argument if the form
  /// is wrong or the element does not exist.
  void set(const std::string& assignment);

  /// Overwrites with all of `overrides`.
  void apply(const std::map<std::string, ConfigEntry>& overrides);

  void remove(const std::string& key) { own_entries().erase(key); }

  /// Gives another value to a key that is there.
  void renew(const std::string& key, const ConfigValue& value) {
    own_entries().at(key).value = value;
  }

  /// The same values, where each key is found and reported with `prefix` before it: "joint" in
  /// under("axis.x.") is "axis.x.joint".
  Config under(const std::string& prefix) const;

  const std::string& file() const { return file_; }
  const ConfigEntry* find(const std::string& key) const;
  /// The text of a key; nothing if the key is missing or is no text.
  std::optional<std::string> text(const std::string& key) const;
  /// The number of a key; nothing if the key is missing or is not a number.
  std::optional<double> number(const std::string& key) const;
  const std::map<std::string, ConfigEntry>& entries() const { return *entries_; }
  /// Further names that the file gives.
  const Aliases& aliases() const { return *aliases_; }
  /// The names of the tables [TABLE.NAME], in the file's order; those of --set alone come last.
  /// Throws as fail() does unless a name is made of A-Z, a-z, 0-9 and '_', as the names of signals
  /// are.
  std::vector<std::string> names_in(const std::string& table) const;

  /// The path of a file that a key names. A name from --set is relative to the working folder, a
  /// name from a scenario file to the folder of that file (find_file). Throws as fail() if missing.
  std::string find_file_of(const std::string& key, const std::string& name) const;

  /// Throws std::invalid_argument `ORIGIN: KEY: MESSAGE` with the key as it was written. The origin
  /// of a key that is not set is the file, or --set if all keys of its table [TABLE.NAME] are from
  /// there. The key may name an element.
  [[noreturn]] void fail(const std::string& key, const std::string& message) const;

  /// The same, but fail() reports the wrong key.
  template <typename Body>
  auto blame(const std::string& key, Body&& body) const {
    try {
      return breakwater::blame(key, std::forward<Body>(body));
    } catch (const WrongKey& wrong) {
      fail(wrong.key(), wrong.what());
    }
  }

 private:
  using Entries = std::map<std::string, ConfigEntry>;

  std::string origin_of(const std::string& key) const;
  Entries& own_entries() {
    if (entries_.use_count() > 1) entries_ = std::make_shared<Entries>(*entries_);
    return *entries_;
  }

  std::string file_;
  std::shared_ptr<Entries> entries_;  ///< shared with copies until one of them changes
  std::shared_ptr<const Aliases> aliases_;
  std::string prefix_;
};

/// The name of a key's table; empty for a root key.
std::string table_of(const std::string& key);
/// The key without its element: "a.b" for "a.b[2]" and for "a.b[2][1]". They count from 1.
std::string whole_key(const std::string& key);
/// Whether `key` names an element of the value of `other`, at any depth.
bool is_element_of(const std::string& key, const std::string& other);

/// A scenario file: its keys, its cases and its readings. A case is a table of overrides
/// `[case.NAME]`. A reading is a table `[readings.NAME]`, chosen by the root key `reading`. The
/// table `[alias]` gives further names to keys: "wall.distance_m" = "contact.wall.distance_m".
class ScenarioFile {
 public:
  /// Throws std::invalid_argument `FILE[:LINE]: reason` if the file cannot be read or parsed, or is
  /// not for `scenario`. A case or reading with an invalid name is refused too: a name matches
  /// [A-Za-z0-9._+-]+ and is not ".", ".." or "all".
  ScenarioFile(const std::string& file, const std::string& scenario);

  const std::string& file() const { return file_; }
  /// The text that was read. The file may have changed since.
  const std::string& text() const { return text_; }
  /// In the file's order.
  const std::vector<std::string>& cases() const { return cases_; }
  bool has_case(const std::string& name) const { return overrides_.contains(name); }
  /// Throws std::invalid_argument `PLACE: FILE has no case "NAME"`.
  void check_case(const std::string& name, const std::string& place) const;
  const std::string& default_case() const { return default_case_; }
  const Aliases& aliases() const { return aliases_; }

  /// The tables, not merged: the file's keys, each case, each reading.
  std::vector<Config> tables() const;

  /// The file's keys, overridden by those of the case, the reading and `sets` (key=value), in this
  /// order. Throws std::invalid_argument if the case or reading does not exist, a set is malformed,
  /// or `sets` has both an array and one of its elements.
  Config config(const std::string& case_name, const std::vector<std::string>& sets = {}) const;

 private:
  std::vector<const std::map<std::string, ConfigEntry>*> all_entries() const;
  const std::map<std::string, ConfigEntry>& reading(const Config& config) const;

  std::string file_;
  std::string text_;
  std::map<std::string, ConfigEntry> entries_;
  std::vector<std::string> cases_;
  std::map<std::string, std::map<std::string, ConfigEntry>> overrides_;
  std::map<std::string, std::map<std::string, ConfigEntry>> readings_;
  std::string default_case_;
  Aliases aliases_;
};

/// Whether a word of the command line is a scenario file rather than a name: "mine.toml".
inline bool is_scenario_file(const std::string& word) {
  return word.ends_with(".toml");
}

}  // namespace breakwater
