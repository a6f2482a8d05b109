#include <breakwater/observers/sized_filters.h>

#include <gtest/gtest.h>

#include <breakwater/observers/fakfd.h>
#include <breakwater/observers/kfd.h>
#include <breakwater/observers/qvff.h>
#include <breakwater/observers/stf.h>
#include <breakwater/plants/damped_inertia.h>
#include "support.h"

namespace breakwater::sized_filters_test {
namespace {

constexpr double kPeriod = 0.01;

// The sized filters of runs and of Python equal the filters of dynamic size, also over variable
// intervals.
TEST(SizedFilters, EqualTheFiltersOfDynamicSize) {
  const SensorError sensor{Eigen::VectorXd::Constant(1, 1e-3), Eigen::VectorXd::Constant(1, 1e-4)};
  for (const int order : {0, 1, 2}) {
    const ExtendedPlant plant =
        sample_with_disturbance_model(damped_inertia(0.5, 0.2), order, kPeriod);
    const Eigen::Index N = plant.states();
    const KalmanDesign design{plant, disturbance_noise(plant, 1e-2),
                              Eigen::MatrixXd::Constant(1, 1, 1e-6),
                              Eigen::MatrixXd::Identity(N, N)};
    const Eigen::VectorXd gamma = scalar_gamma(plant, 1.05);
    const KalmanDesign of_stf = stf_design(plant, sensor, kPeriod);
    const KalmanDesign of_qvff = variable_forgetting_design(plant, kQvffInitialCovariance);
    std::vector<
        std::pair<std::unique_ptr<DisturbanceEstimator>, std::unique_ptr<DisturbanceEstimator>>>
        pairs;
    pairs.emplace_back(sized_kfd(design), std::make_unique<Kfd<>>(design));
    pairs.emplace_back(sized_fakfd(design, gamma), std::make_unique<Fakfd<>>(design, gamma));
    pairs.emplace_back(sized_vfakfd(of_qvff, qvff_design(sensor)),
                       std::make_unique<Vfakfd<>>(of_qvff, qvff_design(sensor)));
    pairs.emplace_back(sized_stf(of_stf, sensor), std::make_unique<Stf<>>(of_stf, sensor));
    for (const auto& [sized, dynamic] : pairs) {
      EXPECT_NE(typeid(*sized), typeid(*dynamic));
      testing::Random random(order);
      for (int k = 0; k < 300; ++k) {
        const double jitter = k > 100 ? random.uniform(0.5, 3.0) : 1.0;
        const SampleInterval interval{jitter * kPeriod, k > 200 ? 1e-4 : 0.0, 0.1, 1e-3};
        if (k > 100) {
          EXPECT_EQ(sized->follow(interval), dynamic->follow(interval));
        }
        const Eigen::VectorXd u = random.vector(1);
        const Eigen::VectorXd y = Eigen::VectorXd::Constant(1, 1e-3 * (k / 7));
        sized->update(u, y);
        dynamic->update(u, y);
        ASSERT_LE((sized->state() - dynamic->state()).norm(), 1e-8 * dynamic->state().norm()) << k;
        ASSERT_LE((sized->disturbance() - dynamic->disturbance()).norm(),
                  1e-8 * (1.0 + dynamic->disturbance().norm()))
            << k;
      }
    }
  }
}

// Two outputs, or more states than the compiled sizes.
TEST(SizedFilters, WorkWithDynamicSize) {
  StateSpace plant{Eigen::MatrixXd::Zero(4, 4), Eigen::MatrixXd::Zero(4, 1),
                   Eigen::MatrixXd::Zero(2, 4)};
  plant.A.topRightCorner(2, 2).setIdentity();
  plant.A.row(2) << -50, 50, -1, 1;
  plant.A.row(3) << 50, -50, 1, -1;
  plant.B(2) = 1.0;
  plant.C.leftCols(2).setIdentity();
  for (const int outputs : {1, 2}) {
    StateSpace some = plant;
    some.C = plant.C.topRows(outputs);
    const ExtendedPlant extended = sample_with_disturbance_model(some, 2, kPeriod);
    const KalmanDesign design{extended, input_noise(extended, 1.0),
                              Eigen::MatrixXd::Identity(outputs, outputs),
                              Eigen::MatrixXd::Identity(7, 7)};
    const auto filter = sized_kfd(design);
    EXPECT_EQ(filter->state().size(), 4);
    EXPECT_EQ(typeid(*filter), typeid(Kfd<>));
  }
}

}  // namespace
}  // namespace breakwater::sized_filters_test
