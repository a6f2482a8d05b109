// A tuning's runs by their numbers.
#pragma once

#include <cstddef>
#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <utility>
#include <vector>

#include <breakwater/experiment/catalogue.h>
#include <breakwater/search/tuning.h>
#include <breakwater/study/executor.h>

namespace breakwater {

/// One run: of a case's evaluation, in a world; of its search or of its validation.
struct TuningRun {
  std::size_t tuned = 0;  ///< number of the case
  std::size_t evaluation = 0;
  bool is_validation = false;
  std::size_t world = 0;
};

/// What one run of each case tells.
struct Trial {
  double search_s = 0.0;              ///< processor time of all searches, as far as these runs tell
  double validation_s = 0.0;          ///< of the validations, at most
  std::vector<std::string> warnings;  ///< of runs that failed
};

/// Numbers of all runs that a tuning may make: first the searches', case after case, evaluation
/// after evaluation, world after world; then the validations'. What an evaluation's keys are is
/// only known once the search asks for it.
class TuningPlan : public PointSource {
 public:
  /// Completes the tuning by its scenario: its cases. Throws std::invalid_argument, one line, if
  /// there is no such scenario or case, or there would be more than 10 million runs.
  TuningPlan(const Catalogue& catalogue, Tuning tuning);

  const Tuning& tuning() const { return tuning_; }
  const ScenarioFile& file() const { return *file_; }

  /// Prepares runs that between them have each value and each end of a range. Throws
  /// std::invalid_argument with the first mistake. What it returns is to be warned of: a key that a
  /// case does not use.
  std::vector<std::string> check() const;
  /// Runs each case in the middle of its ranges, in the first world. Throws std::invalid_argument
  /// if one ends and lacks a metric that an objective or a constraint names, and Interrupted.
  Trial try_each_case(const std::atomic<bool>& stop) const;

  std::size_t size() const;
  /// How many of them are of the searches, were their budgets used to the end.
  std::size_t searches() const;
  /// Evaluations that each search makes, at most.
  std::size_t evaluations() const;
  std::size_t number(const TuningRun& run) const;
  TuningRun run(std::size_t number) const;
  const Worlds& worlds(bool is_validation) const {
    return is_validation ? *tuning_.validation : tuning_.worlds;
  }

  /// What the keys of an evaluation are, as TOML, of a point of the unit cube.
  std::vector<std::string> values(std::size_t tuned, const std::vector<double>& u) const;
  /// Says what the keys of an evaluation are. Not while runs are under way.
  void begin(std::size_t tuned, std::size_t evaluation, std::vector<std::string> values);
  /// Candidates as lines of text, for processes that run them and do not search: the number of the
  /// case, of the evaluation, and its keys' values as TOML, which has no bare tab or end of a line
  /// in them.
  std::vector<std::string> candidate_lines(const std::vector<std::size_t>& runs) const;
  /// Says what such lines say. Throws std::invalid_argument `ORIGIN: reason`.
  void begin(const std::vector<std::string>& lines, const std::string& origin);
  const std::vector<std::string>& values_of(std::size_t tuned, std::size_t evaluation) const {
    return values_[tuned][evaluation];
  }
  /// Whether that was said.
  bool has(std::size_t tuned, std::size_t evaluation) const {
    return evaluation < values_[tuned].size() && !values_[tuned][evaluation].empty();
  }
  /// The configuration of an evaluation in the scenario's own world.
  std::string config_text(std::size_t tuned, std::size_t evaluation) const;

  PreparedRun prepare(std::size_t number) const override;
  std::string unprepared_key(std::size_t number) const override;
  std::filesystem::path folder(std::size_t, const std::string&, bool) const override { return {}; }
  bool logs(std::size_t) const override { return false; }
  std::vector<std::string> task_words(const std::vector<std::size_t>& runs) const override;

 private:
  std::vector<std::string> sets(std::size_t number) const;
  std::vector<std::string> own_sets(std::size_t tuned,
                                    const std::vector<std::string>& values) const;

  const Catalogue& catalogue_;
  Tuning tuning_;
  std::unique_ptr<ScenarioFile> file_;
  std::vector<std::vector<std::vector<std::string>>> values_;  // of each case's evaluations
};

}  // namespace breakwater
