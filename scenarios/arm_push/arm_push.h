// Scenario arm_push: forced displacement of a link (thesis 2.4.3.3).
#pragma once

#include <breakwater/rigs/arm_scenario.h>
#include <breakwater/world/hand.h>

namespace breakwater {

/// The reductions of arm_push's metrics.
std::vector<MetricKind> kinds_of_a_push();

/// The arm holds its start pose. A stiff hand pushes the end of one link, turns it, holds it and
/// lets go. The torques saturate; the question is how the arm returns.
class ArmPush final : public ArmScenario {
 public:
  explicit ArmPush(const Catalogue& catalogue);

  std::string name() const override { return "arm_push"; }
  std::string summary() const override {
    return "forced displacement of each link: torque saturation, recovery";
  }
  Fields fields() override;
  void check(const Config& config) override;
  Recording run(const RunControl& control) const override;
  void prepare_scene(Model& model) const override;

 private:
  int link_ = 1;
  Hand hand_;
  double settled_within_m_ = 0.0;
};

}  // namespace breakwater
