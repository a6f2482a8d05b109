#include <breakwater/config/fields.h>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <map>
#include <set>
#include <stdexcept>
#include <string_view>

#include <breakwater/config/toml_text.h>
#include <breakwater/config/unit_of.h>
#include <breakwater/shell/did_you_mean.h>
#include <breakwater/shell/paths.h>

namespace breakwater {
namespace {

constexpr std::size_t kLongestValue = 200;  // the longest shown text of a wrong value
constexpr double kInfinity = std::numeric_limits<double>::infinity();

using Error = std::optional<Refusal>;

// The key without the name of its table: "observer.alpha" for "axis.NAME.observer.alpha",
// "contact.stiffness_N_m" for "contact.NAME.stiffness_N_m", "wall.motion" for
// "contact.NAME.wall.motion". Empty for another key, and for those that say what an axis is.
std::string without_name(const std::string& key) {
  const std::size_t table = key.find('.'), name = key.find('.', table + 1);
  if (name == std::string::npos) return "";
  const std::string of = key.substr(0, table);
  std::string rest = key.substr(name + 1);
  if (of == "contact" && rest.starts_with("wall.")) return rest;
  if (of == "contact" || of == "push") return of + "." + rest;
  const bool is_own = rest == "joint" || rest == "actuator" || rest == "position_sensor";
  return of == "axis" && !is_own ? rest : "";
}

// Gives a missing key its default value, if it has one.
template <typename Field>
void assign_standard(Field& field) {
  for (const auto& variable : field.variables) {
    if (variable.standard) variable.read(*variable.standard);
    if (variable.clear) variable.clear();
  }
}

// "axis.NAME." of a key of an axis; empty for another key.
std::string axis_in(const std::string& key) {
  constexpr std::string_view kTable = "axis.";
  const std::size_t name =
      key.starts_with(kTable) ? key.find('.', kTable.size()) : std::string::npos;
  return name == std::string::npos ? "" : key.substr(0, name + 1);
}

std::string without(const std::string& part, std::string text) {
  if (part.empty()) return text;
  for (std::size_t at = text.find(part); at != std::string::npos; at = text.find(part, at)) {
    text.erase(at, part.size());
  }
  return text;
}

std::string describe(const ConfigValue& value) {
  if (std::holds_alternative<ConfigValue::Array>(value.data)) return "an array";
  const auto* text = std::get_if<std::string>(&value.data);
  if (text == nullptr) return short_value(value);
  return text->size() <= kLongestValue ? toml_string(*text) : "a long text";
}

Error read_number(const ConfigValue& value, const Range& range, double& target) {
  if (const auto* integer = std::get_if<std::int64_t>(&value.data)) {
    target = static_cast<double>(*integer);
  } else if (const auto* real = std::get_if<double>(&value.data)) {
    target = *real;
  } else {
    return "must be a number, is " + describe(value);
  }
  if (!std::isfinite(target)) return "must be finite, is " + describe(value);
  if (!range.contains(target)) return "must be " + range.text + ", is " + describe(value);
  return std::nullopt;
}

// Adds the index of the element that is wrong.
Error in_element(std::size_t i, Error error) {
  if (error) error->element = fmt::format("[{}]", i + 1) + error->element;
  return error;
}

Error read_numbers(const ConfigValue& value, const Range& range, std::vector<double>& target) {
  const auto* array = std::get_if<ConfigValue::Array>(&value.data);
  if (array == nullptr) return "must be an array of numbers, is " + describe(value);
  target.assign(array->size(), 0.0);
  for (std::size_t i = 0; i < array->size(); ++i) {
    if (Error error = in_element(i, read_number((*array)[i], range, target[i]))) return error;
  }
  return std::nullopt;
}

Error read_text(const ConfigValue& value, std::string& target) {
  const auto* text = std::get_if<std::string>(&value.data);
  if (text == nullptr) return "must be a text, is " + describe(value);
  target = *text;
  return std::nullopt;
}

template <typename Integer>
Error read_count(const ConfigValue& value, const Range& range, Integer& target) {
  const auto* integer = std::get_if<std::int64_t>(&value.data);
  if (integer == nullptr) return "must be a whole number, is " + describe(value);
  if (!range.contains(static_cast<double>(*integer)) || !std::in_range<Integer>(*integer)) {
    return "must be " + range.text + ", is " + describe(value);
  }
  target = static_cast<Integer>(*integer);
  return std::nullopt;
}

std::string with_range(const std::string& what, const Range& range) {
  return range.text == any().text ? what : what + ", " + range.text;
}

std::string print_numbers(const std::vector<double>& values) {
  std::vector<std::string> texts;
  for (const double value : values) texts.push_back(toml_number(value));
  return fmt::format("[{}]", fmt::join(texts, ", "));
}

}  // namespace

Range any() {
  return {-kInfinity, kInfinity, true, "a number"};
}
Range positive() {
  return {0.0, kInfinity, false, "positive"};
}
Range not_negative() {
  return {0.0, kInfinity, true, "0 or more"};
}
Range between(double lower, double upper) {
  return {lower, upper, true, fmt::format("from {} to {}", lower, upper)};
}

void Fields::number(const std::string& key, double& target, const Range& range,
                    const std::string& doc) {
  add(key, {part_, doc, with_range("a number", range),
            [&target, range](const ConfigValue& v) { return read_number(v, range, target); },
            [&target] { return toml_number(target); }});
}

void Fields::number(const std::string& key, std::optional<double>& target, const Range& range,
                    const std::string& doc) {
  Variable variable = {
      part_, doc, with_range("a number", range) + "; optional",
      [&target, range](const ConfigValue& v) { return read_number(v, range, target.emplace()); },
      [&target] { return target ? toml_number(*target) : ""; }};
  variable.clear = [&target] { target.reset(); };
  add(key, std::move(variable));
}

void Fields::count(const std::string& key, int& target, const Range& range,
                   const std::string& doc) {
  add(key, {part_, doc, with_range("a whole number", range),
            [&target, range](const ConfigValue& v) { return read_count(v, range, target); },
            [&target] { return std::to_string(target); }});
}

void Fields::count(const std::string& key, std::uint64_t& target, const Range& range,
                   const std::string& doc) {
  add(key, {part_, doc, with_range("a whole number", range),
            [&target, range](const ConfigValue& v) { return read_count(v, range, target); },
            [&target] { return std::to_string(target); }});
}

void Fields::flag(const std::string& key, bool& target, const std::string& doc) {
  add(key, {part_, doc, "true or false",
            [&target](const ConfigValue& v) -> Error {
              const auto* flag = std::get_if<bool>(&v.data);
              if (flag == nullptr) return "must be true or false, is " + describe(v);
              target = *flag;
              return std::nullopt;
            },
            [&target] { return std::string(target ? "true" : "false"); }});
}

void Fields::text(const std::string& key, std::string& target, const std::string& doc) {
  add(key, {part_, doc, "a text", [&target](const ConfigValue& v) { return read_text(v, target); },
            [&target] { return toml_string(target); }});
}

void Fields::number_or_text(const std::string& key, std::string& target, const std::string& doc) {
  add(key, {part_, doc, "a number or a text",
            [&target](const ConfigValue& v) -> Error {
              if (std::holds_alternative<std::string>(v.data)) return read_text(v, target);
              double number = 0.0;
              Error error = read_number(v, any(), number);
              if (!error) target = toml_number(number);
              return error;
            },
            [&target] { return number_in(target) ? target : toml_string(target); }});
}

void Fields::file(const std::string& key, std::string& target, const std::string& doc) {
  add(key, {part_, doc, "the name of a file",
            [&target](const ConfigValue& v) { return read_text(v, target); },
            [&target] { return toml_string(portable_path(target)); }, &target});
}

void Fields::numbers(const std::string& key, std::vector<double>& target, const Range& range,
                     const std::string& doc) {
  add(key, {part_, doc, with_range("an array of numbers", range),
            [&target, range](const ConfigValue& v) { return read_numbers(v, range, target); },
            [&target] { return print_numbers(target); }});
}

void Fields::number_groups(const std::string& key, std::vector<std::vector<double>>& target,
                           const Range& range, const std::string& doc) {
  add(key, {part_, doc, with_range("an array of arrays of numbers", range),
            [&target, range](const ConfigValue& v) -> Error {
              const auto* array = std::get_if<ConfigValue::Array>(&v.data);
              if (array == nullptr) return "must be an array of numbers, is " + describe(v);
              if (array->empty() || !std::holds_alternative<ConfigValue::Array>((*array)[0].data)) {
                target.assign(1, {});
                return read_numbers(v, range, target[0]);
              }
              target.assign(array->size(), {});
              for (std::size_t i = 0; i < array->size(); ++i) {
                if (Error e = in_element(i, read_numbers((*array)[i], range, target[i]))) return e;
              }
              return std::nullopt;
            },
            [&target] {
              if (target.size() == 1) return print_numbers(target[0]);
              std::vector<std::string> groups;
              for (const auto& group : target) groups.push_back(print_numbers(group));
              return fmt::format("[{}]", fmt::join(groups, ", "));
            }});
}

void Fields::add_choice(const std::string& key, std::vector<std::string> names,
                        std::function<void(std::size_t)> assign, std::function<std::string()> print,
                        const std::string& doc) {
  std::string takes = fmt::format("one of {}", fmt::join(names, ", "));
  add(key,
      {part_, doc, std::move(takes),
       [names = std::move(names), assign = std::move(assign)](const ConfigValue& v) -> Error {
         // TOML reads the word nan of --set as a number.
         const auto* number = std::get_if<double>(&v.data);
         const std::string nan = "nan";
         const auto* string =
             number != nullptr && std::isnan(*number) ? &nan : std::get_if<std::string>(&v.data);
         const auto found = string != nullptr ? std::ranges::find(names, *string) : names.end();
         if (found == names.end()) {
           return fmt::format("must be one of {}, is {}{}", fmt::join(names, ", "), describe(v),
                              string != nullptr ? did_you_mean(*string, names) : "");
         }
         assign(static_cast<std::size_t>(found - names.begin()));
         return std::nullopt;
       },
       [print = std::move(print)] { return toml_string(print()); }});
}

void Fields::add(const std::string& name, Variable variable) {
  const std::string key = prefix_ + name;
  // The name of a number says its unit, unless the meaning says another one.
  const std::string unit = variable.takes.find("number") == std::string::npos ? "" : unit_of(name);
  if (!unit.empty() && !variable.doc.ends_with(']')) variable.doc += " [" + unit + "]";
  const auto [place, is_new] = numbers_.try_emplace(key, fields_.size());
  if (is_new) {
    const std::string unnamed = without_name(key);
    fields_.push_back({key, {}, unnamed});
    if (!unnamed.empty()) named_[unnamed].push_back(place->second);
  }
  Field& field = fields_[place->second];
  for (const Variable& other : field.variables) {
    if (other.part == variable.part) throw std::logic_error("the key " + key + " is bound twice");
  }
  field.variables.push_back(std::move(variable));
}

const Fields::Field* Fields::find(const std::string& key) const {
  const auto found = numbers_.find(key);
  return found != numbers_.end() ? &fields_[found->second] : nullptr;
}

bool Fields::is_known(const std::string& key) const {
  return has(key) || std::any_of(elsewhere_.begin(), elsewhere_.end(),
                                 [&](const auto& one) { return key.starts_with(one.first); });
}

// The variables that a statement on a key concerns: that of the part being bound, or all outside of
// parts.
std::vector<Fields::Variable*> Fields::at(const std::string& name) {
  const std::string key = prefix_ + name;
  std::vector<Variable*> variables;
  if (const auto found = numbers_.find(key); found != numbers_.end()) {
    for (Variable& variable : fields_[found->second].variables) {
      if (variable.part == part_ || part_.name.empty()) variables.push_back(&variable);
    }
  }
  if (variables.empty()) throw std::logic_error("there is no key " + key);
  return variables;
}

void Fields::standard(const std::string& key, const ConfigValue& value) {
  for (Variable* variable : at(key)) variable->standard = value;
}

void Fields::only_for(const std::vector<std::string>& keys, const std::string& choice_name,
                      const std::vector<std::string>& names) {
  const std::string choice = prefix_ + choice_name;
  add_condition(keys, {fmt::format("{} is {}", choice, fmt::join(names, " or ")),
                       [choice, names](const Fields& fields) {
                         return std::any_of(names.begin(), names.end(), [&](const auto& name) {
                           return fields.has_chosen(choice, name);
                         });
                       },
                       choice});
}

void Fields::only_where(const std::vector<std::string>& keys, const std::string& condition,
                        std::function<bool()> holds) {
  const auto test = [holds = std::move(holds)](const Fields&) { return holds(); };
  add_condition(keys, {condition, test});
}

void Fields::only_with(const std::vector<std::string>& keys, const std::string& number) {
  const auto test = [key = prefix_ + number](const Fields& all) {
    return all.number_of(key) != 0.0;
  };
  add_condition(keys, {prefix_ + number + " is not 0", test});
}

void Fields::either(const std::string& key, const std::string& other) {
  for (Variable* variable : at(key)) variable->rival = prefix_ + other;
  for (Variable* variable : at(other)) variable->rival = prefix_ + key;
}

void Fields::add_condition(const std::vector<std::string>& keys, const Condition& condition) {
  for (const std::string& key : keys) {
    for (Variable* variable : at(key)) variable->conditions.push_back(condition);
  }
}

std::string Fields::Field::doc() const {
  // Equal words of several parts are shown once.
  std::vector<std::pair<std::string, std::string>> docs;  // the words, and the parts' names
  for (const Variable& variable : variables) {
    if (variable.part.name.empty()) return variable.doc;
    const auto same =
        std::ranges::find(docs, variable.doc, &std::pair<std::string, std::string>::first);
    if (same != docs.end()) {
      same->second += ", " + variable.part.name;
    } else {
      docs.emplace_back(variable.doc, variable.part.name);
    }
  }
  std::string text;
  for (const auto& [words, names] : docs) {
    text += (text.empty() ? "" : "; ") + names + ": " + words;
  }
  return text;
}

bool Fields::has_chosen(const std::string& choice, const std::string& name) const {
  const Field* field = find(choice);
  const Variable* variable = field != nullptr ? in_use(*field) : nullptr;
  return variable != nullptr && variable->print() == toml_string(name);
}

const Fields::Variable* Fields::in_use(const Field& field) const {
  const Variable* of_part = nullptr;
  for (const Variable& variable : field.variables) {
    const auto& [choice, name] = variable.part;
    if (name.empty()) return &variable;
    if (of_part == nullptr && has_chosen(choice, name)) of_part = &variable;
  }
  return of_part;
}

Fields::Error Fields::assign(Field& field, const ConfigValue& value, const Variable* counts) {
  Error first;
  Error of_counting;
  const Variable* suited = nullptr;
  for (const Variable& variable : field.variables) {
    const Error error = variable.read(value);
    if (!error && suited == nullptr) suited = &variable;
    if (error && !first) first = error;
    if (&variable == counts) of_counting = error;
  }
  if (suited != nullptr) {
    field.suited = static_cast<std::size_t>(suited - field.variables.data());
  }
  if (counts != nullptr) return of_counting;
  return suited != nullptr ? std::nullopt : first;
}

// Whether an array has an entry for each of the fields: it is one of lists, or they take no array.
bool Fields::has_one_each(const ConfigValue::Array& array, const std::vector<std::size_t>& named) {
  return array.size() == named.size() &&
         (std::holds_alternative<ConfigValue::Array>(array.front().data) ||
          assign(fields_[named.front()], {array}, nullptr));
}

// Gives the value of an alias to its key, unless the key has one that overrides it.
Config Fields::without_aliases(const Config& config) const {
  Aliases aliases = config.aliases();
  aliases.insert(aliases_.begin(), aliases_.end());
  Config whole = config;
  for (const auto& [alias, target] : aliases) {
    // A file may have a further name of a key that is one itself by now.
    const auto known = aliases_.find(target);
    const std::string& key = known != aliases_.end() ? known->second : target;
    if (has(alias) || named_.contains(alias)) {
      config.fail("alias." + alias, "is a key itself: choose another name");
    }
    const ConfigEntry* entry = config.find(alias);
    if (entry == nullptr) continue;
    const ConfigEntry* other = whole.find(key);
    const int rank = other != nullptr ? other->rank() : -1;
    if (rank == entry->rank()) {
      config.fail(alias, fmt::format("is another name of {}, which is given too", key));
    }
    whole.remove(alias);
    if (rank > entry->rank()) continue;
    ConfigEntry one = *entry;
    one.given = alias;
    whole.apply({{key, std::move(one)}});
  }
  return whole;
}

Config Fields::spread(const Config& given) {
  const Config config = without_aliases(given);
  // With controller.name = "axes" all keys of controllers and observers are those of the axes. A
  // file's keys for a controller that a case or --set replaces are not.
  const ConfigEntry* controller = config.find("controller.name");
  const bool is_of_axes = config.text("controller.name").value_or("axes") == "axes";
  const bool is_replaced = controller != nullptr && controller->is_chosen;
  const auto is_own = [&](const std::string& key, const ConfigEntry& entry) {
    if (find(key) == nullptr) return false;
    const bool is_of_controller = key.starts_with("observer.") || key.starts_with("controller.");
    return !is_of_axes || !is_of_controller || key == "controller.name" ||
           (is_replaced && !entry.is_chosen);
  };
  Config whole = config;
  for (const auto& [key, entry] : config.entries()) {
    const auto found = named_.find(key);
    if (found == named_.end() || is_own(key, entry)) continue;
    whole.remove(key);
    const std::vector<std::size_t>& named = found->second;
    Field& first = fields_[named.front()];
    const auto* array = std::get_if<ConfigValue::Array>(&entry.value.data);
    const bool is_split = array != nullptr && has_one_each(*array, named);
    if (array != nullptr && !is_split && !array->empty() && assign(first, entry.value, nullptr) &&
        !assign(first, array->front(), nullptr)) {
      config.fail(key, fmt::format("must be one value or an array of {}, has {}", named.size(),
                                   array->size()));
    }
    const std::string written = entry.given.empty() ? key : entry.given;
    bool counts = false;
    for (std::size_t i = 0; i < named.size(); ++i) {
      const std::string& name = fields_[named[i]].key;
      if (config.find(name) != nullptr) continue;
      ConfigEntry one = entry;
      if (is_split) one.value = (*array)[i];
      one.given = is_split ? fmt::format("{}[{}]", written, i + 1) : written;
      whole.apply({{name, std::move(one)}});
      counts = true;
    }
    if (!counts && entry.is_set()) {
      const std::string each = "each " + first.key.substr(0, first.key.find('.'));
      config.fail(key, fmt::format("has no effect, since {} has a value of its own",
                                   named.size() == 1 ? first.key : each));
    }
  }
  return whole;
}

std::vector<UnusedKey> Fields::unused() const {
  // A key that was given without a name is unused if it is so at each name.
  std::map<std::string, std::size_t> counts;
  for (const Field& field : fields_) counts[field.given] += field.was_read ? 1 : 0;
  std::vector<UnusedKey> all;
  for (const Field& field : fields_) {
    if (!field.was_read) continue;
    std::optional<UnusedKey> one = unused(field, in_use(field));
    if (!one) continue;
    if (!field.given.empty()) {
      if (--counts[field.given] > 0) continue;
      const std::string axis = axis_in(field.key);
      *one = {field.given, without(axis, one->reason), without(axis, one->choice)};
    }
    all.push_back(std::move(*one));
  }
  return all;
}

std::optional<UnusedKey> Fields::unused(const Field& field, const Variable* variable) const {
  if (variable == nullptr) {
    std::vector<std::string> names;
    for (const Variable& of_part : field.variables) names.push_back(of_part.part.name);
    const std::string& choice = field.variables.front().part.choice;
    return UnusedKey{
        field.key,
        fmt::format("has an effect only where {} is {}", choice, fmt::join(names, " or ")), choice};
  }
  const auto fails = std::find_if(variable->conditions.begin(), variable->conditions.end(),
                                  [this](const Condition& c) { return !c.holds(*this); });
  if (fails == variable->conditions.end()) return std::nullopt;
  return UnusedKey{field.key, "has an effect only where " + fails->text, fails->choice};
}

void Fields::unite_axes(std::vector<Shown>& all) const {
  std::map<std::string, std::vector<Shown*>> groups;
  for (Shown& one : all) {
    if (axis_in(one.key).empty()) continue;
    const std::string key = without_name(one.key);
    if (!key.empty() && find(key) == nullptr) groups[key].push_back(&one);
  }
  for (const auto& [key, group] : groups) {
    Shown& first = *group.front();
    const bool is_one =
        std::ranges::all_of(group, [&](const Shown* one) { return one->help == first.help; });
    const bool has_names = group.size() > 1 || !first.field->given.empty();
    // An array with an entry for each gave them, by an alias.
    const bool is_split = aliases_.contains(first.field->given) &&
                          std::all_of(group.begin(), group.end(), [&](const Shown* one) {
                            return one->field->given == first.field->given;
                          });
    if (!(is_one || is_split) || !has_names || group.size() != named_.at(key).size()) continue;
    first.key = key;
    if (!is_one) {
      std::vector<std::string> values;
      for (const Shown* one : group) values.push_back(one->help.front().value);
      first.help.front().value = fmt::format("[{}]", fmt::join(values, ", "));
    }
    for (std::size_t i = 1; i < group.size(); ++i) group[i]->key.clear();
  }
  std::erase_if(all, [](const Shown& one) { return one.key.empty(); });
}

void Fields::fail_if(const Config& config, const Field& field, const Error& error) {
  if (error) config.fail(field.key + error->element, error->reason);
}

// Checks the keys of a table that are read elsewhere.
void Fields::check_elsewhere(const Config& table) const {
  for (const auto& [prefix, check_keys] : elsewhere_) {
    std::map<std::string, ConfigEntry> entries;
    for (auto entry = table.entries().lower_bound(prefix);
         entry != table.entries().end() && entry->first.starts_with(prefix); ++entry) {
      entries.insert(*entry);
    }
    if (!entries.empty()) check_keys({table.file(), std::move(entries)});
  }
}

void Fields::check(std::span<const Config> tables) {
  std::set<std::string_view> choices;
  for (const Field& field : fields_) {
    for (const Variable& variable : field.variables) choices.insert(variable.part.choice);
  }
  const auto check_values = [&](const Config& table, const auto& is_wanted) {
    for (Field& field : fields_) {
      const ConfigEntry* entry = is_wanted(field.key) ? table.find(field.key) : nullptr;
      if (entry != nullptr) fail_if(table, field, assign(field, entry->value, nullptr));
    }
  };
  for (const Config& table : tables) {
    check_values(table, [&](const std::string& key) { return choices.contains(key); });
  }
  for (const Config& table : tables) {
    // The first in the file: a misspelt table may make keys of others unknown.
    std::optional<std::pair<std::size_t, std::string>> unknown;
    for (const auto& [key, entry] : table.entries()) {
      if (is_known(key) || (unknown && unknown->first <= entry.line())) continue;
      unknown.emplace(entry.line(), key);
    }
    if (unknown) {
      std::set<std::string> keys;
      for (const Field& field : fields_) keys.insert({field.key, field.unnamed});
      keys.erase("");
      const std::string& key = unknown->second;
      table.fail(key, "unknown key" + did_you_mean(key, {keys.begin(), keys.end()}));
    }
    check_values(table, [](const std::string&) { return true; });
  }
}

// Sets the missing keys that have a default value. One of them may be a choice, so set them first.
void Fields::assign_standards(const Config& config) {
  for (Field& field : fields_) {
    const ConfigEntry* entry = config.find(field.key);
    field.was_read = entry != nullptr;
    field.given = entry != nullptr ? whole_key(entry->given) : "";
    if (!field.was_read) assign_standard(field);
  }
}

std::string* Fields::file_of(const Field& field) const {
  const Variable* variable = in_use(field);
  return variable != nullptr ? variable->file : nullptr;
}

void Fields::find_file(const Config& config, const Field& field) const {
  if (std::string* file = file_of(field)) *file = config.find_file_of(field.key, *file);
}

std::string Fields::missing_in_words(const std::vector<const Field*>& missing) const {
  const Variable* first = in_use(*missing.front());
  std::string words = "is missing: " + first->doc;
  if (!first->part.name.empty()) {
    words += fmt::format("; {} = \"{}\" needs it", first->part.choice, first->part.name);
  }
  std::vector<std::string> others;
  for (const Field* field : missing) {
    if (field == missing.front()) continue;
    // A missing choice chooses no part.
    const std::string& choice = in_use(*field)->part.choice;
    const bool is_chosen = std::none_of(missing.begin(), missing.end(),
                                        [&](const Field* other) { return other->key == choice; });
    if (is_chosen) others.push_back(field->key);
  }
  if (!others.empty()) words += fmt::format("; missing too: {}", fmt::join(others, ", "));
  return words;
}

std::vector<const Fields::Field*> Fields::assign_all(const Config& config) {
  assign_standards(config);
  check(std::span(&config, 1));  // the choices are then known
  std::vector<const Field*> missing;
  for (Field& field : fields_) {
    const Variable* counts = in_use(field);
    const ConfigEntry* rival = counts != nullptr ? config.find(counts->rival) : nullptr;
    const ConfigEntry* entry = config.find(field.key);
    if (entry != nullptr && rival != nullptr && entry->rank() < rival->rank()) {
      field.was_read = false;
      assign_standard(field);
    } else if (entry != nullptr) {
      fail_if(config, field, assign(field, entry->value, counts));
    } else if (counts != nullptr && counts->is_required()) {
      missing.push_back(&field);
    }
  }
  return missing;
}

Config Fields::read(const Config& given) {
  const Config config = spread(given);
  const std::vector<const Field*> missing = assign_all(config);
  if (!missing.empty()) config.fail(missing.front()->key, missing_in_words(missing));
  for (const Field& field : fields_) find_file(config, field);
  Config all = given;
  // The number of an alias is that of its key, which another one may override.
  for (const auto& [alias, key] : aliases_) all.remove(alias);
  all.apply(config.entries());
  return all;
}

bool Fields::renew(Config& config, const std::string& key, const ConfigValue& value) {
  const auto is_number = [](const ConfigValue& one) {
    return std::holds_alternative<std::int64_t>(one.data) ||
           std::holds_alternative<double>(one.data);
  };
  bool is_known = false;
  for (Field& field : fields_) {
    if (!field.was_read || (field.given.empty() ? field.key : field.given) != key) continue;
    is_known = is_number(value) && is_number(config.find(field.key)->value) &&
               !assign(field, value, in_use(field));
    if (!is_known) return false;
    config.renew(field.key, value);
  }
  if (config.find(key) != nullptr) config.renew(key, value);
  return is_known;
}

void Fields::read_again(const Config& config) {
  for (Field& field : fields_) {
    if (!field.was_read) assign_standard(field);
  }
  for (Field& field : fields_) {
    if (field.was_read) assign(field, config.find(field.key)->value, nullptr);
  }
  for (const Field& field : fields_) find_file(config, field);
}

void Fields::read_incomplete(const Config& given) {
  const Config config = spread(given);
  assign_all(config);
  for (Field& field : fields_) {
    field.is_missing = !field.was_read;
    if (field.was_read) find_file(config, field);
  }
}

void Fields::check(const ScenarioFile& file) {
  std::vector<Config> tables = file.tables();
  for (Config& table : tables) table = spread(table);
  check(tables);
  // A case that does not run may change what is read elsewhere.
  for (std::size_t i = 1; i < tables.size(); ++i) check_elsewhere(tables[i]);
}

std::vector<std::string> Fields::read_finished(const Config& given) {
  const Config config = spread(given);
  assign_standards(config);
  std::set<std::string> not_understood;
  for (Field& field : fields_) {
    const ConfigEntry* entry = config.find(field.key);
    if (entry != nullptr && assign(field, entry->value, nullptr)) not_understood.insert(field.key);
  }
  std::vector<std::string> missing;
  for (const Field& field : fields_) {
    const Variable* counts = in_use(field);
    if (counts == nullptr || not_understood.contains(counts->part.choice)) continue;
    if (field.was_read) {
      find_file(config, field);
    } else if (counts->is_required()) {
      missing.push_back(field.key);
    }
  }
  return missing;
}

std::string Fields::print(const std::string& scenario, const std::string& case_name) const {
  std::string text = fmt::format("scenario = {}\ndefault_case = {}\n", toml_string(scenario),
                                 toml_string(case_name));
  std::vector<Shown> lines;  // without a value: it is missing
  for (const Field& field : fields_) {
    const Variable* variable = in_use(field);
    // Keys of parts that are not chosen, and those without a value, are printed only if given.
    if (!field.was_read && (variable == nullptr || variable->clear)) continue;
    if (variable == nullptr) variable = &field.variables[field.suited];
    lines.push_back({&field, field.key, std::vector<KeyHelp>(1)});
    KeyHelp& line = lines.back().help.front();
    line.text = field.doc();
    if (!field.is_missing || variable->standard) line.value = variable->print();
  }
  unite_axes(lines);
  // Each table with its lines, in the order of their first keys. The root's keys come first.
  std::vector<std::pair<std::string, std::string>> tables = {{"", ""}};
  auto table = tables.begin();
  for (const auto& [field, shown, help] : lines) {
    // A key without a name means all axes. The printed file has no aliases of its own.
    const bool is_as_given =
        aliases_.contains(field->given) && (shown != field->key || without_name(shown).empty());
    const std::string& key = is_as_given ? field->given : shown;
    const std::string name = table_of(key);
    if (table->first != name) {
      table = std::ranges::find(tables, name, &std::pair<std::string, std::string>::first);
      if (table == tables.end()) table = tables.insert(table, {name, ""});
    }
    std::string& of_table = table->second;
    const std::string& value = help.front().value;
    of_table.append("# ").append(help.front().text).append(value.empty() ? "\n# " : "\n");
    of_table.append(key, name.empty() ? 0 : name.size() + 1).append(" = ");
    of_table.append(value.empty() ? "  # required" : value).append("\n");
  }
  for (const auto& [name, of_table] : tables) {
    text += (name.empty() ? "" : "\n[" + name + "]\n") + of_table;
  }
  return text + fmt::format("\n[case.{}]\n", toml_key(case_name));
}

// The meanings of a key, each with all the parts that give it.
std::vector<KeyHelp> Fields::help_of(const Field& field) {
  std::vector<KeyHelp> all;
  for (const Variable& variable : field.variables) {
    KeyHelp help = {field.key, variable.part.choice, {}, variable.doc, variable.takes, "", {}};
    if (field.was_read || variable.standard) help.value = variable.print();
    for (const Condition& condition : variable.conditions) {
      help.conditions.push_back(condition.text);
    }
    const auto same = std::find_if(all.begin(), all.end(), [&](const KeyHelp& other) {
      return other.choice == help.choice && other.text == help.text && other.takes == help.takes &&
             other.value == help.value && other.conditions == help.conditions;
    });
    KeyHelp& meaning = same != all.end() ? *same : all.emplace_back(std::move(help));
    if (!variable.part.name.empty()) meaning.parts.push_back(variable.part.name);
  }
  return all;
}

std::vector<KeyHelp> Fields::help() const {
  std::vector<Shown> keys;
  for (const Field& field : fields_) {
    std::vector<KeyHelp> meanings = help_of(field);
    if (const std::string axis = axis_in(field.key); !axis.empty()) {
      for (KeyHelp& help : meanings) {
        help.key = without(axis, help.key);
        help.choice = without(axis, help.choice);
        for (std::string& condition : help.conditions) condition = without(axis, condition);
      }
    }
    keys.push_back({&field, field.key, std::move(meanings)});
  }
  unite_axes(keys);
  std::vector<KeyHelp> all;
  for (const auto& [field, key, of_axes] : keys) {
    const std::vector<KeyHelp>& meanings = key == field->key ? help_of(*field) : of_axes;
    all.insert(all.end(), meanings.begin(), meanings.end());
  }
  return all;
}

std::optional<double> Fields::number_of(const std::string& key) const {
  const auto alias = aliases_.find(key);
  const Field* field = find(alias != aliases_.end() ? alias->second : key);
  if (field == nullptr) return std::nullopt;
  const Variable* variable = in_use(*field);
  const std::string text = (variable != nullptr ? *variable : field->variables.front()).print();
  return text.empty() ? std::numeric_limits<double>::quiet_NaN() : number_in(text);
}

std::vector<std::string> Fields::files() const {
  std::vector<std::string> files;
  for (const Field& field : fields_) {
    if (const std::string* file = file_of(field)) files.push_back(*file);
  }
  return files;
}

}  // namespace breakwater
