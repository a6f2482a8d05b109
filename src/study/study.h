// What a study is: which runs, of what, and what is kept of them.
#pragma once

#include <toml++/toml.h>

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <breakwater/statistics/distribution.h>
#include <breakwater/statistics/goal.h>
#include <breakwater/study/slurm_settings.h>

namespace breakwater {

/// A key and what it takes in turn.
struct VariedKey {
  std::string key;
  std::vector<std::string> values;           ///< as TOML; empty where there is a distribution
  std::optional<Distribution> distribution;  ///< of a number
  std::string written;  ///< as in a study file: "[1, 2]", "{ uniform = [0, 1] }"
  std::string place;    ///< "FILE:LINE: vary.KEY" or "--vary: KEY"

  /// Whether it has a value among `sets` (key=value).
  bool is_in(const std::vector<std::string>& sets) const;
};

/// How the varied keys' values are put together.
enum class Method {
  grid,             ///< every combination of the values
  list,             ///< the first values of all keys, the second, …
  random,           ///< independent draws
  latin_hypercube,  ///< draws, of which each key's fill its range evenly
  sobol,            ///< a low-discrepancy sequence
  saltelli          ///< the design that sensitivity indices are computed from
};

/// A comparison counts these as worlds of their own: samples, which seeds repeat, or every seed of
/// every sample.
enum class WorldUnit { samples, seeds };

/// Which runs leave their folder: none, those that failed, all.
enum class Keep { metrics, failed, all };

/// What a failed run does to the study: it is a result like others, or ends it.
enum class OnFailure { count, stop };

/// A study: for each combination of the varied keys' values (a sample), for each seed, for each
/// candidate that is compared, one run, its point.
struct Study {
  std::string scenario;
  std::string config;             ///< a scenario file; empty: the scenario's own
  std::vector<std::string> sets;  ///< key=value, for all runs
  Method method = Method::grid;
  std::size_t samples = 0;           ///< of the methods that draw
  std::uint64_t sampling_seed = 1;   ///< of what is drawn
  std::vector<std::uint64_t> seeds;  ///< run.seed; empty: the scenario file's
  Keep keep = Keep::metrics;
  OnFailure on_failure = OnFailure::count;
  std::vector<VariedKey> vary;
  std::vector<std::string> cases;    ///< at least one, once completed
  std::vector<VariedKey> compare;    ///< what candidates differ in besides their case
  std::string baseline;              ///< a candidate, or empty
  std::vector<std::string> metrics;  ///< that are compared; empty: all
  /// The goals of metrics that are compared, in the order in which they were named.
  std::vector<std::pair<std::string, Goal>> goals;
  WorldUnit worlds = WorldUnit::samples;
  SlurmSettings slurm;

  /// The metrics that the user named, the most wanted first.
  std::vector<std::string> named_metrics() const;

  /// As a study file: the same study gives the same text.
  std::string print() const;
};

/// Reads the tables of a study file, on which the command line's options lie. Throws
/// std::invalid_argument `FILE:LINE: key: reason`; of a value that comes from an option, `OPTION:
/// key: reason`.
Study read_study(const toml::table& tables, const std::string& file);

/// The TOML value that an option's text means: "500,1000", "lin(0,1,5)", "uniform(0,1)". Throws
/// std::invalid_argument `OPTION: reason`.
toml::table option_value(const std::string& option, const std::string& text);

/// The parts of an option's text between its commas, those in brackets and quotes apart; without
/// the blanks around them.
std::vector<std::string> option_parts(const std::string& text);

/// "1..20" or "1,4,7": seeds. Throws std::invalid_argument.
std::vector<std::uint64_t> parse_seeds(const std::string& text);

}  // namespace breakwater
