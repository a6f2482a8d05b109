// Sampled plants, their observability, filters and the pseudo-inverse.
#include <Eigen/SVD>

#include <breakwater/linear/high_pass.h>
#include <breakwater/linear/observability.h>
#include <breakwater/linear/pseudo_inverse.h>
#include <breakwater/linear/state_space.h>
#include "support.h"

namespace breakwater::state_space_test {
namespace {

TEST(ZeroOrderHold, DoubleIntegratorHasItsClosedForm) {
  const double T = 1e-3;
  const StateSpace plant{(Eigen::Matrix2d() << 0, 1, 0, 0).finished(), Eigen::Vector2d(0, 1 / 0.8),
                         Eigen::RowVector2d(1, 0)};
  const StateSpace sampled = zero_order_hold(plant, T);
  EXPECT_TRUE(sampled.A.isApprox((Eigen::Matrix2d() << 1, T, 0, 1).finished(), 1e-15));
  EXPECT_TRUE(sampled.B.isApprox(Eigen::Vector2d(T * T / 1.6, T / 0.8), 1e-14));
  EXPECT_EQ(sampled.C, plant.C);
}

TEST(ZeroOrderHold, CartWithFrictionHasItsClosedForm) {
  // M v̇ = u − C v: v(k+1) = e^{−C T/M} v + (1 − e^{−C T/M})/C u.
  const double M = 0.625, C = 0.78, T = 0.1;
  const StateSpace plant{(Eigen::Matrix2d() << 0, 1, 0, -C / M).finished(),
                         Eigen::Vector2d(0, 1 / M), Eigen::RowVector2d(1, 0)};
  const StateSpace sampled = zero_order_hold(plant, T);
  const double decay = std::exp(-C * T / M);
  EXPECT_NEAR(sampled.A(1, 1), decay, 1e-15);
  EXPECT_NEAR(sampled.A(0, 1), M / C * (1 - decay), 1e-15);
  EXPECT_NEAR(sampled.B(1), (1 - decay) / C, 1e-15);
  EXPECT_NEAR(sampled.B(0), (T - M / C * (1 - decay)) / C, 1e-15);
}

TEST(ZeroOrderHold, TwoHalfStepsAreOneStep) {
  testing::Random random;
  for (int trial = 0; trial < 20; ++trial) {
    const StateSpace plant{random.matrix(4, 4), random.matrix(4, 2), random.matrix(1, 4)};
    const StateSpace half = zero_order_hold(plant, 0.05);
    const StateSpace whole = zero_order_hold(plant, 0.1);
    EXPECT_TRUE((half.A * half.A).isApprox(whole.A, 1e-13));
    EXPECT_TRUE((half.A * half.B + half.B).isApprox(whole.B, 1e-13));
  }
}

TEST(ZeroOrderHold, RefusesNonsense) {
  const StateSpace plant{Eigen::Matrix2d::Identity(), Eigen::Vector2d(0, 1),
                         Eigen::RowVector2d(1, 0)};
  EXPECT_REFUSED(zero_order_hold(plant, 0.0));
  EXPECT_REFUSED(zero_order_hold(plant, std::nan("")));
  StateSpace misshapen = plant;
  misshapen.B = Eigen::Vector3d(0, 0, 1);
  EXPECT_REFUSED(zero_order_hold(misshapen, 0.1));
  for (Eigen::MatrixXd StateSpace::*part : {&StateSpace::A, &StateSpace::B, &StateSpace::C}) {
    StateSpace infinite = plant;
    (infinite.*part)(0, 0) = INFINITY;
    EXPECT_EQ(complaint_of([&] { zero_order_hold(infinite, 0.1); }),
              "state space: A, B and C must be finite");
  }
}

TEST(ExtendByInputDisturbance, PutsMinusBBesideA) {
  testing::Random random;
  const StateSpace plant{random.matrix(3, 3), random.matrix(3, 2), random.matrix(1, 3)};
  const StateSpace extended = extend_by_input_disturbance(plant);
  // A disturbance equal to the input cancels it: x moves as if u were 0.
  const Eigen::VectorXd x = random.vector(3);
  const Eigen::VectorXd u = random.vector(2);
  Eigen::VectorXd extended_x(5);
  extended_x << x, u;
  const Eigen::VectorXd rate = extended.A * extended_x + extended.B * u;
  EXPECT_TRUE(rate.head(3).isApprox(plant.A * x, 1e-14));
  EXPECT_TRUE(rate.tail(2).isZero());
  EXPECT_TRUE((extended.C * extended_x).isApprox(plant.C * x, 1e-15));
}

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

// Eq. 2.14: U_o = [1 0 0; 0 1 0; 0 −c/J −1/J] is regular unless the input has no effect.
TEST(Observability, ForTheMotorMatchesEq214) {
  Eigen::Matrix3d A;
  A << 0, 1, 0, 0, -0.3, -2.0, 0, 0, 0;
  EXPECT_EQ(observability_rank(A, Eigen::RowVector3d(1, 0, 0)), 3);
  A(1, 2) = 0.0;
  EXPECT_EQ(observability_rank(A, Eigen::RowVector3d(1, 0, 0)), 2);
}

TEST(Observability, RankDoesNotDependOnUnitsOrPeriod) {
  // The extended motor with decreasing sampling periods and units of the disturbance.
  for (const double period_s : {1e-1, 1e-3, 1e-5}) {
    for (const double J : {1e-6, 1.0, 1e6}) {
      const StateSpace motor{(Eigen::Matrix2d() << 0, 1, 0, 0).finished(),
                             Eigen::Vector2d(0, 1 / J), Eigen::RowVector2d(1, 0)};
      const StateSpace extended = zero_order_hold(extend_by_input_disturbance(motor), period_s);
      EXPECT_EQ(observability_rank(extended.A, extended.C), 3) << period_s << " " << J;
    }
  }
}

TEST(Observability, CountsUnobservableStates) {
  // Two separate oscillators. Only the first one is measured.
  Eigen::Matrix4d A = Eigen::Matrix4d::Zero();
  A.topLeftCorner<2, 2>() << 0, 1, -4, 0;
  A.bottomRightCorner<2, 2>() << 0, 1, -9, 0;
  EXPECT_EQ(observability_rank(A, Eigen::RowVector4d(1, 0, 0, 0)), 2);
  EXPECT_EQ(observability_rank(A, Eigen::RowVector4d(1, 0, 1, 0)), 4);
  EXPECT_EQ(observability_rank(A, Eigen::RowVector4d::Zero()), 0);
  // Velocity alone does not determine the position.
  EXPECT_EQ(
      observability_rank((Eigen::Matrix2d() << 0, 1, 0, 0).finished(), Eigen::RowVector2d(0, 1)),
      1);
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
}  // namespace breakwater::state_space_test
