// The plants of an identified axis: its estimate, and draws of its uncertainty.
#pragma once

#include <string>
#include <vector>

#include <breakwater/identification/identified_axis.h>
#include <breakwater/identification/identified_keys.h>

namespace breakwater {

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

/// draws.csv: 32 of them, a row each with the keys of the scenario.
std::string drawn_csv(const Identification& identification, const IdentifiedKeys& scenario);

}  // namespace breakwater
