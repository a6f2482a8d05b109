// Scenarios with a planar arm: a plant with the axes of a URDF, a tip and a controller of an arm.
#pragma once

#include <string>

#include <breakwater/rigs/axis_scenario.h>

namespace breakwater {

/// Shows or hides the geoms with this prefix in pictures. They must be decoration alone.
void show_geoms(Model& model, const std::string& prefix, bool visible);

/// A scenario with a planar arm: its file has the key model.urdf.
///
/// The model must also have the keyframe home and the sensors tip_force, tip_touch and tip_vel. The
/// signals of the log have the values of all joints side by side. The reference of each joint is
/// its start angle.
class ArmScenario : public AxisScenario {
 public:
  void learn(const Config& config) override;
  void check(const Config& config) override;

 protected:
  ArmScenario(const Catalogue& catalogue, AxisScenarioDesign design);

  /// The arm's signals, and the warning of a tip that leaves its start pose.
  void extend(RigRun& run, AxisRig& rig, const AxisLoop& loop) const override;
  /// The time in which the tip should be at its start pose, for a warning.
  virtual TimeWindow holds_start_pose() const = 0;

  // Valid after the check.
  const PlanarChain& chain() const { return *plant_.chain; }
  /// q_0^ref, n.
  Eigen::VectorXd start_angles_rad() const;
  /// The tip pose X at q_0^ref.
  TipPose start_pose() const { return chain().tip_pose(start_angles_rad()); }
};

}  // namespace breakwater
