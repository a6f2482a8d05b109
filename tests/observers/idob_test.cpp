// Observers with placed poles or filters, alone and stacked for several axes.
#include <breakwater/linear/eigenvalues.h>
#include <breakwater/observers/idob.h>
#include <breakwater/observers/kfd.h>
#include <breakwater/observers/mdob.h>
#include <breakwater/observers/multiple_model_estimator.h>
#include <breakwater/observers/raw_difference.h>
#include <breakwater/observers/stacked_estimator.h>
#include <breakwater/observers/state_observer.h>
#include <breakwater/observers/stf.h>
#include <breakwater/plants/damped_inertia.h>
#include "support.h"

namespace breakwater::idob_test {

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

TEST(Idob, ErrorFollowsTheErrorDynamics) {
  // On its nominal plant with a constant disturbance, e(k+1) = (Ā − H C̄) e(k) for any input. The
  // estimate at a sample does not include its measurement (Eqs. 2.21, 2.22).
  const double T = 0.01, J = 2.0, d = 3.0;
  const StateSpace sampled = zero_order_hold(damped_inertia(J, 0.0), T);
  Idob observer(damped_inertia(J, 0.0), {{-10.0, -20.0, -30.0}}, T);
  observer.reset(Eigen::Vector2d(0.1, 0.0));
  Eigen::Vector2d x(0.4, -0.2);
  Eigen::Vector3d error(x(0) - 0.1, x(1), d);
  Eigen::VectorXd u = Eigen::VectorXd::Constant(1, NAN);  // no input before the first sample
  testing::Random random;
  for (int k = 0; k < 500; ++k) {
    observer.update(u, sampled.C * x);
    EXPECT_EQ(observer.signals()[0].values[0], x(0) - observer.state()(0));
    Eigen::Vector3d truth(x(0), x(1), d);
    EXPECT_LT((truth - estimate(observer) - error).norm(), 1e-10) << k;
    u = random.vector(1, 5.0);
    x = sampled.A * x + sampled.B * (u(0) - d);
    error = error_dynamics(observer) * error;
  }
  EXPECT_NEAR(observer.disturbance()(0), d, 1e-8);
}

TEST(Idob, RefusesAnUnobservablePlantWithItsRank) {
  // A free integrator beside the measured one is unobservable. Position and disturbance of the
  // measured one stay observable.
  StateSpace plant{Eigen::Matrix2d::Zero(), Eigen::Vector2d(1, 0), Eigen::RowVector2d(1, 0)};
  EXPECT_TRUE(has(complaint_of([&] { Idob(plant, {{-1.0, -2.0, -3.0}}, 0.01); }), "rank 2 of 3"));
}

TEST(Idob, RefusesTooFewPoles) {
  EXPECT_REFUSED(Idob(damped_inertia(1.0, 0.0), {{-1.0, -2.0}}, 0.01));
  EXPECT_REFUSED(Idob(damped_inertia(1.0, 0.0), {{-1.0, -2.0, -3.0}}, -0.01));
}

// The plain state observer: its poles, and the effect of a disturbance.

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
    EXPECT_REFUSED(StateObserver(plant, Poles{group}, 0.01));
  }
}

Eigen::VectorXd number(double value) {
  return Eigen::VectorXd::Constant(1, value);
}

// An observer after a sample with angle 0 at rest.
void begin(Mdob& observer) {
  observer.reset(Eigen::Vector2d::Zero());
  observer.update(number(NAN), number(0.0));
}

TEST(Mdob, AtRestEstimatesTheFilteredTorque) {
  // q = 0 under torque τ: the disturbance is τ, its estimate τ (1 − e^{−g_w t}), exact at samples.
  const double T = 1e-3, g_w = 80.0, torque = 7.0;
  Mdob observer({1.5, 300.0, g_w}, T);
  begin(observer);
  for (int k = 1; k <= 100; ++k) {
    observer.update(number(torque), number(0.0));
    EXPECT_NEAR(observer.disturbance()(0), torque * -std::expm1(-g_w * k * T), 1e-12);
  }
}

