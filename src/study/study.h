// The definition of a study: its runs and the results to keep.
#pragma once

#include <toml++/toml.h>

#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <breakwater/config/names.h>
#include <breakwater/statistics/distribution.h>
#include <breakwater/statistics/ranking.h>
#include <breakwater/study/sampling.h>

namespace breakwater {

/// A varied key with its values or its distribution.
struct VariedKey {
  std::string key;
  std::vector<std::string> values;           ///< as TOML; empty if there is a distribution
  std::optional<Distribution> distribution;  ///< for a numeric key
  std::string written;  ///< as in a study file: "[1, 2]", "{ uniform = [0, 1] }"
  std::string place;    ///< "FILE:LINE: vary.KEY" or "--vary: KEY"
};

/// Whether `sets` (key=value) give a key a value.
bool is_set(const std::vector<std::string>& sets, const std::string& key);

const Names<Method>& methods();
/// Whether a method draws its samples.
bool draws(Method method);

/// Which runs keep their folder: none, the failed ones, all.
enum class Keep { metrics, failed, all };

/// "FILE:LINE: KEY" or the name of an option, by KEY.
using Places = std::map<std::string, std::string>;

/// The place of a key, or the key if it has none.
std::string place_of(const Places& places, const std::string& key);

/// The number of combinations of the keys' values, and the one with this number. In a grid the last
/// key changes first; a list has the first values of all keys, the second, …
double combinations(const std::vector<VariedKey>& keys, bool is_list = false);
std::vector<std::string> combination(const std::vector<VariedKey>& keys, std::size_t number,
                                     bool is_list = false);

/// The value of a key, as TOML, at a number of the unit interval.
std::string value_at(const VariedKey& key, double u);

/// A metric that a file of a study names.
struct NamedMetric {
  std::string place;  ///< "FILE:LINE: compare.goal.pea_N"
  std::string name;
  bool is_required = true;  ///< not by compare.metrics
  std::string meant = {};   ///< by unknown_metrics(): did_you_mean(), or the known names
};

/// The common part of the files of studies and tunings.
struct StudyBase {
  std::string scenario;
  std::string config;             ///< a scenario file; empty: that of the scenario
  std::vector<std::string> sets;  ///< key=value, for all runs
  Places places;                  ///< at least for scenario, config and each set.KEY
  std::vector<NamedMetric> named;
};

/// The metrics that a study names and `known` lacks.
std::vector<NamedMetric> unknown_metrics(const StudyBase& study,
                                         const std::vector<std::string>& known);

/// A study. It has one run, its point, for each sample (combination of varied values), seed and
/// candidate.
struct Study : StudyBase {
  Method method = Method::grid;
  std::size_t samples = 0;           ///< number of samples for random methods
  std::uint64_t sampling_seed = 1;   ///< random seed of the samples
  std::vector<std::uint64_t> seeds;  ///< run.seed; empty: that of the scenario file
  Keep keep = Keep::metrics;
  bool stops_on_failure = false;  ///< a failed run ends the study; else it counts as a result
  std::vector<VariedKey> vary;
  std::vector<std::string> cases;    ///< at least one, once completed
  std::vector<VariedKey> compare;    ///< keys in which candidates differ besides their case
  std::string baseline;              ///< a candidate, or empty
  std::vector<std::string> metrics;  ///< metrics to compare; empty: all
  /// The goals of compared metrics, in the order of the file.
  std::vector<std::pair<std::string, Goal>> goals;
  Requirement require;  ///< a ranked candidate meets it
  /// Whether each seed of each sample is an independent unit of a comparison. If not, a sample is
  /// one, and its seeds repeat it.
  bool are_seeds_worlds = false;

  /// The study as a file. Equal studies give equal text.
  std::string print() const;
};

/// Reads the tables of a study file, merged with the command line's options. Throws
/// std::invalid_argument (`FILE:LINE: key: reason`, or `OPTION: key: reason` for a value of an
/// option).
Study read_study(const toml::table& tables, const std::string& file);

/// The TOML value of an option's text: "500,1000", "lin(0,1,5)", "uniform(0,1)". Throws
/// std::invalid_argument (`OPTION: reason`).
toml::table option_value(const std::string& option, const std::string& given);

/// Splits an option's text at its commas, except inside brackets and quotes, and trims the parts.
std::vector<std::string> option_parts(const std::string& text);

}  // namespace breakwater
