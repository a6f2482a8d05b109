// Reads a planar chain from URDF.
#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <optional>
#include <stdexcept>
#include <tuple>

#include <breakwater/math/functions.h>
#include <breakwater/plants/planar_chain.h>
#include <breakwater/plants/xml_file.h>

namespace breakwater {
namespace {

using Eigen::Vector3d;

constexpr double kAngleTolerance = 1e-9;
constexpr double kInertiaTolerance = 1e-6;  // numbers of a file are rounded

// The link of a joint's part; empty if it is missing.
std::string link_of(const XmlElement& joint, std::string_view part) {
  const XmlElement* e = joint.child(part);
  return e != nullptr ? e->text("link") : "";
}

bool turns(const XmlElement& joint) {
  const std::string type = joint.text("type");
  return type == "revolute" || type == "continuous";
}

// A joint and the link that it moves or holds.
struct Step {
  const XmlElement* joint;
  const XmlElement* link;
};

class UrdfFile {
 public:
  explicit UrdfFile(const std::string& file) : file_(file), root_(read_xml(file)) {
    if (root_.name != "robot") fail("is not a valid URDF: its root is no <robot>");
    numbers(root_, "version", 1);
    find_chain();
    const auto first = std::find_if(chain.begin(), chain.end(),
                                    [](const Step& step) { return turns(*step.joint); });
    if (first == chain.end()) return;
    vector(*first->joint, "axis", "xyz", Vector3d::UnitX()).cwiseAbs().maxCoeff(&normal_);
  }

  std::vector<Step> chain;  // from the root to the tip

  // The plane of the chain is normal to the axis of its first joint that turns: 0 x, 1 y, 2 z.
  double along_normal(const Vector3d& v) const { return v[normal_]; }
  Eigen::Vector2d in_plane(const Vector3d& v) const {
    return {v[(normal_ + 1) % 3], v[(normal_ + 2) % 3]};
  }

  // `FILE:LINE: joint "name": reason`
  [[noreturn]] void fail(const XmlElement& element, const std::string& reason) const {
    const std::string name = element.text("name");
    throw std::invalid_argument(element.place + ": " + element.name +
                                (name.empty() ? "" : " \"" + name + '"') + ": " + reason);
  }
  [[noreturn]] void fail(const std::string& what) const {
    throw std::invalid_argument(file_ + ":1: " + what);
  }

  // A part's three numbers; `otherwise` if they are missing.
  Vector3d vector(const XmlElement& element, const char* part, const char* attribute,
                  const Vector3d& otherwise) const {
    const XmlElement* e = element.child(part);
    const auto found = e != nullptr ? numbers(*e, attribute, 3) : std::nullopt;
    return found ? Vector3d(found->data()) : otherwise;
  }

  // A part's number, which must be there unless there is an `otherwise`.
  double number(const XmlElement& element, const char* part, const char* attribute,
                std::optional<double> otherwise = std::nullopt) const {
    const XmlElement* e = element.child(part);
    const auto found = e != nullptr ? numbers(*e, attribute, 1) : std::nullopt;
    if (found) return found->front();
    if (otherwise) return *otherwise;
    fail(element, std::string("has no <") + part + "> with " + attribute);
  }

  // The turn in the plane of the <origin> of a joint or of an <inertial>; nothing if it also leaves
  // the plane.
  std::optional<double> planar_yaw(const XmlElement& element) const {
    const Vector3d angles = vector(element, "origin", "rpy", Vector3d::Zero());
    const auto [sin_1, cos_1] = math::sincos(angles[(normal_ + 1) % 3]);
    const auto [sin_2, cos_2] = math::sincos(angles[(normal_ + 2) % 3]);
    const bool is_planar = std::abs(sin_1) <= kAngleTolerance &&
                           std::abs(sin_2) <= kAngleTolerance && cos_1 * cos_2 > 0.0;
    if (!is_planar) return std::nullopt;
    const double angle = angles[normal_];
    // Half turns about both other axes are one about this axis.
    if (cos_1 > 0.0) return angle;
    return normal_ == 1 ? std::numbers::pi - angle : angle + std::numbers::pi;
  }

