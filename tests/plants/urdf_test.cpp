#include <array>

#include <breakwater/plants/planar_chain.h>
#include "support.h"

namespace breakwater {
namespace {
using testing::replaced;

// Writes a URDF, reads it, and returns the error message without the folder, or "".
std::string complaint(const std::string& text) {
  const testing::TemporaryPath file("arm.urdf", text);
  const std::string what = complaint_of([&] { load_planar_chain(file.string()); });
  if (what.empty()) return "";
  EXPECT_TRUE(lacks(what, "\n"));
  EXPECT_TRUE(what.starts_with(file.string() + ":")) << what;
  return what.substr(file.string().size());
}

std::string one_joint(const std::string& joint, const std::string& link =
                                                    "<inertial><mass value='1'/><inertia ixx='1' "
                                                    "ixy='0' ixz='0' iyy='1' iyz='0' izz='1'/>"
                                                    "</inertial>") {
  return "<?xml version='1.0'?>\n<robot name='r'>\n<link name='base'/>\n" + joint +
         "\n<link name='arm'>" + link + "</link>\n</robot>\n";
}

const char* const kGoodJoint =
    "<joint name='shoulder' type='revolute'><parent link='base'/><child link='arm'/>"
    "<axis xyz='0 0 1'/><limit effort='1' velocity='1' lower='-1' upper='1'/></joint>";

TEST(Urdf, ReadsAGoodOne) {
  EXPECT_EQ(complaint(one_joint(kGoodJoint)), "");
}

using Rows = std::vector<std::array<std::string, 3>>;

TEST(Urdf, NamesFileElementAndReason) {
  for (const auto& [from, to, reason] :
       Rows{{"<limit effort='1' velocity='1' lower='-1' upper='1'/>", "",
             "Joint [shoulder] is of type REVOLUTE but it does not specify limits"},
            {"effort='1'", "effort='0'", "its effort and velocity limits must be positive"},
            {"0 0 1", "-1 0 1",
             "its axis is not along x, y or z, or not that of the first joint: no planar chain"},
            {"<axis", "<mimic joint='other'/><axis",
             "has <mimic>, but each joint of a chain moves by itself"},
            {"upper='1'", "upper='-1'", "its lower limit must be below its upper one"},
            {"<axis", "<origin rpy='0.1 0 0'/><axis",
             "its origin is turned out of the plane of the joints before it"},
            {"revolute", "prismatic", "must be revolute, continuous or fixed"}}) {
    EXPECT_EQ(complaint(one_joint(replaced(kGoodJoint, from, to))),
              ":4: joint \"shoulder\": " + reason);
  }
  EXPECT_EQ(complaint(one_joint(kGoodJoint, "")),
            ":5: link \"arm\": is moved by a joint and needs an <inertial> with a mass");
  for (const auto& [from, to] : std::vector<std::array<std::string, 2>>{
           {"ixx='1'", "ixx='2.1'"},  // > iyy + izz
           {"ixy='0'", "ixy='1.1'"},  // a negative principal moment
           {"ixx='1' ixy='0'", "ixx='1.8' ixy='0.5'"}}) {
    EXPECT_EQ(
        complaint(replaced(one_joint(kGoodJoint), from, to)),
        ":5: link \"arm\": no body has this inertia: each principal moment is at most the sum "
        "of the others")
        << to;
  }
  EXPECT_TRUE(complaint(one_joint(replaced(kGoodJoint, "'arm'", "'leg'"))).starts_with(":"));
  EXPECT_EQ(complaint("<robot name='r'>\n<link name='base'/>\n</robot>"),
            ":1: has no revolute joint");
}

TEST(Urdf, RefusesNonNumbers) {
  for (const auto& [from, to, reason] :
       Rows{{"iyz='0'", "iyz='banana'", ":5: <inertia> iyz=\"banana\": must be a number"},
            {"<mass value='1'", "<mass value='nan'",
             ":5: <mass> value=\"nan\": must be finite and not beyond 1e30"},
            {"ixx='1'", "ixx='1,5'", ":5: <inertia> ixx=\"1,5\": must be a number"},
            {"ixx='1'", "ixx=''", ":5: <inertia> ixx=\"\": must be a number"},
            {"lower='-1'", "lower='1e999'",
             ":4: <limit> lower=\"1e999\": must be finite and not beyond 1e30"},
            {"izz='1'", "izz='-1'", ":5: <inertia> izz=\"-1\": must not be negative"},
            {"0 0 1", "0 0", ":4: <axis> xyz=\"0 0\": must be 3 numbers"},
            {"<robot name='r'>", "<robot name='r' version='banana'>",
             ":2: <robot> version=\"banana\": must be a number"},
            {"<?xml version='1.0'?>", "<?xml  version = '1.1' encoding='UTF-8'?>", ""},
            {"0 0 1", " +0 0e0  1 ", ""}}) {
    EXPECT_EQ(complaint(replaced(one_joint(kGoodJoint), from, to)), reason);
  }
  for (const std::string version : {"word", "", "2.0", "1.0x"}) {
    const std::string declaration = "<?xml version='" + version + "'?>";
    EXPECT_EQ(complaint(replaced(one_joint(kGoodJoint), "<?xml version='1.0'?>", declaration)),
              ":1: " + declaration + ": must begin with <?xml version=\"1.0\"");
  }
}

TEST(Urdf, RefusesABranch) {
  std::string two = kGoodJoint;
  two += "\n" + replaced(replaced(kGoodJoint, "shoulder", "other"), "'arm'", "'leg'") +
         "\n<link name='leg'/>";
  EXPECT_EQ(complaint(one_joint(two)),
            ":3: link \"base\": has more than one child: only a chain can be used");
}

TEST(Urdf, RefusesOtherFiles) {
  EXPECT_TRUE(complaint("<robot name='r'>\n<link name='base'>\n").starts_with(":"));
  EXPECT_TRUE(complaint("").starts_with(":"));
  EXPECT_TRUE(complaint("<mujoco/>").starts_with(":"));
  EXPECT_THROW(load_planar_chain("/no/such/file.urdf"), std::invalid_argument);
}

TEST(Urdf, LumpsFixedLinksAndTurnsFrames) {
  // A link with a point mass at its end, on a yawed joint with axis -z.
  const PlanarChain chain = [] {
    const testing::TemporaryPath file("arm.urdf", R"(<robot name="r">
      <link name="base"/>
      <joint name="j" type="revolute"><parent link="base"/><child link="a"/>
        <origin xyz="1 0 5" rpy="0 0 1.5707963267948966"/><axis xyz="0 0 -1"/>
        <limit effort="2" velocity="3" lower="-1" upper="1"/></joint>
      <link name="a"><inertial><origin xyz="0.5 0 0"/><mass value="2"/>
        <inertia ixx="0.1" ixy="0" ixz="0" iyy="0" iyz="0" izz="0.1"/></inertial></link>
      <joint name="f" type="fixed"><parent link="a"/><child link="b"/><origin xyz="1 0 0"/></joint>
      <link name="b"><inertial><mass value="2"/>
        <inertia ixx="0" ixy="0" ixz="0" iyy="0" iyz="0" izz="0"/></inertial></link>
      <joint name="g" type="fixed"><parent link="b"/><child link="t"/><origin xyz="1 0 0"/></joint>
      <link name="t"/></robot>)");
    return load_planar_chain(file.string());
  }();
  const Eigen::VectorXd q = Eigen::VectorXd::Constant(1, 0.0);
  EXPECT_TRUE(chain.tip_pose(q).isApprox(Eigen::Vector3d(1, 2, M_PI / 2), 1e-12));
  // Inertia about the joint: 0.1 + 2·0.5² + 2·1².
  EXPECT_NEAR(chain.mass_matrix(q)(0, 0), 2.6, 1e-12);
  EXPECT_NEAR(chain.tip_pose(Eigen::VectorXd::Constant(1, M_PI / 2))[2], 0.0, 1e-12);
}

// The plane may be normal to x, y or z; the joints may be continuous.
TEST(Urdf, APlaneMayBeNormalToEachAxis) {
  const auto chain = [](const std::string& from, const std::string& to, const std::string& turn) {
    const auto link = [](const std::string& name, const std::string& along) {
      return "<link name='" + name + "'><inertial><origin xyz='" + along +
             "'/><mass value='2'/><inertia ixx='0.1' ixy='0' ixz='0' iyy='0.1' iyz='0' izz='0.1'/>"
             "</inertial></link>";
    };
    const auto joint = [](const std::string& parent, const std::string& child,
                          const std::string& origin, const std::string& rpy,
                          const std::string& axis) {
      return "<joint name='" + child + "' type='continuous'><parent link='" + parent +
             "'/><child link='" + child + "'/><origin xyz='" + origin + "' rpy='" + rpy +
             "'/><axis xyz='" + axis + "'/><limit effort='1' velocity='1'/></joint>";
    };
    const testing::TemporaryPath file(
        "arm.urdf", "<robot name='r'><link name='base'/>" +
                        joint("base", "a", "0 0 0", turn, from) + link("a", to) +
                        joint("a", "b", to, "0 0 0", from) + link("b", to) + "</robot>");
    return load_planar_chain(file.string());
  };
  const Eigen::VectorXd q = Eigen::Vector2d(0.3, 0.8);
  const Eigen::MatrixXd about_z = chain("0 0 1", "0.5 0.1 0", "0 0 0.7").mass_matrix(q);
  const TipPose tip = chain("0 0 1", "0.5 0.1 0", "0 0 0.7").tip_pose(q);
  for (const auto& [axis, along, turn] :
       Rows{{"0 1 0", "0.1 0 0.5", "0 0.7 0"}, {"1 0 0", "0 0.5 0.1", "0.7 0 0"}}) {
    EXPECT_TRUE(chain(axis, along, turn).mass_matrix(q).isApprox(about_z, 1e-14)) << axis;
    EXPECT_TRUE(chain(axis, along, turn).tip_pose(q).isApprox(tip, 1e-14)) << axis;
  }
}

}  // namespace
}  // namespace breakwater
