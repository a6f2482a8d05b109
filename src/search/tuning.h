// What a tuning is: which keys are searched, for what, in which worlds.
#pragma once

#include <toml++/toml.h>

#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include <breakwater/config/names.h>
#include <breakwater/search/search.h>
#include <breakwater/statistics/goal.h>
#include <breakwater/study/study.h>

namespace breakwater {

/// What many runs' values of a metric become one by. `q90` is what nine runs in ten keep: the 90 %
/// quantile, or the 10 % one where large values are good; `worst` is the largest, or the smallest.
enum class Over { median, mean, q90, worst };
const Names<Over>& over_names();

/// Of values x ≥ 1. `large_is_bad` says which end q90 and worst are at.
double gathered(std::vector<double> values, Over over, bool large_is_bad);

struct Objective {
  std::string metric;
  Goal goal = Goal::min;
  Over over = Over::median;
  std::optional<double> reference;  ///< of the hypervolume; else the worst that was met
  std::string place;                ///< "FILE:LINE: objective.METRIC"
};

struct Constraint {
  std::string metric;
  double min = -std::numeric_limits<double>::infinity();
  double max = std::numeric_limits<double>::infinity();
  Over over = Over::worst;
  std::string place;
};

/// What is tuned, with a budget of its own.
struct TunedCase {
  std::string name;               ///< empty: the scenario's default case
  std::string place;              ///< where it is named, if it is
  std::vector<VariedKey> search;  ///< [search], and the case's own
};

/// How worlds come of the keys' values: every combination, or the first values of all keys, the
/// second, …
enum class WorldMethod { grid, list };

/// Worlds: the keys' values put together, with each seed.
struct Worlds {
  std::vector<std::uint64_t> seeds;  ///< empty: the scenario file's
  std::vector<VariedKey> keys;       ///< in a list all have as many values
  WorldMethod method = WorldMethod::grid;

  std::size_t size() const;
  /// key=value of world i < size(): seeds change first.
  std::vector<std::string> sets(std::size_t i) const;
  /// The seed and the keys' values as TOML; no seed: empty.
  std::vector<std::string> values(std::size_t i) const;
};

struct Tuning {
  std::string scenario;
  std::string config;             ///< a scenario file; empty: the scenario's own
  std::vector<std::string> sets;  ///< key=value, for all runs
  SearchAlgorithm algorithm = SearchAlgorithm::nsga2;
  std::size_t budget = 0;      ///< evaluations of each case
  std::size_t population = 0;  ///< of a generation
  std::uint32_t sampling_seed = 1;
  std::vector<TunedCase> cases;
  bool is_for_each = false;  ///< the file names several
  Worlds worlds;
  std::vector<Objective> objectives;
  std::vector<Constraint> constraints;
  std::optional<Worlds> validation;
  std::size_t validated_points = 0;  ///< of each front, at most
  SlurmSettings slurm;

  SearchSettings settings(const TunedCase& tuned) const;
  /// As a tuning's file: the same tuning gives the same text.
  std::string print() const;
};

/// Reads the tables of a tuning's file. Throws std::invalid_argument `FILE:LINE: key: reason`.
Tuning read_tuning(const toml::table& tables, const std::string& file);

}  // namespace breakwater
