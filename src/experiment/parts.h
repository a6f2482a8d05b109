// Parts that a scenario chooses by name, each with its own keys: controllers, estimators.
#pragma once

#include <functional>
#include <memory>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include <breakwater/config/fields.h>
#include <breakwater/experiment/catalogue.h>

namespace breakwater {

/// One kind of part: its name, one line of help, its keys and a function that makes it. `Product`
/// is the part and `Context` the data from its place. rigs/ defines the places.
template <typename Product, typename... Context>
class PartKind {
 public:
  using Makes = std::function<std::unique_ptr<Product>(Context...)>;

  /// The settings of a part for one run.
  struct Part {
    std::function<void(Fields& fields)> bind;
    Makes make;
  };

  /// `Settings` is any default-constructible struct. `bind` binds keys to it, and `make` makes the
  /// part from it. `make` may throw std::invalid_argument: a WrongKey names a key, any other
  /// exception concerns the choice.
  template <typename Settings>
  PartKind(std::string part_name, std::string one_line, void (*bind)(Fields&, Settings&),
           std::unique_ptr<Product> (*make)(const Settings&, Context...))
      : PartKind(std::move(part_name), std::move(one_line),
                 [bind, make] { return part(std::make_shared<Settings>(), bind, make); }) {}

  /// The same for a struct with both as functions: `void bind(Fields&)` and `make`.
  template <typename Settings>
  PartKind(std::string part_name, std::string one_line,
           std::unique_ptr<Product> (Settings::*make)(Context...) const)
      : PartKind(std::move(part_name), std::move(one_line), [make] {
          const auto bind = [](Fields& fields, Settings& settings) { settings.bind(fields); };
          return part(std::make_shared<Settings>(), bind, std::mem_fn(make));
        }) {}

  /// For a part without keys.
  PartKind(std::string part_name, std::string one_line, Makes make)
      : PartKind(std::move(part_name), std::move(one_line), [make] {
          return Part{[](Fields&) {}, make};
        }) {}

  /// For a part without such a struct: `settings` makes both functions.
  PartKind(std::string part_name, std::string one_line, std::function<Part()> settings)
      : name(std::move(part_name)), help(std::move(one_line)), settings_(std::move(settings)) {}

  Part settings() const { return settings_(); }

  std::string name;
  std::string help;

 private:
  template <typename Settings, typename Bind, typename Make>
  static Part part(const std::shared_ptr<Settings>& settings, Bind bind, Make make) {
    return {[=](Fields& fields) { bind(fields, *settings); },
            [=](Context... context) {
              return make(std::as_const(*settings), std::forward<Context>(context)...);
            }};
  }

  std::function<Part()> settings_;
};

/// The choice of a kind of the catalogue by a key ("observer.name"), and the settings of each kind.
template <typename Kind>
class PartChoice {
 public:
  /// `standard` is the default value of the key. If it is empty, the key is required.
  PartChoice(const Catalogue& catalogue, std::string key, std::string standard = "")
      : key_(std::move(key)), standard_(std::move(standard)) {
    for (const Kind& kind : catalogue.all<Kind>()) parts_.emplace_back(kind.name, kind.settings());
  }

  void bind(Fields& fields) {
    std::vector<std::pair<std::string, std::size_t>> options;
    std::string doc = Kind::kWhat;
    for (std::size_t i = 0; i < parts_.size(); ++i) {
      const std::string& name = parts_[i].first;
      options.emplace_back(name, i);
      doc += (i == 0 ? ": " : ", ") + name;
    }
    fields.choice(key_, chosen_, options, doc);
    if (!standard_.empty()) fields.standard(key_, {standard_});
    for (auto& [name, part] : parts_) {
      const Fields::OfPart of_part(fields, key_, name);
      part.bind(fields);
    }
  }

  const std::string& chosen() const { return parts_.at(chosen_).first; }

  /// Makes the chosen part. Throws std::invalid_argument if its settings are wrong.
  template <typename... Context>
  auto make(Context&&... context) const {
    return parts_.at(chosen_).second.make(std::forward<Context>(context)...);
  }

  /// The same, as a check: throws std::invalid_argument `ORIGIN: KEY: reason`.
  template <typename... Context>
  auto check(const Config& config, Context&&... context) const {
    return config.blame(key_, [&] { return make(std::forward<Context>(context)...); });
  }

 private:
  std::string key_;
  std::string standard_;
  std::vector<std::pair<std::string, typename Kind::Part>> parts_;  // by name
  std::size_t chosen_ = 0;
};

}  // namespace breakwater
