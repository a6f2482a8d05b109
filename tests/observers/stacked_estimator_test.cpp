#include <breakwater/linear/eigenvalues.h>
#include <breakwater/observers/stacked_estimator.h>

#include <gtest/gtest.h>

#include <cmath>
#include <stdexcept>

#include <breakwater/observers/idob.h>
#include <breakwater/observers/kfd.h>
#include <breakwater/observers/multiple_model_estimator.h>
#include <breakwater/observers/stf.h>
#include <breakwater/plants/damped_inertia.h>
#include "support.h"

namespace breakwater::stacked_estimator_test {
namespace {

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

// The filter of a triple integrator has Butterworth poles of order 3, w³ = √(Q/R)/(T_s J), as in
// the arm's scenario files.
TEST(Kfd, ForARandomWalkConvergesToButterworthPoles) {
  for (const double inertia : kInertia) {
    Kfd kfd(walk(inertia));
    for (int k = 0; k < 3000; ++k) kfd.update(Eigen::VectorXd::Zero(1), Eigen::VectorXd::Zero(1));
    Eigen::MatrixXd F(3, 3);
    kfd.pole_matrix(F);
    const double w = std::cbrt(std::sqrt(2e-6 / 2e-11) / (kPeriod * inertia));
    PoleGroup found = eigenvalues(F);
    for (auto& pole : found) pole = std::log(pole) / kPeriod;
    const PoleGroup expected = {
        -w, {-0.5 * w, std::sqrt(0.75) * w}, {-0.5 * w, -std::sqrt(0.75) * w}};
    EXPECT_LT(testing::distance(found, expected), 0.08 * w) << inertia;
  }
}

TEST(StackedEstimator, RefusesAPlantThatIsNotAnAxis) {
  EXPECT_THROW(StackedEstimator{Estimators()}, std::invalid_argument);
  Estimators axes;
  axes.push_back(
      std::make_unique<Idob>(StateSpace{Eigen::MatrixXd::Zero(1, 1), Eigen::MatrixXd::Ones(1, 1),
                                        Eigen::MatrixXd::Ones(1, 1)},
                             std::vector<PoleGroup>{{-1.0, -2.0}}, 0.1));
  EXPECT_THROW(StackedEstimator(std::move(axes)), std::invalid_argument);
}

}  // namespace
}  // namespace breakwater::stacked_estimator_test
