// The definition of a tuning: its searched keys, objectives and test conditions.
#pragma once

#include <toml++/toml.h>

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include <breakwater/config/names.h>
#include <breakwater/search/search.h>
#include <breakwater/study/plan.h>

namespace breakwater {

/// The statistic that reduces a metric over many runs to one number. `q90` is the 90 % quantile if
/// small values are good, else the 10 % quantile. `worst` is the largest or the smallest value.
enum class Over { median, mean, q90, worst };
const Names<Over>& over_names();

/// The statistic of one or more values. `large_is_bad` selects the side of q90 and worst.
double gathered(std::vector<double> values, Over over, bool large_is_bad);

struct Objective {
  std::string metric;
  Goal goal = Goal::min;
  Over over = Over::median;
};

struct Constraint : Bound {
  Over over = Over::worst;
};

/// A case of a tuning. It has its own budget.
struct TunedCase {
  std::string name;               ///< empty: the default case of the scenario
  std::string place;              ///< where the file names it
  std::vector<VariedKey> search;  ///< the keys of [search] and those of the case
};

/// The test conditions of each candidate: a plan of one case, whose seed changes first. In a list
/// all keys have equally many values.
Plan worlds_of(std::vector<std::uint64_t> seeds, std::vector<VariedKey> keys, bool is_list);

struct Tuning : StudyBase {
  SearchAlgorithm algorithm = SearchAlgorithm::nsga2;
  std::size_t budget = 0;      ///< evaluations per case
  std::size_t population = 0;  ///< size of a generation
  std::uint32_t sampling_seed = 1;
  std::vector<TunedCase> cases;
  bool is_for_each = false;  ///< the cases may have searched keys of their own
  Plan worlds = worlds_of({}, {}, false);
  std::vector<Objective> objectives;
  std::vector<Constraint> constraints;
  std::optional<Plan> validation;
  std::size_t validated_points = 0;  ///< maximum per front; 1 without fronts

  /// With one objective each case has a best candidate instead of a Pareto front.
  bool has_front() const { return objectives.size() > 1; }
  SearchSettings settings(const TunedCase& tuned) const;
  /// The tuning as a file. Equal tunings give equal text.
  std::string print() const;
};

/// Reads the tables of a tuning's file. Throws std::invalid_argument (`FILE:LINE: key: reason`).
Tuning read_tuning(const toml::table& tables, const std::string& file);

/// The values of the searched keys in an evaluation of a case.
struct TuningCandidate {
  std::size_t tuned = 0;  ///< the case
  std::size_t evaluation = 0;
  std::vector<std::string> values;
};

/// A line of TuningPlan::candidate_lines(); nothing if the tuning has no such candidate.
std::optional<TuningCandidate> read_candidate(const std::string& line, const Tuning& tuning);

}  // namespace breakwater
