#include <breakwater/search/search.h>

#include <fmt/format.h>

#include <tbb/global_control.h>
#include <algorithm>
#include <cmath>
#include <exception>
#include <nlopt.hpp>
#include <pagmo/algorithms/cmaes.hpp>
#include <pagmo/algorithms/maco.hpp>
#include <pagmo/algorithms/nsga2.hpp>
#include <pagmo/algorithms/nspso.hpp>
#include <pagmo/bfe.hpp>
#include <pagmo/population.hpp>
#include <pagmo/problem.hpp>
#include <stdexcept>

namespace breakwater {
namespace {

// Margin to the faces of the cube, where distributions have no value.
constexpr double kFace = 0x1p-30;

// Handle that pagmo copies; the search itself is not copied.
struct Cube {
  const SearchSettings* settings = nullptr;
  const EvaluateAll* evaluate = nullptr;

  pagmo::vector_double fitness(const pagmo::vector_double& u) const {
    return (*evaluate)({u}).front();
  }
  std::pair<pagmo::vector_double, pagmo::vector_double> get_bounds() const {
    if (settings == nullptr) return {{0.0}, {1.0}};
    return {pagmo::vector_double(settings->dimension, kFace),
            pagmo::vector_double(settings->dimension, 1.0 - kFace)};
  }
  pagmo::vector_double::size_type get_nobj() const {
    return settings == nullptr ? 1 : settings->objectives;
  }
};

struct Generation {
  const SearchSettings* settings = nullptr;
  const EvaluateAll* evaluate = nullptr;

  pagmo::vector_double operator()(const pagmo::problem& problem,
                                  const pagmo::vector_double& all) const {
    const std::size_t d = settings->dimension;
    Vectors points;
    for (std::size_t i = 0; i < all.size(); i += d) {
      points.emplace_back(all.begin() + static_cast<std::ptrdiff_t>(i),
                          all.begin() + static_cast<std::ptrdiff_t>(i + d));
    }
    pagmo::vector_double answers;
    for (const auto& answer : (*evaluate)(points)) {
      answers.insert(answers.end(), answer.begin(), answer.end());
    }
    problem.increment_fevals(points.size());
    return answers;
  }
};

void evolve(const SearchSettings& settings, const EvaluateAll& evaluate) {
  // pagmo's own work is small. Its threads would only be one more thing that may fail. The limit
  // stays: its end starts threads, and ends the process if it cannot.
  [[maybe_unused]] static const auto& one_thread =
      *new tbb::global_control(tbb::global_control::max_allowed_parallelism, 1);
  const pagmo::problem problem{Cube{&settings, &evaluate}};
  const pagmo::bfe generation{Generation{&settings, &evaluate}};
  pagmo::population first(problem, generation, settings.population, settings.seed);
  const auto generations = static_cast<unsigned>(settings.budget / settings.population - 1);
  const auto run = [&](auto algorithm) {
    algorithm.set_bfe(generation);
    algorithm.evolve(first);
  };
  switch (settings.algorithm) {
    case SearchAlgorithm::nsga2:
      return run(pagmo::nsga2(generations, 0.95, 10.0,
                              1.0 / static_cast<double>(settings.dimension), 50.0, settings.seed));
    case SearchAlgorithm::nspso:
      return run(pagmo::nspso(generations, 0.6, 2.0, 2.0, 1.0, 0.5, 60, "crowding distance", false,
                              settings.seed));
    case SearchAlgorithm::maco: {
      constexpr std::size_t kUsualKernel = 63;
      const auto kernel = static_cast<unsigned>(std::min(kUsualKernel, settings.population));
      return run(pagmo::maco(generations, kernel, 1.0, 1, 7, 100000, 0.0, false, settings.seed));
    }
    case SearchAlgorithm::cmaes:
      pagmo::cmaes(generations, -1, -1, -1, -1, 0.3, 0.0, 0.0, false, true, settings.seed)
          .evolve(first);
      return;
    case SearchAlgorithm::bobyqa:
      break;
  }
  throw std::logic_error("no evolution");
}

void minimise(const SearchSettings& settings, const EvaluateAll& evaluate) {
  const std::size_t d = settings.dimension;
  std::exception_ptr thrown;
  nlopt::opt method(nlopt::LN_BOBYQA, static_cast<unsigned>(d));
  method.set_lower_bounds(kFace);
  method.set_upper_bounds(1.0 - kFace);
  method.set_initial_step(0.25);
  method.set_xtol_rel(1e-6);
  method.set_maxeval(static_cast<int>(settings.budget));
  const nlopt::vfunc objective = [](const std::vector<double>& u, std::vector<double>&,
                                    void* pass) -> double {
    const auto& [evaluate_all, optimiser, caught] =
        *static_cast<std::tuple<const EvaluateAll*, nlopt::opt*, std::exception_ptr*>*>(pass);
    try {
      return (*evaluate_all)({u}).front().front();
    } catch (...) {
      *caught = std::current_exception();  // an exception of ours cannot pass through NLopt
      optimiser->force_stop();
      return 0.0;
    }
  };
  std::tuple<const EvaluateAll*, nlopt::opt*, std::exception_ptr*> pass(&evaluate, &method,
                                                                        &thrown);
  method.set_min_objective(objective, &pass);
  std::vector<double> u(d, 0.5);
  double best = 0.0;
  try {
    method.optimize(u, best);
  } catch (const nlopt::roundoff_limited&) {
    // The rounding errors stop it at the best point it can reach.
  } catch (const nlopt::forced_stop&) {
  }
  if (thrown) std::rethrow_exception(thrown);
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
  if (settings.algorithm == SearchAlgorithm::bobyqa) return minimise(settings, evaluate);
  evolve(settings, evaluate);
}

}  // namespace breakwater
