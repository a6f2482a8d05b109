// Planar chains, and their files.
#include <kdl/chain.hpp>
#include <kdl/chaindynparam.hpp>
#include <kdl/chainfksolverpos_recursive.hpp>
#include <kdl/chainjnttojacdotsolver.hpp>
#include <kdl/chainjnttojacsolver.hpp>

#include <breakwater/plants/planar_chain.h>
#include "support.h"
#include "tables.h"

namespace breakwater::planar_chain_test {

// A random chain, and the same chain in KDL as a second implementation.
struct RandomChain {
  PlanarChain ours;
  KDL::Chain kdl;
};

RandomChain random_chain(testing::Random& random, int n) {
  std::vector<PlanarJoint> joints;
  KDL::Chain kdl;
  for (int i = 0; i < n; ++i) {
    PlanarJoint joint;
    joint.name = "joint" + std::to_string(i);
    joint.offset_m = random.vector(2);
    joint.yaw_rad = random.uniform(-3, 3);
    joint.sense = random.uniform(-1, 1) > 0 ? 1.0 : -1.0;
    joint.effort_limit_Nm = joint.velocity_limit_rad_s = 1.0;
    joint.link_mass_kg = random.uniform(0.1, 2);
    joint.link_com_m = random.vector(2);
    joint.link_inertia_kgm2 = random.uniform(0.01, 1);
    joints.push_back(joint);
    // KDL: a fixed frame up to the joint, then the joint with its link's inertia.
    kdl.addSegment(
        KDL::Segment(KDL::Joint(KDL::Joint::None),
                     KDL::Frame(KDL::Rotation::RotZ(joint.yaw_rad),
                                KDL::Vector(joint.offset_m.x(), joint.offset_m.y(), 0))));
    const KDL::RotationalInertia inertia(0.1, 0.1, joint.link_inertia_kgm2);
    kdl.addSegment(KDL::Segment(
        KDL::Joint(KDL::Vector(0, 0, 0), KDL::Vector(0, 0, joint.sense), KDL::Joint::RotAxis),
        KDL::Frame::Identity(),
        KDL::RigidBodyInertia(joint.link_mass_kg,
                              KDL::Vector(joint.link_com_m.x(), joint.link_com_m.y(), 0),
                              inertia)));
  }
  const Eigen::Vector2d tip = random.vector(2);
  const double tip_yaw = random.uniform(-3, 3);
  kdl.addSegment(
      KDL::Segment(KDL::Joint(KDL::Joint::None),
                   KDL::Frame(KDL::Rotation::RotZ(tip_yaw), KDL::Vector(tip.x(), tip.y(), 0))));
  return {PlanarChain(joints, tip, tip_yaw), kdl};
}

KDL::JntArray to_kdl(const Eigen::VectorXd& q) {
  KDL::JntArray array(static_cast<unsigned>(q.size()));
  array.data = q;
  return array;
}

TEST(PlanarChain, AgreesWithKdl) {
  testing::Random random;
  for (int trial = 0; trial < 60; ++trial) {
    const int n = 1 + trial % 6;
    const RandomChain chain = random_chain(random, n);
    const Eigen::VectorXd q = random.vector(n, 3.0);
    const Eigen::VectorXd dq = random.vector(n, 3.0);

    KDL::Frame tip;
    KDL::ChainFkSolverPos_recursive fk(chain.kdl);
    ASSERT_EQ(fk.JntToCart(to_kdl(q), tip), 0);
    const TipPose X = chain.ours.tip_pose(q);
    EXPECT_NEAR(X[0], tip.p.x(), 1e-13);
    EXPECT_NEAR(X[1], tip.p.y(), 1e-13);
    double roll, pitch, yaw;
    tip.M.GetRPY(roll, pitch, yaw);
    EXPECT_NEAR(std::remainder(X[2] - yaw, 2 * M_PI), 0.0, 1e-12);

    KDL::Jacobian kdl_J(static_cast<unsigned>(n));
    KDL::ChainJntToJacSolver jacobian(chain.kdl);
    ASSERT_EQ(jacobian.JntToJac(to_kdl(q), kdl_J), 0);
    TaskJacobian J(3, n);
    chain.ours.tip_jacobian(q, J);
    EXPECT_LT((J.topRows(2) - kdl_J.data.topRows(2)).cwiseAbs().maxCoeff(), 1e-13);
    EXPECT_LT((J.row(2) - kdl_J.data.row(5)).cwiseAbs().maxCoeff(), 1e-13);

    KDL::Twist bias;
    KDL::ChainJntToJacDotSolver jacobian_rate(chain.kdl);
    ASSERT_EQ(jacobian_rate.JntToJacDot(KDL::JntArrayVel(to_kdl(q), to_kdl(dq)), bias), 0);
    const TipPose ours = chain.ours.tip_bias_acceleration(q, dq);
    EXPECT_NEAR(ours[0], bias.vel.x(), 1e-11);
    EXPECT_NEAR(ours[1], bias.vel.y(), 1e-11);
    EXPECT_NEAR(ours[2], 0.0, 1e-12);

    KDL::JntSpaceInertiaMatrix kdl_M(static_cast<unsigned>(n));
    KDL::ChainDynParam dynamics(chain.kdl, KDL::Vector::Zero());
    ASSERT_EQ(dynamics.JntToMass(to_kdl(q), kdl_M), 0);
    EXPECT_TRUE(chain.ours.mass_matrix(q).isApprox(kdl_M.data, 1e-12));
  }
}

TEST(PlanarChain, ThesisArmMatchesEq251) {
  const PlanarChain arm = load_planar_chain(testing::source_file("models/arm.urdf"));
  ASSERT_EQ(arm.joints(), 3);
  const Eigen::Vector3d q(0.3, -0.7, 1.1);
  const double L = 0.2;
  EXPECT_NEAR(arm.tip_pose(q)[0], L * (std::cos(0.3) + std::cos(-0.4) + std::cos(0.7)), 1e-15);
  EXPECT_NEAR(arm.tip_pose(q)[1], L * (std::sin(0.3) + std::sin(-0.4) + std::sin(0.7)), 1e-15);
  EXPECT_NEAR(arm.tip_pose(q)[2], 0.7, 1e-15);
  EXPECT_EQ(arm.effort_limits_Nm(), Eigen::Vector3d(20.7360, 20.7360, 12.6720));
  EXPECT_NEAR(arm.velocity_limits_rad_s()(0), M_PI, 1e-12);
  double mass = 0;
  for (int i = 0; i < 3; ++i) mass += arm.joint(i).link_mass_kg;
  EXPECT_NEAR(mass, 3 * 0.22 + 2 * 0.77, 1e-12);
}

TEST(PlanarChain, RefusesNonsense) {
  EXPECT_REFUSED(PlanarChain({}, {0, 0}, 0));
}

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

std::string one_joint(const std::string& joint) {
  return "<?xml version='1.0'?>\n<robot name='r'>\n<link name='base'/>\n" + joint +
         "\n<link name='arm'><inertial><mass value='1'/><inertia ixx='1' ixy='0' ixz='0' iyy='1' "
         "iyz='0' izz='1'/></inertial></link>\n</robot>\n";
}

const char* const kGoodJoint =
    "<joint name='shoulder' type='revolute'><parent link='base'/><child link='arm'/>"
    "<axis xyz='0 0 1'/><limit effort='1' velocity='1' lower='-1' upper='1'/></joint>";

// A text of a good file is replaced by another one.
TEST(Urdf, IsReadOrNamesFileElementAndReason) {
  for (const auto& row : testing::rows_of("Urdf")) {
    EXPECT_EQ(complaint(replaced(one_joint(kGoodJoint), row.at(0), row.at(1))), row.at(2));
  }
  for (const char* text : {"<robot name='r'>\n<link name='base'>\n", "", "<mujoco/>"}) {
    EXPECT_TRUE(complaint(text).starts_with(":")) << text;
  }
  EXPECT_TRUE(complaint(one_joint(replaced(kGoodJoint, "'arm'", "'leg'"))).starts_with(":"));
  EXPECT_REFUSED(load_planar_chain("/no/such/file.urdf"));
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
       {std::tuple("0 1 0", "0.1 0 0.5", "0 0.7 0"), {"1 0 0", "0 0.5 0.1", "0.7 0 0"}}) {
    EXPECT_TRUE(chain(axis, along, turn).mass_matrix(q).isApprox(about_z, 1e-14)) << axis;
    EXPECT_TRUE(chain(axis, along, turn).tip_pose(q).isApprox(tip, 1e-14)) << axis;
  }
}

}  // namespace breakwater::planar_chain_test
