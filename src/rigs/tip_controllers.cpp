#include <breakwater/rigs/tip_controllers.h>

#include <algorithm>
#include <optional>
#include <stdexcept>
#include <utility>

#include <breakwater/plants/spatial_chain.h>
#include <breakwater/rigs/arm_parts.h>
#include <breakwater/sim/linear_model.h>
#include <breakwater/sim/named_elements.h>

namespace breakwater {
namespace {

Eigen::Isometry3d frame_of(const mjtNum* position, const mjtNum* quaternion) {
  Eigen::Isometry3d frame = Eigen::Isometry3d::Identity();
  frame.linear() =
      Eigen::Quaterniond(quaternion[0], quaternion[1], quaternion[2], quaternion[3]).matrix();
  frame.translation() = Eigen::Map<const Eigen::Vector3d>(position);
  return frame;
}

// A frame with this x axis.
Eigen::Matrix3d along(const Eigen::Vector3d& x, const Eigen::Vector3d& across) {
  Eigen::Matrix3d frame;
  frame << x, across, x.cross(across);
  return frame;
}

// A frame in a body.
struct Tip {
  int body = 0;
  Eigen::Isometry3d frame = Eigen::Isometry3d::Identity();
};

Tip tip_of_site(const Model& model, int site) {
  return {model->site_bodyid[site],
          frame_of(model->site_pos + 3 * site, model->site_quat + 4 * site)};
}

Tip tip_of_geom(const Model& model, int geom) {
  return {model->geom_bodyid[geom],
          frame_of(model->geom_pos + 3 * geom, model->geom_quat + 4 * geom)};
}

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
      const char* const name = mj_id2name(model.get(), mjOBJ_JOINT, id);
      const auto axis = std::find_if(plant.axes.begin(), plant.axes.end(), [&](const auto& each) {
        return name != nullptr && each.axis.joint == name;
      });
      const std::string place = "joint " + (name != nullptr ? '"' + std::string(name) + '"'
                                                            : "number " + std::to_string(id));
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

// An arm's controller and the keys that a plant adds to it.
class TipPart final : public PlantControllerKind::Part {
 public:
  explicit TipPart(std::unique_ptr<ArmControllerKind::Part> own) : own_(std::move(own)) {}

  void bind(Fields& fields) override {
    own_->bind(fields);
    fields.optional_number("force.convert_gain_per_m", convert_gain_per_m_, positive(),
                           "factor of the force gain: K_f is this value times the reference [1/m]");
    fields.optional_number("controller.k_posture", k_posture_, not_negative(),
                           "stiffness to the start angles of the motion that the tip does not "
                           "feel; its damping is critical [1/s^2]");
    bind_observer_feed(fields, feed_);
    fields.standard("observer.feed", {std::string("clipped")});
  }

  std::unique_ptr<Controller> make(const PlantTask& task,
                                   std::shared_ptr<DisturbanceEstimator> estimator) const override {
    return own_->make(setup(task, std::move(estimator)));
  }

 private:
  ArmSetup setup(const PlantTask& task, std::shared_ptr<DisturbanceEstimator> estimator) const {
    const TipTask tip = task.tip();
    if (!estimator) throw WrongKey("observer.name", "needs an estimator for each joint");
    ArmSetup arm{TipChain(tip.kinematics), {}, {}, task.whole.period_s};
    const Eigen::Index n = arm.chain.joints();
    AccelerationControlDesign& joints = arm.acceleration;
    joints.nominal_inertia_kgm2.resize(n);
    arm.task.start_angles_rad.resize(n);
    for (Eigen::Index i = 0; i < n; ++i) {
      const AxisTask& axis = task.axes[static_cast<std::size_t>(i)];
      joints.nominal_inertia_kgm2(i) = 1.0 / axis.axis.plant.B(1);
      arm.task.start_angles_rad(i) = axis.reference.at(0.0);
    }
    joints.nominal_mass_matrix_kgm2 = tip.mass_matrix_kgm2;
    joints.torque_limit_Nm = task.limit;
    joints.make_observer = [estimator = std::move(estimator)] { return estimator; };
    joints.feed = feed_;
    joints.period_s = task.whole.period_s;
    const Reference& force = task.force.reference;
    if (!(force.value > 0.0)) {
      throw WrongKey("force.reference_N", "must be positive: the tip presses on the wall");
    }
    arm.task.start_pose = arm.chain.tip_pose(arm.task.start_angles_rad);
    arm.task.force_control_from_s = force.from_s;
    arm.task.force_reference_N = force.value;
    arm.task.convert_gain_N_m = convert_gain_per_m_ * force.value;
    arm.task.force_lag_s = tip.force_lag_s;
    arm.task.wall_x_m = tip.wall_x_m;
    arm.task.k_posture = k_posture_;
    return arm;
  }

