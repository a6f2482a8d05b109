#include <breakwater/linear/eigenvalues.h>
#include <breakwater/observers/idob.h>

#include <gtest/gtest.h>

#include <cmath>
#include <stdexcept>

#include "support.h"

namespace breakwater {
namespace {

StateSpace inertia(double J) {
  return {(Eigen::Matrix2d() << 0, 1, 0, 0).finished(), Eigen::Vector2d(0, 1 / J),
          Eigen::RowVector2d(1, 0)};
}

Eigen::MatrixXd error_dynamics(const Idob& observer) {
  Eigen::MatrixXd F(observer.poles(), observer.poles());
  observer.pole_matrix(F);
  return F;
}

Eigen::VectorXd estimate(const Idob& observer) {
  Eigen::VectorXd x(observer.poles());
  x << observer.state(), observer.disturbance();
  return x;
}

TEST(Idob, ErrorDynamicsHaveThePlacedPoles) {
  const double T = 1e-3;
  for (const double J : {0.1, 1.0, 2.6683}) {
    const Idob observer(inertia(J), {{-40.0, -43.0, -46.0}}, T);
    const PoleGroup expected = {std::exp(-0.046), std::exp(-0.043), std::exp(-0.040)};
    EXPECT_LT(testing::distance(eigenvalues(error_dynamics(observer)), expected), 1e-7);
  }
}

TEST(Idob, ErrorFollowsTheErrorDynamics) {
  // On its nominal plant with a constant disturbance, e(k+1) = (Ā − H C̄) e(k) for any input.
  const double T = 0.01, J = 2.0, d = 3.0;
  const StateSpace sampled = zero_order_hold(inertia(J), T);
  Idob observer(inertia(J), {{-10.0, -20.0, -30.0}}, T);
  observer.reset(Eigen::Vector2d(0.1, 0.0));
  Eigen::Vector2d x(0.4, -0.2);
  Eigen::Vector3d error(x(0) - 0.1, x(1), d);
  Eigen::VectorXd u = Eigen::VectorXd::Zero(1);
  testing::Random random;
  for (int k = 0; k < 500; ++k) {
    observer.update(u, sampled.C * x);
    Eigen::Vector3d truth(x(0), x(1), d);
    EXPECT_LT((truth - estimate(observer) - error).norm(), 1e-10) << k;
    u = random.vector(1, 5.0);
    x = sampled.A * x + sampled.B * (u(0) - d);
    error = error_dynamics(observer) * error;
  }
  EXPECT_NEAR(observer.disturbance()(0), d, 1e-8);
}

// Eqs. 2.21, 2.22: the estimate at a sample does not include the measurement of this sample.
TEST(Idob, IsThePredictor) {
  const double T = 0.01;
  Idob observer(inertia(1.0), {{-10.0, -20.0, -30.0}}, T);
  const StateSpace sampled = zero_order_hold(extend_by_input_disturbance(inertia(1.0)), T);
  observer.reset(Eigen::Vector2d(0.3, -0.1));
  Eigen::VectorXd expected = Eigen::Vector3d(0.3, -0.1, 0.0);
  Eigen::VectorXd u = Eigen::VectorXd::Constant(1, NAN);  // no input before the first sample
  testing::Random random(13);
  for (int k = 0; k < 100; ++k) {
    const Eigen::VectorXd y = random.vector(1);
    observer.update(u, y);
    EXPECT_LT((estimate(observer) - expected).norm(), 1e-12 * expected.norm()) << k;
    EXPECT_EQ(observer.signals()[0].values[0], y(0) - observer.state()(0));
    u = random.vector(1);
    expected = (error_dynamics(observer) * expected + sampled.B * u + observer.H() * y).eval();
  }
}

TEST(Idob, JointsOfTheArmStayDecoupled) {
  StateSpace plant{Eigen::MatrixXd::Zero(6, 6), Eigen::MatrixXd::Zero(6, 3),
                   Eigen::MatrixXd::Zero(3, 6)};
  plant.A.topRightCorner(3, 3).setIdentity();
  plant.B.bottomRows(3) = Eigen::Vector3d(1 / 2.6683, 1 / 1.6772, 1 / 0.8155).asDiagonal();
  plant.C.leftCols(3).setIdentity();
  const Idob joint2(inertia(1.6772), {{-41.0, -44.0, -47.0}}, 1e-3);
  const Idob arm(plant, {{-40.0, -43.0, -46.0}, {-41.0, -44.0, -47.0}, {-42.0, -45.0, -48.0}},
                 1e-3);
  for (int state = 0; state < 3; ++state) {
    for (int output = 0; output < 3; ++output) {
      const double expected = output == 1 ? joint2.H()(state, 0) : 0.0;
      EXPECT_NEAR(arm.H()(3 * state + 1, output), expected, 1e-6 * std::abs(joint2.H()(state, 0)));
    }
  }
}

TEST(Idob, RefusesAnUnobservablePlantWithItsRank) {
  // A free integrator beside the measured one is unobservable. Position and disturbance of the
  // measured one stay observable.
  StateSpace plant{Eigen::Matrix2d::Zero(), Eigen::Vector2d(1, 0), Eigen::RowVector2d(1, 0)};
  try {
    Idob observer(plant, {{-1.0, -2.0, -3.0}}, 0.01);
    FAIL() << "took an unobservable plant";
  } catch (const std::invalid_argument& error) {
    EXPECT_NE(std::string(error.what()).find("rank 2 of 3"), std::string::npos) << error.what();
  }
}

TEST(Idob, RefusesTooFewPoles) {
  EXPECT_THROW(Idob(inertia(1.0), {{-1.0, -2.0}}, 0.01), std::invalid_argument);
  EXPECT_THROW(Idob(inertia(1.0), {{-1.0, -2.0, -3.0}}, -0.01), std::invalid_argument);
}

}  // namespace
}  // namespace breakwater
