// The keys of a scenario: type, range, meaning and variable.
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <unordered_map>
#include <utility>
#include <vector>

#include <breakwater/config/config.h>
#include <breakwater/config/names.h>

namespace breakwater {

/// The condition on a number, besides being finite.
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

/// An ineffective key, and the condition that it needs: "only where observer.name is kfd".
struct UnusedKey {
  std::string key;
  std::string reason;
  std::string choice;  ///< the key that decides; empty if it is another condition
};

/// One meaning of a key, for a reference of all keys.
struct KeyHelp {
  std::string key;
  std::string choice;  ///< the key that chooses between the parts; empty: all have the key
  std::vector<std::string> parts;  ///< the parts that use the key: {"kfd", "dkf"}
  std::string text;
  std::string takes;  ///< "a number, positive"
  std::string value;  ///< in TOML; empty: neither the file nor a default value gives it
  std::vector<std::string> conditions;  ///< all must hold: "disturbance.kind is sine"

  bool operator==(const KeyHelp&) const = default;
};

/// The reason to refuse a value.
struct Refusal {
  Refusal(std::string why, std::string which = "")
      : reason(std::move(why)), element(std::move(which)) {}

  std::string reason;
  std::string element;  ///< the element of an array: "[2]", "[2][1]"; empty: the whole value
};

/// The keys of a scenario in printing order. Each key is bound to a variable of the settings.
/// read() fills the variables from a config, and print() writes them as a scenario file.
///
/// A key that is bound while an OfPart lives belongs to that part. It is required only if the part
/// is chosen. Several parts may bind the same key to different variables.
class Fields {
 public:
  /// The keys that are bound during its life belong to the part `name` of the choice `choice`.
  class OfPart {
   public:
    OfPart(Fields& fields, const std::string& choice, std::string name) : fields_(fields) {
      fields_.part_ = {fields.prefix_ + choice, std::move(name)};
    }
    OfPart(const OfPart&) = delete;
    OfPart& operator=(const OfPart&) = delete;
    ~OfPart() { fields_.part_ = {}; }

   private:
    Fields& fields_;
  };

  /// During its life, all keys of binding functions begin with `prefix` ("axis.x."), also those of
  /// choices and parts. Config::under() then finds the values.
  class Under {
   public:
    Under(Fields& fields, const std::string& prefix) : fields_(fields), outer_(fields.prefix_) {
      fields_.prefix_ += prefix;
    }
    Under(const Under&) = delete;
    Under& operator=(const Under&) = delete;
    ~Under() { fields_.prefix_ = outer_; }

   private:
    Fields& fields_;
    std::string outer_;
  };

  void number(const std::string& key, double& target, const Range& range, const std::string& doc);
  /// A number whose default value is the present one of the variable.
  void optional_number(const std::string& key, double& target, const Range& range,
                       const std::string& doc) {
    number(key, target, range, doc);
    standard(key, {target});
  }
  /// A number without a default value. The file may leave out the key: there is then no value, and
  /// print() leaves it out too.
  void number(const std::string& key, std::optional<double>& target, const Range& range,
              const std::string& doc);
  void count(const std::string& key, int& target, const Range& range, const std::string& doc);
  /// A count whose default value is the present one of the variable.
  void optional_count(const std::string& key, int& target, const Range& range,
                      const std::string& doc) {
    count(key, target, range, doc);
    standard(key, {std::int64_t{target}});
  }
  void count(const std::string& key, std::uint64_t& target, const Range& range,
             const std::string& doc);
  void flag(const std::string& key, bool& target, const std::string& doc);
  void optional_flag(const std::string& key, bool& target, const std::string& doc) {
    flag(key, target, doc);
    standard(key, {target});
  }
  void text(const std::string& key, std::string& target, const std::string& doc);
  void optional_text(const std::string& key, std::string& target, const std::string& doc) {
    text(key, target, doc);
    standard(key, {target});
  }
  /// A number, or a text in its place. A number is kept as its text.
  void number_or_text(const std::string& key, std::string& target, const std::string& doc);
  /// The name of a file. A file of Breakwater is printed so that any installation finds it.
  void file(const std::string& key, std::string& target, const std::string& doc);
  void numbers(const std::string& key, std::vector<double>& target, const Range& range,
               const std::string& doc);
  /// A single group may be written as a plain array of numbers, and is printed so.
  void number_groups(const std::string& key, std::vector<std::vector<double>>& target,
                     const Range& range, const std::string& doc);

