// A study's runs on this machine, and what is left of them.
#pragma once

#include <cstddef>
#include <filesystem>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include <breakwater/experiment/catalogue.h>
#include <breakwater/study/executor.h>
#include <breakwater/study/plan.h>
#include <breakwater/study/results.h>
#include <breakwater/study/shards.h>
#include <breakwater/study/study_folder.h>

namespace breakwater {

/// A plan with what is needed to run its points.
class Sweep : public PointSource {
 public:
  /// Completes the study by its scenario: cases, and "all". Throws std::invalid_argument, one line,
  /// if there is no such scenario or case.
  Sweep(const Catalogue& catalogue, Study study);

  const Plan& plan() const { return *plan_; }
  const ScenarioFile& file() const { return *file_; }

  /// Prepares the plan's probes. Throws std::invalid_argument with the first mistake: nothing of a
  /// study runs if a value of it is wrong. Returns what is right but in vain, a line each.
  std::vector<std::string> check() const;
  /// From now on these runs are kept, by their keys; before, none.
  void keep_in(const StudyFolder& folder, Keep keep) {
    folder_ = folder;
    keep_ = keep;
  }

  PreparedRun prepare(std::size_t point) const override;
  std::string unprepared_key(std::size_t point) const override;
  std::filesystem::path folder(std::size_t point, const std::string& key,
                               bool failed) const override;
  bool logs(std::size_t point) const override;

 private:
  PreparedRun prepare(const StudyPoint& point) const;

  const Catalogue& catalogue_;
  std::unique_ptr<ScenarioFile> file_;
  std::unique_ptr<Plan> plan_;
  std::optional<StudyFolder> folder_;
  Keep keep_ = Keep::metrics;
};

/// Points as ranges "0-99,120", each once and in order. Throws std::invalid_argument for what is no
/// such text, or beyond `size`.
std::vector<std::size_t> parse_points(const std::string& text, std::size_t size);
std::string print_points(const std::vector<std::size_t>& points);

/// What a study still has to do, in order.
std::vector<std::size_t> pending(const ShardIndex& index);

struct Estimate {
  double seconds = 0.0;           ///< of processor time, of all points
  std::vector<PointResult> runs;  ///< one of each candidate
};

/// How long a study will take, from one run of each candidate; other lengths of the run or of its
/// step count in proportion, of very many points as far as a sample of them tells. Throws
/// Interrupted.
Estimate estimate(const Sweep& sweep, const std::atomic<bool>& stop);

}  // namespace breakwater
