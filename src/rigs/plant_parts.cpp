#include <breakwater/rigs/plant_parts.h>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <utility>

#include <breakwater/observers/raw_difference.h>
#include <breakwater/sim/linear_model.h>
#include <breakwater/sim/model.h>

namespace breakwater {
namespace {

using SharedEstimator = std::shared_ptr<DisturbanceEstimator>;

std::unique_ptr<DisturbanceEstimator> make_raw_difference(const NominalAxis& axis) {
  // Without a linear model, or with joints that no axis measures, there is no estimate of the whole
  // plant. The axes' own controllers need none.
  const bool is_whole = axis.E.size() == 0;
  if (axis.plant.states() == 0 || (is_whole && 2 * axis.plant.outputs() < axis.plant.states())) {
    return nullptr;
  }
  return std::make_unique<RawDifference>(axis.plant, axis.period_s);
}

}  // namespace

PlantTask plant_task(const AxisPlant& plant, bool is_linear) {
  PlantTask task;
  const Eigen::Index entries = plant.senses_true_state ? 3 : 1;
  const auto force_behind = [&](std::size_t axes) {
    if (!plant.tip) return ForceTask();
    return ForceTask{entries * static_cast<Eigen::Index>(axes), plant.tip->reference};
  };
  task.force = force_behind(plant.axes.size());
  const Model model = plant.load_model();
  std::vector<int> joints, actuators;
  std::vector<std::unique_ptr<Transmission>> transmissions;
  std::vector<SpringOnJoint> springs;
  std::vector<double> limits;
  NominalAxis& whole = task.whole;
  whole.period_s = plant.physics.control_period_s;
  const auto count = static_cast<Eigen::Index>(plant.axes.size());
  whole.sensor.quantum.resize(count);
  whole.sensor.noise_std.resize(count);
  task.pose.resize(count);
  for (std::size_t i = 0; i < plant.axes.size(); ++i) {
    const AxisSettings& one = plant.axes[i];
    task.names.push_back(one.axis.name);
    task.axes.push_back({.axis = plant.nominal(i),
                         .reference = one.reference,
                         .start_state = Eigen::Vector2d(one.reference.before, one.start_velocity) *
                                        one.transmission.measured_ratio(),
                         .senses_true_state = plant.senses_true_state,
                         .force = force_behind(1)});
    const auto row = static_cast<Eigen::Index>(i);
    whole.sensor.quantum(row) = one.quantum();
    whole.sensor.noise_std(row) = one.measurement_noise();
    task.pose(row) = one.reference.before;
    joints.push_back(model.id(mjOBJ_JOINT, one.measured_joint()));
    if (!one.axis.is_driven()) continue;
    task.driven.push_back(i);
    actuators.push_back(actuator_id(model, one.axis));
    limits.push_back(one.force_limit());
  }
  task.limit =
      Eigen::Map<const Eigen::VectorXd>(limits.data(), static_cast<Eigen::Index>(limits.size()));
  if (!is_linear) return task;
  try {
    Model nominal = plant.nominal_model();
    for (const AxisSettings& one : plant.axes) {
      if (!one.transmission.is_elastic()) continue;
      // The engine never integrates the nominal spring, so its stability does not matter.
      transmissions.push_back(std::make_unique<Transmission>(
          nominal, one.transmission.motor(one.axis.joint), one.axis.joint,
          one.transmission.linear_design(one.nominal_from)));
      springs.push_back({transmissions.back().get(),
                         nominal.id(mjOBJ_JOINT, one.transmission.motor(one.axis.joint))});
    }
    LinearModel linear =
        linearise(std::move(nominal), plant.pose(model), joints, actuators, springs);
    whole.plant = std::move(linear.plant);
    task.held_input = std::move(linear.held_input);
    task.to_states = whole.plant.C.transpose();
    for (Eigen::Index i = 0; i < count; ++i) {
      const AxisSettings& one = plant.axes[static_cast<std::size_t>(i)];
      task.pose(i) = linear.qpos(model->jnt_qposadr[joints[static_cast<std::size_t>(i)]]);
      if (!one.transmission.is_elastic()) continue;
      // At rest the other side of the spring moves too.
      const bool is_motor = one.transmission.measured == Side::motor;
      const double ratio = one.transmission.design.ratio;
      const std::string other = is_motor ? one.axis.joint : one.transmission.motor(one.axis.joint);
      task.to_states(model.dof(other), i) = is_motor ? 1.0 / ratio : ratio;
    }
  } catch (const std::invalid_argument& error) {
    task.why_not_linear = error.what();
  }
  return task;
}

namespace {

Eigen::Isometry3d frame_of(const mjtNum* position, const mjtNum* quaternion) {
  Eigen::Isometry3d frame = Eigen::Isometry3d::Identity();
  frame.linear() =
      Eigen::Quaterniond(quaternion[0], quaternion[1], quaternion[2], quaternion[3]).matrix();
  frame.translation() = Eigen::Map<const Eigen::Vector3d>(position);
  return frame;
}

// A frame in a body.
struct Tip {
  int body = 0;
  Eigen::Isometry3d frame = Eigen::Isometry3d::Identity();
};

// The joints from the world to a body. Its `frame` in the last moving link is set.
std::vector<SpatialJoint> joints_to(int body, const AxisPlant& plant, const Model& model,
                                    Eigen::Isometry3d& frame) {
  std::vector<int> bodies;
  for (int one = body; one != 0; one = model->body_parentid[one]) bodies.push_back(one);
  std::reverse(bodies.begin(), bodies.end());
  std::vector<SpatialJoint> joints;
  frame.setIdentity();
  for (const int one : bodies) {
    frame = frame * frame_of(model->body_pos + 3 * one, model->body_quat + 4 * one);
    for (int k = 0; k < model->body_jntnum[one]; ++k) {
      const int id = model->body_jntadr[one] + k;
      const std::string name = model.name(mjOBJ_JOINT, id);
      const auto axis = std::find_if(plant.axes.begin(), plant.axes.end(),
                                     [&](const auto& each) { return each.axis.joint == name; });
      const std::string place =
          "joint " + (!name.empty() ? '"' + name + '"' : "number " + std::to_string(id));
      if (axis == plant.axes.end()) {
        throw std::invalid_argument(place + " moves the tip and has no axis");
      }
      if (!axis->axis.is_driven()) {
        throw std::invalid_argument(place + " moves the tip and no actuator drives it");
      }
      if (axis->transmission.measured_ratio() != 1.0) {
        throw std::invalid_argument(place + " moves the tip and its encoder is at the motor");
      }
      SpatialJoint joint;
      joint.frame = std::exchange(frame, Eigen::Isometry3d::Identity());
      joint.axis = Eigen::Map<const Eigen::Vector3d>(model->jnt_axis + 3 * id);
      joint.anchor_m = Eigen::Map<const Eigen::Vector3d>(model->jnt_pos + 3 * id);
      joint.slides = model->jnt_type[id] == mjJNT_SLIDE;
      joint.zero = model->qpos0[model->jnt_qposadr[id]];
      joint.effort_limit = axis->force_limit();
      joints.push_back(std::move(joint));
    }
  }
  if (joints.size() != plant.axes.size()) {
    throw std::invalid_argument("moves the joints of the tip alone, and there are other axes");
  }
  return joints;
}

// The nominal model of a URDF: its joints are independent, and their coupling is a disturbance.
ArmSetup planar_setup(const AxisPlant& plant) {
  ArmSetup arm{TipChain(plant.chain), {}, {}, plant.physics.control_period_s};
  const Eigen::Index n = arm.chain->joints();
  if (static_cast<Eigen::Index>(plant.axes.size()) != n) {
    throw std::invalid_argument("moves the joints of the URDF alone, and there are other axes");
  }
  arm.task.start_angles_rad = plant.reference_at_start();
  arm.task.force_lag_s = plant.tip->low_pass_s;
  arm.acceleration.nominal_inertia_kgm2.resize(n);
  for (Eigen::Index i = 0; i < n; ++i) {
    const AxisSettings& joint = plant.axes[static_cast<std::size_t>(i)];
    const PlanarJoint& known = plant.chain->joint(i);
    if (joint.axis.joint != known.name) {
      throw std::invalid_argument("needs the joints of the model in the order of the URDF");
    }
    // The controllers limit their torque as in the URDF.
    if (std::abs(joint.force_limit() - known.effort_limit_Nm) > 1e-9 * known.effort_limit_Nm) {
      const bool is_set = joint.drive_limit > 0.0;
      throw WrongKey(is_set ? joint.axis.prefix() + "drive.limit_Nm" : "model.mjcf",
                     fmt::format("the actuator of \"{}\" must have the limits ±{} N m of the URDF",
                                 known.name, known.effort_limit_Nm));
    }
    arm.acceleration.nominal_inertia_kgm2(i) = joint.transmission.nominal.load_inertia;
  }
  return arm;
}

// An arm's controller and the keys that a plant adds to it.
struct TipPart {
  ArmControllerKind::Part own;
  double convert_gain_per_m = 10.0;
  double k_posture = ArmTask().k_posture;
  ObserverFeed feed = ObserverFeed::clipped;

