// The arm with its controller and simulation, shared by the arm's scenarios.
#pragma once

#include <functional>
#include <limits>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include <breakwater/experiment/scenario.h>
#include <breakwater/rigs/arm_parts.h>
#include <breakwater/rigs/axis_parts.h>
#include <breakwater/rigs/drive_settings.h>
#include <breakwater/rigs/force_sensor_settings.h>
#include <breakwater/rigs/transmission_settings.h>
#include <breakwater/sim/joint_friction.h>
#include <breakwater/sim/simulation.h>
#include <breakwater/sim/wall_contact.h>

namespace breakwater {

/// The drive of one joint: keys axis.NAME.…. All quantities are those at the joint, and the motor's
/// inertia, viscous friction and error of the transmission those at the motor.
struct ArmJoint {
  ArmJoint(std::string which, const Catalogue& catalogue)
      : name(std::move(which)), drive(catalogue) {}

  std::string name;
  double friction_Nm = 0.0;  ///< Coulomb friction; negative: that of the model file
  DriveSettings drive;       ///< friction law and motor
  ScaleSettings scale;       ///< errors of the encoder's scale
  TransmissionSettings transmission;

  std::string prefix() const { return "axis." + name + "."; }
  void bind(Fields& fields);

  /// The transmission with the motor's angle over the ratio in place of its angle. The command and
  /// the encoder are then those of the joint for every ratio.
  TransmissionSettings at_joint() const;
};

/// The keys of all arm scenarios.
struct ArmSettings {
  explicit ArmSettings(const Catalogue& catalogue)
      : controller(catalogue, "controller.name"),
        observer(catalogue, "observer.name", "idob"),
        catalogue_(&catalogue) {
    joints.emplace_back("joint1", catalogue);
  }

  ModelFile mjcf;
  std::string urdf;
  PhysicsSettings physics;
  TimingSettings timing;  ///< timing of the commands
  RunSettings run;

  std::vector<ArmJoint> joints;  ///< one for each joint after learn()
  const ArmJoint& joint(Eigen::Index i) const { return joints.at(static_cast<std::size_t>(i)); }
  std::vector<double> start_angles_rad;  ///< q_0^ref
  PartChoice<ArmControllerKind> controller;

  std::vector<double> nominal_inertia_kgm2;
  PartChoice<AxisEstimatorKind> observer;  ///< one for each joint
  ObserverFeed observer_feed = ObserverFeed::clipped;

  double encoder_counts_per_turn = 0.0;
  EncoderRounding encoder_rounding = EncoderRounding::nearest;
  double angle_noise_rad = 0.0;
  ForceSensorSettings force_sensor;
  FaultSettings faults;

  /// Takes the joints from the URDF. A file that is missing or wrong is left to read()
  /// and check_arm().
  void learn(const Config& config);
  void bind(Fields& fields);

 private:
  const Catalogue* catalogue_;
};

/// The differences between the arm's scenarios.
struct ArmRole {
  double force_control_from_s = std::numeric_limits<double>::infinity();
  double force_reference_N = 0.0;
  double convert_gain_N_m = 1.0;                              ///< K_f
  double wall_x_m = std::numeric_limits<double>::infinity();  ///< as in ArmTask
  bool starts_at_reference = false;  ///< at q_0^ref instead of keyframe "home"
  /// Geoms that the run looks up or makes collide; see Model::load_physics().
  std::vector<std::string> geoms;
  std::function<void(Model&)>
      prepare_model;  ///< may be empty; called before the simulation is made
  /// Makes a contact that is applied as a force; may be empty, or give null.
  std::function<std::unique_ptr<WallContact>(const Model&)> make_contact;
};

/// Checks what the single fields cannot: sizes, periods, the design of controller and observer.
/// Throws std::invalid_argument `ORIGIN: KEY: reason`.
void check_arm(const ArmSettings& settings, const ArmRole& role, const Config& config);

/// The tip pose X at q_0^ref.
TipPose start_pose(const ArmSettings& settings);

/// Shows or hides the geoms with this prefix in pictures. They must be decoration alone.
void show_geoms(Model& model, const std::string& prefix, bool visible);

/// The plant, controller and simulation of the arm, with the true values for log and metrics.
///
/// The model must have a hinge NAME, the sensors NAME_pos and NAME_vel, and an actuator for each
/// joint NAME of the URDF, in this order. It must also have the sensors tip_force, tip_touch,
/// tip_vel.
class ArmRig {
 public:
  /// Throws std::invalid_argument if the model lacks something.
  ArmRig(const ArmSettings& settings, const ArmRole& role);
  ArmRig(const ArmRig&) = delete;
  ArmRig& operator=(const ArmRig&) = delete;

  Simulation& simulation() { return *simulation_; }
  const Simulation& simulation() const { return *simulation_; }
  const PlanarChain& chain() const { return chain_; }
  /// Makes the wall solid, or not, which is the geom `wall` of the model.
  void set_solid(int wall, bool is_solid);

  /// Updates the true values below from the last step of the simulation.
  void observe();
  const Eigen::VectorXd& q() const { return q_; }
  const Eigen::VectorXd& dq() const { return dq_; }
  const TipPose& tip() const { return tip_; }
  const double& contact_force_N() const { return *contact_force_; }
  const double& filtered_force_N() const;
  const double& tip_speed_x_m_s() const { return *tip_speed_x_; }

  /// The signals of the log at the control rate: true, measured, estimated and commanded.
  std::vector<Signal> signals() const;
  /// The forces at the tip and the generalised positions, for the log at the physics rate.
  std::vector<Signal> fine_signals() const;

 private:
  bool has_rotors() const { return simulation_->qpos().size() > positions_of_file_; }

  PlanarChain chain_;
  std::unique_ptr<Controller> controller_;
  std::unique_ptr<WallContact> contact_;                      // null: the engine's
  std::vector<std::unique_ptr<Transmission>> transmissions_;  // one for each joint; null: rigid
  std::vector<std::size_t> motors_;  // index in qpos; that of the joint itself, if it is rigid
  std::vector<std::unique_ptr<JointFriction>> frictions_;  // empty: the engine's
  std::unique_ptr<Simulation> simulation_;
  bool has_motors_;
  std::size_t positions_of_file_;  // added rotors come behind them; pictures do not have them
  Eigen::VectorXd q_;
  Eigen::VectorXd dq_;
  Eigen::VectorXd motor_q_;
  Eigen::VectorXd transmitted_Nm_;
  Eigen::VectorXd friction_Nm_;
  Eigen::VectorXd current_A_;
  TipPose tip_;
  double saturated_ = 0.0;
  const double* contact_force_;
  const double* force_sensor_;
  const double* tip_speed_x_;
  std::vector<const double*> q_sensors_;
  std::vector<const double*> dq_sensors_;
};

}  // namespace breakwater
