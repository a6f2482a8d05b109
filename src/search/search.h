// Optimisation over the unit cube.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include <breakwater/config/names.h>

namespace breakwater {

/// nsga2, nspso and maco have several objectives and ask for a whole generation. cmaes and bobyqa
/// have one objective and ask for one point at a time.
///
/// Sources: nsga2: K. Deb et al., IEEE Trans. Evol. Comput. 6 (2002) 182–197. nspso: X. Li, GECCO
/// 2003, 37–48. maco: M. Schlüter, J. A. Egea, J. R. Banga, Comput. Oper. Res. 36 (2009) 2217–2229,
/// extended in pagmo. cmaes: N. Hansen, The CMA evolution strategy, 2006. bobyqa: M. J. D. Powell,
/// DAMTP 2009/NA06. bobyqa is from NLopt, all others from pagmo: F. Biscani, D. Izzo, J. Open
/// Source Softw. 5 (2020) 2338.
enum class SearchAlgorithm { nsga2, nspso, maco, cmaes, bobyqa };

const Names<SearchAlgorithm>& search_algorithms();
bool has_several_objectives(SearchAlgorithm algorithm);
/// The default size of a generation; 1 for bobyqa, which has none.
std::size_t usual_population(SearchAlgorithm algorithm);

struct SearchSettings {
  SearchAlgorithm algorithm = SearchAlgorithm::nsga2;
  std::size_t dimension = 1;   ///< dimension of the cube
  std::size_t objectives = 2;  ///< all are minimised
  std::size_t budget = 400;  ///< maximal number of evaluations; incomplete generations are not run
  std::size_t population = 40;
  std::uint32_t seed = 1;
};

using Vectors = std::vector<std::vector<double>>;
/// The objectives for some points u of the open unit cube.
using EvaluateAll = std::function<Vectors(const Vectors& u)>;

/// The number of evaluations that a search uses: whole generations. bobyqa may use fewer.
std::size_t used_budget(const SearchSettings& settings);

/// The reason why the settings are not valid; empty if they are. Examples: nsga2 needs a population
/// that is a multiple of 4; the budget must hold two generations, of which the first is random.
std::string objection(const SearchSettings& settings);

/// Calls `evaluate` until the budget is used or the algorithm stops. The points depend only on the
/// settings and the answers. Throws the exceptions of `evaluate`, and std::invalid_argument if
/// there is an objection, or pagmo and NLopt are not there. They are in a library of their own
/// (engines.cpp): pagmo takes longer to load than all other libraries of a program together. The
/// library has the version in its name, since it shares types with the program.
void search(const SearchSettings& settings, const EvaluateAll& evaluate);

/// The indices of the points that no other point dominates, in ascending order. A point dominates
/// another one if no coordinate is larger and one is smaller. Only the first of equal points
/// counts.
std::vector<std::size_t> front_of(const Vectors& points);

/// At most `count` numbers of 0 … size − 1 with equal distances, including both ends.
std::vector<std::size_t> evenly_spaced(std::size_t size, std::size_t count);

}  // namespace breakwater
