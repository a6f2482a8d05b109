// Reading a planar chain from URDF: urdfdom for the meaning, tinyxml2 for the line numbers.
#include <console_bridge/console.h>
#include <tinyxml2.h>
#include <urdf_model/model.h>
#include <urdf_parser/urdf_parser.h>

#include <cmath>
#include <cstring>
#include <fstream>
#include <locale>
#include <mutex>
#include <numbers>
#include <optional>
#include <sstream>
#include <stdexcept>

#include "math/functions.h"
#include "plants/planar_chain.h"

namespace breakwater {
namespace {

constexpr double kAngleTolerance = 1e-9;

// urdfdom reports to a process-wide handler; this one keeps the first complaint.
class FirstComplaint : public console_bridge::OutputHandler {
 public:
  void log(const std::string& text, console_bridge::LogLevel level, const char*, int) override {
    if (level >= console_bridge::CONSOLE_BRIDGE_LOG_ERROR && text_.empty()) text_ = text;
  }
  const std::string& text() const { return text_; }

 private:
  std::string text_;
};

class UrdfFile {
 public:
  explicit UrdfFile(std::string file) : file_(std::move(file)) {
    std::ifstream stream(file_);
    std::stringstream text;
    text << stream.rdbuf();
    if (!stream) throw std::invalid_argument(file_ + ": cannot be read");
    if (xml_.Parse(text.str().c_str()) != tinyxml2::XML_SUCCESS) {
      throw std::invalid_argument(file_ + ":" + std::to_string(xml_.ErrorLineNum()) +
                                  ": is not well-formed XML (" + xml_.ErrorName() + ")");
    }
    model_ = parse(text.str());
  }

  const urdf::ModelInterface& model() const { return *model_; }

  // `FILE:LINE: joint "name": reason`
  [[noreturn]] void fail(const char* element, const std::string& name,
                         const std::string& reason) const {
    throw std::invalid_argument(file_ + ":" + std::to_string(line_of(element, name)) + ": " +
                                element + " \"" + name + "\": " + reason);
  }

