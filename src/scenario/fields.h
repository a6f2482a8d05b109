// Which keys a scenario has, of what type and range, and which variable each fills.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "scenario/config.h"

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

  /// Reads every key. Throws std::invalid_argument `ORIGIN: KEY: reason` for the first key that is
  /// unknown, missing, of the wrong type or out of range.
  void read(const Config& config);

  /// The scenario file that gives these values again, with one case and no overrides.
  std::string print(const std::string& scenario, const std::string& case_name) const;

  /// What the keys of files name now: the models that a run is made of, once they are read and the
  /// scenario's check() has found them.
  std::vector<std::string> files() const;

 private:
  using Error = std::optional<std::string>;
  struct Field {
    std::string key;
    std::string doc;
    std::function<Error(const ConfigValue&)> read;
    std::function<std::string()> print;
  };

  void add_choice(const std::string& key, const std::vector<std::string>& names,
                  std::function<void(std::size_t)> assign, std::function<std::string()> print,
                  const std::string& doc);

  std::vector<Field> fields_;
  std::vector<const std::string*> files_;
};

}  // namespace breakwater
