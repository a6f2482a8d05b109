// Searches for what is best, over the unit cube.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <string>
#include <utility>
#include <vector>

#include <breakwater/config/names.h>

namespace breakwater {

/// nsga2, nspso and maco have several objectives and ask for a generation at once; cmaes and bobyqa
/// have one and ask for one point at a time.
///
/// Sources: nsga2: K. Deb et al., IEEE Trans. Evol. Comput. 6 (2002) 182–197. nspso: X. Li, GECCO
/// 2003, 37–48. maco: M. Schlüter, J. A. Egea, J. R. Banga, Comput. Oper. Res. 36 (2009) 2217–2229,
/// extended in pagmo. cmaes: N. Hansen, The CMA evolution strategy, 2006. bobyqa: M. J. D. Powell,
/// DAMTP 2009/NA06. All but bobyqa (NLopt's) are pagmo's: F. Biscani, D. Izzo, J. Open Source
/// Softw. 5 (2020) 2338.
enum class SearchAlgorithm { nsga2, nspso, maco, cmaes, bobyqa };

const Names<SearchAlgorithm>& search_algorithms();
bool has_several_objectives(SearchAlgorithm algorithm);
/// A generation's size where none is asked for; 1 of bobyqa, which has none.
std::size_t usual_population(SearchAlgorithm algorithm);

struct SearchSettings {
  SearchAlgorithm algorithm = SearchAlgorithm::nsga2;
  std::size_t dimension = 1;   ///< of the cube
  std::size_t objectives = 2;  ///< all to be small
  std::size_t budget = 400;    ///< evaluations at most: what does not make a generation is left
  std::size_t population = 40;
  std::uint32_t seed = 1;
};

using Vectors = std::vector<std::vector<double>>;
/// The objectives of some points u of the open unit cube.
using EvaluateAll = std::function<Vectors(const Vectors& u)>;

/// How much of the budget a search uses: whole generations; of bobyqa it may be less.
std::size_t used_budget(const SearchSettings& settings);

/// What does not fit together, in words; empty if all does: nsga2 wants a population that is a
/// multiple of 4, a generation needs twice the population (the first one is drawn), and so on.
std::string objection(const SearchSettings& settings);

/// Calls `evaluate` until the budget is used or the algorithm finds no more. The points it asks for
/// are a function of the settings and of the answers alone. Throws what `evaluate` throws, and
/// std::invalid_argument if there is an objection.
void search(const SearchSettings& settings, const EvaluateAll& evaluate);

}  // namespace breakwater
