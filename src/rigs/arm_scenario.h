// Scenarios with a planar arm: a plant with an axis for each joint, a tip and one controller.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <breakwater/experiment/scenario.h>
#include <breakwater/rigs/arm_parts.h>
#include <breakwater/rigs/axis_rig.h>

namespace breakwater {

/// Shows or hides the geoms with this prefix in pictures. They must be decoration alone.
void show_geoms(Model& model, const std::string& prefix, bool visible);

/// An arm under its controller. The signals of the log have the values of all joints side by side.
class ArmRig : public AxisRig {
 public:
  /// The chain and the controller must outlive the rig. Throws std::invalid_argument if the model
  /// lacks something.
  ArmRig(const AxisPlant& plant, const PlanarChain& chain, Controller& controller);

  /// Updates the values below from the last step of the simulation.
  void observe();
  const Eigen::VectorXd& q() const { return joints_[0].values; }
  const TipPose& tip() const { return tip_; }

  /// The signals of the log at the control rate: true, measured, estimated and commanded.
  std::vector<Signal> signals() const;
  /// The forces at the tip and the generalised positions, for the log at the physics rate.
  std::vector<Signal> fine_signals() const;

 private:
  // A signal with a value for each joint.
  struct JointValues {
    const char* name;
    const char* unit;
    const char* what;
    const double& (AxisRig::*of_joint)(std::size_t) const;
    Eigen::VectorXd values;
  };

  const PlanarChain& chain_;
  const Controller& controller_;
  std::vector<JointValues> joints_;  // first the true angles, then their rates
  TipPose tip_ = TipPose::Zero();
};

/// A scenario with a planar arm, whose joints and nominal model are those of a URDF.
///
/// The model must have a hinge and a <motor> for each joint NAME of the URDF, in this order. It
/// must also have the keyframe home and the sensors tip_force, tip_touch and tip_vel.
class ArmScenario : public Scenario {
 public:
  void learn(const Config& config) override;
  const RunSettings& run_settings() const override { return plant_.run; }

 protected:
  /// The arm starts at q_0^ref, or at the keyframe home.
  ArmScenario(const Catalogue& catalogue, MetricRows rows, bool starts_at_reference);

  /// Binds the keys of all arms.
  void bind(Fields& fields);
  /// Completes the plant. Checks what the single fields cannot: sizes, periods, the design of
  /// controller and observer. Throws std::invalid_argument `ORIGIN: KEY: reason`.
  void check_arm(const Config& config);

  // Valid after the check.
  const PlanarChain& chain() const { return chain_.value(); }
  /// The tip pose X at q_0^ref.
  TipPose start_pose() const;
  /// The task of the controller: position control at q_0^ref.
  virtual ArmTask task() const;
  std::unique_ptr<Controller> make_controller() const { return controller_.make(setup()); }

  AxisPlant plant_;  ///< its axes are the joints; all quantities are those at the joint
  std::vector<double> start_angles_rad_;  ///< q_0^ref

 private:
  ArmSetup setup() const;
  NominalAxis nominal_joint(Eigen::Index joint) const;
  std::unique_ptr<DisturbanceEstimator> make_observer() const;

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
