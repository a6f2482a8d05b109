// The plain state observer: its poles, and the effect of a disturbance.
#include <breakwater/linear/eigenvalues.h>
#include <breakwater/observers/state_observer.h>

#include <cmath>

#include <breakwater/plants/damped_inertia.h>
#include "support.h"

namespace breakwater {
namespace {

TEST(StateObserver, ErrorHasThePlacedPolesAndDisturbanceBiasesIt) {
  const StateSpace plant = damped_inertia(0.625, 0.78);
  const StateSpace sampled = zero_order_hold(plant, 0.01);
  StateObserver observer(plant, {{-20.0, -25.0}}, 0.01);
  Eigen::MatrixXd F(2, 2);
  observer.pole_matrix(F);
  EXPECT_LT(testing::distance(eigenvalues(F), {std::exp(-0.2), std::exp(-0.25)}), 1e-9);

  // Without a disturbance it converges from any start, and its estimated disturbance is zero.
  const auto error_after = [&](double disturbance) {
    Eigen::VectorXd x = Eigen::Vector2d(0.3, -0.2);
    Eigen::VectorXd u = Eigen::VectorXd::Constant(1, 0.7);
    observer.reset(Eigen::VectorXd::Zero(2));
    for (int k = 0; k < 400; ++k) {
      observer.update(u, sampled.C * x);
      if (k < 399) x = sampled.A * x + sampled.B * (u.array() - disturbance).matrix();
    }
    EXPECT_EQ(observer.disturbance()(0), 0.0);
    return (observer.state() - x).norm();
  };
  EXPECT_LT(error_after(0.0), 1e-9);
  EXPECT_GT(error_after(1.0), 1e-3);
}

TEST(StateObserver, RefusesUnstablePoles) {
  const StateSpace plant = damped_inertia(0.625, 0.78);
  using Poles = std::vector<PoleGroup>;
  for (const PoleGroup& group : {PoleGroup{-20.0, 5.0}, PoleGroup{-20.0, 0.0},
                                 PoleGroup{{0.1, 3.0}, {0.1, -3.0}}, PoleGroup{-20.0, NAN}}) {
    EXPECT_THROW(StateObserver(plant, Poles{group}, 0.01), std::invalid_argument);
  }
}

}  // namespace
}  // namespace breakwater