  /// Several options may have the same meaning. The first of them is printed.
  template <typename Enum>
  void choice(const std::string& key, Enum& target, Names<Enum> options, const std::string& doc) {
    const auto all = std::make_shared<const Names<Enum>>(std::move(options));
    add_choice(
        key, names_of(*all), [all, &target](std::size_t i) { target = (*all)[i].second; },
        [all, &target] { return name_of(*all, target); }, doc);
  }

  /// A choice whose default value is the present one of the variable.
  template <typename Enum>
  void optional_choice(const std::string& key, Enum& target, const Names<Enum>& options,
                       const std::string& doc) {
    choice(key, target, options, doc);
    standard(key, {name_of(options, target)});
  }

  /// Sets the default value of a key. The file may then leave out the key.
  void standard(const std::string& key, const ConfigValue& value);

  /// States that `keys` have an effect only if the choice `choice_name` has one of the values
  /// `names`. If a key has several such statements, all of them must hold.
  void only_for(const std::vector<std::string>& keys, const std::string& choice_name,
                const std::vector<std::string>& names);
  /// The same for the condition `holds`. `condition` is its text.
  void only_where(const std::vector<std::string>& keys, const std::string& condition,
                  std::function<bool()> holds);
  /// The same for the condition that the number of another key is not 0.
  void only_with(const std::vector<std::string>& keys, const std::string& number);

  /// States that two keys exclude each other. Where both are given, the one of higher rank counts,
  /// and the other one takes its default value.
  void either(const std::string& key, const std::string& other);

  /// A file may have keys that begin with `prefix`. They are read elsewhere. `check` checks those
  /// of a table.
  void leave(const std::string& prefix, std::function<void(const Config& keys)> check) {
    elsewhere_.emplace(prefix, std::move(check));
  }

  /// Further names of keys, besides those of the file that is read.
  void alias(const Aliases& aliases) { aliases_.insert(aliases.begin(), aliases.end()); }

  /// Reads every key and makes file names absolute. A key of a table with names (axis.NAME.KEY,
  /// contact.NAME.KEY, push.NAME.KEY) may be given without the name: KEY, contact.KEY, and wall.KEY
  /// for contact.NAME.wall.KEY. It then counts for each name that has such a key and no value of
  /// its own. An array with an entry for each of them, in their order, has one for each. Throws
  /// std::invalid_argument `ORIGIN: KEY: reason` for the first wrong key. It is unknown, missing,
  /// of the wrong type, out of range, without its file, or given by two names. Returns the keys as
  /// they were given, and those with the name of each table for which they count.
  Config read(const Config& given);
  /// After read(): gives `key`, as it was given, another number in `config`, which read() returned.
  /// False if it has no number there, or may not have this one.
  bool renew(Config& config, const std::string& key, const ConfigValue& value);
  /// Reads `config` again, which read() returned and renew() changed.
  void read_again(const Config& config);
  /// As read(), but keys may be missing: print() then asks for them.
  void read_incomplete(const Config& given);
  /// Checks every table of a file, whichever case runs: a wrong value is refused even if another
  /// one overrides it. Throws as read() does, but not for missing keys. Call it before read().
  void check(const ScenarioFile& file);
  /// The same for tables: each key of a table must exist, and its value must suit one of its
  /// variables. Keys of a part that does not exist are unknown too. Checks the choices of all
  /// tables first: they are the cause.
  void check(std::span<const Config> tables);

  /// Reads the config of a finished run. It skips unknown keys, and values that this program does
  /// not know, such as the name of a user's controller. Returns the missing keys.
  std::vector<std::string> read_finished(const Config& given);

  /// The ineffective keys of the config that was read, with the reason. Call it after read().
  std::vector<UnusedKey> unused() const;

  /// A scenario file with these values, with one case and no overrides. A key that was given by
  /// another name keeps it. A key that is the same at each of several axes, or was given as an
  /// array for them, is printed once, without their names. A key without a value is a comment to
  /// fill in, `# required`.
  std::string print(const std::string& scenario, const std::string& case_name) const;

