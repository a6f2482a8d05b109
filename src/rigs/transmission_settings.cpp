#include <breakwater/rigs/transmission_settings.h>

#include <breakwater/plants/damped_inertia.h>
#include <breakwater/sim/friction.h>
#include <breakwater/sim/linear_model.h>

namespace breakwater {

void TransmissionSettings::bind(Fields& fields, const AxisUnits& u,
                                const std::string& inertia_suffix,
                                const std::string& friction_suffix) {
  const auto number = [&fields](const std::string& key, double& target, const Range& range,
                                const std::string& doc) {
    fields.number(key, target, range, doc);
    fields.standard(key, {target});
  };
  const std::string stiffness = "_" + u.force_suffix + "_" + u.position_suffix;
  const std::string position = "_" + u.position_suffix, friction = "_" + friction_suffix;
  const std::string torque_per = u.force + " per ";
  number("transmission.ratio", design.ratio, positive(),
         "N: motion of the motor for one of the load");
  number("transmission.stiffness" + stiffness, design.stiffness, not_negative(),
         "K: stiffness between motor and load, at the load; 0: rigid [" + torque_per + u.position +
             "]");
  number("transmission.damping" + friction, design.damping, not_negative(),
         "damping of this spring [" + torque_per + u.velocity + "]");
  number("transmission.backlash" + position, design.backlash, not_negative(),
         "b: play of the load while the motor stands [" + u.position + "]");
  number("transmission.kinematic_error" + position, design.kinematic_error, any(),
         "amplitude of the transmission's error, at the load [" + u.position + "]");
  number("transmission.kinematic_error_per_turn", design.error_per_turn, any(),
         "periods of this error in a turn of the motor");
  number("transmission.motor_inertia_" + inertia_suffix, motor_inertia, not_negative(),
         "inertia of the motor of a rigid transmission; 0: that of the model file");
  number("transmission.motor_viscous_friction" + friction, motor_friction, not_negative(),
         "viscous friction of the motor [" + torque_per + u.velocity + "]");
  fields.text("transmission.motor_joint", motor_joint,
              "joint of the motor in the model, for a transmission with a stiffness");
  fields.standard("transmission.motor_joint", {std::string()});
  fields.choice("encoder.side", measured, {{"load", Side::load}, {"motor", Side::motor}},
                "side of the transmission with the encoder");
  fields.standard("encoder.side", {std::string("load")});
  fields.choice("nominal.model", nominal_model,
                {{"rigid", NominalModel::rigid},
                 {"motor", NominalModel::motor},
                 {"spring", NominalModel::spring}},
                "model of controller and observer: motor and load as one inertia, the motor alone, "
                "or both with the spring");
  fields.standard("nominal.model", {std::string("rigid")});
  number("nominal.motor_inertia_" + inertia_suffix, nominal_motor_inertia, not_negative(),
         "nominal inertia of the motor");
  number("nominal.stiffness" + stiffness, nominal_stiffness, not_negative(),
         "nominal stiffness of the transmission [" + torque_per + u.position + "]");
  number("nominal.damping" + friction, nominal_damping, not_negative(),
         "nominal damping of the transmission [" + torque_per + u.velocity + "]");
  number("nominal.motor_viscous_friction" + friction, nominal_motor_friction, not_negative(),
         "nominal viscous friction of the motor [" + torque_per + u.velocity + "]");

  const auto only = [&](std::vector<std::string> keys, const std::string& when, auto holds) {
    fields.only_where(keys, when, holds);
  };
  const std::string elastic = "transmission.stiffness" + stiffness + " is not 0";
  only({"transmission.damping" + friction, "transmission.backlash" + position,
        "transmission.kinematic_error" + position, "transmission.kinematic_error_per_turn",
        "transmission.motor_joint", "transmission.motor_viscous_friction" + friction,
        "encoder.side"},
       elastic, [this] { return is_elastic(); });
  only({"transmission.motor_inertia_" + inertia_suffix},
       "transmission.stiffness" + stiffness + " is 0", [this] { return !is_elastic(); });
}

void TransmissionSettings::author(Model& model, const std::string& load,
                                  const std::string& actuator) const {
  if (is_elastic()) {
    author_friction(model, model.id(mjOBJ_JOINT, motor_joint), motor_friction, 0.0);
    return;
  }
  if (design.ratio == 1.0 && motor_inertia == 0.0) return;
  model.add_gear(model.id(mjOBJ_ACTUATOR, actuator), model.id(mjOBJ_JOINT, load), design.ratio,
                 motor_inertia);
}

std::unique_ptr<Transmission> TransmissionSettings::make(const Model& model,
                                                         const std::string& load) const {
  return std::make_unique<Transmission>(model, motor_joint, load, design);
}

StateSpace TransmissionSettings::linear(const Model& model, std::span<const double> pose,
                                        const std::string& load) const {
  const Eigen::MatrixXd M = joint_inertia(model, pose);
  const auto dof = [&](const std::string& joint) {
    return model->jnt_dofadr[model.id(mjOBJ_JOINT, joint)];
  };
  const auto inertia = [&](const std::string& joint) { return M(dof(joint), dof(joint)); };
  const double load_friction = model->dof_damping[dof(load)];
  if (!is_elastic()) {
    StateSpace plant = damped_inertia(inertia(load), load_friction);
    plant.B *= design.ratio;
    return plant;
  }
  return motor_and_load({.motor_inertia = inertia(motor_joint),
                         .load_inertia = inertia(load),
                         .stiffness = design.stiffness,
                         .damping = design.damping,
                         .motor_friction = motor_friction,
                         .load_friction = load_friction,
                         .ratio = design.ratio},
                        measured);
}

void TransmissionSettings::describe(NominalAxis& axis, double load_inertia,
                                    double load_friction) const {
  if (is_elastic() && motor_joint.empty()) {
    throw WrongKey("transmission.motor_joint",
                   "a transmission with a stiffness needs the motor's joint in the model");
  }
  if (measured == Side::motor && !is_elastic() && design.ratio != 1.0) {
    throw WrongKey("encoder.side",
                   "motor needs a transmission with a stiffness: see encoder.gear_ratio for a "
                   "rigid one");
  }
  const double N = design.ratio;
  axis.measured = measured;
  axis.measured_ratio = measured_ratio();
  if (nominal_stiffness > 0.0 && nominal_motor_inertia > 0.0) {
    axis.inertias = TwoInertia{.motor_inertia = nominal_motor_inertia,
                               .load_inertia = load_inertia,
                               .stiffness = nominal_stiffness,
                               .damping = nominal_damping,
                               .motor_friction = nominal_motor_friction,
                               .load_friction = load_friction,
                               .ratio = N};
  }
  switch (nominal_model) {
    case NominalModel::rigid: {
      const double scale = axis.measured_ratio * axis.measured_ratio;
      axis.plant = damped_inertia((load_inertia + N * N * nominal_motor_inertia) / scale,
                                  (load_friction + N * N * nominal_motor_friction) / scale);
      axis.plant.B *= N / axis.measured_ratio;
      return;
    }
    case NominalModel::motor:
      if (measured != Side::motor || !(nominal_motor_inertia > 0.0)) {
        throw WrongKey("nominal.model",
                       "motor needs encoder.side = \"motor\" and the motor's nominal inertia");
      }
      axis.plant = damped_inertia(nominal_motor_inertia, nominal_motor_friction);
      return;
    case NominalModel::spring:
      if (!axis.inertias) {
        throw WrongKey("nominal.model", "spring needs a nominal stiffness and motor's inertia");
      }
      axis.plant = motor_and_load(*axis.inertias, measured);
      axis.E = load_torque_input(*axis.inertias, measured);
      axis.controlled = measured == Side::load ? 0 : 2;
      axis.inertia = (load_inertia + N * N * nominal_motor_inertia) / axis.measured_ratio;
      return;
  }
}

}  // namespace breakwater
