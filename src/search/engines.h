// The parts of a search that pagmo and NLopt do.
#pragma once

#include <vector>

#include <breakwater/search/search.h>

namespace breakwater {

/// They are in a library of their own (engines.cpp): pagmo takes longer to load than all other
/// libraries of a program together. The library has the version in its name, since it shares types
/// with the program.
struct SearchEngines {
  /// search() with settings that have no objection.
  void (*search)(const SearchSettings& settings, const EvaluateAll& evaluate) = nullptr;
  /// hypervolume_below() of points that are below the reference, in two dimensions or more.
  double (*hypervolume)(const Vectors& points, const std::vector<double>& reference) = nullptr;
};

/// Loads the library at the first call. Throws std::invalid_argument if it is not there.
const SearchEngines& search_engines();

}  // namespace breakwater
