// The keys of a plant of axes (motors, carts, machines): what the plant has, and what each axis
// has.
#pragma once

#include <string>
#include <vector>

#include <breakwater/control/step_reference.h>
#include <breakwater/experiment/settings.h>
#include <breakwater/linear/state_space.h>
#include <breakwater/rigs/axis_parts.h>
#include <breakwater/rigs/drive_settings.h>
#include <breakwater/rigs/transmission_settings.h>
#include <breakwater/world/disturbance.h>

namespace breakwater {

/// The names and units of an axis in its model.
struct Axis {
  std::string name;  ///< of its keys and signals; empty for a plant with one axis and without names
  std::string joint;
  std::string actuator;
  std::string position_sensor;  ///< empty: the joint itself
  std::string channel;          ///< name of the position's sensor channel
  bool counts_pulses;           ///< the key of its encoder is pulses per revolution
  std::string inertia_name;     ///< "inertia", "mass"
  std::string inertia_suffix;   ///< "kgm2"
  std::string friction_suffix;  ///< suffix of the viscous friction: "Nms_rad"
  AxisUnits units;

  /// Of its keys: "axis.NAME.", or "".
  std::string prefix() const { return name.empty() ? "" : "axis." + name + "."; }
  /// The name of its signal or channel `what`: "NAME.what", or "what".
  std::string own(const std::string& what) const { return name.empty() ? what : name + "." + what; }
};

/// The axes of models/motor.xml and models/cart.xml.
Axis motor_axis();
Axis cart_axis();

/// The settings of one axis.
struct AxisSettings {
  AxisSettings(Axis which, const Catalogue& catalogue) : axis(std::move(which)), drive(catalogue) {}

  Axis axis;

  // Not all scenarios have keys for these.
  double start_position = 0.0;  ///< distance of the start from the model's pose
  double start_velocity = 0.0;
  StepReference reference;  ///< reference of the position
  Disturbance force;        ///< d, which opposes the drive (Eqs. 2.5, 2.36)
  Disturbance output;       ///< d_o, added to the measurement (Eq. 2.37)

  double viscous_friction = 0.0;  ///< friction of the plant
  double coulomb_friction = 0.0;
  double nominal_inertia = 0.0;  ///< for the controller and the observer
  double nominal_friction = 0.0;

  double drive_limit = 0.0;       ///< 0: none
  double drive_resolution = 0.0;  ///< step of the PWM; 0: not quantised
  DriveSettings drive;            ///< friction law and motor

  int encoder_bits = 0;  ///< 0: not quantised
  double encoder_multiplication = 1.0;
  double encoder_gear_ratio = 1.0;
  double encoder_resolution = 0.0;  ///< one count, in place of pulses; 0: not quantised
  double encoder_phase = 0.0;
  EncoderOrigin encoder_origin = EncoderOrigin::counted;
  EncoderRounding encoder_rounding = EncoderRounding::nearest;
  ScaleSettings scale;     ///< errors of the encoder's scale
  double noise_std = 0.0;  ///< noise of the measurement
  double input_noise_std =
      0.0;  ///< standard deviation of a random force that is drawn at each control sample
  int delay_samples = 0;
  TransmissionSettings transmission;

  /// The keys begin with axis.prefix().
  void bind(Fields& fields);

  Encoder encoder() const;
  double quantum() const;                ///< Δ of the encoder; 0: not quantised
  double pulses_per_revolution() const;  ///< b_reso, or counts per metre; 0: not quantised
  double force_limit() const;            ///< limit of the drive; infinity: none
};

/// The settings of a plant with axes.
struct AxisPlant {
  /// A plant with one axis, and keys without a prefix.
  AxisPlant(const Axis& only, const Catalogue& catalogue) : axes{AxisSettings(only, catalogue)} {}

  ModelFile mjcf;
  PhysicsSettings physics;
  TimingSettings timing;  ///< of the commands
  RunSettings run;
  FaultSettings faults;
  double inertia_ratio = 1.0;      ///< ratio of the plant's inertia to that of its model file
  double judged_to_s = 0.0;        ///< end of the metrics' windows: a shorter run has no metrics
  bool senses_true_state = false;  ///< samples also have the true positions and velocities
  std::vector<AxisSettings> axes;

  /// The first axis.
  AxisSettings& axis() { return axes.front(); }
  const AxisSettings& axis() const { return axes.front(); }

  void bind(Fields& fields);

  /// The nominal model of an axis, for the estimator and the controller.
  NominalAxis nominal(std::size_t axis = 0) const;

  /// The plant's model, with its physics, friction and limits. Throws std::invalid_argument if
  /// the file lacks something.
  Model load_model() const;
  /// The measured positions of all axes; then, with senses_true_state, all true positions and all
  /// true velocities.
  SensingSetup sensing() const;
};

/// Checks what the single fields cannot: the names in the model file, periods. Throws
/// std::invalid_argument `ORIGIN: KEY: reason`.
void check_plant(const AxisPlant& plant, const Config& config);

/// The linear part of the first axis, continuous: its inertia and its viscous friction, or both
/// inertias of its transmission.
StateSpace linear_axis(const AxisPlant& plant);

}  // namespace breakwater
