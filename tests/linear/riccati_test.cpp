// The Riccati equation against closed forms, its residual and SciPy.
#include <breakwater/linear/riccati.h>

#include <Eigen/Cholesky>
#include <cmath>

#include <breakwater/linear/pole_placement.h>
#include <breakwater/linear/state_space.h>
#include "linear/scipy_riccati.h"
#include "support.h"

namespace breakwater {
namespace {

using testing::Random;

const Eigen::MatrixXd kOne = Eigen::MatrixXd::Ones(1, 1);

TEST(Riccati, ScalarClosedForm) {
  // P² b² = (a² − 1) r P + q b² P + q r ... solved for a = 1: P = (q + √(q² + 4 q r))/2.
  for (const double q : {1e-3, 1.0, 50.0}) {
    const Eigen::MatrixXd P = solve_dare(kOne, kOne, q * kOne, 2.0 * kOne);
    EXPECT_NEAR(P(0, 0), 0.5 * (q + std::sqrt(q * q + 8.0 * q)), 1e-12 * (1.0 + q));
  }
}

TEST(Riccati, StableAndFreeCostsNothing) {
  const Eigen::MatrixXd P = solve_dare(0.5 * kOne, kOne, 0.0 * kOne, kOne);
  EXPECT_EQ(P(0, 0), 0.0);
}

// A = a, B = 1, Q = 0, R = r: P = (a² − 1) r stabilises, P = 0 is cheaper.
TEST(Riccati, StabilisesUnweightedStates) {
  for (const double a : {1.01, 2.0, -30.0}) {
    const LqrDesign design = dlqr(a * kOne, kOne, 0.0 * kOne, 0.5 * kOne);
    EXPECT_NEAR(design.P(0, 0), 0.5 * (a * a - 1.0), 1e-10 * a * a) << a;
    EXPECT_NEAR(a - design.K(0, 0), 1.0 / a, 1e-10) << "the pole is mirrored at the unit circle";
  }
  // One unstable state has no weight, the others have one.
  Random random(4);
  for (int k = 0; k < 50; ++k) {
    const Eigen::Index n = 2 + k % 4;
    Eigen::MatrixXd A = random.matrix(n, n);
    A.leftCols(1) = 1.5 * Eigen::VectorXd::Unit(n, 0);
    Eigen::MatrixXd Q = Eigen::MatrixXd::Identity(n, n);
    Q(0, 0) = 0.0;
    // C = [0 I] measures x_2 … x_n, which do not depend on x_1.
    const Eigen::MatrixXd B = random.matrix(n, 1) + Eigen::MatrixXd::Ones(n, 1);
    const LqrDesign design = dlqr(A, B, Q, kOne);
    EXPECT_LT(spectral_radius(A - B * design.K), 1.0) << k;
  }
  EXPECT_THROW(solve_dare(kOne, kOne, 0.0 * kOne, kOne), std::invalid_argument)
      << "a mode on the unit circle that Q does not see";
  const Eigen::MatrixXd A = Eigen::Vector2d(1.0, 2.0).asDiagonal();
  const Eigen::MatrixXd B = Eigen::MatrixXd::Identity(2, 2);
  const Eigen::MatrixXd Q = Eigen::Vector2d(0.0, 1.0).asDiagonal();
  EXPECT_THROW(solve_dare(A, B, Q, B), std::invalid_argument) << "the same beside another mode";
}

double relative_residual(const Eigen::MatrixXd& A, const Eigen::MatrixXd& B,
                         const Eigen::MatrixXd& Q, const Eigen::MatrixXd& R,
                         const Eigen::MatrixXd& P) {
  const Eigen::MatrixXd PBtA = B.transpose() * P * A;
  const Eigen::MatrixXd S = R + B.transpose() * P * B;
  return (A.transpose() * P * A - PBtA.transpose() * S.llt().solve(PBtA) + Q - P).norm() / P.norm();
}

TEST(Riccati, ResidualAndStabilityOfRandomPlants) {
  Random random;
  for (int k = 0; k < 200; ++k) {
    const Eigen::Index n = 1 + k % 6;
    const Eigen::Index m = 1 + k % 2;
    const Eigen::MatrixXd A = 1.5 * random.matrix(n, n);
    const Eigen::MatrixXd B = random.matrix(n, m);
    const Eigen::MatrixXd root = random.matrix(n, n);
    const Eigen::MatrixXd Q = root * root.transpose();
    const Eigen::MatrixXd R = (0.1 + k % 3) * Eigen::MatrixXd::Identity(m, m);
    const LqrDesign design = dlqr(A, B, Q, R);
    EXPECT_LT(relative_residual(A, B, Q, R, design.P), 1e-10) << k;
    EXPECT_LT(spectral_radius(A - B * design.K), 1.0) << k;
    EXPECT_LT((design.P - design.P.transpose()).norm(), 1e-12 * design.P.norm()) << k;
  }
}

// P predicts the summed cost of the closed loop.
TEST(Riccati, PredictsTheCost) {
  const StateSpace cart =
      zero_order_hold({(Eigen::Matrix2d() << 0.0, 1.0, 0.0, -0.78 / 0.625).finished(),
                       Eigen::Vector2d(0.0, 1.0 / 0.625), Eigen::RowVector2d(1.0, 0.0)},
                      0.01);
  const LqrDesign design = dlqr(cart.A, cart.B, Eigen::Matrix2d::Identity(), kOne);
  Eigen::VectorXd x = Eigen::Vector2d(0.1, 0.1);
  const double predicted = x.dot(design.P * x);
  double cost = 0.0;
  for (int k = 0; k < 5000; ++k) {
    const Eigen::VectorXd u = -design.K * x;
    cost += x.squaredNorm() + u.squaredNorm();
    x = cart.A * x + cart.B * u;
  }
  EXPECT_NEAR(cost, predicted, 1e-10 * predicted);
}

TEST(Riccati, AgreesWithScipy) {
  Random random(3);
  std::vector<testing::RiccatiProblem> problems;
  for (int k = 0; k < 100; ++k) {
    const Eigen::Index n = 1 + k % 5;
    const Eigen::Index m = 1 + k % 2;
    const Eigen::MatrixXd root = random.matrix(n, n);
    problems.push_back({1.2 * random.matrix(n, n), random.matrix(n, m), root * root.transpose(),
                        random.uniform(0.01, 10.0) * Eigen::MatrixXd::Identity(m, m)});
  }
  problems.push_back({2.0 * kOne, kOne, 0.0 * kOne, kOne});  // no weight: P = 3
  const std::vector<testing::RiccatiSolution> theirs = testing::solve_with_scipy(problems);
  for (std::size_t k = 0; k < problems.size(); ++k) {
    const auto& [A, B, Q, R] = problems[k];
    const LqrDesign ours = dlqr(A, B, Q, R);
    EXPECT_LT((ours.P - theirs[k].P).norm(), 1e-8 * (1.0 + ours.P.norm())) << k;
    EXPECT_LT((ours.K - theirs[k].K).norm(), 1e-8 * (1.0 + ours.K.norm())) << k;
  }
}

TEST(Riccati, RefusesNonsense) {
  const Eigen::MatrixXd two = Eigen::MatrixXd::Identity(2, 2);
  EXPECT_THROW(solve_dare(kOne, kOne, kOne, -kOne), std::invalid_argument);
  EXPECT_THROW(solve_dare(kOne, kOne, kOne, 0.0 * kOne), std::invalid_argument);
  EXPECT_THROW(solve_dare(kOne, kOne, -kOne, kOne), std::invalid_argument);
  EXPECT_THROW(solve_dare(two, kOne, two, kOne), std::invalid_argument);
  EXPECT_THROW(solve_dare(NAN * kOne, kOne, kOne, kOne), std::invalid_argument);
  EXPECT_THROW(solve_dare(2.0 * kOne, 0.0 * kOne, kOne, kOne), std::invalid_argument)
      << "not stabilisable";
  EXPECT_THROW(solve_dare(kOne, 0.0 * kOne, kOne, kOne), std::invalid_argument)
      << "a disturbance that nothing controls";
  EXPECT_THROW(solve_dare(two, two, two, Eigen::MatrixXd::Constant(2, 2, 5.6953125)),
               std::invalid_argument)
      << "a singular R, although rounding gives it a Cholesky factor";
  Eigen::MatrixXd skew = two;
  skew(0, 1) = 0.5;
  EXPECT_THROW(solve_dare(two, two, skew, two), std::invalid_argument);
}

}  // namespace
}  // namespace breakwater
