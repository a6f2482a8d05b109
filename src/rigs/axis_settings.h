// The keys of a plant of axes (motors, carts, machines): what the plant has, and what each axis
// has. The types of an axis, from its keys to its run:
//
//   Axis          names of its joint, actuator, sensor and units
//   AxisSettings  its keys; AxisPlant has those of all axes: the true plant
//   NominalAxis   what a controller or an estimator knows of it; AxisTask: with its reference
//   AxisParts     the controller and the estimator chosen for it; AxisLoop: as they are made
//   AxisRig       the plant in the engine, stepped under a controller
//
// Besides its axes a plant has disturbances, forces on bodies, and the tip with its force sensor.
#pragma once

#include <array>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <breakwater/control/reference.h>
#include <breakwater/experiment/settings.h>
#include <breakwater/plants/planar_chain.h>
#include <breakwater/rigs/axis_parts.h>
#include <breakwater/rigs/contact_settings.h>
#include <breakwater/rigs/drive_settings.h>
#include <breakwater/sim/sensing.h>
#include <breakwater/world/disturbance.h>

namespace breakwater {

/// The names and units of an axis in its model.
struct Axis {
  /// A part of its keys and signals; empty for a plant with one axis and without names.
  std::string name;
  std::string joint;
  std::string actuator;      ///< kNone: it is measured, but not driven; kJoint: that of the joint
  bool is_replaced = false;  ///< a motor replaces the actuator of the model
  std::string position_sensor;  ///< kJoint: the joint itself
  std::string channel;          ///< name of the position's sensor channel
  AxisUnits units;

  /// The prefix of its keys: "axis.NAME.", or "".
  std::string prefix() const { return name.empty() ? "" : "axis." + name + "."; }
  bool is_driven() const { return actuator != kNone; }
  bool measures_joint() const { return position_sensor == kJoint; }

  static constexpr const char* kNone = "none";
  static constexpr const char* kJoint = "joint";
  /// The name of its signal `what`: "NAME_what", or "what".
  std::string own(const std::string& what) const { return name.empty() ? what : name + "_" + what; }
};

/// The actuator of a driven axis. Throws std::invalid_argument if the model lacks it.
int actuator_id(const Model& model, const Axis& axis);

/// The axes of models/motor.xml and models/cart.xml.
Axis motor_axis();
Axis cart_axis();

/// An axis of a plant whose file names its axes, or the only axis of a plant.
Axis named_axis(const std::string& name, const std::string& joint, const std::string& actuator,
                bool is_hinge);

/// A disturbance by the keys disturbance.…
struct DisturbanceSettings {
  Disturbance shape = {.second_amplitude = 2.0,
                       .second_frequency_rad_s = 5.0,
                       .end_frequency_rad_s = 5.0,
                       .sweep_s = 9.0};
  std::string file;    ///< table of the kind csv
  double end_s = 0.0;  ///< 0: the end of the run

  /// `suffix` and `unit` are those of the amplitude: "Nm", "N m".
  void bind(Fields& fields, const std::string& suffix, const std::string& unit);

  /// Reads the table of the kind csv, and checks the end. Throws std::invalid_argument `ORIGIN:
  /// KEY: reason`.
  void load(const Config& config);

  /// The disturbance, where noise has the run's seed and the stream `channel`.
  Disturbance make(std::uint64_t seed, const std::string& channel) const;
};

/// A force on a body: keys push.NAME.….
struct PushSettings {
  std::string name;
  std::string body;
  std::vector<double> along;  ///< direction in the world, of any length
  DisturbanceSettings disturbance;

  std::string prefix() const { return "push." + name + "."; }
  void bind(Fields& fields);
};

/// The force sensor of the tip and the reference of its force: keys tip.…, sensor.force_…, force.….
struct TipSettings {
  std::string contact = Axis::kNone;  ///< its force is the true one, if no `touch` is
  std::string touch;  ///< <touch> of the model with the force of the engine's contact
  std::string sensor = Axis::kNone;  ///< kNone: the force of the contact is measured itself
  int component = 0;
  // The chain of the sensor, each part of which is off at 0.
  double low_pass_s = 0.0;    ///< time constant
  double tool_mass_kg = 0.0;  ///< before the sensor: it reads what this mass' inertia takes
  double resonance_Hz = 0.0;
  SensorChannel raw;    ///< the rest of the channel before the low-pass
  Reference reference;  ///< 0 until it begins; never, and without keys, if that is infinite

  void bind(Fields& fields);
  /// The channels "force", behind the low-pass, and "force_raw", before it. `contact_force_N` is
  /// the force of the contact.
  std::array<SensorChannel, 2> channels(const double* contact_force_N) const;
};

/// The settings of one axis.
struct AxisSettings {
  AxisSettings(Axis which, const Catalogue& catalogue) : axis(std::move(which)), drive(catalogue) {}

  Axis axis;

  double start_position = 0.0;  ///< distance of the start from the model's pose
  double start_velocity = 0.0;
  Reference reference;  ///< reference of the position
  Disturbance force;    ///< d, which opposes the drive (Eqs. 2.5, 2.36); that of `disturbance`
  /// d_o, added to the measurement (Eq. 2.37); begins with d.
  Disturbance output = {.kind = DisturbanceKind::step};

  double viscous_friction = -1.0;  ///< friction of the plant; negative: that of the model file
  double coulomb_friction = -1.0;
  NominalFrom nominal_from = NominalFrom::keys;

  double drive_limit = 0.0;       ///< 0: that of the model file, if any
  double drive_resolution = 0.0;  ///< step of the PWM; 0: not quantised
  DriveSettings drive;            ///< friction law and motor

