#include <breakwater/rigs/arm_rig.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>
#include <utility>

#include <breakwater/observers/stacked_estimator.h>
#include <breakwater/plants/damped_inertia.h>
#include <breakwater/sim/joint_friction.h>

namespace breakwater {
namespace {

Eigen::VectorXd to_eigen(const std::vector<double>& values) {
  return Eigen::Map<const Eigen::VectorXd>(values.data(), static_cast<Eigen::Index>(values.size()));
}

double quantum_rad(const ArmSettings& settings) {
  const double counts = settings.encoder_counts_per_turn;
  return counts > 0.0 ? 2.0 * std::numbers::pi / counts : 0.0;
}

// A joint as its estimator models it: J_n q̈ = τ − d. The coupling with other joints is part of d.
NominalAxis nominal_joint(const ArmSettings& settings, const PlanarChain& chain, int joint) {
  const double inertia_kgm2 = settings.nominal_inertia_kgm2[static_cast<std::size_t>(joint)];
  return {
      .plant = damped_inertia(inertia_kgm2, 0.0),
      .period_s = settings.physics.control_period_s,
      .force_limit = chain.effort_limits_Nm()(joint),
      .sensor = {Eigen::VectorXd::Constant(1, quantum_rad(settings)),
                 Eigen::VectorXd::Constant(1, settings.angle_noise_rad), settings.encoder_rounding},
      .pulses_per_revolution = settings.encoder_counts_per_turn,
      .units = rotation_units(),
      .joint = joint,
      .joints = static_cast<int>(chain.joints())};
}

std::unique_ptr<DisturbanceEstimator> make_observer(const ArmSettings& settings,
                                                    const PlanarChain& chain) {
  std::vector<std::unique_ptr<DisturbanceEstimator>> joints;
  for (int i = 0; i < chain.joints(); ++i) {
    joints.push_back(settings.observer.make(nominal_joint(settings, chain, i)));
  }
  return std::make_unique<StackedEstimator>(std::move(joints));
}

AccelerationControlDesign acceleration_design(const ArmSettings& settings,
                                              const PlanarChain& chain) {
  AccelerationControlDesign design;
  design.nominal_inertia_kgm2 = to_eigen(settings.nominal_inertia_kgm2);
  design.torque_limit_Nm = chain.effort_limits_Nm();
  design.make_observer = [&settings, chain] { return make_observer(settings, chain); };
  design.feed = settings.observer_feed;
  design.period_s = settings.physics.control_period_s;
  return design;
}

ArmTask arm_task(const ArmSettings& settings, const ArmRole& role, const PlanarChain& chain) {
  ArmTask task;
  task.start_angles_rad = to_eigen(settings.start_angles_rad);
  task.start_pose = chain.tip_pose(task.start_angles_rad);
  task.force_control_from_s = role.force_control_from_s;
  task.force_reference_N = role.force_reference_N;
  task.convert_gain_N_m = role.convert_gain_N_m;
  task.force_lag_s = settings.force_sensor.low_pass_s;
  task.wall_x_m = role.wall_x_m;
  return task;
}

ArmSetup arm_setup(const ArmSettings& settings, const ArmRole& role, const PlanarChain& chain) {
  return {chain, acceleration_design(settings, chain), arm_task(settings, role, chain),
          settings.physics.control_period_s};
}

SensingSetup sensing_setup(const ArmSettings& settings, const PlanarChain& chain) {
  SensingSetup setup;
  for (Eigen::Index i = 0; i < chain.joints(); ++i) {
    Encoder encoder = {.quantum = quantum_rad(settings), .rounding = settings.encoder_rounding};
    settings.joint(i).scale.apply(encoder);
    const std::string& name = chain.joint(i).name;
    const TransmissionSettings& transmission = settings.joint(i).transmission;
    const std::string measured = transmission.measured_joint(name);
    const bool is_motor = measured != name;
    setup.channels.push_back({.name = "q" + std::to_string(i + 1),
                              .sensor = is_motor ? measured : name + "_pos",
                              .reading = is_motor ? Reading::joint_position : Reading::component,
                              .encoder = encoder,
                              .noise_std = settings.angle_noise_rad});
  }
  settings.force_sensor.add_channels(setup, {.sensor = "tip_force"});
  settings.faults.apply(setup);
  setup.seed = settings.run.seed;
  return setup;
}

constexpr double kFrictionOfModel = -1.0;
constexpr const char* kFriction = "plant.coulomb_friction_Nm";

double coulomb_Nm(const ArmSettings& settings, const Model& model, const PlanarChain& chain,
                  Eigen::Index joint) {
  const double friction_Nm = settings.joint(joint).friction_Nm;
  if (friction_Nm != kFrictionOfModel) return friction_Nm;
  return model->dof_frictionloss[model->jnt_dofadr[model.id(mjOBJ_JOINT, chain.joint(joint).name)]];
}

// Actuator i must drive joint i of the chain, with its limits.
void check_actuators(const Model& model, const PlanarChain& chain) {
  const std::string place = model.file() + ": ";
  if (model->nu != chain.joints()) {
    throw std::invalid_argument(place + "has " + std::to_string(model->nu) +
                                " actuators for the URDF's " + std::to_string(chain.joints()) +
                                " joints");
  }
  for (int i = 0; i < model->nu; ++i) {
    const std::string& name = chain.joint(i).name;
    const int joint = model.id(mjOBJ_JOINT, name);
    if (model->jnt_type[joint] != mjJNT_HINGE || model->actuator_trntype[i] != mjTRN_JOINT ||
        model->actuator_trnid[2 * i] != joint) {
      throw std::invalid_argument(place + "actuator " + std::to_string(i + 1) +
                                  " must drive the hinge \"" + name + "\"");
    }
    // The controllers limit their torque as in the URDF, and the plant as in the MJCF.
    const double effort = chain.joint(i).effort_limit_Nm;
    const mjtNum* range = model->actuator_ctrlrange + static_cast<std::ptrdiff_t>(2) * i;
    const bool has_its_limits = model->actuator_gear[static_cast<std::ptrdiff_t>(6) * i] == 1.0 &&
                                model->actuator_ctrllimited[i] != 0 &&
                                std::abs(range[0] + effort) <= 1e-9 * effort &&
                                std::abs(range[1] - effort) <= 1e-9 * effort;
    if (!has_its_limits) {
      throw std::invalid_argument(place + "actuator " + std::to_string(i + 1) +
                                  " must have gear 1 and the ctrlrange ±" + std::to_string(effort) +
                                  " N m of the URDF's \"" + name + "\"");
    }
  }
}

}  // namespace

TipPose start_pose(const ArmSettings& settings) {
  return load_planar_chain(settings.urdf).tip_pose(to_eigen(settings.start_angles_rad));
}

TransmissionSettings ArmJoint::at_joint() const {
  TransmissionSettings at_joint = transmission;
  const double ratio = std::exchange(at_joint.design.ratio, 1.0);
  at_joint.motor_inertia *= ratio * ratio;
  at_joint.motor_friction *= ratio * ratio;
  at_joint.design.error_per_turn *= ratio;
  return at_joint;
}

void ArmSettings::learn(const Config& config) {
  const auto file = config.text("model.urdf");
  if (!file) return;
  try {
    const PlanarChain chain = load_planar_chain(config.find_file_of("model.urdf", *file));
    joints.clear();
    for (int i = 0; i < chain.joints(); ++i) joints.emplace_back(chain.joint(i).name, *catalogue_);
  } catch (const std::invalid_argument&) {
    return;
  }
}

void ArmJoint::bind(Fields& fields) {
  const Fields::Under under(fields, prefix());
  const AxisUnits units = rotation_units();
  fields.number(kFriction, friction_Nm, between(kFrictionOfModel, 1e3),
                "Coulomb friction of the joint; -1: that of the model file [N m]");
  fields.standard(kFriction, {kFrictionOfModel});
  drive.bind(fields, units);
  scale.bind(fields, units);
  transmission.bind_plant(fields, units, "kgm2", "Nms_rad");
}

void ArmSettings::bind(Fields& fields) {
  bind_model(fields, mjcf);
  fields.file("model.urdf", urdf, "URDF file of the arm, the controllers' nominal model");
  physics.bind(fields);
  timing.bind(fields);
  run.bind(fields);
  fields.numbers("task.start_angles_rad", start_angles_rad, any(),
                 "q_0^ref, the start posture; its tip pose is X_0^ref [rad]");
  for (ArmJoint& joint : joints) joint.bind(fields);
  controller.bind(fields);
  fields.numbers("observer.nominal_inertia_kgm2", nominal_inertia_kgm2, positive(),
                 "diagonal of J_n: nominal inertia of each joint [kg m^2]");
  observer.bind(fields);
  bind_observer_feed(fields, observer_feed);
  fields.number("sensor.encoder_counts_per_turn", encoder_counts_per_turn, between(0, 1e12),
                "encoder counts per turn of each joint; 0: not quantised");
  bind_encoder_rounding(fields, encoder_rounding);
  fields.only_where({"encoder.rounding"}, "sensor.encoder_counts_per_turn is not 0",
                    [this] { return encoder_counts_per_turn != 0.0; });
  fields.number("sensor.angle_noise_rad", angle_noise_rad, not_negative(),
                "standard deviation of white noise on each angle sample [rad]");
  force_sensor.bind_noise(fields);
  faults.bind(fields, "q1, q2, ..., force, force_raw", run.duration_s);
}

void check_arm(const ArmSettings& settings, const ArmRole& role, const Config& config) {
  settings.physics.check(config, settings.run);
  settings.timing.check(config, settings.physics);
  const PlanarChain chain = load_planar_chain(settings.urdf);
  const auto one_per_joint = [&](const char* key, std::size_t size) {
    if (size != static_cast<std::size_t>(chain.joints())) {
      config.fail(key, "must have one entry for each of the URDF's " +
                           std::to_string(chain.joints()) + " joints");
    }
  };
  one_per_joint("task.start_angles_rad", settings.start_angles_rad.size());
  one_per_joint("observer.nominal_inertia_kgm2", settings.nominal_inertia_kgm2.size());

  for (const ArmJoint& joint : settings.joints) {
    if (joint.friction_Nm < 0.0 && joint.friction_Nm != kFrictionOfModel) {
      config.under(joint.prefix())
          .fail(kFriction, "must be -1 (the value of the model file) or not negative");
    }
  }
  for (int i = 0; i < chain.joints(); ++i) {
    settings.observer.check(config, nominal_joint(settings, chain, i));
  }
  settings.controller.check(config, arm_setup(settings, role, chain));
  const Model model = Model::load_physics(settings.mjcf, role.geoms);
  check_actuators(model, chain);
  for (int i = 0; i < chain.joints(); ++i) {
    const Config own = config.under(settings.joint(i).prefix());
    try {
      settings.joint(i).transmission.check_motor(model, chain.joint(i).name);
    } catch (const WrongKey& wrong) {
      own.fail(wrong.key(), wrong.what());
    }
    settings.joint(i).drive.check(own, coulomb_Nm(settings, model, chain, i));
  }
  const std::vector<SensorChannel> channels = sensing_setup(settings, chain).channels;
  settings.faults.check(config, channels);
  ArmRig rig(settings, role);  // throws if the model lacks something
}

void show_geoms(Model& model, const std::string& prefix, bool visible) {
  // MJCF draws the groups 0 to 2, and not 3 to 5.
  constexpr int kShown = 2;
  constexpr int kHidden = 5;
  for (const int geom : model.geoms_named(prefix)) {
    model.get()->geom_group[geom] = visible ? kShown : kHidden;
  }
}

ArmRig::ArmRig(const ArmSettings& settings, const ArmRole& role)
    : chain_(load_planar_chain(settings.urdf)),
      controller_(settings.controller.make(arm_setup(settings, role, chain_))),
      has_motors_(std::any_of(settings.joints.begin(), settings.joints.end(),
                              [](const auto& joint) { return joint.drive.electric().is_on(); })),
      q_(Eigen::VectorXd::Zero(chain_.joints())),
      dq_(q_),
      motor_q_(q_),
      transmitted_Nm_(q_),
      friction_Nm_(q_),
      current_A_(q_),
      tip_(TipPose::Zero()) {
  Model model = Model::load_physics(settings.mjcf, role.geoms);
  model.set_physics(settings.physics.timestep_s, settings.physics.integrator);
  positions_of_file_ = static_cast<std::size_t>(model->nq);
  author_friction(model);  // also of joints that are not the chain's
  std::vector<double> coulombs;
  for (Eigen::Index i = 0; i < chain_.joints(); ++i) {
    const std::string& name = chain_.joint(i).name;
    coulombs.push_back(coulomb_Nm(settings, model, chain_, i));
    set_coulomb_friction(model, model.id(mjOBJ_JOINT, name), coulombs.back());
    settings.joint(i).at_joint().author(model, name, static_cast<int>(i));
  }
  // The stability of each spring depends on the inertias of the whole model.
  for (Eigen::Index i = 0; i < chain_.joints(); ++i) {
    const std::string& name = chain_.joint(i).name;
    const TransmissionSettings transmission = settings.joint(i).at_joint();
    const bool is_elastic = transmission.is_elastic();
    transmissions_.push_back(is_elastic ? transmission.make(model, name) : nullptr);
    const int motor = model.id(mjOBJ_JOINT, is_elastic ? transmission.motor(name) : name);
    motors_.push_back(static_cast<std::size_t>(model->jnt_qposadr[motor]));
    std::unique_ptr<FrictionLaw> law =
        settings.joint(i).drive.make_friction(coulombs[static_cast<std::size_t>(i)]);
    if (!law) continue;
    const std::string rubs = transmission.friction_joint(name);
    frictions_.push_back(std::make_unique<JointFriction>(
        model, rubs, std::move(law), rubs == name ? transmissions_.back().get() : nullptr));
  }
  const double tool_kg = settings.force_sensor.tool_mass_kg;
  if (tool_kg > 0.0) model.add_mass("tip", tool_kg);
  if (role.prepare_model) role.prepare_model(model);
  if (role.make_contact) contact_ = role.make_contact(model);
  const int home = model.id(mjOBJ_KEY, "home");
  std::vector<double> qpos(model->key_qpos + static_cast<std::ptrdiff_t>(home) * model->nq,
                           model->key_qpos + static_cast<std::ptrdiff_t>(home + 1) * model->nq);
  if (role.starts_at_reference) {
    for (Eigen::Index i = 0; i < chain_.joints(); ++i) {
      const int joint = model.id(mjOBJ_JOINT, chain_.joint(i).name);
      const auto at = static_cast<std::size_t>(i);
      qpos[static_cast<std::size_t>(model->jnt_qposadr[joint])] = qpos[motors_[at]] =
          settings.start_angles_rad[at];
    }
  }
  simulation_ =
      std::make_unique<Simulation>(std::move(model), *controller_, sensing_setup(settings, chain_),
                                   settings.physics.steps_per_sample());
  const CommandDelays delays = settings.timing.delays();
  if (delays.is_on()) simulation_->set_timing(delays, settings.run.seed);
  for (int i = 0; has_motors_ && i < chain_.joints(); ++i) {
    simulation_->set_drive(i, settings.joint(i).drive.electric());
  }
  for (const auto& transmission : transmissions_) {
    if (transmission) simulation_->add(*transmission);
  }
  for (const auto& friction : frictions_) simulation_->add(*friction);
  simulation_->set_position(qpos);
  contact_force_ = &simulation_->sensor("tip_touch");
  force_sensor_ = &simulation_->sensor("tip_force");
  if (contact_) {
    simulation_->add(*contact_);
    contact_force_ = &contact_->force_N();
  }
  if (settings.force_sensor.has_body()) {
    force_sensor_ = &simulation_->sensing().filtered(static_cast<std::size_t>(chain_.joints()) + 1);
  }
  tip_speed_x_ = &simulation_->sensor("tip_vel");
  for (Eigen::Index i = 0; i < chain_.joints(); ++i) {
    q_sensors_.push_back(&simulation_->sensor(chain_.joint(i).name + "_pos"));
    dq_sensors_.push_back(&simulation_->sensor(chain_.joint(i).name + "_vel"));
  }
}

const double& ArmRig::filtered_force_N() const {
  return simulation_->sensing().filtered(static_cast<std::size_t>(chain_.joints()));
}

void ArmRig::set_solid(int wall, bool is_solid) {
  if (contact_) {
    contact_->set_solid(is_solid);
  } else {
    simulation_->set_collidable(wall, is_solid);
  }
}

void ArmRig::observe() {
  for (Eigen::Index i = 0; i < chain_.joints(); ++i) {
    const auto at = static_cast<std::size_t>(i);
    q_(i) = *q_sensors_[at];
    dq_(i) = *dq_sensors_[at];
    if (has_rotors()) {
      motor_q_(i) = simulation_->qpos()[motors_[at]];
      const Transmission* elastic = transmissions_[at].get();
      transmitted_Nm_(i) = elastic != nullptr ? elastic->torque(simulation_->qpos().data(),
                                                                simulation_->qvel().data())
                           : has_motors_      ? simulation_->drive_force()(i)
                                              : simulation_->actuation()(i);
    }
    if (!frictions_.empty()) friction_Nm_(i) = frictions_[at]->force();
    if (has_motors_) current_A_(i) = simulation_->motor(static_cast<int>(i)).current_A();
  }
  tip_ = chain_.tip_pose(q_);
  saturated_ = simulation_->saturated() ? 1.0 : 0.0;
}

std::vector<Signal> ArmRig::signals() const {
  const auto n = static_cast<std::size_t>(chain_.joints());
  const Simulation& sim = *simulation_;
  const std::span<const double> measured = view(sim.sample().y);
  std::vector<Signal> signals = {
      {"qpos", "rad", "the engine's generalised positions", sim.qpos().first(positions_of_file_)},
      {"q_true_rad", "rad", "true joint angles", view(q_)},
      {"dq_true_rad_s", "rad/s", "true joint velocities", view(dq_)},
      {"x_true_m", "m", "true x of the tip", view(tip_[0])},
      {"y_true_m", "m", "true y of the tip", view(tip_[1])},
      {"phi_true_rad", "rad", "true angle of the tip", view(tip_[2])},
      {"force_true_N", "N", "true normal contact force", view(*contact_force_)},
      {"q_measured_rad", "rad", "sampled joint angles", measured.first(n)},
      {"force_measured_N", "N", "sampled force behind the low-pass", measured.subspan(n, 1)},
      {"force_raw_measured_N", "N", "sampled force before the low-pass",
       measured.subspan(n + 1, 1)},
      {"torque_command_Nm", "N m", "commanded joint torques", view(sim.command())},
      {"torque_applied_Nm", "N m", "joint torques after saturation", view(sim.actuation())},
      {"saturated", "1", "1 where any torque is at its limit", view(saturated_)}};
  if (contact_) {
    signals.push_back({"wall_m", "m", "how far the wall has moved", view(contact_->wall_m())});
  }
  if (has_motors_) {
    signals.push_back({"current_A", "A", "currents of the motors", view(current_A_)});
    signals.push_back({"motor_Nm", "N m", "true torques of the motors", view(sim.drive_force())});
  }
  if (!frictions_.empty()) {
    signals.push_back({"friction_Nm", "N m", "dry friction of the joints", view(friction_Nm_)});
  }
  if (has_rotors()) {
    signals.push_back({"motor_q_true_rad", "rad",
                       "true angles of the motors over the ratios of their transmissions",
                       view(motor_q_)});
    signals.push_back({"transmission_Nm", "N m", "torques of the transmissions on the joints",
                       view(transmitted_Nm_)});
  }
  for (const Signal& signal : controller_->signals()) signals.push_back(signal);
  return signals;
}

std::vector<Signal> ArmRig::fine_signals() const {
  return {{"qpos", "rad", "the engine's generalised positions",
           simulation_->qpos().first(positions_of_file_)},
          {"force_true_N", "N", "true normal contact force", view(*contact_force_)},
          {"force_sensor_N", "N", "force sensor, before its low-pass", view(*force_sensor_)},
          {"force_filtered_N", "N", "force sensor, behind its low-pass", view(filtered_force_N())}};
}

}  // namespace breakwater
