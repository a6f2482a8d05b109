// The keys of a real drive: transmission, friction, motor, timing, encoder scale. All are off by
// default. The nominal model.
#pragma once

#include <Eigen/Core>
#include <memory>
#include <string>
#include <vector>

#include <breakwater/config/fields.h>
#include <breakwater/experiment/parts.h>
#include <breakwater/experiment/settings.h>
#include <breakwater/rigs/axis_parts.h>
#include <breakwater/signals/axis_units.h>
#include <breakwater/sim/transmission.h>
#include <breakwater/world/command_timing.h>
#include <breakwater/world/encoder.h>
#include <breakwater/world/friction_law.h>
#include <breakwater/world/motor_drive.h>

namespace breakwater {

/// A friction law by its name: key friction.law. It is given F_C, the joint's Coulomb friction.
/// Null: the engine's own Coulomb friction.
struct FrictionKind : PartKind<FrictionLaw, double> {
  using PartKind::PartKind;
  static constexpr const char* kWhat = "friction law";
};

/// Breakwater's own.
std::vector<FrictionKind> friction_laws();

/// Friction law and motor of a joint: keys friction.… and drive.…
struct DriveSettings {
  explicit DriveSettings(const Catalogue& catalogue)
      : friction(catalogue, "friction.law", "coulomb") {}

  PartChoice<FrictionKind> friction;  ///< makes null for the engine's Coulomb friction
  ElectricDrive electric;

  void bind(Fields& fields, const AxisUnits& units);
  /// Throws std::invalid_argument `ORIGIN: KEY: reason` if friction or motor is wrong. `coulomb` is
  /// the joint's Coulomb friction.
  void check(const Config& config, double coulomb) const;
};

/// Binds a sine of the position: its amplitude STEM_SUFFIX, and its periods per turn or metre.
void bind_sine(Fields& fields, const std::string& stem, const std::string& amplitude_suffix,
               PositionSine& sine, const AxisUnits& units, const std::string& doc);

/// When commands reach the drives: keys control.…
class TimingSettings {
 public:
  void bind(Fields& fields);
  /// Throws std::invalid_argument `ORIGIN: KEY: reason` if the file or a delay is wrong.
  void check(const Config& config, const PhysicsSettings& physics) const;
  /// With the values of the file.
  CommandDelays delays() const;

 private:
  bool has_file_ = false;
  CommandDelays delays_;  // without the file
  std::string file_;
};

enum class NominalModel { rigid, motor, spring };

/// The source of an axis' nominal numbers.
enum class NominalFrom {
  keys,
  model  ///< the model and the keys transmission.…, with all other joints held
};

/// The transmission from a motor's joint to the axis' joint, which is the load. Without a stiffness
/// the transmission is rigid, and the motor has no joint of its own. With a stiffness the motor's
/// joint is that of the model, or a rotor that author() adds. The nominal model has the
/// transmission's true ratio.
struct TransmissionSettings {
  TransmissionDesign design;
  std::string motor_joint;     ///< empty: the model has none
  double motor_inertia = 0.0;  ///< 0: that of the motor's joint, if the model has one
  double motor_friction = 0.0;
  double motor_coulomb = 0.0;
  Side friction_side = Side::load;  ///< the side of the dry friction
  Side measured = Side::load;       ///< the side of the encoder

  NominalModel nominal_model = NominalModel::rigid;
  TwoInertia nominal;  ///< the load's values are keys of the axis; AxisPlant sets the true ratio

  /// The keys of the plant: `transmission.…`, `friction.side` and `encoder.side`.
  void bind_plant(Fields& fields, const AxisUnits& units);
  /// All keys: those of the plant, `transmission.motor_joint` and `nominal.…`. All have a default
  /// value.
  void bind(Fields& fields, const AxisUnits& units);

  bool is_elastic() const { return design.stiffness > 0.0; }
  bool adds_rotor() const { return is_elastic() && motor_joint.empty(); }
  /// The motor's joint of an elastic transmission.
  std::string motor(const std::string& load) const {
    return motor_joint.empty() ? load + ".motor" : motor_joint;
  }
  /// The joint of the side with the encoder.
  std::string measured_joint(const std::string& load) const {
    return is_elastic() && measured == Side::motor ? motor(load) : load;
  }
  /// The joint with the dry friction.
  std::string friction_joint(const std::string& load) const {
    return is_elastic() && friction_side == Side::motor ? motor(load) : load;
  }
  /// The inertia of the rotor that author() adds: the motor's, and the armature of the joint `load`
  /// over the ratio squared. A model file has the motor's inertia as an armature.
  double rotor_inertia(const Model& model, const std::string& load) const;
  /// Throws std::invalid_argument if the motor of an elastic transmission has neither a joint in
  /// the model of the file nor an inertia.
  void check_motor(const Model& model, const std::string& load) const;
  /// Motion of the measured side for one of the load at rest.
  double measured_ratio() const { return measured == Side::motor ? design.ratio : 1.0; }

  /// Adds the motor's rotor, if the model has no joint for it, and sets the motor's inertia. The
  /// motor's friction is added to that of its joint in the model. Dry friction of the motor's side
  /// is taken from the joint `load`. Without a stiffness, sets the gear of the actuator at this
  /// joint.
  void author(Model& model, const std::string& load, int actuator) const;
  /// The coupling of the joints of an elastic transmission. Throws std::invalid_argument if the
  /// integrator is not stable on its spring.
  std::unique_ptr<Transmission> make(const Model& model, const std::string& load) const;
  /// The numbers of the plant at a pose with the joints' inertia M. The load of a rigid
  /// transmission includes its motor.
  TwoInertia true_numbers(const Model& model, const Eigen::MatrixXd& M,
                          const std::string& load) const;
  /// The design without backlash and kinematic error, and from keys with the nominal spring.
  TransmissionDesign linear_design(NominalFrom from) const;
  /// The linear part of the plant, without backlash and kinematic error.
  StateSpace linear(const TwoInertia& numbers) const;

  /// Sets the plant in an axis' nominal model. Throws a WrongKey if a key is missing or contradicts
  /// another.
  void describe(NominalAxis& axis, const TwoInertia& numbers, NominalFrom from) const;

 private:
  std::string motor_inertia_key_;  // without "transmission." or "nominal."
};

}  // namespace breakwater
