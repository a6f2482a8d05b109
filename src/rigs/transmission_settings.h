// The keys of an axis' transmission, and of its nominal model.
#pragma once

#include <memory>
#include <span>
#include <string>

#include <breakwater/config/fields.h>
#include <breakwater/rigs/axis_parts.h>
#include <breakwater/sim/transmission.h>

namespace breakwater {

enum class NominalModel { rigid, motor, spring };

/// The transmission from a motor's joint to the axis' joint, which is the load. Without a stiffness
/// the transmission is rigid, and the motor has no joint of its own. The nominal model has the
/// transmission's true ratio.
struct TransmissionSettings {
  TransmissionDesign design;
  std::string motor_joint;
  double motor_inertia = 0.0;  ///< inertia of a rigid transmission's motor
  double motor_friction = 0.0;
  Side measured = Side::load;  ///< the side of the encoder

  NominalModel nominal_model = NominalModel::rigid;
  double nominal_motor_inertia = 0.0;
  double nominal_stiffness = 0.0;
  double nominal_damping = 0.0;
  double nominal_motor_friction = 0.0;

  /// Keys `transmission.…`, `encoder.side` and `nominal.…`, all with a default value.
  void bind(Fields& fields, const AxisUnits& units, const std::string& inertia_suffix,
            const std::string& friction_suffix);

  bool is_elastic() const { return design.stiffness > 0.0; }
  /// Motion of the measured side for one of the load at rest.
  double measured_ratio() const { return measured == Side::motor ? design.ratio : 1.0; }

  /// Sets the motor's friction or, without a stiffness, the gear of the actuator at the joint
  /// `load`.
  void author(Model& model, const std::string& load, const std::string& actuator) const;
  /// The coupling of the joints of an elastic transmission.
  std::unique_ptr<Transmission> make(const Model& model, const std::string& load) const;
  /// The linear part of the plant at a pose, without backlash and kinematic error.
  StateSpace linear(const Model& model, std::span<const double> pose,
                    const std::string& load) const;

  /// Sets the plant in an axis' nominal model, from the load's nominal numbers. Throws a WrongKey
  /// if a key is missing or contradicts another.
  void describe(NominalAxis& axis, double load_inertia, double load_friction) const;
};

}  // namespace breakwater
