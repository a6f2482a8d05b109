// Observers of several axes, and the poles that are logged.
#include <breakwater/observers/idob.h>
#include <breakwater/observers/kfd.h>
#include <breakwater/observers/mdob.h>
#include <breakwater/observers/multiple_model_estimator.h>
#include <breakwater/observers/observer_poles.h>
#include <breakwater/observers/raw_difference.h>
#include <breakwater/observers/stacked_estimator.h>
#include <breakwater/observers/stf.h>
#include <breakwater/plants/damped_inertia.h>
#include "support.h"

namespace breakwater::stacked_estimator_test {

// Two positions, two velocities; the outputs are the positions in the other order.
StateSpace two_axes() {
  StateSpace plant;
  plant.A = Eigen::Matrix4d::Identity();
  plant.B = Eigen::MatrixXd::Zero(4, 2);
  plant.C = Eigen::MatrixXd::Zero(2, 4);
  plant.C(0, 1) = plant.C(1, 0) = 1.0;
  return plant;
}

TEST(RawDifference, DividesTheDifferenceByThePeriod) {
  RawDifference filter(two_axes(), 0.5);
  const Eigen::Vector2d u = Eigen::Vector2d::Zero();
  filter.reset(Eigen::Vector4d::Zero());
  filter.update(u, Eigen::Vector2d(1.0, 2.0));
  EXPECT_EQ(filter.state(), Eigen::Vector4d(2.0, 1.0, 0.0, 0.0));
  filter.update(u, Eigen::Vector2d(4.0, 2.5));
  EXPECT_EQ(filter.state(), Eigen::Vector4d(2.5, 4.0, 1.0, 6.0));
}

TEST(ObserverPoles, AreEigenvaluesOfTheMatrixInBothPlanes) {
  const double T = 0.01;
  const StateSpace plant{(Eigen::Matrix2d() << 0, 1, 0, 0).finished(), Eigen::Vector2d(0, 1),
                         Eigen::RowVector2d(1, 0)};
  Idob idob(plant, {{-10.0, {-20.0, 5.0}, {-20.0, -5.0}}}, T);
  ObserverPoles poles(idob, T);
  poles.update();
  const std::vector<std::complex<double>> expected = {{-20.0, -5.0}, {-20.0, 5.0}, {-10.0, 0.0}};
  const auto at = [&poles](std::size_t part, std::size_t i) -> std::complex<double> {
    return {poles.signals()[part].values[i], poles.signals()[part + 1].values[i]};
  };
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_LT(std::abs(at(2, i) - expected[i]), 1e-6);
    EXPECT_LT(std::abs(at(0, i) - std::exp(T * expected[i])), 1e-8);
  }
  Mdob mdob({1.0, 100.0, 50.0}, T);
  ObserverPoles of_filters(mdob, T);
  of_filters.update();
  EXPECT_NEAR(of_filters.signals()[0].values[0], 0.5, 1e-12);        // 1/(1 + g_d T_s)
  EXPECT_NEAR(of_filters.signals()[0].values[1], 1.0 / 1.5, 1e-12);  // 1/(1 + g_w T_s)
}

constexpr double kPeriod = 1e-3;
const Eigen::Vector3d kInertia(2.6683, 1.6772, 0.8155);

using Estimators = std::vector<std::unique_ptr<DisturbanceEstimator>>;

SensorError encoder() {
  return {Eigen::VectorXd::Constant(1, 1e-4), Eigen::VectorXd::Zero(1)};
}

KalmanDesign walk(double inertia) {
  const ExtendedPlant plant =
      sample_with_disturbance_model(damped_inertia(inertia, 0.0), 0, kPeriod);
  return {plant, disturbance_noise(plant, 2e-6), Eigen::MatrixXd::Constant(1, 1, 2e-11),
          Eigen::MatrixXd::Identity(3, 3)};
}