  // The yaw of a joint's <origin>, or of a link's <inertial>'s; nothing if it is rolled or pitched.
  // Of its rpy itself: urdfdom keeps a quaternion, rounded by functions that differ by processor.
  std::optional<double> planar_yaw(const char* element, const std::string& name) const {
    const tinyxml2::XMLElement* e = find(element, name);
    if (e != nullptr && std::strcmp(element, "link") == 0) e = e->FirstChildElement("inertial");
    if (e != nullptr) e = e->FirstChildElement("origin");
    const char* rpy = e == nullptr ? nullptr : e->Attribute("rpy");
    if (rpy == nullptr) return 0.0;
    std::istringstream stream(rpy);
    stream.imbue(std::locale::classic());
    double roll = 0.0, pitch = 0.0, yaw = 0.0;
    stream >> roll >> pitch >> yaw;
    const auto [sin_roll, cos_roll] = math::sincos(roll);
    const auto [sin_pitch, cos_pitch] = math::sincos(pitch);
    const bool is_planar = std::abs(sin_roll) <= kAngleTolerance &&
                           std::abs(sin_pitch) <= kAngleTolerance && cos_roll * cos_pitch > 0.0;
    if (!is_planar) return std::nullopt;
    return cos_pitch > 0.0 ? yaw : yaw + std::numbers::pi;  // turned over about both: about z
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

  // Points at the joint or link that urdfdom's message names, if it names one.
  [[noreturn]] void fail_with(const std::string& complaint) const {
    if (const auto* robot = xml_.FirstChildElement("robot")) {
      for (const auto* e = robot->FirstChildElement(); e != nullptr; e = e->NextSiblingElement()) {
        const char* name = e->Attribute("name");
        const bool has_place =
            std::strcmp(e->Name(), "joint") == 0 || std::strcmp(e->Name(), "link") == 0;
        if (has_place && name != nullptr && names(complaint, name)) {
          fail(e->Name(), name, complaint);
        }
      }
    }
    throw std::invalid_argument(file_ + ":1: is not a valid URDF" +
                                (complaint.empty() ? "" : ": " + complaint));
  }

  static bool names(const std::string& complaint, const std::string& name) {
    return complaint.find("[" + name + "]") != std::string::npos ||
           complaint.find("'" + name + "'") != std::string::npos;
  }

  // The joint or link of that name, or else the robot, or nullptr.
  const tinyxml2::XMLElement* find(const char* element, const std::string& name) const {
    const auto* robot = xml_.FirstChildElement("robot");
    if (robot == nullptr) return nullptr;
    for (const auto* e = robot->FirstChildElement(element); e != nullptr;
         e = e->NextSiblingElement(element)) {
      if (e->Attribute("name", name.c_str()) != nullptr) return e;
    }
    return robot;
  }

  int line_of(const char* element, const std::string& name) const {
    const auto* found = find(element, name);
    return found == nullptr ? 1 : found->GetLineNum();
  }

  std::string file_;
  tinyxml2::XMLDocument xml_;
  urdf::ModelInterfaceSharedPtr model_;
};

// A frame in the plane: where a URDF origin puts a child in its parent.
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
    file.fail("joint", joint.name, "its origin is rolled or pitched, so the chain is not planar");
  }
  return {{origin.position.x, origin.position.y}, *yaw};
}

// Adds a link's inertia, given where its frame is in the frame of the moving link that carries it.
void lump(const UrdfFile& file, const urdf::Link& link, const PlanarFrame& frame,
          PlanarJoint& carrier) {
  if (!link.inertial) return;
  const urdf::Inertial& inertial = *link.inertial;
  if (!std::isfinite(inertial.mass) || inertial.mass < 0.0 || !std::isfinite(inertial.izz) ||
      inertial.izz < 0.0) {
    file.fail("link", link.name, "its mass and izz must be finite and not negative");
  }
  if (!file.planar_yaw("link", link.name)) {
    file.fail("link", link.name, "its inertial frame is rolled or pitched, so izz is not its own");
  }
  const double mass = carrier.link_mass_kg + inertial.mass;
  if (mass == 0.0) return;
  const Eigen::Vector2d com = frame.map({inertial.origin.position.x, inertial.origin.position.y});
  const Eigen::Vector2d lumped_com =
      (carrier.link_mass_kg * carrier.link_com_m + inertial.mass * com) / mass;
  carrier.link_inertia_kgm2 +=
      inertial.izz + carrier.link_mass_kg * (carrier.link_com_m - lumped_com).squaredNorm() +
      inertial.mass * (com - lumped_com).squaredNorm();
  carrier.link_mass_kg = mass;
  carrier.link_com_m = lumped_com;
}

PlanarJoint revolute_joint(const UrdfFile& file, const urdf::Joint& joint,
                           const PlanarFrame& frame) {
  if (std::abs(std::abs(joint.axis.z) - 1.0) > kAngleTolerance) {
    file.fail("joint", joint.name, "its axis is not ±z, so the chain is not planar");
  }
  if (!joint.limits) file.fail("joint", joint.name, "has no <limit>");
  const double effort = joint.limits->effort;
  const double velocity = joint.limits->velocity;
  if (!(std::isfinite(effort) && effort > 0.0 && std::isfinite(velocity) && velocity > 0.0)) {
    file.fail("joint", joint.name, "its effort and velocity limits must be positive");
  }
  PlanarJoint result;
  result.name = joint.name;
  result.offset_m = frame.position_m;
  result.yaw_rad = frame.yaw_rad;
  result.sense = joint.axis.z > 0.0 ? 1.0 : -1.0;
  result.effort_limit_Nm = effort;
  result.velocity_limit_rad_s = velocity;
  return result;
}

}  // namespace

PlanarChain load_planar_chain(const std::string& urdf_file) {
  const UrdfFile file(urdf_file);
  std::vector<PlanarJoint> joints;
  PlanarFrame frame;  // of the current link, in the frame of the moving link that carries it
  urdf::LinkConstSharedPtr link = file.model().getRoot();
  while (!link->child_joints.empty()) {
    if (link->child_joints.size() > 1) {
      file.fail("link", link->name, "has more than one child: only a chain can be used");
    }
    const urdf::Joint& joint = *link->child_joints.front();
    const urdf::Link& child = *link->child_links.front();
    frame = frame * planar_origin(file, joint);
    if (joint.type == urdf::Joint::REVOLUTE) {
      joints.push_back(revolute_joint(file, joint, frame));
      frame = {};
      lump(file, child, frame, joints.back());
      if (joints.back().link_mass_kg <= 0.0) {
        file.fail("link", child.name, "is moved by a joint and needs an <inertial> with a mass");
      }
    } else if (joint.type == urdf::Joint::FIXED) {
      if (!joints.empty()) lump(file, child, frame, joints.back());
    } else {
      file.fail("joint", joint.name, "must be revolute or fixed");
    }
    link = file.model().getLink(child.name);
  }
  if (joints.empty()) {
    throw std::invalid_argument(urdf_file + ":1: has no revolute joint");
  }
  return {std::move(joints), frame.position_m, frame.yaw_rad};
}

}  // namespace breakwater
