// Scenario plant: any plant of hinges and slides, described by its MJCF and a TOML.
#pragma once

#include <memory>
#include <string>
#include <utility>
#include <vector>

#include <breakwater/experiment/catalogue.h>
#include <breakwater/rigs/axis_scenario.h>
#include <breakwater/rigs/plant_parts.h>

namespace breakwater {

/// The file names the axes ([axis.NAME]), the forces on bodies ([push.NAME]), the contacts
/// ([contact.NAME]), the force sensor ([tip]) and the metrics ([metric.NAME]). Each axis has its
/// own reference, disturbance, estimator and controller, or one controller drives all axes.
class Plant final : public LoopScenario {
 public:
  Plant(const Catalogue& catalogue, std::string name, std::string summary)
      : catalogue_(with_none(catalogue)),
        plant_(catalogue_),
        parts_(catalogue_),
        name_(std::move(name)),
        summary_(std::move(summary)) {}

  std::string name() const override { return name_; }
  std::string summary() const override { return summary_; }
  void learn(const Config& config) override;
  Fields fields() override;
  void check(const Config& config) override;
  const RunSettings& run_settings() const override { return plant_.run; }
  std::vector<std::string> warnings() const override { return warnings_; }
  Recording run(const RunControl& control) const override;
  void prepare_scene(Model& model) const override {
    for (const ContactSettings& one : plant_.contacts) one.prepare(model);
  }
  /// All axes hold the pose of start.keyframe.
  std::vector<AxisOfPlant> loops() const override;

 private:
  PlantTask task() const;
  /// Warns if the tip holds fewer coordinates than there are.
  void warn_of_free_coordinates(const std::vector<TipCoordinate>& held);
  /// Whether the axis has a controller of its own.
  bool has_own_loop(std::size_t i) const;
  /// The axes' own controllers, with `other` at the axis `replaced` if it is there.
  std::unique_ptr<Controller> axes_control(const std::vector<AxisTask>& tasks,
                                           std::unique_ptr<Controller> other = nullptr,
                                           std::size_t replaced = 0) const;

  Catalogue catalogue_;
  AxisPlant plant_;
  PlantParts parts_;
  std::string name_;
  std::string summary_;
  std::vector<AxisParts> axis_parts_;  // in the order of the axes
  std::vector<std::string> warnings_;
};

/// A scenario that is a file of this class.
inline ScenarioKind plant_kind(const std::string& name, const std::string& summary) {
  return {name, [=](const Catalogue& catalogue) -> std::unique_ptr<Scenario> {
            return std::make_unique<Plant>(catalogue, name, summary);
          }};
}

}  // namespace breakwater
