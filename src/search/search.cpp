#include <breakwater/search/search.h>

#include <fmt/format.h>

#include <algorithm>
#include <stdexcept>

#include <breakwater/record/loaded_library.h>
#include <breakwater/shell/paths.h>

namespace breakwater {
namespace {

struct NoEngines : std::invalid_argument {
  explicit NoEngines(const std::string& reason)
      : std::invalid_argument("searches need pagmo and NLopt: " + reason) {}
};

bool dominates(const std::vector<double>& one, const std::vector<double>& other) {
  return one != other &&
         std::equal(one.begin(), one.end(), other.begin(), other.end(), std::less_equal<>());
}

}  // namespace

const Names<SearchAlgorithm>& search_algorithms() {
  static const Names<SearchAlgorithm> names = {{"nsga2", SearchAlgorithm::nsga2},
                                               {"nspso", SearchAlgorithm::nspso},
                                               {"maco", SearchAlgorithm::maco},
                                               {"cmaes", SearchAlgorithm::cmaes},
                                               {"bobyqa", SearchAlgorithm::bobyqa}};
  return names;
}

bool has_several_objectives(SearchAlgorithm algorithm) {
  return algorithm != SearchAlgorithm::cmaes && algorithm != SearchAlgorithm::bobyqa;
}

std::size_t usual_population(SearchAlgorithm algorithm) {
  if (algorithm == SearchAlgorithm::bobyqa) return 1;
  return algorithm == SearchAlgorithm::cmaes ? 16 : 40;
}

std::size_t used_budget(const SearchSettings& settings) {
  if (settings.algorithm == SearchAlgorithm::bobyqa) return settings.budget;
  return settings.budget / settings.population * settings.population;
}

std::string objection(const SearchSettings& settings) {
  constexpr std::size_t kFewestOfNsga2 = 8, kFewest = 5, kMost = 10000;
  const std::string name = name_of(search_algorithms(), settings.algorithm);
  if (settings.dimension < 1) return "there is nothing to search";
  if (has_several_objectives(settings.algorithm) && settings.objectives < 2) {
    return fmt::format("{} needs two objectives or more; cmaes and bobyqa have one", name);
  }
  if (!has_several_objectives(settings.algorithm) && settings.objectives != 1) {
    return fmt::format("{} has one objective, not {}; nsga2, nspso and maco have several", name,
                       settings.objectives);
  }
  if (settings.algorithm == SearchAlgorithm::bobyqa) {
    if (settings.dimension < 2) return "bobyqa needs two keys or more";
    const std::size_t fewest = settings.dimension + 3;
    if (settings.budget >= fewest) return "";
    return fmt::format("a budget of {} is too small for bobyqa with {} keys: {} at least",
                       settings.budget, settings.dimension, fewest);
  }
  if (settings.algorithm == SearchAlgorithm::nsga2 &&
      (settings.population % 4 != 0 || settings.population < kFewestOfNsga2)) {
    return fmt::format("nsga2's population must be a multiple of 4, 8 at least, not {}",
                       settings.population);
  }
  if (settings.population < kFewest || settings.population > kMost) {
    return fmt::format("a population must have {} to {} members, not {}", kFewest, kMost,
                       settings.population);
  }
  if (settings.budget < 2 * settings.population) {
    return fmt::format(
        "a budget of {} is below one generation: {} are drawn before it, and as many "
        "are bred of them",
        settings.budget, settings.population);
  }
  return "";
}

void search(const SearchSettings& settings, const EvaluateAll& evaluate) {
  if (const std::string reason = objection(settings); !reason.empty()) {
    throw std::invalid_argument(reason);
  }
  static const LoadedLibrary engines(own_library(BREAKWATER_SEARCH_ENGINES), "breakwater");
  engines.symbol<NoEngines, decltype(search)>("breakwater_search")(settings, evaluate);
}

std::vector<std::size_t> front_of(const Vectors& points) {
  std::vector<std::size_t> front;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const auto rules_out = [&](std::size_t other) {
      return points[other] == points[i] || dominates(points[other], points[i]);
    };
    if (std::any_of(front.begin(), front.end(), rules_out)) continue;
    std::erase_if(front, [&](std::size_t other) { return dominates(points[i], points[other]); });
    front.push_back(i);
  }
  return front;
}

std::vector<std::size_t> evenly_spaced(std::size_t size, std::size_t count) {
  std::vector<std::size_t> numbers;
  const std::size_t all = std::min(size, count);
  if (all == 1) return {size / 2};
  for (std::size_t i = 0; i < all; ++i) numbers.push_back(i * (size - 1) / (all - 1));
  return numbers;
}

}  // namespace breakwater
