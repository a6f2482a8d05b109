// Reads a planar chain from URDF. urdfdom gives the meaning. tinyxml2 gives the line numbers and
// finds errors that urdfdom accepts.
#include <console_bridge/console.h>
#include <urdf_model/model.h>
#include <urdf_parser/urdf_parser.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <mutex>
#include <numbers>
#include <optional>
#include <stdexcept>

#include <breakwater/math/functions.h>
#include <breakwater/plants/planar_chain.h>
#include <breakwater/plants/xml_file.h>

namespace breakwater {
namespace {

constexpr double kAngleTolerance = 1e-9;
constexpr double kInertiaTolerance = 1e-6;  // numbers of a file are rounded

// urdfdom reports to a process-wide handler. This one stores the first message.
class FirstComplaint : public console_bridge::OutputHandler {
 public:
  void log(const std::string& text, console_bridge::LogLevel level, const char*, int) override {
    if (level >= console_bridge::CONSOLE_BRIDGE_LOG_ERROR && text_.empty()) text_ = text;
  }
  const std::string& text() const { return text_; }

 private:
  std::string text_;
};

// An attribute with numbers in URDF's specification.
struct NumberAttribute {
  const char* element;
  const char* name;
  std::size_t count;
  bool may_be_negative;
};

constexpr NumberAttribute kNumberAttributes[] = {
    {"origin", "xyz", 3, true},
    {"origin", "rpy", 3, true},
    {"axis", "xyz", 3, true},
    {"mass", "value", 1, false},
    {"inertia", "ixx", 1, false},
    {"inertia", "ixy", 1, true},
    {"inertia", "ixz", 1, true},
    {"inertia", "iyy", 1, false},
    {"inertia", "iyz", 1, true},
    {"inertia", "izz", 1, false},
    {"limit", "lower", 1, true},
    {"limit", "upper", 1, true},
    {"limit", "effort", 1, false},
    {"limit", "velocity", 1, false},
    {"dynamics", "damping", 1, false},
    {"dynamics", "friction", 1, false},
    {"calibration", "rising", 1, true},
    {"calibration", "falling", 1, true},
    {"mimic", "multiplier", 1, true},
    {"mimic", "offset", 1, true},
    {"safety_controller", "soft_lower_limit", 1, true},
    {"safety_controller", "soft_upper_limit", 1, true},
    {"safety_controller", "k_position", 1, true},
    {"safety_controller", "k_velocity", 1, true},
    {"box", "size", 3, false},
    {"cylinder", "radius", 1, false},
    {"cylinder", "length", 1, false},
    {"sphere", "radius", 1, false},
    {"mesh", "scale", 3, true},
    {"color", "rgba", 4, false},
    {"robot", "version", 1, false},
};

void check_numbers(const XmlFile& xml, const tinyxml2::XMLElement& element) {
  for (const NumberAttribute& a : kNumberAttributes) {
    if (std::strcmp(element.Name(), a.element) != 0) continue;
    const tinyxml2::XMLAttribute* attribute = element.FindAttribute(a.name);
    if (attribute == nullptr) continue;
    const std::string text = attribute->Value();
    const auto refuse = [&](const std::string& what) {
      xml.fail(attribute->GetLineNum(),
               std::string("<") + a.element + "> " + a.name + "=\"" + text + "\": " + what);
    };
    const auto numbers = read_numbers(text);
    if (!numbers || numbers->size() != a.count) {
      refuse(a.count == 1 ? "must be a number" : "must be " + std::to_string(a.count) + " numbers");
    }
    for (const double number : *numbers) {
      if (!is_sensible(number)) refuse("must be finite and not beyond 1e30");
      if (number < 0.0 && !a.may_be_negative) refuse("must not be negative");
    }
  }
  for (const auto* child = element.FirstChildElement(); child != nullptr;
       child = child->NextSiblingElement()) {
    check_numbers(xml, *child);
  }
}

bool turns(const urdf::Joint& joint) {
  return joint.type == urdf::Joint::REVOLUTE || joint.type == urdf::Joint::CONTINUOUS;
}

class UrdfFile {
 public:
  UrdfFile(const std::string& file, const std::string& text) : file_(file), xml_(file, text) {
    check_numbers(xml_, *xml_.root());
    model_ = parse(xml_.text());
    normal_ = normal_of_first_joint();
  }

