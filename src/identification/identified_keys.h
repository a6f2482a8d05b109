// Which key of a scenario takes which identified parameter: identified.toml in its folder.
#pragma once

#include <map>
#include <string>
#include <vector>

#include <breakwater/experiment/catalogue.h>

namespace breakwater {

/// Identified parameters, and numbers that follow from them, by name and in SI units.
using IdentifiedNumbers = std::map<std::string, double>;

/// A text with <EXPRESSION> in it: a sum of products of numbers and names (MetricExpression).
/// Throws std::invalid_argument if one is wrong.
std::string with_numbers(const std::string& text, const IdentifiedNumbers& numbers);

/// The file of a scenario that runs on an identified plant.
struct IdentifiedKeys {
  struct Key {
    bool is_drawn;      ///< a key of the true plant: a study draws its value
    std::string needs;  ///< the number that must not be 0; empty: none
    std::string set;    ///< "key=value", with <EXPRESSION> in the value
  };

  std::string scenario;   ///< its name; empty: there is no such scenario
  std::string case_name;  ///< the case that identified.toml has
  std::vector<Key> keys;

  /// "key=value" of the keys of one of both kinds, in the same order for each plant.
  std::vector<std::string> sets(bool is_drawn, const IdentifiedNumbers& numbers) const;
};

/// The first scenario of the catalogue that takes a plant of this model.
IdentifiedKeys identified_keys(const Catalogue& catalogue, const std::string& model);

}  // namespace breakwater
