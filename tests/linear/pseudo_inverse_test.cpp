#include <breakwater/linear/pseudo_inverse.h>

#include <Eigen/SVD>

#include "support.h"

namespace breakwater {
namespace {

using Jacobian = Eigen::Matrix<double, 3, Eigen::Dynamic>;
using Inverse = Eigen::Matrix<double, Eigen::Dynamic, 3>;

// A second implementation with Eigen's SVD and the same truncation.
Inverse by_svd(const Jacobian& J, double tolerance) {
  const Eigen::JacobiSVD<Eigen::MatrixXd> svd(J, Eigen::ComputeThinU | Eigen::ComputeThinV);
  Eigen::VectorXd inverse = svd.singularValues();
  for (double& s : inverse) s = s > tolerance ? 1.0 / s : 0.0;
  return svd.matrixV() * inverse.asDiagonal() * svd.matrixU().transpose();
}

TEST(PseudoInverse, AgreesWithTheSvd) {
  testing::Random random;
  for (int trial = 0; trial < 200; ++trial) {
    const Eigen::Index n = 3 + trial % 4;
    const Jacobian J = random.matrix(3, n);
    Inverse J_plus(n, 3);
    pseudo_inverse(J, 0.02, J_plus);
    EXPECT_TRUE(J_plus.isApprox(by_svd(J, 0.02), 1e-10)) << trial;
  }
}

TEST(PseudoInverse, MeetsMoorePenrose) {
  testing::Random random;
  const Jacobian J = random.matrix(3, 5);
  Inverse P(5, 3);
  pseudo_inverse(J, 1e-6, P);
  EXPECT_TRUE((J * P * J).isApprox(J, 1e-12));
  EXPECT_TRUE((P * J * P).isApprox(P, 1e-12));
  EXPECT_TRUE((J * P).isApprox((J * P).transpose(), 1e-12));
  EXPECT_TRUE((P * J).isApprox((P * J).transpose(), 1e-12));
}

TEST(PseudoInverse, DropsSmallSingularValues) {
  Jacobian J = Jacobian::Zero(3, 3);
  J(0, 0) = 1.0;
  J(1, 1) = 0.0199;
  J(2, 2) = 0.0201;
  Inverse P(3, 3);
  pseudo_inverse(J, 0.02, P);
  EXPECT_NEAR(P(0, 0), 1.0, 1e-14);
  EXPECT_NEAR(P(1, 1), 0.0, 1e-14);
  EXPECT_NEAR(P(2, 2), 1.0 / 0.0201, 1e-9);
  // With damping a small singular value counts as σ/tolerance².
  damped_pseudo_inverse(J, 0.02, P);
  EXPECT_NEAR(P(0, 0), 1.0, 1e-14);
  EXPECT_NEAR(P(1, 1), 0.0199 / 4e-4, 1e-9);
  EXPECT_NEAR(P(2, 2), 1.0 / 0.0201, 1e-9);
}

}  // namespace
}  // namespace breakwater