  void bind(Fields& fields) {
    own.bind(fields);
    fields.optional_number("force.convert_gain_per_m", convert_gain_per_m, positive(),
                           "factor of the force gain: K_f is this value times the reference [1/m]");
    fields.optional_number("controller.k_posture", k_posture, not_negative(),
                           "stiffness to the start angles of the motion that the tip does not "
                           "feel; its damping is critical [1/s^2]");
    fields.optional_choice(
        "observer.feed", feed,
        {{"clipped", ObserverFeed::clipped}, {"unclipped", ObserverFeed::unclipped}},
        "torque that the observer gets: after saturation (clipped) or before it (unclipped)");
  }

  std::unique_ptr<Controller> make(const PlantTask& task, SharedEstimator estimator) const {
    ArmSetup arm = task.tip();
    if (!estimator) throw WrongKey("observer.name", "needs an estimator for each joint");
    if (task.axes.front().senses_true_state) {
      throw WrongKey("sensor.true_state", "must be false: it takes positions and force alone");
    }
    AccelerationControlDesign& joints = arm.acceleration;
    joints.torque_limit_Nm = task.limit;
    joints.observer = std::move(estimator);
    joints.feed = feed;
    arm.task.start_pose = arm.chain->tip_pose(arm.task.start_angles_rad);
    arm.task.k_posture = k_posture;
    const Reference& force = task.force.reference;
    if (std::isinf(force.from_s)) return own.make(arm);
    if (!(force.value > 0.0)) {
      throw WrongKey("force.reference_N", "must be positive: the tip presses on the wall");
    }
    arm.task.force_control_from_s = force.from_s;
    arm.task.force_reference_N = force.value;
    arm.task.convert_gain_N_m = convert_gain_per_m * force.value;
    return own.make(arm);
  }
};

}  // namespace

ArmSetup tip_setup(const AxisPlant& plant) {
  if (!plant.tip) throw std::invalid_argument("needs a tip: a table [tip]");
  if (plant.chain) return planar_setup(plant);
  const Model model = plant.nominal_model();
  const TipSettings& settings = *plant.tip;
  const auto of_tip = std::ranges::find(plant.contacts, settings.contact, &ContactSettings::name);
  if (of_tip == plant.contacts.end()) {
    throw std::invalid_argument("needs tip.contact: a contact with a plane");
  }
  const auto [geom, plane] = of_tip->geoms(model);
  const int ball = geom_id(model, geom), wall = geom_id(model, plane);
  if (model->geom_type[wall] != mjGEOM_PLANE || model->geom_bodyid[wall] != 0) {
    throw std::invalid_argument("needs a plane of the world among the geoms of contact \"" +
                                of_tip->name + "\": its normal is the direction of the force");
  }
  const Tip touching = {model->geom_bodyid[ball],
                        frame_of(model->geom_pos + 3 * ball, model->geom_quat + 4 * ball)};
  Eigen::Isometry3d contact = frame_of(model->geom_pos + 3 * wall, model->geom_quat + 4 * wall);
  const Eigen::Vector3d x = -contact.linear().col(2), y = contact.linear().col(1);
  contact.linear() << x, y, x.cross(y);
  Tip tip = touching;
  if (settings.sensor != Axis::kNone) {
    const int site = model->sensor_objid[model.id(mjOBJ_SENSOR, settings.sensor)];
    tip = {model->site_bodyid[site],
           frame_of(model->site_pos + 3 * site, model->site_quat + 4 * site)};
  }
  Eigen::Isometry3d body;
  const std::vector<SpatialJoint> joints = joints_to(tip.body, plant, model, body);
  const Eigen::VectorXd start = plant.reference_at_start();
  const auto chain = std::make_shared<SpatialChain>(joints, body * tip.frame, contact, start);
  ArmSetup arm{TipChain(chain), {}, {}, plant.physics.control_period_s};
  arm.task.start_angles_rad = start;
  arm.task.force_lag_s = settings.low_pass_s;
  arm.acceleration.nominal_inertia_kgm2.resize(start.size());
  std::vector<Eigen::Index> rates;
  for (std::size_t i = 0; i < plant.axes.size(); ++i) {
    rates.push_back(model.dof(plant.axes[i].axis.joint));
    arm.acceleration.nominal_inertia_kgm2(static_cast<Eigen::Index>(i)) =
        1.0 / plant.nominal(i).plant.B(1);
  }
  arm.acceleration.nominal_mass_matrix_kgm2 = joint_inertia(model, plant.pose(model))(rates, rates);
  if (model->geom_type[ball] == mjGEOM_SPHERE && touching.body == tip.body) {
    const SpatialChain to_ball(joints, body * touching.frame, contact, start);
    const double ball_x_m = to_ball.tip_pose(start)(0);
    if (ball_x_m > 0.0) {
      throw std::invalid_argument("the tip starts behind the plane \"" + plane + '"');
    }
    arm.task.wall_x_m = chain->tip_pose(start)(0) - ball_x_m - model->geom_size[3 * ball];
  }
  return arm;
}

Catalogue with_none(Catalogue catalogue, bool is_arm) {
  catalogue.add(AxisEstimatorKind(
      "none", "no estimator: the measured position, its difference over a sample, no disturbance",
      make_raw_difference));
  if (is_arm) catalogue.drop<PlantControllerKind>();
  for (const ArmControllerKind& kind : catalogue.all<ArmControllerKind>()) {
    // A controller in Python is of all kinds.
    if (catalogue.has<PlantControllerKind>(kind.name)) continue;
    PlantControllerKind of_plant(kind.name, kind.help, [kind] {
      const auto part = std::make_shared<TipPart>(TipPart{kind.settings()});
      return PlantControllerKind::Part{[part](Fields& fields) { part->bind(fields); },
                                       [part](const PlantTask& task, SharedEstimator estimator) {
                                         return part->make(task, std::move(estimator));
                                       }};
    });
    of_plant.moves_tip = true;
    catalogue.add(std::move(of_plant));
  }
  catalogue.add(AxisControllerKind("none", "no control", [](const AxisTask&, SharedEstimator) {
    return std::make_unique<NoControl>();
  }));
  catalogue.add(ContactLawKind(ContactSettings::kOfModel, "the contact as the model file has it",
                               [] { return std::unique_ptr<ContactForceLaw>(); }));
  return catalogue;
}

}  // namespace breakwater