TEST(Mdob, EstimatesZeroOnItsNominalPlant) {
  // Free acceleration: τ = J q̈ needs no disturbance. The error vanishes with the period.
  const double J = 0.8, torque = 2.0;
  double previous = 1e300;
  for (const double T : {1e-3, 1e-4, 1e-5}) {
    Mdob observer({J, 1e4, 100.0}, T);
    begin(observer);
    double largest_late = 0.0;
    const int steps = static_cast<int>(std::lround(0.3 / T));
    for (int k = 1; k <= steps; ++k) {
      const double t = k * T;
      observer.update(number(torque), number(0.5 * torque / J * t * t));
      if (t > 0.2) largest_late = std::max(largest_late, std::abs(observer.disturbance()(0)));
    }
    EXPECT_LT(largest_late, 0.5 * previous);
    previous = largest_late;
  }
  EXPECT_LT(previous, 0.02 * torque);
}

TEST(Mdob, FindsAConstantDisturbanceWithTheSignOfEq253) {
  // J q̈ = τ − d with τ = 0: the disturbance pushes the joint back, so d̂ must be positive.
  const double T = 1e-4, J = 1.0, d = 10.0;
  Mdob observer({J, 2000.0, 50.0}, T);
  begin(observer);
  for (int k = 1; k <= 10000; ++k) {
    const double t = k * T;
    observer.update(number(0.0), number(-0.5 * d / J * t * t));
  }
  EXPECT_NEAR(observer.disturbance()(0), d, 0.05);
  EXPECT_NEAR(observer.state()(1), -d / J, 0.02);
}

TEST(Mdob, ARawDifferenceIsOne) {
  Mdob observer({1.0, INFINITY, 50.0}, 1e-3);
  observer.reset(Eigen::Vector2d::Zero());
  observer.update(number(0.0), number(0.5));
  EXPECT_EQ(observer.state()(1), 0.0);  // one sample gives no difference
  observer.update(number(0.0), number(0.7));
  EXPECT_NEAR(observer.state()(1), 200.0, 1e-9);
  EXPECT_EQ(observer.state()(0), 0.7);
}

TEST(Mdob, RefusesNonsense) {
  EXPECT_REFUSED(Mdob({0.0, 1.0, 1.0}, 1e-3));
  EXPECT_REFUSED(Mdob({1.0, -1.0, 1.0}, 1e-3));
  EXPECT_REFUSED(Mdob({1.0, 1.0, std::nan("")}, 1e-3));
  EXPECT_REFUSED(Mdob({1.0, 1.0, 1.0}, 0.0));
  EXPECT_REFUSED(Mdob({1.0, 1.0, INFINITY}, 1e-3)) << "estimates would be NaN";
}

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

TEST(RawDifference, RefusesAPlantThatDoesNotMeasureEachPosition) {
  StateSpace one_output = two_axes(), scaled = two_axes();
  one_output.C = one_output.C.topRows(1).eval();
  scaled.C *= 2.0;
  EXPECT_REFUSED(RawDifference(one_output, 0.5));
  EXPECT_REFUSED(RawDifference(scaled, 0.5));
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

TEST(StackedEstimator, RefusesAPlantThatIsNotAnAxis) {
  EXPECT_REFUSED(StackedEstimator{Estimators()});
  Estimators axes;
  axes.push_back(
      std::make_unique<Idob>(StateSpace{Eigen::MatrixXd::Zero(1, 1), Eigen::MatrixXd::Ones(1, 1),
                                        Eigen::MatrixXd::Ones(1, 1)},
                             std::vector<PoleGroup>{{-1.0, -2.0}}, 0.1));
  EXPECT_REFUSED(StackedEstimator(std::move(axes)));
}

}  // namespace breakwater::idob_test
