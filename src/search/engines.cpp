// The library of search/search.h.
#include <breakwater/search/search.h>

#include <tbb/global_control.h>

#include <algorithm>
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
  nlopt::opt method(nlopt::LN_BOBYQA, static_cast<unsigned>(d));
  method.set_lower_bounds(kFace);
  method.set_upper_bounds(1.0 - kFace);
  method.set_initial_step(0.25);
  method.set_xtol_rel(1e-6);
  method.set_maxeval(static_cast<int>(settings.budget));
  struct Passed {
    const EvaluateAll& evaluate;
    std::exception_ptr thrown = nullptr;
  } passed = {evaluate};
  const nlopt::vfunc objective = [](const std::vector<double>& u, std::vector<double>&,
                                    void* pass) -> double {
    auto& all = *static_cast<Passed*>(pass);
    try {
      return all.evaluate({u}).front().front();
    } catch (...) {
      all.thrown = std::current_exception();  // NLopt knows only some exceptions
      throw nlopt::forced_stop();
    }
  };
  method.set_min_objective(objective, &passed);
  std::vector<double> u(d, 0.5);
  double best = 0.0;
  try {
    method.optimize(u, best);
  } catch (const nlopt::roundoff_limited&) {
    // The rounding errors stop it at the best point it can reach.
  } catch (const nlopt::forced_stop&) {
  }
  if (passed.thrown) std::rethrow_exception(passed.thrown);
}

}  // namespace
}  // namespace breakwater

extern "C" [[gnu::visibility("default")]] void breakwater_search(
    const breakwater::SearchSettings& settings, const breakwater::EvaluateAll& evaluate) {
  const bool is_bobyqa = settings.algorithm == breakwater::SearchAlgorithm::bobyqa;
  (is_bobyqa ? breakwater::minimise : breakwater::evolve)(settings, evaluate);
}