  EncoderCounts counts;          ///< no bits: not quantised
  double counts_per_turn = 0.0;  ///< in place of `counts`, unless it is 0
  Encoder encoder;               ///< its quantum is that of `counts` where the axis counts pulses
  bool has_noise = true;         ///< false: neither of the next two
  double noise_std = 0.0;        ///< noise of the measurement
  double input_noise_std = 0.0;  ///< that of a random force, drawn at each control sample
  int delay_samples = 0;
  TransmissionSettings transmission;
  /// A joint of a URDF: the keys of its transmission, which count for the motor. All else, its
  /// command and its encoder too, is at the joint for every ratio.
  std::optional<TransmissionSettings> of_motor;

  DisturbanceSettings disturbance;
  bool has_disturbance_keys = true;  ///< false: the scenario gives d by keys of its own
  std::string reference_file;
  /// A controller has its reference, so that the end of a hold is judged.
  bool is_controlled = false;
  // From the model.
  TwoInertia model_numbers;
  double model_limit = std::numeric_limits<double>::infinity();

  /// The keys axis.NAME.…, or those of the only axis of a plant.
  void bind(Fields& fields);

  /// The joint of the side with the encoder.
  std::string measured_joint() const { return transmission.measured_joint(axis.joint); }
  double measurement_noise() const { return has_noise ? noise_std : 0.0; }
  double input_noise() const { return has_noise ? input_noise_std : 0.0; }
  double quantum() const;                ///< Δ of the encoder; 0: not quantised
  double pulses_per_revolution() const;  ///< b_reso, or counts per metre; 0: not quantised
  double force_limit() const;            ///< limit of the drive; infinity: none

 private:
  void bind_nominal(Fields& fields);
  void bind_parts(Fields& fields);
  void bind_nominal_from(Fields& fields);
};

/// The settings of a plant with axes.
struct AxisPlant {
  explicit AxisPlant(const Catalogue& catalogue) : catalogue_(&catalogue) {}

  ModelFile mjcf;
  std::string urdf;
  /// The chain of model.urdf, if the file has that key. Each of its joints is an axis with a
  /// nominal model by keys. The chain is the nominal kinematics of the tip.
  std::shared_ptr<const PlanarChain> chain;
  PhysicsSettings physics;
  TimingSettings timing;  ///< timing of the commands
  RunSettings run;
  FaultSettings faults;
  double inertia_ratio = 1.0;      ///< ratio of the plant's inertia to that of its model file
  bool knows_disturbances = true;  ///< the axes' disturbances, and friction as a part of them
  double judged_to_s = 0.0;        ///< end of the metrics' windows: a shorter run has no metrics
  double fine_from_s = 0.0;        ///< window of the track at the physics rate, if there is one
  double fine_to_s = 0.0;
  bool senses_true_state = false;  ///< samples also have the true positions and velocities
  /// The keyframe of the start pose; kNone: the pose of the model's joints.
  std::string keyframe = Axis::kNone;
  std::vector<AxisSettings> axes;
  // A plant with named axes has keys for these.
  std::vector<PushSettings> pushes;
  std::vector<ContactSettings> contacts;
  std::optional<TipSettings> tip;

  /// Takes the names of axes, pushes and contacts from the tables of a file. The joints of a URDF
  /// are axes too. Takes the kind of each axis from its joint, and finds whether there is a tip.
  /// The axes have the order of their joints in the model. Throws std::invalid_argument `ORIGIN:
  /// KEY: reason`.
  void learn(const Config& config);

  /// The first axis.
  AxisSettings& axis() { return axes.front(); }
  const AxisSettings& axis() const { return axes.front(); }

  /// The keys of a plant with named axes, or of one axis without a name.
  void bind(Fields& fields);

  /// The keys record.fine_….
  void bind_fine(Fields& fields);

  /// Checks what the single fields cannot: the names in the model file, periods. Completes the
  /// settings. Throws std::invalid_argument `ORIGIN: KEY: reason`.
  void check(const Config& config);

  /// The nominal model of an axis, for the estimator and the controller.
  NominalAxis nominal(std::size_t i = 0) const;
  /// A line for each axis whose nominal model of one inertia has no motor of its own, and one for
  /// the actuators that motors replace.
  std::vector<std::string> warnings() const;

  /// The plant's model, with its physics, friction and limits. Throws std::invalid_argument if
  /// the file lacks something.
  Model load_model() const { return load_model(nullptr); }
  /// The model that controllers know: that of the file without the keys plant.…. The keys
  /// nominal.… of an axis set its joint's inertia, with all other joints held at the pose, and its
  /// viscous friction. Throws std::invalid_argument if they give no positive definite mass matrix.
  Model nominal_model() const;
  /// Coulomb friction of an axis and its motor, as a force of the drive. Throws as load_model().
  double coulomb_friction_at_drive(std::size_t i) const;
  /// The references of all axes at the start.
  Eigen::VectorXd reference_at_start() const;
  /// The pose of all joints that the keyframe gives. Throws std::invalid_argument if there is none.
  std::vector<double> pose(const Model& model) const;
  /// The same with the axes' distances of the start.
  std::vector<double> start_pose(const Model& model) const;
  /// The measured positions of all axes; then, with senses_true_state, all true positions and all
  /// true velocities. With a tip, its force behind the low-pass and before it follow.
  /// `contact_force_N`, which the run computes, is that of the tip's contact.
  SensingSetup sensing(const double* contact_force_N) const;

 private:
  Model load_model(const Config* config) const;  // checks the names of the keys, if it is there
  Model model_of_file() const;  // load_model() without the keys plant.… and the tool
  void check_names(const Model& model, const Config& config) const;
  void check_contacts(const Model& model, const Config& config) const;
  void check_tip(const Model& model, const Config& config) const;

  const Catalogue* catalogue_;
};

}  // namespace breakwater
