// The runs of a tuning by number.
#pragma once

#include <cstddef>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include <breakwater/experiment/catalogue.h>
#include <breakwater/search/tuning.h>
#include <breakwater/study/executor.h>

namespace breakwater {

/// One run: an evaluation of a case in a test condition, in the search or the validation.
struct TuningRun {
  std::size_t tuned = 0;  ///< index of the case
  std::size_t evaluation = 0;
  bool is_validation = false;
  std::size_t world = 0;
};

/// A tuning with the numbers of all runs that it may make. The order is: case, evaluation, test
/// condition; first all searches, then the validation. begin() sets the keys of an evaluation when
/// the search asks for it.
class TuningPlan : public PointSource {
 public:
  /// Completes the tuning from its scenario. Throws std::invalid_argument if the scenario or a case
  /// does not exist, or there are more than 10 million runs.
  TuningPlan(const Catalogue& catalogue, Tuning tuning);

  const Tuning& tuning() const { return tuning_; }
  const ScenarioFile& file() const { return *file_; }

  /// Prepares runs that together have each value and each end of a range. Returns a warning for
  /// each ineffective key. Throws std::invalid_argument for the first mistake, and for a metric
  /// that the scenario of a case does not define. A user's own scenario may define none.
  std::vector<std::string> check() const;

  std::size_t size() const;
  /// The number of runs of all searches with full budgets.
  std::size_t searches() const;
  /// The maximal number of evaluations of a search.
  std::size_t evaluations() const;
  std::size_t number(const TuningRun& run) const;
  TuningRun run(std::size_t number) const;
  const Plan& worlds(bool is_validation) const {
    return is_validation ? *tuning_.validation : tuning_.worlds;
  }

  /// The values of the keys, as TOML, at a point of the unit cube.
  std::vector<std::string> values(std::size_t tuned, const std::vector<double>& u) const;
  /// Sets the values of an evaluation. Do not call it during runs.
  void begin(std::size_t tuned, std::size_t evaluation, std::vector<std::string> values);
  /// All candidates so far as lines of text for processes that do not search. A line has the index
  /// of the case, the number of the evaluation and the values as TOML, separated by tabs. TOML
  /// values contain no bare tab or newline.
  std::string candidate_lines() const;
  /// Sets the values from a file of such lines. Throws std::invalid_argument (`FILE: reason`).
  void begin(const std::filesystem::path& file);
  const std::vector<std::string>& values_of(std::size_t tuned, std::size_t evaluation) const {
    return values_[tuned][evaluation];
  }
  /// Whether begin() has set the values.
  bool has(std::size_t tuned, std::size_t evaluation) const {
    return evaluation < values_[tuned].size() && !values_[tuned][evaluation].empty();
  }
  /// The configuration of an evaluation in the scenario's own test condition.
  std::string config_text(std::size_t tuned, std::size_t evaluation) const;

  PreparedRun prepare(std::size_t number) const override;
  std::string asked(std::size_t number) const override;
  std::filesystem::path folder(std::size_t, const std::string&, bool) const override { return {}; }

 private:
  std::vector<std::string> sets(std::size_t number) const;
  std::vector<std::string> own_sets(std::size_t tuned,
                                    const std::vector<std::string>& values) const;

  const Catalogue& catalogue_;
  Tuning tuning_;
  std::shared_ptr<const ScenarioFile> file_;
  std::shared_ptr<BoundCases> bound_ = std::make_shared<BoundCases>();
  std::vector<std::vector<std::vector<std::string>>> values_;  // by case and evaluation
};

}  // namespace breakwater
