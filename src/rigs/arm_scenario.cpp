#include <breakwater/rigs/arm_scenario.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <utility>

#include <breakwater/math/float_environment.h>
#include <breakwater/rigs/plant_parts.h>

namespace breakwater {
namespace {

constexpr double kFrictionOfModel = -1.0;
constexpr const char* kFriction = "plant.coulomb_friction_Nm";

Eigen::VectorXd to_eigen(const std::vector<double>& values) {
  return Eigen::Map<const Eigen::VectorXd>(values.data(), static_cast<Eigen::Index>(values.size()));
}

AxisSettings arm_joint(const std::string& name, std::size_t i, const Catalogue& catalogue) {
  Axis axis = named_axis(name, name, Axis::kJoint, true);
  axis.channel = "q" + std::to_string(i + 1);
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
  plant_.keyframe = "home";
  plant_.tip.emplace().sensor = "tip_force";
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

Fields ArmScenario::fields() {
  Fields fields;
  bind_model(fields, plant_.mjcf);
  fields.file("model.urdf", urdf_, "URDF file of the arm, the controllers' nominal model");
  plant_.physics.bind(fields);
  plant_.timing.bind(fields);
  plant_.run.bind(fields);
  fields.numbers("task.start_angles_rad", start_angles_rad_, any(),
                 "q_0^ref, the start posture; its tip pose is X_0^ref");
  for (std::size_t i = 0; i < plant_.axes.size(); ++i) {
    bind_joint(fields, plant_.axes[i], transmissions_[i]);
  }
  controller_.bind(fields);
  fields.numbers("observer.nominal_inertia_kgm2", nominal_inertia_kgm2_, positive(),
                 "diagonal of J_n: nominal inertia of each joint");
  observer_.bind(fields);
  bind_observer_feed(fields, observer_feed_);
  fields.number("sensor.encoder_counts_per_turn", encoder_counts_per_turn_, between(0, 1e12),
                "encoder counts per turn of each joint; 0: not quantised");
  AxisSettings& first = plant_.axes.front();
  bind_encoder_rounding(fields, first.encoder.rounding);
  fields.only_where({"encoder.rounding"}, "sensor.encoder_counts_per_turn is not 0",
                    [this] { return encoder_counts_per_turn_ != 0.0; });
  fields.number("sensor.angle_noise_rad", first.noise_std, not_negative(),
                "standard deviation of white noise on each angle sample");
  plant_.tip->chain.bind_noise(fields);
  plant_.faults.bind(fields, "q1, q2, ..., force, force_raw", plant_.run.duration_s);
  bind(fields);
  rows_.bind(fields);
  return fields;
}

void ArmScenario::check(const Config& config) {
  if (!chain_) chain_ = load_planar_chain(urdf_);
  const auto one_per_joint = [&](const char* key, std::size_t size) {
    if (size != static_cast<std::size_t>(chain().joints())) {
      config.fail(key, "must have one entry for each of the URDF's " +
                           std::to_string(chain().joints()) + " joints");
    }
  };
  one_per_joint("task.start_angles_rad", start_angles_rad_.size());
  one_per_joint("observer.nominal_inertia_kgm2", nominal_inertia_kgm2_.size());
  for (std::size_t i = 0; i < plant_.axes.size(); ++i) {
    AxisSettings& joint = plant_.axes[i];
    if (joint.coulomb_friction < 0.0 && joint.coulomb_friction != kFrictionOfModel) {
      config.under(joint.axis.prefix())
          .fail(kFriction, "must be -1 (the value of the model file) or not negative");
    }
    joint.counts = {encoder_counts_per_turn_ > 0.0 ? 1 : 0, 0.5 * encoder_counts_per_turn_};
    joint.encoder.rounding = plant_.axes.front().encoder.rounding;
    joint.noise_std = plant_.axes.front().noise_std;
    joint.transmission = at_joint(transmissions_[i]);
    joint.transmission.nominal.load_inertia = nominal_inertia_kgm2_[i];
  }
  plant_.check(config);
  // The controllers limit their torque as in the URDF, and the plant as in the MJCF.
  const Eigen::VectorXd effort_Nm = chain().effort_limits_Nm();
  for (std::size_t i = 0; i < plant_.axes.size(); ++i) {
    AxisSettings& joint = plant_.axes[i];
    const double limit_Nm = effort_Nm(static_cast<Eigen::Index>(i));
    if (std::abs(joint.force_limit() - limit_Nm) > 1e-9 * limit_Nm) {
      throw std::invalid_argument(plant_.mjcf.path + ": the actuator of \"" + joint.axis.joint +
                                  "\" must have the limits ±" + std::to_string(limit_Nm) +
                                  " N m of the URDF");
    }
    if (starts_at_reference_) joint.start_position = start_angles_rad_[i] - joint.reference.before;
  }
  // A log with the friction of one joint has that of all.
  plant_.knows_disturbances =
      std::any_of(plant_.axes.begin(), plant_.axes.end(),
                  [](const auto& one) { return one.drive.make_friction(1.0) != nullptr; });
  estimator_of_each(nominal_joints(),
                    [&](const NominalAxis& one) { return observer_.check(config, one); });
  const auto controller = controller_.check(config, setup());
  AxisRig(plant_, *controller);  // throws if the model lacks something
  rows_.check(
      config, [this] { return fields(); }, plant_.physics, complete(config));
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
  design.make_observer = [this] {
    return estimator_of_each(nominal_joints(),
                             [this](const NominalAxis& one) { return observer_.make(one); });
  };
  design.feed = observer_feed_;
  design.period_s = plant_.physics.control_period_s;
  return {chain(), std::move(design), task(), plant_.physics.control_period_s};
}

// The joints as their estimators model them: J_n q̈ = τ − d. The coupling is part of d.
std::vector<NominalAxis> ArmScenario::nominal_joints() const {
  std::vector<NominalAxis> joints;
  for (std::size_t i = 0; i < plant_.axes.size(); ++i) joints.push_back(plant_.nominal(i));
  return joints;
}

void ArmScenario::add_signals(RigRun& run, const AxisRig& rig) const {
  struct State {
    Eigen::VectorXd q;
    TipPose tip = TipPose::Zero();
    TipPose offset = TipPose::Zero();
  };
  const auto n = plant_.axes.size();
  const std::span<const double> measured = view(rig.simulation().sample().y);
  const auto add = [&](const char* name, const char* unit, const char* text,
                       std::span<const double> values) {
    run.signals.push_back({name, unit, text, values});
  };
  const auto gather = [&](const char* name, const char* unit, const char* text,
                          const double& (AxisRig::*of_joint)(std::size_t) const) {
    run.compute(name, unit, text, n,
                [&rig, of_joint](double, std::size_t i) { return (rig.*of_joint)(i); });
  };
  const auto any = [&](auto&& has) {
    return std::any_of(plant_.axes.begin(), plant_.axes.end(), has);
  };
  const std::vector<Signal> tip = rig.tip_signals();
  run.fine = {{"qpos", "rad", "the engine's generalised positions", rig.positions()},
              tip[0],
              tip[1],
              tip[2]};
  run.signals = {run.fine[0]};
  gather("q_true_rad", "rad", "true joint angles", &AxisRig::position);
  gather("dq_true_rad_s", "rad/s", "true joint velocities", &AxisRig::velocity);
  const auto state = std::make_shared<State>(State{Eigen::VectorXd(chain().joints())});
  // It computes the state that the signals behind it read.
  run.compute("x_true_m", "m", "true x of the tip",
              [this, &rig, state, start = start_pose()](double) {
                for (Eigen::Index i = 0; i < state->q.size(); ++i) {
                  state->q(i) = rig.position(static_cast<std::size_t>(i));
                }
                state->tip = chain().tip_pose(state->q);
                state->offset = state->tip - start;
                return state->tip[0];
              });
  run.compute("y_true_m", "m", "true y of the tip", [state](double) { return state->tip[1]; });
  run.compute("phi_true_rad", "rad", "true angle of the tip",
              [state](double) { return state->tip[2]; });
  run.signals.push_back(run.fine[1]);
  add("q_measured_rad", "rad", "sampled joint angles", measured.first(n));
  run.signals.insert(run.signals.end(), {tip[3], tip[4]});
  gather("torque_command_Nm", "N m", "commanded joint torques", &AxisRig::command);
  gather("torque_applied_Nm", "N m", "joint torques after saturation", &AxisRig::actuation);
  add("saturated", "1", "1 where any torque is at its limit", view(rig.saturated()));
  if (const WallContact* wall = rig.wall()) {
    add("wall_m", "m", "how far the wall has moved", view(wall->wall_m()));
  }
  if (any([](const auto& one) { return one.drive.electric().is_on(); })) {
    gather("current_A", "A", "currents of the motors", &AxisRig::current_A);
    gather("motor_Nm", "N m", "true torques of the motors", &AxisRig::motor_force);
  }
  if (plant_.knows_disturbances) {
    gather("friction_Nm", "N m", "dry friction of the joints", &AxisRig::friction);
  }
  if (any([](const auto& one) { return one.transmission.is_elastic(); })) {
    gather("motor_q_true_rad", "rad",
           "true angles of the motors over the ratios of their transmissions",
           &AxisRig::motor_position);
    gather("transmission_Nm", "N m", "torques of the transmissions on the joints",
           &AxisRig::transmitted);
  }
  constexpr const char* kForMetrics = "";
  run.compute("x_offset_m", "m", kForMetrics, [state](double) { return state->offset[0]; });
  run.compute("y_offset_m", "m", kForMetrics, [state](double) { return state->offset[1]; });
  run.compute("phi_offset_rad", "rad", kForMetrics, [state](double) { return state->offset[2]; });
  run.compute("joint_offset_rad", "rad", kForMetrics, n, [this, state](double, std::size_t i) {
    return state->q(static_cast<Eigen::Index>(i)) - start_angles_rad_[i];
  });
  run.compute("tip_error_m", "m", kForMetrics,
              [state](double) { return state->offset.head<2>().norm(); });
  run.judged.emplace().push_back(
      {HeldReference(holds_start_pose(), "the tip", "m"),
       [state, from_s = holds_start_pose().from_s](HeldReference& held, double time_s) {
         const double error_m = state->offset.head<2>().norm();
         if (time_s <= from_s) held.ask(error_m);
         held.add(time_s, error_m);
       }});
}

Recording ArmScenario::run(const RunControl& control) const {
  const math::FloatEnvironment floats;
  const std::unique_ptr<Controller> controller = controller_.make(setup());
  AxisRig rig(plant_, *controller);
  RigRun run;
  run.samples_end = false;
  add_signals(run, rig);
  run.signals.insert(run.signals.end(), controller->signals().begin(), controller->signals().end());
  extend(run, rig);
  return rig.run(control, rows_, std::move(run));
}

}  // namespace breakwater