 private:
  // An attribute with numbers; nothing if it is missing.
  std::optional<std::vector<double>> numbers(const XmlElement& element, const char* name,
                                             std::size_t count) const {
    const std::string* text = element.find(name);
    if (text == nullptr) return std::nullopt;
    const auto refuse = [&](const std::string& what) {
      throw std::invalid_argument(element.place + ": <" + element.name + "> " + name + "=\"" +
                                  *text + "\": " + what);
    };
    const auto found = read_numbers(*text);
    if (!found || found->size() != count) {
      refuse(count == 1 ? "must be a number" : "must be " + std::to_string(count) + " numbers");
    }
    if (!std::all_of(found->begin(), found->end(), is_sensible)) {
      refuse("must be finite and not beyond 1e30");
    }
    return found;
  }

  // The links or joints, by their names.
  std::map<std::string, const XmlElement*> all(std::string_view kind) const {
    std::map<std::string, const XmlElement*> found;
    for (const XmlElement& e : root_.children) {
      if (e.name != kind) continue;
      if (e.text("name").empty() || !found.emplace(e.text("name"), &e).second) {
        fail(e, "needs a name of its own");
      }
    }
    return found;
  }

  void find_chain() {
    const auto links = all("link");
    std::map<std::string, const XmlElement*> joint_to;  // by the name of a link
    std::multimap<std::string, const XmlElement*> joints_from;
    for (const auto& [name, joint] : all("joint")) {
      for (const char* end : {"parent", "child"}) {
        if (!links.contains(link_of(*joint, end))) {
          fail(*joint, std::string("its <") + end + "> is no link of the robot");
        }
      }
      if (!joint_to.emplace(link_of(*joint, "child"), joint).second) {
        fail(*joint, "its <child> is that of another joint too");
      }
      joints_from.emplace(link_of(*joint, "parent"), joint);
    }
    const XmlElement* link = nullptr;
    for (const auto& [name, one] : links) {
      if (joint_to.contains(name)) continue;
      if (link != nullptr)
        fail(*one, "no joint has this link or \"" + link->text("name") + "\" as <child>");
      link = one;
    }
    if (link == nullptr) fail("is not a valid URDF: it has no link, or each is a <child>");
    // It ends, since no joint leads to the first link, and one alone to each other.
    for (auto [next, end] = joints_from.equal_range(link->text("name")); next != end;
         std::tie(next, end) = joints_from.equal_range(link->text("name"))) {
      if (std::next(next) != end) {
        fail(*link, "has more than one child: only a chain can be used");
      }
      link = links.at(link_of(*next->second, "child"));
      chain.push_back({next->second, link});
    }
  }

  std::string file_;
  XmlElement root_;
  Eigen::Index normal_ = 2;
};

// A frame in the plane: the URDF origin of a child in its parent.
struct PlanarFrame {
  Eigen::Vector2d position_m = {0, 0};
  double yaw_rad = 0.0;