  // The plane of the chain is normal to the axis of its first joint that turns: 0 x, 1 y, 2 z.
  double along_normal(const urdf::Vector3& v) const { return std::array{v.x, v.y, v.z}[normal_]; }
  Eigen::Vector2d in_plane(const urdf::Vector3& v) const {
    const std::array xyz{v.x, v.y, v.z};
    return {xyz[(normal_ + 1u) % 3], xyz[(normal_ + 2u) % 3]};
  }

  const urdf::ModelInterface& model() const { return *model_; }

  // `FILE:LINE: joint "name": reason`
  [[noreturn]] void fail(const char* element, const std::string& name,
                         const std::string& reason) const {
    throw std::invalid_argument(file_ + ":" + std::to_string(line_of(element, name)) + ": " +
                                element + " \"" + name + "\": " + reason);
  }

  // The turn in the plane of the <origin> of a joint or of a link's <inertial>; nothing if it also
  // leaves the plane.
  // It comes from rpy: urdfdom stores a quaternion with processor-dependent rounding.
  std::optional<double> planar_yaw(const char* element, const std::string& name) const {
    const tinyxml2::XMLElement* e = &find(element, name);
    if (std::strcmp(element, "link") == 0) e = e->FirstChildElement("inertial");
    if (e != nullptr) e = e->FirstChildElement("origin");
    const char* rpy = e == nullptr ? nullptr : e->Attribute("rpy");
    if (rpy == nullptr) return 0.0;
    const std::vector<double> angles = *read_numbers(rpy);  // check_numbers() has found three
    const auto [sin_1, cos_1] = math::sincos(angles[(normal_ + 1u) % 3]);
    const auto [sin_2, cos_2] = math::sincos(angles[(normal_ + 2u) % 3]);
    const bool is_planar = std::abs(sin_1) <= kAngleTolerance &&
                           std::abs(sin_2) <= kAngleTolerance && cos_1 * cos_2 > 0.0;
    if (!is_planar) return std::nullopt;
    const double angle = angles[normal_];
    // Half turns about both other axes are one about this axis.
    if (cos_1 > 0.0) return angle;
    return normal_ == 1 ? std::numbers::pi - angle : angle + std::numbers::pi;
  }

 private:
  urdf::ModelInterfaceSharedPtr parse(const std::string& text) {
    static std::mutex handler_in_use;
    const std::lock_guard lock(handler_in_use);
    FirstComplaint complaint;
    console_bridge::useOutputHandler(&complaint);
    auto model = urdf::parseURDF(text);
    console_bridge::restorePreviousOutputHandler();
    if (model) return model;
    fail_with(complaint.text());
  }

  unsigned normal_of_first_joint() const {
    for (urdf::LinkConstSharedPtr link = model_->getRoot(); link && !link->child_joints.empty();
         link = model_->getLink(link->child_joints.front()->child_link_name)) {
      const urdf::Joint& joint = *link->child_joints.front();
      if (!turns(joint)) continue;
      const std::array size{std::abs(joint.axis.x), std::abs(joint.axis.y), std::abs(joint.axis.z)};
      return static_cast<unsigned>(std::max_element(size.begin(), size.end()) - size.begin());
    }
    return 2;
  }

