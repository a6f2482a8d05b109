#include <breakwater/sim/robot_scene.h>

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cmath>
#include <stdexcept>

#include <breakwater/linear/pseudo_inverse.h>
#include <breakwater/math/functions.h>
#include <breakwater/sim/mjcf_conversion.h>
#include <breakwater/sim/model.h>

namespace breakwater {
namespace {

constexpr double kRadius_m = 0.01;
constexpr double kMostGap_m = 0.05;
constexpr double kGapOfReach = 0.1;  // a small robot stays bent
constexpr double kLever_m = 0.3;     // makes a turn a motion
constexpr int kPoses = 1000;
constexpr double kSmall = 1e-3;  // share of the largest value that counts as none

// The body and the place of the tip.
struct TipPlace {
  int body = 0;
  int site = -1;  // -1: the body's frame
};

std::string joined(const std::vector<std::string>& names) {
  std::string text;
  for (const std::string& name : names) text += (text.empty() ? "" : ", ") + name;
  return text;
}

TipPlace find_tip(const Model& model, const std::string& tip) {
  const auto site_at = [&](int site) { return TipPlace{model->site_bodyid[site], site}; };
  if (!tip.empty()) {
    if (model.has(mjOBJ_SITE, tip)) return site_at(model.id(mjOBJ_SITE, tip));
    if (model.has(mjOBJ_BODY, tip)) return {model.id(mjOBJ_BODY, tip), -1};
  }
  std::vector<std::string> sites, ends;
  std::vector<int> bodies;
  const auto add_name = [&](std::vector<std::string>& names, mjtObj kind, int id) {
    const std::string name = model.name(kind, id);
    if (!name.empty()) names.push_back(name);
  };
  for (int i = 0; i < model->nsite; ++i) add_name(sites, mjOBJ_SITE, i);
  for (int i = 1; i < model->nbody; ++i) {
    const auto* const parents = model->body_parentid;
    if (std::find(parents, parents + model->nbody, i) != parents + model->nbody) continue;
    add_name(ends, mjOBJ_BODY, i);
    bodies.push_back(i);
  }
  if (tip.empty() && model->nsite == 1) return site_at(0);
  if (tip.empty() && model->nsite == 0 && bodies.size() == 1) return {bodies.front(), -1};
  throw std::invalid_argument(
      (tip.empty() ? "--tip: is needed"
                   : "--tip: " + model.file() + " has no site or body \"" + tip + '"') +
      (!sites.empty()    ? "; its sites are " + joined(sites)
       : !ends.empty()   ? "; its last bodies are " + joined(ends)
       : !bodies.empty() ? "; its last bodies have no names: name a body, or a site"
                         : "; it has no body"));
}

// Position (3), rotation (3×3) and Jacobian (6×n) of the tip in the pose of the data.
struct TipMotion {
  Eigen::Vector3d position;
  Eigen::Matrix<double, 3, 3, Eigen::RowMajor> rotation;
  Eigen::Matrix<double, 6, Eigen::Dynamic, Eigen::RowMajor> jacobian;
};

TipMotion motion_of(const Model& model, mjData& data, const TipPlace& tip,
                    const std::vector<int>& joints) {
  mj_kinematics(model.get(), &data);
  mj_comPos(model.get(), &data);
  TipMotion motion;
  const bool is_site = tip.site >= 0;
  const mjtNum* position = is_site ? data.site_xpos + 3 * tip.site : data.xpos + 3 * tip.body;
  motion.position = Eigen::Map<const Eigen::Vector3d>(position);
  motion.rotation = Eigen::Map<const decltype(motion.rotation)>(
      is_site ? data.site_xmat + 9 * tip.site : data.xmat + 9 * tip.body);
  decltype(motion.jacobian) whole(6, model->nv);
  mj_jac(model.get(), &data, whole.data(), whole.data() + 3 * model->nv, position, tip.body);
  motion.jacobian.resize(6, static_cast<Eigen::Index>(joints.size()));
  for (std::size_t i = 0; i < joints.size(); ++i) {
    motion.jacobian.col(static_cast<Eigen::Index>(i)) = whole.col(model->jnt_dofadr[joints[i]]);
  }
  return motion;
}

// Sets the pose of the joints to that with the largest manipulability. It is the product of the
// singular values without those that are 0 in every pose.
void choose_pose(const Model& model, mjData& data, const TipPlace& tip,
                 const std::vector<int>& joints) {
  const std::vector<mjtNum> first(data.qpos, data.qpos + model->nq);
  std::vector<mjtNum> best = first;
  double most = -1.0;
  Eigen::Index rank = 0;
  // Kronecker's sequence with the roots of x^(n + 1) = x + 1 covers the ranges evenly.
  double root = 2.0;
  for (int i = 0; i < 100; ++i) {
    root = math::exp(math::log(1.0 + root) / (1.0 + static_cast<double>(joints.size())));
  }
  for (int pose = 0; pose < kPoses; ++pose) {
    double step = 1.0;
    for (const int joint : joints) {
      step /= root;
      const double share = 0.25 + 0.5 * std::fmod(0.5 + pose * step, 1.0);
      const mjtNum* range = model->jnt_range + 2 * joint;
      const bool is_limited = model->jnt_limited[joint] != 0;
      const double middle = first[static_cast<std::size_t>(model->jnt_qposadr[joint])];
      data.qpos[model->jnt_qposadr[joint]] =
          is_limited ? range[0] + share * (range[1] - range[0]) : middle + 4.0 * (share - 0.5);
    }
    Eigen::MatrixXd jacobian = motion_of(model, data, tip, joints).jacobian;
    jacobian.bottomRows<3>() *= kLever_m;
    const Eigen::VectorXd values = singular_values(jacobian);
    const Eigen::Index now = (values.array() > kSmall * values(0)).count();
    const double reached = values.head(now).prod();
    if (now < rank || (now == rank && !(reached > (1.0 + kSmall) * most))) continue;
    mj_collision(model.get(), &data);
    if (data.ncon > 0) continue;
    rank = now;
    most = reached;
    best.assign(data.qpos, data.qpos + model->nq);
  }
  std::copy(best.begin(), best.end(), data.qpos);
}

// The body's element that is or has the tip.
MjcfElement* find_body(MjcfElement& root, const Model& model, const TipPlace& tip) {
  const bool is_site = tip.site >= 0;
  const std::string name =
      is_site ? model.name(mjOBJ_SITE, tip.site) : model.name(mjOBJ_BODY, tip.body);
  MjcfElement* found = nullptr;
  for_each_section(root, "worldbody", [&](MjcfElement& world) {
    for_each_below(world, "", [&](MjcfElement& element, MjcfElement& parent, const std::string&) {
      const bool is_it = element.name == (is_site ? "site" : "body");
      if (is_it && element.text("name") == name) found = is_site ? &parent : &element;
    });
  });
  return found;
}

MjcfElement geom(const std::string& name, const std::string& type) {
  MjcfElement element;
  element.name = "geom";
  element.attributes = {{"name", name},   {"type", type},       {"mass", "0"},
                        {"contype", "0"}, {"conaffinity", "0"}, {"group", "2"}};
  return element;
}

// Draws a line from the origin of each body to those of the bodies on it.
void draw_links(MjcfElement& body) {
  std::vector<MjcfElement> links;
  for (MjcfElement& child : body.children) {
    if (child.name != "body") continue;
    draw_links(child);
    const std::string place = child.text("pos");
    const bool is_apart = place.find_first_of("123456789") != place.npos;
    if (body.name != "body" || !is_apart) continue;
    MjcfElement& link = links.emplace_back(geom("", "capsule"));
    link.erase("name");
    link.set("fromto", "0 0 0 " + place);
    link.set("size", "0.02");
    link.set("rgba", "0.75 0.78 0.82 1");
  }
  body.children.insert(body.children.end(), links.begin(), links.end());
}

// A file whose meshes are gone has geoms in a hidden group alone, for collisions, or none.
void show_robot(MjcfElement& root, const Model& model) {
  constexpr int kLastShown = 2;
  int hidden = 0;
  for (int i = 0; i < model->ngeom; ++i) {
    if (model->geom_bodyid[i] == 0) continue;
    if (model->geom_group[i] <= kLastShown) return;
    ++hidden;
  }
  for_each_section(root, "worldbody", [&](MjcfElement& world) {
    if (hidden == 0) draw_links(world);
    for_each_below(world, "", [](MjcfElement& element, MjcfElement& parent, const std::string&) {
      if (element.name == "geom" && parent.name == "body")
        element.set("group", std::to_string(kLastShown));
    });
  });
}

}  // namespace

RobotScene robot_before_wall(const std::string& file, const std::string& tip_name) {
  RobotScene scene;
  scene.root = convert_mjcf(file, ModelFile::kMostElements).root;
  if (scene.root.name != "mujoco") throw std::invalid_argument(file + ": is no MJCF");
  const Model model = Model::load(file);
  const TipPlace tip = find_tip(model, tip_name);
  std::vector<int> joints;
  for (int body = tip.body; body != 0; body = model->body_parentid[body]) {
    for (int k = model->body_jntnum[body] - 1; k >= 0; --k) {
      joints.push_back(model->body_jntadr[body] + k);
    }
  }
  std::reverse(joints.begin(), joints.end());
  if (joints.empty()) throw std::invalid_argument(file + ": no joint moves the tip");
  for (const int joint : joints) {
    scene.joints.push_back(model.name(mjOBJ_JOINT, joint));
    if (scene.joints.back().empty()) {
      throw std::invalid_argument(file + ": joint number " + std::to_string(joint + 1) +
                                  " moves the tip and needs a name");
    }
    const bool is_axis = model.is_axis(joint);
    bool is_driven = false;
    for (int i = 0; i < model->nu; ++i) is_driven |= model.drives(i, joint);
    if (!is_axis || !is_driven) {
      throw std::invalid_argument(file + ": joint \"" + scene.joints.back() +
                                  "\" moves the tip and " +
                                  (is_axis ? "no actuator drives it" : "is no hinge or slide"));
    }
  }
  for (const auto& [kind, name] :
       {std::pair(mjOBJ_GEOM, RobotScene::kTip), std::pair(mjOBJ_GEOM, RobotScene::kWall),
        std::pair(mjOBJ_KEY, RobotScene::kStart)}) {
    if (model.has(kind, name)) {
      throw std::invalid_argument(file + ": has \"" + name + "\" already");
    }
  }
  const DataPointer data = model.make_data();
  if (model.has(mjOBJ_KEY, "home")) {
    mj_resetDataKeyframe(model.get(), data.get(), model.id(mjOBJ_KEY, "home"));
  } else {
    mj_resetData(model.get(), data.get());
    choose_pose(model, *data, tip, joints);
  }
  const TipMotion motion = motion_of(model, *data, tip, joints);

  const double most = motion.jacobian.topRows<3>().norm();
  Eigen::Vector3d towards = Eigen::Vector3d::Zero();
  for (const int axis : {2, 0, 1}) {
    const Eigen::Vector3d along = motion.rotation.col(axis);
    if ((along.transpose() * motion.jacobian.topRows<3>()).norm() < 0.1 * most) continue;
    towards = along;
    scene.tip = (tip.site >= 0 ? "site \"" + model.name(mjOBJ_SITE, tip.site)
                               : "origin of body \"" + model.name(mjOBJ_BODY, tip.body)) +
                "\"; its " + "xyz"[axis] + " axis faces the wall";
    break;
  }
  show_robot(scene.root, model);
  MjcfElement ball = geom(RobotScene::kTip, "sphere");
  ball.set("size", std::array{kRadius_m});
  if (tip.site >= 0) {
    ball.set("pos", std::span<const double>(model->site_pos + 3 * tip.site, 3));
  }
  ball.set("rgba", "0.86 0.16 0.14 1");
  MjcfElement wall = geom(RobotScene::kWall, "plane");
  const Eigen::Vector3d first(data->xanchor + 3 * joints.front());
  const double gap_m = std::min(kMostGap_m, kGapOfReach * (motion.position - first).norm());
  const Eigen::Vector3d place = motion.position + (gap_m + kRadius_m) * towards;
  const Eigen::Vector3d normal = -towards;
  wall.set("size", "0.15 0.15 0.01");
  wall.set("pos", std::span<const double>(place.data(), 3));
  wall.set("zaxis", std::span<const double>(normal.data(), 3));
  wall.set("rgba", "0.56 0.60 0.65 0.8");
  MjcfElement key{"key", "", {{"name", RobotScene::kStart}}, {}};
  key.set("qpos", std::span<const double>(data->qpos, static_cast<std::size_t>(model->nq)));
  MjcfElement* const body = find_body(scene.root, model, tip);
  if (body == nullptr) throw std::invalid_argument(file + ": the body of the tip needs a name");
  body->children.push_back(ball);
  scene.root.children.push_back({"worldbody", "", {}, {wall}});
  scene.root.children.push_back({"keyframe", "", {}, {key}});
  return scene;
}

}  // namespace breakwater
