// The scenarios, parts and commands that a program offers.
#pragma once

#include <algorithm>
#include <any>
#include <filesystem>
#include <functional>
#include <memory>
#include <stdexcept>
#include <string>
#include <typeindex>
#include <unordered_map>
#include <vector>

#include <breakwater/experiment/scenario.h>
#include <breakwater/shell/did_you_mean.h>

namespace breakwater {

/// A scenario and its name.
struct ScenarioKind {
  static constexpr const char* kWhat = "scenario";

  std::string name;
  std::function<std::unique_ptr<Scenario>(const Catalogue&)> make;
  /// The folder of NAME.toml, shots.toml and its own models. If it is empty or missing, look_for()
  /// finds each of them as scenarios/NAME/FILE.
  std::filesystem::path folder = {};
  /// Points of a study that differ in numbers may share one. No number decides which keys learn()
  /// and fields() find, and check() sets all that it finds out anew.
  bool may_be_shared = false;

  /// Its scenario file. Throws std::invalid_argument with all searched places if there is none.
  std::filesystem::path file() const;
  /// The tables of file(), or of `config` unless that is empty. A program parses its scenario's
  /// file once, and again when its text changes. Throws as ScenarioFile does.
  std::shared_ptr<const ScenarioFile> scenario_file(const std::string& config = "") const;
  /// Its shot list, which may be missing.
  std::filesystem::path shots() const;
};

/// A part for a list: its kind ("estimator of an axis"), its name, one line of help.
struct ListedPart {
  std::string what;
  std::string name;
  std::string help;
};

/// Scenarios, and the parts that they choose by name. main() makes it and passes it on. A kind is
/// any struct with a `name` and a `kWhat` for messages. Kinds of one type keep their order.
class Catalogue {
 public:
  /// Throws std::invalid_argument if this type and name are already there.
  template <typename Kind>
  void add(Kind kind) {
    if (has<Kind>(kind.name)) {
      throw std::invalid_argument("the catalogue has \"" + kind.name + "\" (" + Kind::kWhat +
                                  ") already: give yours another name");
    }
    std::any& shelf = shelves_[typeid(Kind)];
    if (!shelf.has_value()) shelf = std::vector<Kind>{};
    if constexpr (requires { kind.help; }) parts_.push_back({Kind::kWhat, kind.name, kind.help});
    std::any_cast<std::vector<Kind>>(&shelf)->push_back(std::move(kind));
  }

  /// Removes all kinds of one type.
  template <typename Kind>
  void drop() {
    shelves_.erase(typeid(Kind));
  }

  /// All kinds of one type.
  template <typename Kind>
  const std::vector<Kind>& all() const {
    static const std::vector<Kind> none;
    const auto found = shelves_.find(typeid(Kind));
    return found == shelves_.end() ? none : *std::any_cast<std::vector<Kind>>(&found->second);
  }

  template <typename Kind>
  std::vector<std::string> names() const {
    std::vector<std::string> names;
    for (const Kind& kind : all<Kind>()) names.push_back(kind.name);
    return names;
  }

  template <typename Kind>
  bool has(const std::string& name) const {
    return std::ranges::find(all<Kind>(), name, &Kind::name) != all<Kind>().end();
  }

  /// All kinds with a line of help, in the order in which they were added.
  const std::vector<ListedPart>& parts() const { return parts_; }

  /// The kind with this name. Throws std::invalid_argument if there is none.
  template <typename Kind>
  const Kind& get(const std::string& name) const {
    for (const Kind& kind : all<Kind>()) {
      if (kind.name == name) return kind;
    }
    throw std::invalid_argument(std::string("there is no ") + Kind::kWhat + " \"" + name + '"' +
                                did_you_mean(name, names<Kind>()));
  }

 private:
  std::unordered_map<std::type_index, std::any> shelves_;
  std::vector<ListedPart> parts_;
};

/// The scenario of a scenario file. Throws std::invalid_argument `FILE[:LINE]: reason` if the file
/// cannot be read or parsed, or names none of the catalogue.
std::string scenario_name_in(const Catalogue& catalogue, const std::string& file);

/// Makes a scenario by its name. Throws std::invalid_argument if there is none.
std::unique_ptr<Scenario> make_scenario(const Catalogue& catalogue, const std::string& name);

/// `PROGRAM NAME [OPTION...]`.
struct CommandKind {
  static constexpr const char* kWhat = "command";

  std::string name;
  std::string summary;  ///< one line, for PROGRAM --help
  /// Returns the exit status. argv[0] is the command's name.
  int (*run)(const Catalogue&, int argc, const char* const* argv);
  const char* group = "Your own work";  ///< in which PROGRAM --help has it
};

/// The kind of a scenario with a constructor that takes the catalogue and then `arguments`.
template <typename OneScenario, typename... Arguments>
ScenarioKind scenario_kind(const std::string& name, bool may_be_shared = false,
                           const Arguments&... arguments) {
  return {name,
          [arguments...](const Catalogue& catalogue) -> std::unique_ptr<Scenario> {
            return std::make_unique<OneScenario>(catalogue, arguments...);
          },
          {},
          may_be_shared};
}

}  // namespace breakwater
