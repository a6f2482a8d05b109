// Which keys a scenario has, of what type and range, and which variable each fills.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <breakwater/config/config.h>

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
  std::string choice;  ///< the key on whose value it depends; empty: on another condition
};

/// One meaning of a key, for a reference of all keys.
struct KeyHelp {
  std::string key;
  std::string choice;              ///< chooses the parts that use it; empty: the scenario uses it
  std::vector<std::string> parts;  ///< of which one must be chosen: {"kfd", "dkf"}
  std::string text;
  std::string takes;  ///< "a number, positive"
  std::string value;  ///< as TOML has it; empty: neither the file nor a default value gives it
  std::vector<std::string> conditions;  ///< each must hold: "disturbance.kind is sine"
};

/// Why a value is refused.
struct Refusal {
  Refusal(std::string why, std::string which = "")
      : reason(std::move(why)), element(std::move(which)) {}

  std::string reason;
  std::string element;  ///< of an array: "[2]", "[2][1]"; empty: all of it
};

/// The keys of a scenario in the order in which they are printed. Each is bound to a variable of
/// the settings: read() fills them from a config, print() writes them out as a scenario file.
///
/// A key that is bound while an OfPart lives is that part's: it must be there only where the part
/// is chosen. Several parts may bind one key, each to a variable of its own.
class Fields {
 public:
  /// What is bound during its life belongs to the part that the choice `choice` calls `name`.
  class OfPart {
   public:
    OfPart(Fields& fields, std::string choice, std::string name) : fields_(fields) {
      fields_.part_ = {std::move(choice), std::move(name)};
    }
    OfPart(const OfPart&) = delete;
    OfPart& operator=(const OfPart&) = delete;
    ~OfPart() { fields_.part_ = {}; }

   private:
    Fields& fields_;
  };

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
  /// One group may stand there as its numbers alone, and is printed so.
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

  /// What a key is where a file does not have it: such a key need not be there.
  void standard(const std::string& key, const ConfigValue& value);

  /// Says that `keys` count only where the choice `choice` has one of the values `names`: where it
  /// has another, setting them has no effect. Several such statements on a key must all hold.
  void only_for(const std::vector<std::string>& keys, const std::string& choice,
                const std::vector<std::string>& names);
  /// The same where `holds` returns true, which `condition` says in words.
  void only_where(const std::vector<std::string>& keys, const std::string& condition,
                  std::function<bool()> holds);

  /// Reads every key, and makes files' names absolute. Throws std::invalid_argument `ORIGIN: KEY:
  /// reason` for the first key that is unknown, missing, of the wrong type or out of range, or
  /// names a file that is not there.
  void read(const Config& config);
  /// The same, but what is missing is no error: print() then asks for it.
  void read_incomplete(const Config& config);
  /// Checks every table of a file, whichever case runs: a value that is wrong is refused even where
  /// another overrides it. Throws as read() does, but misses nothing; a part that is not there is
  /// named before keys of its own. To be called before it.
  void check(const ScenarioFile& file);

  /// Reads what it can of a run that is finished: a key that is unknown, or whose value this
  /// program does not know (a controller of another's, say), counts for nothing. Returns the keys
  /// that are missing where the run would need them.
  std::vector<std::string> read_finished(const Config& config);

  /// The keys that were read and have no effect, and why.
  std::vector<UnusedKey> unused() const;

  /// The scenario file that gives these values again, with one case and no overrides. A key that
  /// has no value stands there as a comment to fill in, `# required`.
  std::string print(const std::string& scenario, const std::string& case_name) const;

  /// Every meaning of every key, in their order, with the values that were read.
  std::vector<KeyHelp> help() const;

  /// What the keys of files name now: the models that a run is made of, once they are read and the
  /// scenario's check() has found them.
  std::vector<std::string> files() const;

 private:
  using Error = std::optional<Refusal>;
  struct Condition {
    std::string text;
    std::function<bool(const Fields&)> holds;
    std::string choice = {};  // the key on whose value it depends, if it does on one
  };
  // One of the parts among which a choice chooses; of none, the scenario itself.
  struct Part {
    std::string choice;
    std::string name;

    bool operator==(const Part&) const = default;
  };
  struct Variable {
    Part part;
    std::string doc;
    std::string takes;  // "a number, positive"
    std::function<Error(const ConfigValue&)> read;
    std::function<std::string()> print;
    std::string* file = nullptr;             // its name, if it is one
    std::vector<Condition> conditions = {};  // of its having an effect
    std::optional<ConfigValue> standard = {};
  };
  struct Field {
    std::string key;
    std::vector<Variable> variables;
    bool was_read = false;
    bool is_missing = false;  // of an incomplete file, unless it has a standard
    std::size_t suited = 0;   // the first variable whom its value suited

    std::string doc() const;
  };

  // Assigns every key that the config has. Returns those that count and stand nowhere.
  std::vector<const Field*> assign_all(const Config& config);
  void add(const std::string& key, Variable variable);
  const Field* find(const std::string& key) const;
  std::vector<Variable*> at(const std::string& key);
  void add_condition(const std::vector<std::string>& keys, const Condition& condition);
  // Whether the choice `choice` is there and chooses `name`.
  bool has_chosen(const std::string& choice, const std::string& name) const;
  // The one that counts: the scenario's own or the chosen part's; null if there is none.
  const Variable* in_use(const Field& field) const;
  // Of keys that count and stand nowhere: the first with its meaning and who needs it, then the
  // others.
  std::string missing_in_words(const std::vector<const Field*>& missing) const;
  // To every variable. An error if the value does not suit the one that counts; if none does
  // (null), unless it suits some.
  static Error assign(Field& field, const ConfigValue& value, const Variable* counts);
  static void fail_if(const Config& config, const Field& field, const Error& error);
  void assign_standards(const Config& config);
  void check(const Config& table);
  // The part of it that is about which parts are chosen.
  void check_choices(const Config& table);
  void find_file(const Config& config, const Field& field) const;
  void add_choice(const std::string& key, const std::vector<std::string>& names,
                  std::function<void(std::size_t)> assign, std::function<std::string()> print,
                  const std::string& doc);

  std::vector<Field> fields_;
  Part part_;  // whose keys are being bound
};

}  // namespace breakwater
