// Scenarios with a planar arm: a plant with an axis for each joint, a tip and one controller.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include <breakwater/experiment/scenario.h>
#include <breakwater/rigs/arm_parts.h>
#include <breakwater/rigs/axis_rig.h>

namespace breakwater {

/// Shows or hides the geoms with this prefix in pictures. They must be decoration alone.
void show_geoms(Model& model, const std::string& prefix, bool visible);

/// A scenario with a planar arm, whose joints and nominal model are those of a URDF.
///
/// The model must have a hinge and an actuator for each joint NAME of the URDF. It must also have
/// the keyframe home and the sensors tip_force, tip_touch and tip_vel. The signals of the log have
/// the values of all joints side by side.
class ArmScenario : public Scenario {
 public:
  void learn(const Config& config) override;
  /// Binds the keys of all arms, then bind(), then the rows of the metrics.
  Fields fields() override;
  /// Completes the plant. Checks what the single fields cannot: sizes, periods, the design of
  /// controller and observer. Also calls complete(). Throws std::invalid_argument
  /// `ORIGIN: KEY: reason`.
  void check(const Config& config) override;
  const RunSettings& run_settings() const override { return plant_.run; }
  Recording run(const RunControl& control) const override;

 protected:
  /// The arm starts at q_0^ref, or at the keyframe home.
  ArmScenario(const Catalogue& catalogue, MetricRows rows, bool starts_at_reference);

  /// Binds the scenario's own keys.
  virtual void bind(Fields& fields) = 0;
  /// Checks what only this scenario has. Returns the names for the rows of its metrics.
  virtual MetricContext complete(const Config& config) = 0;
  /// Adds signals and more to a run.
  virtual void extend(RigRun& run, AxisRig& rig) const = 0;
  /// The time in which the tip should be at its start pose, for a warning.
  virtual TimeWindow holds_start_pose() const = 0;

  // Valid after the check.
  const PlanarChain& chain() const { return chain_.value(); }
  /// The tip pose X at q_0^ref.
  TipPose start_pose() const;
  /// The task of the controller: position control at q_0^ref.
  virtual ArmTask task() const;

  AxisPlant plant_;  ///< its axes are the joints; all quantities are those at the joint
  std::vector<double> start_angles_rad_;  ///< q_0^ref

 private:
  ArmSetup setup() const;
  std::vector<NominalAxis> nominal_joints() const;
  void add_signals(RigRun& run, const AxisRig& rig) const;

  const Catalogue* catalogue_;
  bool starts_at_reference_;
  std::string urdf_;
  std::optional<PlanarChain> chain_;
  std::vector<TransmissionSettings> transmissions_;  // with the quantities of the motors
  PartChoice<ArmControllerKind> controller_;
  std::vector<double> nominal_inertia_kgm2_;
  PartChoice<AxisEstimatorKind> observer_;  // one for each joint
  ObserverFeed observer_feed_ = ObserverFeed::clipped;
  double encoder_counts_per_turn_ = 0.0;
};

}  // namespace breakwater
