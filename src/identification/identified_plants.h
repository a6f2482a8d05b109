// The plants of an identified axis, its estimate and draws of its uncertainty, and the scenario
// that takes them: identified.toml in its folder.
#pragma once

#include <map>
#include <string>
#include <vector>

#include <breakwater/experiment/catalogue.h>
#include <breakwater/identification/identified_axis.h>

namespace breakwater {

/// Identified parameters, and numbers that follow from them, by name and in SI units.
using IdentifiedNumbers = std::map<std::string, double>;

/// The estimate as the numbers of a plant: parameters by their keys in identified.json, and what
/// follows from them.
IdentifiedNumbers identified_plant(const Identification& identification);

/// Plants from the joint distribution of the parameters. It is normal in the scales of the fit. The
/// deviations are those of the 95 % intervals, the correlations those of the likelihood's
/// curvature. Friction stays at least 0. The phase of the encoder is uniform over one count. The
/// same estimate has the same draws, and more draws begin with the same ones. `count` should be a
/// power of two.
std::vector<IdentifiedNumbers> drawn_plants(const Identification& identification,
                                            std::size_t count);

/// The file of a scenario that runs on an identified plant.
struct IdentifiedKeys {
  struct Key {
    bool is_drawn;      ///< a key of the true plant: a study draws its value
    std::string needs;  ///< the number that must not be 0; empty: none
    std::string set;    ///< "key=value", with <EXPRESSION> in it, of numbers and names
  };

  std::string scenario;   ///< its name; empty: there is no such scenario
  std::string case_name;  ///< the case that identified.toml has
  std::vector<Key> keys;  ///< the drawn ones first

  /// "key=value" of the keys, in the same order for each plant. Throws std::invalid_argument if an
  /// expression (MetricExpression) is wrong.
  std::vector<std::string> sets(const IdentifiedNumbers& numbers, bool only_drawn = false) const;
};

/// The first scenario of the catalogue that takes a plant of this model.
IdentifiedKeys identified_keys(const Catalogue& catalogue, const std::string& model);

/// draws.csv: 32 of them, a row each with the keys of the scenario.
std::string drawn_csv(const Identification& identification, const IdentifiedKeys& scenario);

}  // namespace breakwater
