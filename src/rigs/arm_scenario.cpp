#include <breakwater/rigs/arm_scenario.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>
#include <utility>

#include <breakwater/observers/stacked_estimator.h>

namespace breakwater {
namespace {

constexpr double kFrictionOfModel = -1.0;
constexpr const char* kFriction = "plant.coulomb_friction_Nm";
constexpr const char* kHome = "home";
constexpr const char* kForceSensor = "tip_force";

Eigen::VectorXd to_eigen(const std::vector<double>& values) {
  return Eigen::Map<const Eigen::VectorXd>(values.data(), static_cast<Eigen::Index>(values.size()));
}

AxisSettings arm_joint(const std::string& name, std::size_t i, const Catalogue& catalogue) {
  Axis axis = named_axis(name, name, "", true);
  axis.channel = "q" + std::to_string(i + 1);
  axis.counts_pulses = false;
  return {std::move(axis), catalogue};
}

void bind_joint(Fields& fields, AxisSettings& joint, TransmissionSettings& transmission) {
  const Fields::Under under(fields, joint.axis.prefix());
  const Axis& axis = joint.axis;
  fields.optional_number(kFriction, joint.coulomb_friction, between(kFrictionOfModel, 1e3),
                         "Coulomb friction of the joint; -1: that of the model file [N m]");
  joint.drive.bind(fields, axis.units);
  bind_scale(fields, joint.encoder, axis.units);
  transmission.bind_plant(fields, axis.units);
}

// The transmission with the motor's angle over the ratio in place of its angle. The command and the
// encoder are then those of the joint for every ratio.
TransmissionSettings at_joint(TransmissionSettings transmission) {
  const double ratio = std::exchange(transmission.design.ratio, 1.0);
  transmission.motor_inertia *= ratio * ratio;
  transmission.motor_friction *= ratio * ratio;
  transmission.design.error_per_turn *= ratio;
  return transmission;
}

// Actuator i must drive joint i of the chain, with its limits. The controllers limit their torque
// as in the URDF, and the plant as in the MJCF.
void check_actuators(const Model& model, const PlanarChain& chain) {
  const auto refuse = [&](const std::string& reason) {
    throw std::invalid_argument(model.file() + ": " + reason);
  };
  if (model->nu != chain.joints()) {
    refuse("has " + std::to_string(model->nu) + " actuators for the URDF's " +
           std::to_string(chain.joints()) + " joints");
  }
  for (int i = 0; i < model->nu; ++i) {
    const std::string actuator = "actuator " + std::to_string(i + 1);
    const std::string& name = chain.joint(i).name;
    const int joint = model.id(mjOBJ_JOINT, name);
    if (model->jnt_type[joint] != mjJNT_HINGE || model->actuator_trntype[i] != mjTRN_JOINT ||
        model->actuator_trnid[2 * i] != joint) {
      refuse(actuator + " must drive the hinge \"" + name + "\"");
    }
    const double effort = chain.effort_limits_Nm()(i);
    const mjtNum* range = model->actuator_ctrlrange + static_cast<std::ptrdiff_t>(2) * i;
    const bool has_its_limits = model->actuator_gear[static_cast<std::ptrdiff_t>(6) * i] == 1.0 &&
                                model->actuator_ctrllimited[i] != 0 &&
                                std::abs(range[0] + effort) <= 1e-9 * effort &&
                                std::abs(range[1] - effort) <= 1e-9 * effort;
    if (!has_its_limits) {
      refuse(actuator + " must have gear 1 and the ctrlrange ±" + std::to_string(effort) +
             " N m of the URDF's \"" + name + "\"");
    }
    if (mj_id2name(model.get(), mjOBJ_ACTUATOR, i) == nullptr) refuse(actuator + " needs a name");
  }
}

}  // namespace

void show_geoms(Model& model, const std::string& prefix, bool visible) {
  // MJCF draws the groups 0 to 2, and not 3 to 5.
  constexpr int kShown = 2;
  constexpr int kHidden = 5;
  for (const int geom : model.geoms_named(prefix)) {
    model.get()->geom_group[geom] = visible ? kShown : kHidden;
  }
}

ArmScenario::ArmScenario(const Catalogue& catalogue, MetricRows rows, bool starts_at_reference)
    : Scenario(std::move(rows)),
      plant_(catalogue),
      catalogue_(&catalogue),
      starts_at_reference_(starts_at_reference),
      transmissions_(1),
      controller_(catalogue, "controller.name"),
      observer_(catalogue, "observer.name", "idob") {
  plant_.axes.push_back(arm_joint("joint1", 0, catalogue));
  plant_.keyframe = kHome;
  plant_.tip.emplace().sensor = kForceSensor;
  plant_.tip->touch = "tip_touch";
}

// A file that is missing or wrong is left to the reading of the keys and the check.
void ArmScenario::learn(const Config& config) {
  Scenario::learn(config);
  const auto file = config.text("model.urdf");
  if (!file) return;
  try {
    chain_ = load_planar_chain(config.find_file_of("model.urdf", *file));
  } catch (const std::invalid_argument&) {
    return;
  }
  plant_.axes.clear();
  for (Eigen::Index i = 0; i < chain().joints(); ++i) {
    plant_.axes.push_back(arm_joint(chain().joint(i).name, plant_.axes.size(), *catalogue_));
  }
  transmissions_.resize(plant_.axes.size());
}

void ArmScenario::bind(Fields& fields) {
  bind_model(fields, plant_.mjcf);
  fields.file("model.urdf", urdf_, "URDF file of the arm, the controllers' nominal model");
  plant_.physics.bind(fields);
  plant_.timing.bind(fields);
  plant_.run.bind(fields);
  fields.numbers("task.start_angles_rad", start_angles_rad_, any(),
                 "q_0^ref, the start posture; its tip pose is X_0^ref [rad]");
  for (std::size_t i = 0; i < plant_.axes.size(); ++i) {
    bind_joint(fields, plant_.axes[i], transmissions_[i]);
  }
  controller_.bind(fields);
  fields.numbers("observer.nominal_inertia_kgm2", nominal_inertia_kgm2_, positive(),
                 "diagonal of J_n: nominal inertia of each joint [kg m^2]");
  observer_.bind(fields);
  bind_observer_feed(fields, observer_feed_);
  fields.number("sensor.encoder_counts_per_turn", encoder_counts_per_turn_, between(0, 1e12),
                "encoder counts per turn of each joint; 0: not quantised");
  AxisSettings& first = plant_.axes.front();
  bind_encoder_rounding(fields, first.encoder.rounding);
  fields.only_where({"encoder.rounding"}, "sensor.encoder_counts_per_turn is not 0",
                    [this] { return encoder_counts_per_turn_ != 0.0; });
  fields.number("sensor.angle_noise_rad", first.noise_std, not_negative(),
                "standard deviation of white noise on each angle sample [rad]");
  plant_.tip->chain.bind_noise(fields);
  plant_.faults.bind(fields, "q1, q2, ..., force, force_raw", plant_.run.duration_s);
}

void ArmScenario::check_arm(const Config& config) {
  if (!chain_) chain_ = load_planar_chain(urdf_);
  const auto one_per_joint = [&](const char* key, std::size_t size) {
    if (size != static_cast<std::size_t>(chain().joints())) {
      config.fail(key, "must have one entry for each of the URDF's " +
                           std::to_string(chain().joints()) + " joints");
    }
  };
  one_per_joint("task.start_angles_rad", start_angles_rad_.size());
  one_per_joint("observer.nominal_inertia_kgm2", nominal_inertia_kgm2_.size());
  // A wrong model has errors about the model, not about keys that an arm does not have.
  const Model model = Model::load_physics(plant_.mjcf);
  check_actuators(model, chain());
  model.id(mjOBJ_KEY, kHome);
  model.id(mjOBJ_SENSOR, kForceSensor);
  const std::vector<double> home = plant_.pose(model);
  for (std::size_t i = 0; i < plant_.axes.size(); ++i) {
    AxisSettings& joint = plant_.axes[i];
    if (joint.coulomb_friction < 0.0 && joint.coulomb_friction != kFrictionOfModel) {
      config.under(joint.axis.prefix())
          .fail(kFriction, "must be -1 (the value of the model file) or not negative");
    }
    joint.axis.actuator = mj_id2name(model.get(), mjOBJ_ACTUATOR, static_cast<int>(i));
    joint.encoder.quantum =
        encoder_counts_per_turn_ > 0.0 ? 2.0 * std::numbers::pi / encoder_counts_per_turn_ : 0.0;
    joint.encoder.rounding = plant_.axes.front().encoder.rounding;
    joint.noise_std = plant_.axes.front().noise_std;
    joint.transmission = at_joint(transmissions_[i]);
    joint.transmission.nominal.load_inertia = nominal_inertia_kgm2_[i];
    const int at = model->jnt_qposadr[model.id(mjOBJ_JOINT, joint.axis.joint)];
    if (starts_at_reference_) {
      joint.start_position = start_angles_rad_[i] - home[static_cast<std::size_t>(at)];
    }
  }
  check_plant(plant_, config);
  // A log with the friction of one joint has that of all.
  plant_.knows_disturbances =
      std::any_of(plant_.axes.begin(), plant_.axes.end(),
                  [](const auto& one) { return one.drive.make_friction(1.0) != nullptr; });
  for (Eigen::Index i = 0; i < chain().joints(); ++i) observer_.check(config, nominal_joint(i));
  const auto controller = controller_.check(config, setup());
  ArmRig(plant_, chain(), *controller);  // throws if the model lacks something
}

TipPose ArmScenario::start_pose() const {
  return chain().tip_pose(to_eigen(start_angles_rad_));
}

ArmTask ArmScenario::task() const {
  ArmTask task;
  task.start_angles_rad = to_eigen(start_angles_rad_);
  task.start_pose = start_pose();
  task.force_lag_s = plant_.tip->chain.low_pass_s;
  return task;
}

ArmSetup ArmScenario::setup() const {
  AccelerationControlDesign design;
  design.nominal_inertia_kgm2 = to_eigen(nominal_inertia_kgm2_);
  design.torque_limit_Nm = chain().effort_limits_Nm();
  design.make_observer = [this] { return make_observer(); };
  design.feed = observer_feed_;
  design.period_s = plant_.physics.control_period_s;
  return {chain(), std::move(design), task(), plant_.physics.control_period_s};
}

// A joint as its estimator models it: J_n q̈ = τ − d. The coupling with other joints is part of d.
NominalAxis ArmScenario::nominal_joint(Eigen::Index joint) const {
  NominalAxis axis = plant_.nominal(static_cast<std::size_t>(joint));
  axis.force_limit = chain().effort_limits_Nm()(joint);
  axis.pulses_per_revolution = encoder_counts_per_turn_;
  axis.joint = static_cast<int>(joint);
  axis.joints = static_cast<int>(chain().joints());
  return axis;
}

std::unique_ptr<DisturbanceEstimator> ArmScenario::make_observer() const {
  std::vector<std::unique_ptr<DisturbanceEstimator>> joints;
  for (Eigen::Index i = 0; i < chain().joints(); ++i) {
    joints.push_back(observer_.make(nominal_joint(i)));
  }
  return std::make_unique<StackedEstimator>(std::move(joints));
}

ArmRig::ArmRig(const AxisPlant& plant, const PlanarChain& chain, Controller& controller)
    : AxisRig(plant, controller), chain_(chain), controller_(controller) {
  const auto any = [&](auto&& has) {
    return std::any_of(plant.axes.begin(), plant.axes.end(), has);
  };
  const auto gather = [&](const char* name, const char* unit, const char* what, auto of_joint) {
    joints_.push_back({name, unit, what, of_joint, Eigen::VectorXd::Zero(chain.joints())});
  };
  gather("q_true_rad", "rad", "true joint angles", &AxisRig::position);
  gather("dq_true_rad_s", "rad/s", "true joint velocities", &AxisRig::velocity);
  if (any([](const auto& one) { return one.drive.electric().is_on(); })) {
    gather("current_A", "A", "currents of the motors", &AxisRig::current_A);
    gather("motor_Nm", "N m", "true torques of the motors", &AxisRig::motor_force);
  }
  if (plant.knows_disturbances) {
    gather("friction_Nm", "N m", "dry friction of the joints", &AxisRig::friction);
  }
  if (any([](const auto& one) { return one.transmission.is_elastic(); })) {
    gather("motor_q_true_rad", "rad",
           "true angles of the motors over the ratios of their transmissions",
           &AxisRig::motor_position);
    gather("transmission_Nm", "N m", "torques of the transmissions on the joints",
           &AxisRig::transmitted);
  }
}

void ArmRig::observe() {
  for (JointValues& joints : joints_) {
    for (Eigen::Index i = 0; i < joints.values.size(); ++i) {
      joints.values(i) = (this->*joints.of_joint)(static_cast<std::size_t>(i));
    }
  }
  tip_ = chain_.tip_pose(q());
}

std::vector<Signal> ArmRig::signals() const {
  const auto n = static_cast<std::size_t>(chain_.joints());
  const Simulation& sim = simulation();
  const std::span<const double> measured = view(sim.sample().y);
  const auto of_joints = [this](std::size_t i) {
    const JointValues& one = joints_[i];
    return Signal{one.name, one.unit, one.what, view(one.values)};
  };
  std::vector<Signal> signals = {
      fine_signals().front(),
      of_joints(0),
      of_joints(1),
      {"x_true_m", "m", "true x of the tip", view(tip_[0])},
      {"y_true_m", "m", "true y of the tip", view(tip_[1])},
      {"phi_true_rad", "rad", "true angle of the tip", view(tip_[2])},
      {"force_true_N", "N", "true normal contact force", view(contact_force_N())},
      {"q_measured_rad", "rad", "sampled joint angles", measured.first(n)},
      {"force_measured_N", "N", "sampled force behind the low-pass", measured.subspan(n, 1)},
      {"force_raw_measured_N", "N", "sampled force before the low-pass",
       measured.subspan(n + 1, 1)},
      {"torque_command_Nm", "N m", "commanded joint torques", view(sim.command())},
      {"torque_applied_Nm", "N m", "joint torques after saturation", view(sim.actuation())},
      {"saturated", "1", "1 where any torque is at its limit", view(saturated())}};
  if (wall() != nullptr) {
    signals.push_back({"wall_m", "m", "how far the wall has moved", view(wall()->wall_m())});
  }
  for (std::size_t i = 2; i < joints_.size(); ++i) signals.push_back(of_joints(i));
  for (const Signal& signal : controller_.signals()) signals.push_back(signal);
  return signals;
}

std::vector<Signal> ArmRig::fine_signals() const {
  return {{"qpos", "rad", "the engine's generalised positions", positions()},
          {"force_true_N", "N", "true normal contact force", view(contact_force_N())},
          {"force_sensor_N", "N", "force sensor, before its low-pass", view(sensor_force_N())},
          {"force_filtered_N", "N", "force sensor, behind its low-pass", view(filtered_force_N())}};
}

}  // namespace breakwater