  Eigen::Vector2d map(const Eigen::Vector2d& v) const {
    const auto [s, c] = math::sincos(yaw_rad);
    return position_m + Eigen::Vector2d(c * v.x() - s * v.y(), s * v.x() + c * v.y());
  }
  PlanarFrame operator*(const PlanarFrame& child) const {
    return {map(child.position_m), yaw_rad + child.yaw_rad};
  }
};

PlanarFrame planar_origin(const UrdfFile& file, const XmlElement& joint) {
  const std::optional<double> yaw = file.planar_yaw(joint);
  if (!yaw) file.fail(joint, "its origin is turned out of the plane of the joints before it");
  return {file.in_plane(file.vector(joint, "origin", "xyz", Vector3d::Zero())), *yaw};
}

// ∫ r rᵀ dm = tr(I)/2 − I has no negative eigenvalue, so no negative principal minor. The products
// are those of I: the minus of each cancels in the minors.
bool is_of_a_body(const Vector3d& moments, double xy, double xz, double yz) {
  const double half = 0.5 * (moments.x() + moments.y() + moments.z());
  const double x = half - moments.x(), y = half - moments.y(), z = half - moments.z();
  const double least = -kInertiaTolerance;
  const double determinant =
      x * (y * z - yz * yz) - xy * (xy * z + yz * xz) - xz * (xy * yz + y * xz);
  return x >= least * half && y >= least * half && z >= least * half &&
         x * y - xy * xy >= least * half * half && x * z - xz * xz >= least * half * half &&
         y * z - yz * yz >= least * half * half && determinant >= least * half * half * half;
}

// Adds a link's inertia to the moving link. `frame` is the link's frame in that of the moving link.
void lump(const UrdfFile& file, const XmlElement& link, const PlanarFrame& frame,
          PlanarJoint& carrier) {
  const XmlElement* inertial = link.child("inertial");
  if (inertial == nullptr) return;
  const double own_mass = file.number(*inertial, "mass", "value");
  if (own_mass < 0.0) file.fail(link, "its mass must not be negative");
  const auto moment = [&](const char* name) { return file.number(*inertial, "inertia", name); };
  const Vector3d moments(moment("ixx"), moment("iyy"), moment("izz"));
  if (!is_of_a_body(moments, moment("ixy"), moment("ixz"), moment("iyz"))) {
    file.fail(link,
              "no body has this inertia: each principal moment is at most the sum of the others");
  }
  if (!file.planar_yaw(*inertial)) {
    file.fail(link, "its inertial frame is turned out of the plane of the joints");
  }
  const double mass = carrier.link_mass_kg + own_mass;
  if (mass == 0.0) return;
  const Eigen::Vector2d com =
      frame.map(file.in_plane(file.vector(*inertial, "origin", "xyz", Vector3d::Zero())));
  const Eigen::Vector2d lumped_com =
      (carrier.link_mass_kg * carrier.link_com_m + own_mass * com) / mass;
  carrier.link_inertia_kgm2 +=
      file.along_normal(moments) +
      carrier.link_mass_kg * (carrier.link_com_m - lumped_com).squaredNorm() +
      own_mass * (com - lumped_com).squaredNorm();
  carrier.link_mass_kg = mass;
  carrier.link_com_m = lumped_com;
}

PlanarJoint revolute_joint(const UrdfFile& file, const XmlElement& joint,
                           const PlanarFrame& frame) {
  const Vector3d axis = file.vector(joint, "axis", "xyz", Vector3d::UnitX());
  const double length = std::hypot(axis.x(), axis.y(), axis.z());
  const double along = file.along_normal(axis);
  if (length == 0.0 || !(std::abs(along) >= (1.0 - kAngleTolerance) * length)) {
    file.fail(joint,
              "its axis is not along x, y or z, or not that of the first joint: no planar chain");
  }
  if (joint.child("mimic") != nullptr) {
    file.fail(joint, "has <mimic>, but each joint of a chain moves by itself");
  }
  const double effort = file.number(joint, "limit", "effort");
  const double velocity = file.number(joint, "limit", "velocity");
  if (!(effort > 0.0 && velocity > 0.0)) {
    file.fail(joint, "its effort and velocity limits must be positive");
  }
  // Both are 0 if the file has none.
  const double lower = file.number(joint, "limit", "lower", 0.0);
  const double upper = file.number(joint, "limit", "upper", 0.0);
  const bool has_limits = joint.text("type") == "revolute" && (lower != 0.0 || upper != 0.0);
  if (has_limits && !(lower < upper)) {
    file.fail(joint, "its lower limit must be below its upper one");
  }
  PlanarJoint result;
  result.name = joint.text("name");
  result.offset_m = frame.position_m;
  result.yaw_rad = frame.yaw_rad;
  result.sense = along > 0.0 ? 1.0 : -1.0;
  result.effort_limit_Nm = effort;
  result.velocity_limit_rad_s = velocity;
  return result;
}

}  // namespace

PlanarChain load_planar_chain(const std::string& urdf_file) {
  const UrdfFile file(urdf_file);
  std::vector<PlanarJoint> joints;
  PlanarFrame frame;  // frame of the current link, in the frame of the moving link
  for (const auto& [joint, link] : file.chain) {
    frame = frame * planar_origin(file, *joint);
    if (turns(*joint)) {
      joints.push_back(revolute_joint(file, *joint, frame));
      frame = {};
      lump(file, *link, frame, joints.back());
      if (joints.back().link_mass_kg <= 0.0) {
        file.fail(*link, "is moved by a joint and needs an <inertial> with a mass");
      }
    } else if (joint->text("type") == "fixed") {
      if (!joints.empty()) lump(file, *link, frame, joints.back());
    } else {
      file.fail(*joint, "must be revolute, continuous or fixed");
    }
  }
  if (joints.empty()) file.fail("has no revolute joint");
  return {std::move(joints), frame.position_m, frame.yaw_rad};
}

}  // namespace breakwater
