#include <breakwater/linear/state_space.h>

#include <cmath>

#include "support.h"

namespace breakwater {
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
  EXPECT_THROW(zero_order_hold(plant, 0.0), std::invalid_argument);
  EXPECT_THROW(zero_order_hold(plant, std::nan("")), std::invalid_argument);
  StateSpace misshapen = plant;
  misshapen.B = Eigen::Vector3d(0, 0, 1);
  EXPECT_THROW(zero_order_hold(misshapen, 0.1), std::invalid_argument);
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

}  // namespace
}  // namespace breakwater
