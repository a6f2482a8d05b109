// The runs of a study on this machine.
#pragma once

#include <cstddef>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include <breakwater/experiment/catalogue.h>
#include <breakwater/study/executor.h>
#include <breakwater/study/plan.h>
#include <breakwater/study/study_folder.h>

namespace breakwater {

/// The file of a study's scenario. Throws std::invalid_argument if there is no such scenario.
std::shared_ptr<const ScenarioFile> scenario_file(const Catalogue& catalogue,
                                                  const std::string& scenario,
                                                  const std::string& config, const Places& places);

/// A plan with everything that its runs need.
class Sweep : public PointSource {
 public:
  /// Completes the study from its scenario: the cases, and "all". Throws std::invalid_argument if
  /// the scenario or a case does not exist.
  Sweep(const Catalogue& catalogue, Study study);

  const Plan& plan() const { return *plan_; }
  const ScenarioFile& file() const { return *file_; }

  /// The same study with one seed, the one after its first.
  Sweep with_next_seed() const;

  /// Prepares the plan's probes, so that no run begins if a value is wrong, and checks the metrics.
  /// Returns one line per ineffective key. Throws std::invalid_argument for the first mistake.
  std::vector<std::string> check() const;
  /// Looks for misspelt names of metrics: those that no candidate's scenario defines. A user's own
  /// scenario may define none. Throws std::invalid_argument.
  void check_metrics() const;
  /// Keeps the folders of the chosen runs from now on. Before this call none is kept.
  void keep_in(const StudyFolder& folder, Keep keep) {
    folder_ = folder;
    keep_ = keep;
  }

  PreparedRun prepare(std::size_t point) const override;
  /// The metrics of a point's scenario, also those that a run may be too short for. Empty if the
  /// point is refused.
  std::vector<std::string> defined_metrics(std::size_t point) const;
  std::string asked(std::size_t number) const override;
  std::filesystem::path folder(std::size_t point, const std::string& key,
                               bool failed) const override;

 private:
  PreparedRun prepare(const StudyPoint& point, const std::shared_ptr<BoundCases>& bound) const;

  const Catalogue& catalogue_;
  std::shared_ptr<const ScenarioFile> file_;
  std::unique_ptr<Plan> plan_;
  std::shared_ptr<BoundCases> bound_ = std::make_shared<BoundCases>();
  std::optional<StudyFolder> folder_;
  Keep keep_ = Keep::metrics;
};

}  // namespace breakwater