  // Reports the line of the joint or link in urdfdom's message, if there is one.
  [[noreturn]] void fail_with(const std::string& complaint) const {
    for (const auto* e = xml_.root()->FirstChildElement(); e != nullptr;
         e = e->NextSiblingElement()) {
      const char* name = e->Attribute("name");
      const bool has_place =
          std::strcmp(e->Name(), "joint") == 0 || std::strcmp(e->Name(), "link") == 0;
      if (has_place && name != nullptr && names(complaint, name)) fail(e->Name(), name, complaint);
    }
    throw std::invalid_argument(file_ + ":1: is not a valid URDF" +
                                (complaint.empty() ? "" : ": " + complaint));
  }

  static bool names(const std::string& complaint, const std::string& name) {
    return complaint.find("[" + name + "]") != std::string::npos ||
           complaint.find("'" + name + "'") != std::string::npos;
  }

  // The joint or link with this name, or the robot.
  const tinyxml2::XMLElement& find(const char* element, const std::string& name) const {
    for (const auto* e = xml_.root()->FirstChildElement(element); e != nullptr;
         e = e->NextSiblingElement(element)) {
      if (e->Attribute("name", name.c_str()) != nullptr) return *e;
    }
    return *xml_.root();
  }

  int line_of(const char* element, const std::string& name) const {
    return find(element, name).GetLineNum();
  }

