// Filters with one output have a recursion of their own. It is compared with matrix products.
#include <gtest/gtest.h>

#include <memory>
#include <vector>

#include <breakwater/observers/fakfd.h>
#include <breakwater/observers/kfd.h>
#include <breakwater/observers/qvff.h>
#include <breakwater/observers/stf.h>
#include <breakwater/plants/damped_inertia.h>
#include "observers/idle_output.h"
#include "support.h"

namespace breakwater::one_output_test {
namespace {

constexpr double kPeriod = 0.01;

StateSpace two_masses() {
  StateSpace plant{Eigen::MatrixXd::Zero(4, 4), Eigen::MatrixXd::Zero(4, 1),
                   Eigen::MatrixXd::Identity(1, 4)};
  plant.A.topRightCorner(2, 2).setIdentity();
  plant.A.row(2) << -50, 50, -1, 1;
  plant.A.row(3) << 50, -50, 1, -1;
  plant.B(2) = 1.0;
  return plant;
}

SensorError sensor(Eigen::Index outputs) {
  return {Eigen::VectorXd::Constant(outputs, 1e-3), Eigen::VectorXd::Constant(outputs, 1e-4)};
}

using Filters = std::vector<std::unique_ptr<DisturbanceEstimator>>;

Filters filters(const ExtendedPlant& plant) {
  const Eigen::Index N = plant.states(), p = plant.outputs();
  const KalmanDesign design{plant, disturbance_noise(plant, 1e-2),
                            1e-6 * Eigen::MatrixXd::Identity(p, p),
                            Eigen::MatrixXd::Identity(N, N)};
  Filters all;
  all.push_back(std::make_unique<Kfd>(design));
  all.push_back(std::make_unique<Fakfd>(design, scalar_gamma(plant, 1.05)));
  all.push_back(std::make_unique<Vfakfd>(variable_forgetting_design(plant, kQvffInitialCovariance),
                                         qvff_design(sensor(p))));
  all.push_back(std::make_unique<Stf>(stf_design(plant, sensor(p), kPeriod), sensor(p)));
  return all;
}

// Two to seven states, also over variable intervals. Seven use matrix products too.
TEST(OneOutput, EqualsMatrixProducts) {
  const StateSpace first_order{Eigen::MatrixXd::Constant(1, 1, -0.4), Eigen::MatrixXd::Ones(1, 1),
                               Eigen::MatrixXd::Ones(1, 1)};
  for (const auto& [continuous, order] :
       {std::pair(first_order, 0), std::pair(damped_inertia(0.5, 0.2), 0),
        std::pair(damped_inertia(0.5, 0.2), 1), std::pair(damped_inertia(0.5, 0.2), 2),
        std::pair(two_masses(), 0), std::pair(two_masses(), 1), std::pair(two_masses(), 2)}) {
    const ExtendedPlant plant = sample_with_disturbance_model(continuous, order, kPeriod);
    const Filters one = filters(plant), two = filters(testing::with_idle_output(plant));
    for (std::size_t i = 0; i < one.size(); ++i) {
      testing::Random random(order);
      for (int k = 0; k < 300; ++k) {
        const double jitter = k > 100 ? random.uniform(0.5, 3.0) : 1.0;
        const SampleInterval interval{jitter * kPeriod, k > 200 ? 1e-4 : 0.0, 0.1, 1e-3};
        if (k > 100) {
          EXPECT_EQ(one[i]->follow(interval), two[i]->follow(interval));
        }
        const Eigen::VectorXd u = random.vector(1);
        const Eigen::Vector2d y(1e-3 * (k / 7), 0.0);
        one[i]->update(u, y.head<1>());
        two[i]->update(u, y);
        ASSERT_LE((one[i]->state() - two[i]->state()).norm(), 1e-8 * two[i]->state().norm())
            << plant.states() << " states, filter " << i << ", sample " << k;
        ASSERT_LE((one[i]->disturbance() - two[i]->disturbance()).norm(),
                  1e-8 * (1.0 + two[i]->disturbance().norm()))
            << plant.states() << " states, filter " << i << ", sample " << k;
      }
    }
  }
}

}  // namespace
}  // namespace breakwater::one_output_test
