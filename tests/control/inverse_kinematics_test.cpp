#include <breakwater/control/inverse_kinematics.h>

#include <Eigen/LU>
#include <cmath>

#include "support.h"

namespace breakwater::inverse_kinematics_test {
namespace {

PlanarChain chain_of(int n) {
  std::vector<PlanarJoint> joints(static_cast<std::size_t>(n));
  for (std::size_t i = 0; i < joints.size(); ++i) {
    joints[i].offset_m = {i == 0 ? 0.0 : 0.2, 0.0};
    joints[i].link_mass_kg = 1.0;
  }
  return {joints, {0.2, 0.0}, 0.0};
}

TEST(LmInverseKinematics, SolvesItsNormalEquations) {
  // The residual of {Jᵀ W_e J + W_n} q̃ = Jᵀ W_e X_e + X_e (Eqs. 2.65 to 2.68).
  testing::Random random;
  const LmDesign design;
  LmInverseKinematics ik(design, 3);
  const PlanarChain arm = chain_of(3);
  for (int trial = 0; trial < 100; ++trial) {
    TaskJacobian J(3, 3);
    arm.tip_jacobian(random.vector(3, 3.0), J);
    const TipVector X_e = 0.1 * random.vector(3);
    const Eigen::Vector3d step = ik.step(J, X_e);
    if (step.cwiseAbs().maxCoeff() >= design.step_limit_rad) continue;
    const Eigen::Matrix3d W_e = design.weights.asDiagonal();
    Eigen::Matrix3d W_n = X_e.cwiseAbs().asDiagonal();
    W_n.diagonal().array() += design.damping;
    const Eigen::Vector3d residual =
        (J.transpose() * W_e * J + W_n) * step - (J.transpose() * W_e * X_e + X_e);
    EXPECT_LT(residual.norm(), 1e-11) << trial;
  }
}

// Repeats the step, as the position loop does, until the tip stops.
double error_after(LmInverseKinematics& ik, const PlanarChain& chain, Eigen::VectorXd q,
                   const TipVector& goal, int iterations) {
  TaskJacobian J(3, chain.joints());
  for (int i = 0; i < iterations; ++i) {
    chain.tip_jacobian(q, J);
    q += ik.step(J, goal - chain.tip_pose(q));
  }
  return (goal - chain.tip_pose(q)).norm();
}

TEST(LmInverseKinematics, ConvergesFromABentPosture) {
  LmInverseKinematics ik({}, 3);
  EXPECT_LT(error_after(ik, chain_of(3), Eigen::Vector3d(0.9, -1.8, 0.9), Eigen::Vector3d(0.5, 0.05, 0.1), 50),
            1e-9);
}

TEST(LmInverseKinematics, StaysFiniteAtTheStretchedPosture) {
  // A singular posture: x has no first-order reduction. The step must be finite and nonzero.
  LmInverseKinematics ik({}, 3);
  TaskJacobian J(3, 3);
  chain_of(3).tip_jacobian(Eigen::Vector3d::Zero(), J);
  const Eigen::VectorXd step = ik.step(J, Eigen::Vector3d(-0.15, 0.0, 0.0));
  EXPECT_TRUE(step.allFinite());
  EXPECT_GT(step.norm(), 1e-3);
  EXPECT_LE(step.cwiseAbs().maxCoeff(), M_PI);
}

TEST(LmInverseKinematics, SugiharaWorksForAnyNumberOfJoints) {
  LmDesign design;
  design.form = LmForm::sugihara;
  testing::Random random;
  for (const int n : {2, 3, 4, 6}) {
    const PlanarChain chain = chain_of(n);
    const Eigen::VectorXd start = random.vector(n);
    const TipVector goal = chain.tip_pose(start + 0.3 * random.vector(n));
    LmInverseKinematics ik(design, n);
    EXPECT_LT(error_after(ik, chain, start, goal, 300), 1e-6) << n;
  }
}

// {Jᵀ W_e J + W_n} q̃ = M, for each form, by another factorization.
TEST(LmInverseKinematics, SolvesTheEquationOfItsForm) {
  const LmDesign defaults;
  const Eigen::Vector3d X_e(0.02, -0.01, 0.03);
  TaskJacobian J(3, 3);
  chain_of(3).tip_jacobian(Eigen::Vector3d(0.9, -1.8, 0.9), J);
  const Eigen::Matrix3d W_e = defaults.weights.asDiagonal();
  const Eigen::Vector3d task = J.transpose() * W_e * X_e;
  const Eigen::Vector3d square = Eigen::Vector3d::Constant(0.5 * X_e.dot(W_e * X_e));
  const struct {
    LmForm form;
    Eigen::Vector3d M, W_n;
  } rows[] = {{LmForm::printed, task + X_e, X_e.cwiseAbs()},
              {LmForm::sugihara_damping, task + X_e, square},
              {LmForm::sugihara, task, square}};
  for (const auto& row : rows) {
    LmDesign design;
    design.form = row.form;
    Eigen::Matrix3d normal = J.transpose() * W_e * J;
    normal.diagonal() += row.W_n + Eigen::Vector3d::Constant(design.damping);
    const Eigen::Vector3d expected = normal.fullPivLu().solve(row.M);
    EXPECT_LT((LmInverseKinematics(design, 3).step(J, X_e) - expected).norm(),
              1e-9 * expected.norm())
        << static_cast<int>(row.form);
  }
}

TEST(LmInverseKinematics, LimitsEachStep) {
  LmDesign design;
  design.step_limit_rad = 0.01;
  LmInverseKinematics ik(design, 3);
  TaskJacobian J(3, 3);
  chain_of(3).tip_jacobian(Eigen::Vector3d(0.9, -1.8, 0.9), J);
  EXPECT_DOUBLE_EQ(ik.step(J, Eigen::Vector3d(0.5, 0.5, 0.5)).cwiseAbs().maxCoeff(), 0.01);
}

TEST(LmInverseKinematics, RefusesNonsense) {
  EXPECT_THROW(LmInverseKinematics({}, 4), std::invalid_argument);
  EXPECT_THROW(LmInverseKinematics({.weights = Eigen::Vector3d(1, 0, 1)}, 3), std::invalid_argument);
  EXPECT_THROW(LmInverseKinematics({.damping = 0.0}, 3), std::invalid_argument);
  EXPECT_THROW(LmInverseKinematics({.step_limit_rad = 0.0}, 3), std::invalid_argument);
  EXPECT_THROW(LmInverseKinematics({.step_limit_rad = std::nan("")}, 3), std::invalid_argument);
}

}  // namespace
}  // namespace breakwater::inverse_kinematics_test