  std::string file_;
  XmlFile xml_;
  urdf::ModelInterfaceSharedPtr model_;
  unsigned normal_ = 2;
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

PlanarFrame planar_origin(const UrdfFile& file, const urdf::Joint& joint) {
  const urdf::Pose& origin = joint.parent_to_joint_origin_transform;
  const std::optional<double> yaw = file.planar_yaw("joint", joint.name);
  if (!yaw) {
    file.fail("joint", joint.name, "its origin is turned out of the plane of the joints before it");
  }
  return {file.in_plane(origin.position), *yaw};
}

// ∫ r rᵀ dm = tr(I)/2 − I has no negative eigenvalue, so no negative principal minor.
bool is_of_a_body(const urdf::Inertial& of) {
  const double half = 0.5 * (of.ixx + of.iyy + of.izz);
  const double x = half - of.ixx, y = half - of.iyy, z = half - of.izz;
  const double xy = of.ixy, xz = of.ixz, yz = of.iyz;  // the minus of each cancels in the minors
  const double least = -kInertiaTolerance;
  const double determinant =
      x * (y * z - yz * yz) - xy * (xy * z + yz * xz) - xz * (xy * yz + y * xz);
  return x >= least * half && y >= least * half && z >= least * half &&
         x * y - xy * xy >= least * half * half && x * z - xz * xz >= least * half * half &&
         y * z - yz * yz >= least * half * half && determinant >= least * half * half * half;
}

// Adds a link's inertia to the moving link. `frame` is the link's frame in that of the moving link.
void lump(const UrdfFile& file, const urdf::Link& link, const PlanarFrame& frame,
          PlanarJoint& carrier) {
  if (!link.inertial) return;
  const urdf::Inertial& inertial = *link.inertial;
  if (!std::isfinite(inertial.mass) || inertial.mass < 0.0) {
    file.fail("link", link.name, "its mass must be finite and not negative");
  }
  if (!is_of_a_body(inertial)) {
    file.fail("link", link.name,
              "no body has this inertia: each principal moment is at most the sum of the others");
  }
  if (!file.planar_yaw("link", link.name)) {
    file.fail("link", link.name, "its inertial frame is turned out of the plane of the joints");
  }
  const double mass = carrier.link_mass_kg + inertial.mass;
  if (mass == 0.0) return;
  const Eigen::Vector2d com = frame.map(file.in_plane(inertial.origin.position));
  const Eigen::Vector2d lumped_com =
      (carrier.link_mass_kg * carrier.link_com_m + inertial.mass * com) / mass;
  carrier.link_inertia_kgm2 +=
      file.along_normal({inertial.ixx, inertial.iyy, inertial.izz}) +
      carrier.link_mass_kg * (carrier.link_com_m - lumped_com).squaredNorm() +
      inertial.mass * (com - lumped_com).squaredNorm();
  carrier.link_mass_kg = mass;
  carrier.link_com_m = lumped_com;
}

PlanarJoint revolute_joint(const UrdfFile& file, const urdf::Joint& joint,
                           const PlanarFrame& frame) {
  const double length = std::hypot(joint.axis.x, joint.axis.y, joint.axis.z);
  const double along = file.along_normal(joint.axis);
  if (length == 0.0 || !(std::abs(along) >= (1.0 - kAngleTolerance) * length)) {
    file.fail("joint", joint.name,
              "its axis is not along x, y or z, or not that of the first joint: no planar chain");
  }
  if (joint.mimic) {
    file.fail("joint", joint.name, "has <mimic>, but each joint of a chain moves by itself");
  }
  if (!joint.limits) file.fail("joint", joint.name, "has no <limit>");
  const double effort = joint.limits->effort;
  const double velocity = joint.limits->velocity;
  if (!(std::isfinite(effort) && effort > 0.0 && std::isfinite(velocity) && velocity > 0.0)) {
    file.fail("joint", joint.name, "its effort and velocity limits must be positive");
  }
  // Both are 0 if the file has none.
  const bool has_limits = joint.type == urdf::Joint::REVOLUTE &&
                          (joint.limits->lower != 0.0 || joint.limits->upper != 0.0);
  if (has_limits && !(joint.limits->lower < joint.limits->upper)) {
    file.fail("joint", joint.name, "its lower limit must be below its upper one");
  }
  PlanarJoint result;
  result.name = joint.name;
  result.offset_m = frame.position_m;
  result.yaw_rad = frame.yaw_rad;
  result.sense = along > 0.0 ? 1.0 : -1.0;
  result.effort_limit_Nm = effort;
  result.velocity_limit_rad_s = velocity;
  return result;
}

PlanarChain read_chain(const std::string& urdf_file, const std::string& text) {
  const UrdfFile file(urdf_file, text);
  std::vector<PlanarJoint> joints;
  PlanarFrame frame;  // frame of the current link, in the frame of the moving link
  urdf::LinkConstSharedPtr link = file.model().getRoot();
  while (!link->child_joints.empty()) {
    if (link->child_joints.size() > 1) {
      file.fail("link", link->name, "has more than one child: only a chain can be used");
    }
    const urdf::Joint& joint = *link->child_joints.front();
    const urdf::Link& child = *link->child_links.front();
    frame = frame * planar_origin(file, joint);
    if (turns(joint)) {
      joints.push_back(revolute_joint(file, joint, frame));
      frame = {};
      lump(file, child, frame, joints.back());
      if (joints.back().link_mass_kg <= 0.0) {
        file.fail("link", child.name, "is moved by a joint and needs an <inertial> with a mass");
      }
    } else if (joint.type == urdf::Joint::FIXED) {
      if (!joints.empty()) lump(file, child, frame, joints.back());
    } else {
      file.fail("joint", joint.name, "must be revolute, continuous or fixed");
    }
    link = file.model().getLink(child.name);
  }
  if (joints.empty()) {
    throw std::invalid_argument(urdf_file + ":1: has no revolute joint");
  }
  return {std::move(joints), frame.position_m, frame.yaw_rad};
}

// The last chain: the runs of a study read the same one again and again.
struct LastChain {
  std::mutex mutex;
  std::string text;
  std::optional<PlanarChain> chain;
};

}  // namespace

PlanarChain load_planar_chain(const std::string& urdf_file) {
  static LastChain last;
  const std::string text = read_text(urdf_file);
  const std::lock_guard lock(last.mutex);
  if (!last.chain || last.text != text) {
    last.chain = read_chain(urdf_file, text);
    last.text = text;
  }
  return *last.chain;
}

}  // namespace breakwater