  /// Every meaning of every key, in their order, with the values that were read. A key that is the
  /// same at each of several axes is there once, without their names.
  std::vector<KeyHelp> help() const;

  /// The present number of a key, NaN for an optional one without a value; nothing if there is no
  /// such key with a number.
  std::optional<double> number_of(const std::string& key) const;
  /// Whether the choice `choice` is there and chooses `name`.
  bool has_chosen(const std::string& choice, const std::string& name) const;
  bool has(const std::string& key) const { return find(key) != nullptr; }

  /// The present values of the keys that name files. Call it after read() and the scenario's
  /// check(), which finds the models.
  std::vector<std::string> files() const;

 private:
  using Error = std::optional<Refusal>;
  struct Condition {
    std::string text;
    std::function<bool(const Fields&)> holds;
    std::string choice = {};  // the key that decides, if any
  };
  // A part that a choice can choose; without a name, the scenario itself.
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
    std::string* file = nullptr;             // the variable, if it is a file name
    std::vector<Condition> conditions = {};  // all must hold for an effect
    std::string rival = {};                  // the key that excludes it, if any
    std::optional<ConfigValue> standard = {};
    std::function<void()> clear = {};  // leaves the variable without a value; null if it needs one

    bool is_required() const { return !standard && !clear; }
  };
  struct Field {
    std::string key;
    std::vector<Variable> variables;
    std::string unnamed;  // the key without the name of its table, if it may be given so
    bool was_read = false;
    bool is_missing = false;  // missing in an incomplete file, without a default value
    std::size_t suited = 0;   // the first variable that the value suits
    std::string given = {};   // ConfigEntry::given without the number of an element

    std::string doc() const;
  };

  // Assigns every key of the config. Returns the missing keys that the chosen parts need.
  std::vector<const Field*> assign_all(const Config& config);
  Config without_aliases(const Config& config) const;
  // Gives the keys without a name to all names that lack them.
  Config spread(const Config& given);
  bool has_one_each(const ConfigValue::Array& array, const std::vector<std::size_t>& named);
  // A key and the texts shown for it.
  struct Shown {
    const Field* field;
    std::string key;
    std::vector<KeyHelp> help;
  };
  // Makes one of those that are the same at each of several axes, or were given as an array.
  void unite_axes(std::vector<Shown>& all) const;
  static std::vector<KeyHelp> help_of(const Field& field);
  std::optional<UnusedKey> unused(const Field& field, const Variable* variable) const;
  void add(const std::string& name, Variable variable);
  const Field* find(const std::string& key) const;
  bool is_known(const std::string& key) const;
  std::vector<Variable*> at(const std::string& name);
  void add_condition(const std::vector<std::string>& keys, const Condition& condition);
  // The variable of the scenario or of the chosen part; null if there is none.
  const Variable* in_use(const Field& field) const;
  // The message on missing keys, with the meaning of the first one and the part that needs it.
  std::string missing_in_words(const std::vector<const Field*>& missing) const;
  // Assigns to every variable. Returns an error if the value does not suit `counts`, or, if
  // `counts` is null, if it suits no variable.
  static Error assign(Field& field, const ConfigValue& value, const Variable* counts);
  static void fail_if(const Config& config, const Field& field, const Error& error);
  void assign_standards(const Config& config);
  void check_elsewhere(const Config& table) const;
  // The name of a file that counts; null if the key has another value.
  std::string* file_of(const Field& field) const;
  void find_file(const Config& config, const Field& field) const;
  void add_choice(const std::string& key, std::vector<std::string> names,
                  std::function<void(std::size_t)> assign, std::function<std::string()> print,
                  const std::string& doc);

  std::vector<Field> fields_;
  std::unordered_map<std::string, std::size_t> numbers_;             // by key
  std::unordered_map<std::string, std::vector<std::size_t>> named_;  // by the key without a name
  Aliases aliases_;
  Part part_;           // the part whose keys are being bound
  std::string prefix_;  // the prefix of the keys that are being bound
  std::map<std::string, std::function<void(const Config& keys)>> elsewhere_;
};

}  // namespace breakwater
