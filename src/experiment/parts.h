// Parts that a scenario chooses by their names, each with keys of its own: controllers, estimators.
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

/// Thrown by a part that cannot be made of its settings: the key that is to blame.
class WrongKey : public std::invalid_argument {
 public:
  WrongKey(std::string key, const std::string& reason)
      : std::invalid_argument(reason), key_(std::move(key)) {}

  const std::string& key() const { return key_; }

 private:
  std::string key_;
};

/// Calls `make`, and blames `key` for an std::invalid_argument that it throws.
template <typename Make>
auto blame(const char* key, Make&& make) {
  try {
    return std::forward<Make>(make)();
  } catch (const WrongKey&) {
    throw;
  } catch (const std::invalid_argument& error) {
    throw WrongKey(key, error.what());
  }
}

/// One kind of part for one kind of place: its name, one line of help, the keys that it has and a
/// function that makes it. What it makes (`Product`) and what it is told of the place where it goes
/// (`Context`) are the place's: rigs/ has the places.
template <typename Product, typename... Context>
class PartKind {
 public:
  /// A part's settings for one run.
  class Part {
   public:
    Part() = default;
    Part(const Part&) = delete;
    Part& operator=(const Part&) = delete;
    virtual ~Part() = default;
    virtual void bind(Fields& fields) = 0;
    virtual std::unique_ptr<Product> make(Context... context) const = 0;
  };

  /// `Settings` is any struct that can be made of nothing. `bind` binds keys to it; `make` makes
  /// the part of it, or throws std::invalid_argument: a WrongKey blames a key, any other the
  /// choice.
  template <typename Settings>
  PartKind(std::string part_name, std::string one_line, void (*bind)(Fields&, Settings&),
           std::unique_ptr<Product> (*make)(const Settings&, Context...))
      : name(std::move(part_name)),
        help(std::move(one_line)),
        settings_([bind, make] { return std::make_unique<PartOf<Settings>>(bind, make); }) {}

  /// Of a part that is no struct: `settings` makes what keys are bound to and the part is made of.
  PartKind(std::string part_name, std::string one_line,
           std::function<std::unique_ptr<Part>()> settings)
      : name(std::move(part_name)), help(std::move(one_line)), settings_(std::move(settings)) {}

  std::unique_ptr<Part> settings() const { return settings_(); }

  std::string name;
  std::string help;

 private:
  template <typename Settings>
  class PartOf final : public Part {
   public:
    PartOf(void (*binds)(Fields&, Settings&),
           std::unique_ptr<Product> (*makes)(const Settings&, Context...))
        : bind_(binds), make_(makes) {}
    void bind(Fields& fields) override { bind_(fields, settings_); }
    std::unique_ptr<Product> make(Context... context) const override {
      return make_(settings_, std::forward<Context>(context)...);
    }

   private:
    Settings settings_{};
    void (*bind_)(Fields&, Settings&);
    std::unique_ptr<Product> (*make_)(const Settings&, Context...);
  };

  std::function<std::unique_ptr<Part>()> settings_;
};

/// Which of the catalogue's kinds a run takes, by a key of its own ("observer.name"), and the
/// settings of each.
template <typename Kind>
class PartChoice {
 public:
  /// `standard` is what a file without the key gets; empty: the key must be there.
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
      part->bind(fields);
    }
  }

  /// The chosen part. Throws std::invalid_argument if its settings define none.
  template <typename... Context>
  auto make(Context&&... context) const {
    return parts_.at(chosen_).second->make(std::forward<Context>(context)...);
  }

  /// The same, to check it: throws std::invalid_argument `ORIGIN: KEY: reason`.
  template <typename... Context>
  auto check(const Config& config, Context&&... context) const {
    try {
      return make(std::forward<Context>(context)...);
    } catch (const WrongKey& wrong) {
      config.fail(wrong.key(), wrong.what());
    } catch (const std::invalid_argument& error) {
      config.fail(key_, error.what());
    }
  }

 private:
  std::string key_;
  std::string standard_;
  std::vector<std::pair<std::string, std::unique_ptr<typename Kind::Part>>> parts_;  // by name
  std::size_t chosen_ = 0;
};

}  // namespace breakwater
