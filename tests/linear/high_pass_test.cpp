// The high-pass and pseudo-inverses, by closed forms and Eigen's SVD.
#include <Eigen/SVD>

#include <breakwater/linear/high_pass.h>
#include <breakwater/linear/pseudo_inverse.h>
#include "support.h"

namespace breakwater::filters_test {

double gain_at(double frequency_Hz, double cutoff_Hz, double period_s) {
  HighPass filter(cutoff_Hz, period_s);
  double largest = 0.0;
  for (int k = 0; k < 20000; ++k) {
    const double y = filter.update(std::sin(2 * M_PI * frequency_Hz * k * period_s));
    if (k > 10000) largest = std::max(largest, std::abs(y));
  }
  return largest;
}

TEST(HighPass, HasButterworthsGain) {
  // |H| = 1/√(1 + (w_c/w)⁴), in the bilinear transform's warped frequencies w = tan(π f T).
  const double T = 1e-3, cutoff = 150.0;
  for (const double f : {10.1, 40.3, 150.0, 301.7}) {
    const double ratio = std::tan(M_PI * cutoff * T) / std::tan(M_PI * f * T);
    EXPECT_NEAR(gain_at(f, cutoff, T), 1.0 / std::sqrt(1.0 + std::pow(ratio, 4)), 2e-3) << f;
  }
}

TEST(HighPass, RemovesAConstant) {
  HighPass filter(150.0, 1e-3);
  double y = 0.0;
  for (int k = 0; k < 1000; ++k) y = filter.update(7.0);
  EXPECT_NEAR(y, 0.0, 1e-12);
}

TEST(HighPass, RefusesNonsense) {
  EXPECT_REFUSED(HighPass(500.0, 1e-3));
  EXPECT_REFUSED(HighPass(0.0, 1e-3));
  EXPECT_REFUSED(HighPass(10.0, 0.0));
  EXPECT_REFUSED(HighPass(std::nan(""), 1e-3));
}

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

}  // namespace breakwater::filters_test
