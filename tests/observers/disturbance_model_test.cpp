#include <breakwater/observers/disturbance_model.h>

#include <cmath>

#include <breakwater/observers/kalman_design.h>
#include "support.h"

namespace breakwater {
namespace {

StateSpace cart(double period_s) {
  const double M = 0.625, C = 0.78;
  return zero_order_hold({(Eigen::Matrix2d() << 0, 1, 0, -C / M).finished(),
                          Eigen::Vector2d(0, 1 / M), Eigen::RowVector2d(1, 0)},
                         period_s);
}

TEST(DisturbanceModel, OrderZeroIsTheSampledContinuousExtension) {
  const double T = 0.1, M = 0.625, C = 0.78;
  const StateSpace continuous{(Eigen::Matrix2d() << 0, 1, 0, -C / M).finished(),
                              Eigen::Vector2d(0, 1 / M), Eigen::RowVector2d(1, 0)};
  const StateSpace expected = zero_order_hold(extend_by_input_disturbance(continuous), T);
  const ExtendedPlant extended = extend_by_disturbance_model(zero_order_hold(continuous, T), 0, T);
  EXPECT_LT((extended.sampled.A - expected.A).norm(), 1e-14);
  EXPECT_LT((extended.sampled.B - expected.B).norm(), 1e-14);
  EXPECT_EQ(extended.sampled.C, expected.C);
}

TEST(DisturbanceModel, ProducesStepRampAndParabola) {
  // The chain of sums of Eq. 4.3, run freely: d(k) = d + k T ḋ + k(k−1)/2 T² d̈.
  const double T = 0.1;
  for (int order = 0; order <= 2; ++order) {
    const ExtendedPlant plant = extend_by_disturbance_model(cart(T), order, T);
    ASSERT_EQ(plant.states(), 3 + order);
    Eigen::VectorXd x = Eigen::VectorXd::Zero(plant.states());
    const double start[] = {0.7, -0.3, 0.2};
    for (int i = 0; i <= order; ++i) x(2 + i) = start[i];
    Eigen::Vector2d truth = Eigen::Vector2d::Zero();
    for (int k = 0; k < 50; ++k) {
      const double d = start[0] + (order > 0 ? k * T * start[1] : 0.0) +
                       (order > 1 ? 0.5 * k * (k - 1) * T * T * start[2] : 0.0);
      EXPECT_NEAR(x(2), d, 1e-12) << order << " " << k;
      EXPECT_LT((x.head(2) - truth).norm(), 1e-10 * (1.0 + truth.norm()));
      truth = cart(T).A * truth - cart(T).B * d;
      x = plant.sampled.A * x;
    }
  }
}

TEST(DisturbanceModel, EveryInputHasItsOwnChain) {
  StateSpace plant{Eigen::MatrixXd::Identity(2, 2), Eigen::MatrixXd::Identity(2, 2),
                   Eigen::MatrixXd::Identity(2, 2)};
  const ExtendedPlant extended = extend_by_disturbance_model(plant, 1, 0.5);
  Eigen::VectorXd x(6);
  x << 0, 0, 1, 2, 10, 20;
  const Eigen::VectorXd next = extended.sampled.A * x;
  EXPECT_EQ(next, (Eigen::VectorXd(6) << -1, -2, 6, 12, 10, 20).finished());
}

TEST(DisturbanceModel, RefusesAnUnobservablePairWithItsRank) {
  StateSpace plant{Eigen::Matrix2d::Zero(), Eigen::Vector2d(1, 0), Eigen::RowVector2d(1, 0)};
  plant.A.diagonal() << 1.0, 0.5;  // the second state is unobservable
  try {
    extend_by_disturbance_model(plant, 0, 0.01);
    FAIL() << "took an unobservable pair";
  } catch (const std::invalid_argument& error) {
    EXPECT_NE(std::string(error.what()).find("rank 2 of 3"), std::string::npos) << error.what();
  }
}

TEST(DisturbanceModel, RefusesNonsense) {
  EXPECT_THROW(extend_by_disturbance_model(cart(0.1), 3, 0.1), std::invalid_argument);
  EXPECT_THROW(extend_by_disturbance_model(cart(0.1), -1, 0.1), std::invalid_argument);
  EXPECT_THROW(extend_by_disturbance_model(cart(0.1), 0, 0.0), std::invalid_argument);
}

TEST(KalmanDesign, RefusesAnInvalidCovariance) {
  const ExtendedPlant plant = extend_by_disturbance_model(cart(0.1), 0, 0.1);
  const Eigen::MatrixXd I3 = Eigen::MatrixXd::Identity(3, 3);
  const Eigen::MatrixXd I1 = Eigen::MatrixXd::Identity(1, 1);
  EXPECT_NO_THROW(check(KalmanDesign{plant, 0.0 * I3, I1, I3}));
  EXPECT_THROW(check(KalmanDesign{plant, -I3, I1, I3}), std::invalid_argument);
  EXPECT_THROW(check(KalmanDesign{plant, I3, 0.0 * I1, I3}), std::invalid_argument);
  EXPECT_THROW(check(KalmanDesign{plant, I3, I1, -I3}), std::invalid_argument);
  EXPECT_THROW(check(KalmanDesign{plant, I3, 1e101 * I1, I3}), std::invalid_argument);
  EXPECT_THROW(check(KalmanDesign{plant, I1, I1, I3}), std::invalid_argument);
  Eigen::MatrixXd lopsided = I3;
  lopsided(0, 1) = 0.5;
  EXPECT_THROW(check(KalmanDesign{plant, I3, I1, lopsided}), std::invalid_argument);
  EXPECT_THROW(check(KalmanDesign{plant, I3 * std::nan(""), I1, I3}), std::invalid_argument);
}

}  // namespace
}  // namespace breakwater
