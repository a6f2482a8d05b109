// Which keys a scenario has, of what type and range, and which variable each fills.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <breakwater/scenario/config.h>

namespace breakwater {

/// What a number must satisfy besides being finite.
struct Range {
  double lower;
  double upper;
  bool lower_is_allowed;
  std::string text;  ///< "positive"

  bool contains(double value) const {
    return value <= upper && (lower_is_allowed ? value >= lower : value > lower);
  }
};
Range any();
Range positive();
Range not_negative();
Range between(double lower, double upper);

/// A key that has no effect, and on what that depends: "only where observer.name is kfd".
struct UnusedKey {
  std::string key;
  std::string reason;
};

/// The keys of a scenario in the order in which they are printed. Each is bound to a variable of
/// the settings: read() fills them from a config, print() writes them out as a scenario file.
class Fields {
 public:
  void number(const std::string& key, double& target, const Range& range, const std::string& doc);
  void count(const std::string& key, int& target, const Range& range, const std::string& doc);
  void count(const std::string& key, std::uint64_t& target, const Range& range,
             const std::string& doc);
  void flag(const std::string& key, bool& target, const std::string& doc);
  void text(const std::string& key, std::string& target, const std::string& doc);
  /// A file's name; one of Breakwater's own is printed so that any installation finds it.
  void file(const std::string& key, std::string& target, const std::string& doc);
  void numbers(const std::string& key, std::vector<double>& target, const Range& range,
               const std::string& doc);
  void number_groups(const std::string& key, std::vector<std::vector<double>>& target,
                     const Range& range, const std::string& doc);

  /// Several options may mean the same: the first of them is printed.
  template <typename Enum>
  void choice(const std::string& key, Enum& target,
              std::vector<std::pair<std::string, Enum>> options, const std::string& doc) {
    std::vector<std::string> names;
    for (const auto& option : options) names.push_back(option.first);
    add_choice(
        key, names, [options, &target](std::size_t i) { target = options[i].second; },
        [options, &target] {
          for (const auto& [name, value] : options) {
            if (value == target) return name;
          }
          return std::string();
        },
        doc);
  }

  /// Says that `keys` count only where the choice `choice` has one of the values `names`: where it
  /// has another, setting them has no effect. Several such statements on a key must all hold.
  void only_for(const std::vector<std::string>& keys, const std::string& choice,
                const std::vector<std::string>& names);
  /// The same where `holds` returns true, which `condition` says in words.
  void only_where(const std::vector<std::string>& keys, const std::string& condition,
                  std::function<bool()> holds);

  /// Reads every key. Throws std::invalid_argument `ORIGIN: KEY: reason` for the first key that is
  /// unknown, missing, of the wrong type or out of range.
  void read(const Config& config);
  /// The same for a run of `file`, of which every table is checked first, whichever case runs: a
  /// value that is wrong is refused even where another overrides it.
  void read(const ScenarioFile& file, const Config& config);

  /// The keys that have no effect with what was read, and why.
  std::vector<UnusedKey> unused() const;

  /// The scenario file that gives these values again, with one case and no overrides.
  std::string print(const std::string& scenario, const std::string& case_name) const;

  /// What the keys of files name now: the models that a run is made of, once they are read and the
  /// scenario's check() has found them.
  std::vector<std::string> files() const;

 private:
  using Error = std::optional<std::string>;
  struct Condition {
    std::string text;
    std::function<bool(const Fields&)> holds;
  };
  struct Field {
    std::string key;
    std::string doc;
    std::function<Error(const ConfigValue&)> read;
    std::function<std::string()> print;
    std::vector<Condition> conditions = {};  // of its having an effect
  };

  const Field* find(const std::string& key) const;
  Field& at(const std::string& key);
  void check(const Config& table);
  void add_choice(const std::string& key, const std::vector<std::string>& names,
                  std::function<void(std::size_t)> assign, std::function<std::string()> print,
                  const std::string& doc);

  std::vector<Field> fields_;
  std::vector<const std::string*> files_;
};

}  // namespace breakwater
