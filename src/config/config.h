// Scenario files and --set: where every value of a run comes from.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <stdexcept>
#include <string>
#include <utility>
#include <variant>
#include <vector>

namespace breakwater {

/// A TOML value as far as scenarios use them.
struct ConfigValue {
  using Array = std::vector<ConfigValue>;
  std::variant<bool, std::int64_t, double, std::string, Array> data;
};

inline constexpr const char* kSetOrigin = "--set";

/// A value and where it was written.
struct ConfigEntry {
  ConfigValue value;
  std::string origin;      ///< "FILE:LINE" or "--set"
  bool is_chosen = false;  ///< by the case or --set, and not what all cases of the file have

  bool is_set() const { return origin == kSetOrigin; }
};

/// The keys that one run is to use, dotted ("contact.stiffness_N_m"), with their origins.
class Config {
 public:
  Config(std::string file, std::map<std::string, ConfigEntry> entries)
      : file_(std::move(file)), entries_(std::move(entries)) {}

  /// Applies one `key.path=value`; a value that is not TOML is taken as a string. Of a key that is
  /// an array one element alone may be given (whole_key()), if the array is there. Throws
  /// std::invalid_argument if it is not of that form, or there is no such element.
  void set(const std::string& assignment);

  /// Overwrites with all of `overrides`.
  void apply(const std::map<std::string, ConfigEntry>& overrides);

  void remove(const std::string& key) { entries_.erase(key); }

  const ConfigEntry* find(const std::string& key) const;
  /// A key's number, whole or not; nothing if it is not there or is none.
  std::optional<double> number(const std::string& key) const;
  const std::map<std::string, ConfigEntry>& entries() const { return entries_; }

  /// The file that a key names, found from where the key was written: the working folder for
  /// --set, the scenario file's folder else (find_file). Throws as fail() if it is not there.
  std::string find_file_of(const std::string& key, const std::string& name) const;

  /// Throws std::invalid_argument `ORIGIN: KEY: MESSAGE`, the origin being the key's, or the file
  /// where the key stands nowhere. The key may be an element's.
  [[noreturn]] void fail(const std::string& key, const std::string& message) const;

  /// Calls `body`; an std::invalid_argument that it throws is blamed on `key` as fail() does.
  template <typename Body>
  auto blame(const std::string& key, Body&& body) const {
    try {
      return std::forward<Body>(body)();
    } catch (const std::invalid_argument& error) {
      fail(key, error.what());
    }
  }

 private:
  std::string file_;
  std::map<std::string, ConfigEntry> entries_;
};

/// The key without the element that it may name: "a.b" of "a.b[2]", the second of the array a.b,
/// and of "a.b[2][1]", the first of that. Elements are counted from 1, as the values of a signal
/// are.
std::string whole_key(const std::string& key);
/// Whether a key names an element of what another one does, or an element of such an element.
bool is_element_of(const std::string& key, const std::string& other);

/// A scenario file: its own keys; the cases, which are tables of overrides `[case.NAME]`; and,
/// where it has them, readings: sets of keys `[readings.NAME]`, of which the root key `reading`
/// picks one.
class ScenarioFile {
 public:
  /// Throws std::invalid_argument `FILE[:LINE]: reason` if it cannot be read or parsed, names
  /// another scenario than `scenario`, or has a case or reading whose name is none for a folder:
  /// names are [A-Za-z0-9._+-]+, and not ".", ".." or "all".
  ScenarioFile(const std::string& file, const std::string& scenario);

  const std::string& file() const { return file_; }
  /// What was read: the file may be another by now.
  const std::string& text() const { return text_; }
  /// In the file's order.
  const std::vector<std::string>& cases() const { return cases_; }
  bool has_case(const std::string& name) const { return overrides_.contains(name); }
  /// Throws std::invalid_argument `PLACE: FILE has no case "NAME"` if there is none of that name.
  void check_case(const std::string& name, const std::string& place) const;
  const std::string& default_case() const { return default_case_; }

  /// Each table of keys alone: the file's own, the cases', the readings'.
  std::vector<Config> tables() const;

  /// The file's keys with one case's, then the reading's, then `sets` (key=value) on top. Throws
  /// std::invalid_argument if there is no such case or reading, a set is malformed, or one gives an
  /// array and another an element of it.
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
};

}  // namespace breakwater
