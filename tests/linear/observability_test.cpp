#include <breakwater/linear/observability.h>

#include <breakwater/linear/state_space.h>
#include "support.h"

namespace breakwater {
namespace {

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

}  // namespace
}  // namespace breakwater