std::unique_ptr<DisturbanceEstimator> estimator(int kind, double inertia) {
  const StateSpace plant = damped_inertia(inertia, 0.0);
  if (kind == 0) return std::make_unique<Kfd>(walk(inertia));
  if (kind == 1) {
    const ExtendedPlant extended = sample_with_disturbance_model(plant, 0, kPeriod);
    return std::make_unique<Stf>(stf_design(extended, encoder(), kPeriod), encoder());
  }
  return std::make_unique<MultipleModelEstimator>(
      MultipleModelDesign{plant, kPeriod, encoder(), 50.0 * inertia});
}

// Each axis has the estimates and signals of a separate estimator.
TEST(StackedEstimator, EqualsSeparateAxes) {
  for (const int kind : {0, 1, 2}) {
    Estimators stacked, alone;
    for (const double inertia : kInertia) {
      stacked.push_back(estimator(kind, inertia));
      alone.push_back(estimator(kind, inertia));
    }
    StackedEstimator all(std::move(stacked));
    testing::Random random(3);
    Eigen::VectorXd x(6);
    x << random.vector(3, 1e-3), random.vector(3, 1e-2);
    all.reset(x);
    for (int i = 0; i < 3; ++i) alone[i]->reset(Eigen::Vector2d(x(i), x(3 + i)));
    for (int k = 0; k < 200; ++k) {
      const Eigen::VectorXd u = random.vector(3, 10.0), y = random.vector(3, 1e-2);
      all.update(u, y);
      for (int i = 0; i < 3; ++i) {
        alone[i]->update(u.segment<1>(i), y.segment<1>(i));
        ASSERT_EQ(all.state()(i), alone[i]->state()(0));
        ASSERT_EQ(all.state()(3 + i), alone[i]->state()(1));
        ASSERT_EQ(all.disturbance()(i), alone[i]->disturbance()(0));
        for (const Signal& one : alone[i]->signals()) {
          const bool is_number = one.values.size() == 1;
          const std::string name = is_number ? one.name : one.name + "_q" + std::to_string(i + 1);
          const auto found = std::find_if(all.signals().begin(), all.signals().end(),
                                          [&](const Signal& s) { return s.name == name; });
          ASSERT_NE(found, all.signals().end()) << name;
          if (is_number) {
            ASSERT_EQ(found->values.size(), 3U);
            ASSERT_EQ(found->values[static_cast<std::size_t>(i)], one.values[0]) << name;
          } else {
            ASSERT_TRUE(std::equal(found->values.begin(), found->values.end(), one.values.begin(),
                                   one.values.end()));
          }
        }
      }
    }
  }
}

// Three IDOBs equal the thesis' IDOB of all joints (Eqs. 2.54–2.58).
TEST(StackedEstimator, WithIdobsEqualsTheIdobOfAllJoints) {
  StateSpace plant{Eigen::MatrixXd::Zero(6, 6), Eigen::MatrixXd::Zero(6, 3),
                   Eigen::MatrixXd::Zero(3, 6)};
  plant.A.topRightCorner(3, 3).setIdentity();
  plant.B.bottomRows(3) = kInertia.cwiseInverse().asDiagonal();
  plant.C.leftCols(3).setIdentity();
  const std::vector<PoleGroup> poles = {
      {-40.0, -43.0, -46.0}, {-41.0, -44.0, -47.0}, {-42.0, -45.0, -48.0}};
  Idob arm(plant, poles, kPeriod);
  Estimators joints;
  for (std::size_t i = 0; i < 3; ++i) {
    joints.push_back(std::make_unique<Idob>(damped_inertia(kInertia(i), 0.0),
                                            std::vector<PoleGroup>{poles[i]}, kPeriod));
  }
  StackedEstimator stacked(std::move(joints));
  testing::Random random(5);
  const Eigen::VectorXd x = random.vector(6);
  arm.reset(x);
  stacked.reset(x);
  for (int k = 0; k < 500; ++k) {
    const Eigen::VectorXd u = random.vector(3, 10.0), y = random.vector(3, 1e-2);
    arm.update(u, y);
    stacked.update(u, y);
    ASSERT_LE((arm.state() - stacked.state()).norm(), 1e-9 * arm.state().norm()) << k;
    ASSERT_LE((arm.disturbance() - stacked.disturbance()).norm(), 1e-9 * arm.disturbance().norm());
  }
}

}  // namespace breakwater::stacked_estimator_test