  std::unique_ptr<ArmControllerKind::Part> own_;
  double convert_gain_per_m_ = 10.0;
  double k_posture_ = ArmTask().k_posture;
  ObserverFeed feed_ = ObserverFeed::clipped;
};

}  // namespace

TipTask tip_task(const AxisPlant& plant) {
  TipTask task;
  if (!plant.tip) throw std::invalid_argument("needs a tip: a table [tip]");
  const Model model = plant.nominal_model();
  const TipSettings& settings = *plant.tip;
  task.force_lag_s = settings.chain.low_pass_s;
  std::optional<Tip> touching;
  double radius_m = 0.0;
  std::optional<Eigen::Isometry3d> contact;
  for (const ContactSettings& one : plant.contacts) {
    if (one.name != settings.contact) continue;
    const auto [geom, plane] = one.geoms(model);
    const int ball = geom_id(model, geom), wall = geom_id(model, plane);
    if (model->geom_type[wall] != mjGEOM_PLANE || model->geom_bodyid[wall] != 0) {
      throw std::invalid_argument("needs a plane of the world among the geoms of contact \"" +
                                  one.name + "\": its normal is the direction of the force");
    }
    touching = tip_of_geom(model, ball);
    if (model->geom_type[ball] == mjGEOM_SPHERE) radius_m = model->geom_size[3 * ball];
    contact = frame_of(model->geom_pos + 3 * wall, model->geom_quat + 4 * wall);
    contact->linear() = along(-contact->linear().col(2), contact->linear().col(1));
  }
  const bool has_sensor = settings.sensor != TipSettings::kNone;
  const Tip tip =
      has_sensor ? tip_of_site(model, model->sensor_objid[model.id(mjOBJ_SENSOR, settings.sensor)])
                 : *touching;
  Eigen::Isometry3d body;
  const std::vector<SpatialJoint> joints = joints_to(tip.body, plant, model, body);
  Eigen::VectorXd start(static_cast<Eigen::Index>(joints.size()));
  for (Eigen::Index i = 0; i < start.size(); ++i) {
    start(i) = plant.axes[static_cast<std::size_t>(i)].reference.at(0.0);
  }
  if (!contact) throw std::invalid_argument("needs tip.contact: a contact with a plane");
  const auto chain = std::make_shared<SpatialChain>(joints, body * tip.frame, *contact, start);
  task.kinematics = chain;
  std::vector<Eigen::Index> rates;
  for (const AxisSettings& one : plant.axes) {
    rates.push_back(model->jnt_dofadr[model.id(mjOBJ_JOINT, one.axis.joint)]);
  }
  task.mass_matrix_kgm2 = joint_inertia(model, plant.pose(model))(rates, rates);
  if (radius_m > 0.0 && touching->body == tip.body) {
    const SpatialChain ball(joints, body * touching->frame, *contact, start);
    const double ball_x_m = ball.pose(start)(0);
    if (ball_x_m > 0.0) throw std::invalid_argument("the tip starts behind the contact's plane");
    task.wall_x_m = chain->pose(start)(0) - ball_x_m - radius_m;
  }
  return task;
}

std::vector<PlantControllerKind> tip_controllers(const Catalogue& catalogue) {
  std::vector<PlantControllerKind> kinds;
  for (const ArmControllerKind& kind : catalogue.all<ArmControllerKind>()) {
    // A controller in Python is of all kinds.
    if (catalogue.has<PlantControllerKind>(kind.name)) continue;
    kinds.emplace_back(kind.name, kind.help,
                       [kind] { return std::make_unique<TipPart>(kind.settings()); });
    kinds.back().moves_tip = true;
  }
  return kinds;
}

}  // namespace breakwater
