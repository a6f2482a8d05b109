// The Kalman filters with disturbance estimation, on random stable plants; their designs and steady
// states.
#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>

#include <breakwater/linear/pole_placement.h>
#include <breakwater/observers/disturbance_model.h>
#include <breakwater/observers/fakfd.h>
#include <breakwater/observers/idob.h>
#include <breakwater/observers/kalman_estimator.h>
#include <breakwater/observers/kfd.h>
#include <breakwater/observers/mdob.h>
#include <breakwater/observers/observer_poles.h>
#include <breakwater/observers/stf.h>
#include <breakwater/observers/vfakfd.h>
#include <breakwater/plants/damped_inertia.h>
#include "linear/scipy_riccati.h"
#include "observers/idle_output.h"
#include "observers/random_plant.h"

namespace breakwater::kalman_estimators_test {

using testing::congruence;
using testing::kalman_gain;
using testing::Random;
using testing::random_plant;

Eigen::MatrixXd random_covariance(Random& random, Eigen::Index size, double scale) {
  const Eigen::MatrixXd root = random.matrix(size, size);
  return scale * (root * root.transpose() + 0.1 * Eigen::MatrixXd::Identity(size, size));
}

KalmanDesign random_design(Random& random, Eigen::Index n, Eigen::Index m, Eigen::Index p,
                           int order) {
  KalmanDesign design;
  design.plant = extend_by_disturbance_model(random_plant(random, n, m, p), order, 0.1);
  design.Q = random_covariance(random, design.plant.states(), 1e-2);
  design.R = random_covariance(random, p, 1.0);
  design.P0 = random_covariance(random, design.plant.states(), 1.0);
  return design;
}

ExtendedPlant double_integrator(double period_s) {
  return extend_by_disturbance_model(zero_order_hold(damped_inertia(1.0, 0.0), period_s), 0,
                                     period_s);
}

SensorError sensor(double quantum, Eigen::Index outputs = 1, double noise_std = 0.0) {
  return {Eigen::VectorXd::Constant(outputs, quantum),
          Eigen::VectorXd::Constant(outputs, noise_std)};
}

VfakfdDesign forgetting(double alpha, Eigen::Index outputs = 1) {
  return {Eigen::VectorXd::Constant(outputs, alpha), Eigen::VectorXd::Zero(outputs)};
}

using Filters = std::vector<std::unique_ptr<KalmanEstimator>>;

// Symmetric and positive definite. P is scaled to correlations, since T makes the scales of the
// states differ by 1e6.
void expect_covariances(const Filters& filters, const std::string& where) {
  for (std::size_t i = 0; i < filters.size(); ++i) {
    const Eigen::MatrixXd P = filters[i]->P();
    ASSERT_EQ(P, P.transpose()) << where << " " << i;
    const Eigen::VectorXd scale = P.diagonal().cwiseSqrt().cwiseInverse();
    const Eigen::MatrixXd correlation = scale.asDiagonal() * P * scale.asDiagonal();
    ASSERT_EQ(Eigen::LLT<Eigen::MatrixXd>(correlation).info(), Eigen::Success) << where << " " << i;
    const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(correlation);
    ASSERT_GT(eigen.eigenvalues()(0), 0.0) << where << " " << i;
  }
}

VfakfdDesign never_forgets(Eigen::Index p) {
  VfakfdDesign design;
  design.alpha = Eigen::VectorXd::Constant(p, 1.0);
  design.dead_zone = Eigen::VectorXd::Constant(p, 1e300);
  return design;
}

TEST(Kfd, IsTheTextbookFilter) {
  // Eqs. 3.7–3.11 with dense inverses.
  Random random(3);
  for (const auto& [n, m, p] : {std::tuple(2, 1, 1), std::tuple(3, 2, 2), std::tuple(4, 1, 2)}) {
    const KalmanDesign design = random_design(random, n, m, p, m == 1 ? 1 : 0);
    const StateSpace& s = design.plant.sampled;
    Kfd filter(design);
    Eigen::VectorXd x = Eigen::VectorXd::Zero(s.states());
    Eigen::MatrixXd P = design.P0;
    for (int k = 0; k < 200; ++k) {
      const Eigen::VectorXd u = random.vector(m), y = random.vector(p);
      if (k > 0) {
        x = s.A * x + s.B * u;
        P = congruence(s.A, P) + design.Q;
      }
      const Eigen::MatrixXd G = kalman_gain(P, s.C, design.R);
      x = x + G * (y - s.C * x);
      P = P - G * s.C * P;
      filter.update(u, y);
      EXPECT_LT((filter.extended_state() - x).norm(), 1e-12 * (1.0 + x.norm()));
      EXPECT_LT((filter.P() - P).norm(), 1e-12 * (1.0 + P.norm()));
    }
    EXPECT_EQ(filter.state().size(), n);
    EXPECT_EQ(filter.disturbance().size(), m);
    EXPECT_EQ(filter.disturbance()(0), filter.extended_state()(n));
  }
}

// One output has a recursion of its own. It is compared with the matrices, for the first state as
// output and for a combination of states.
TEST(AdaptiveFilters, OneOutputEqualsMatrixProducts) {
  Random random(15);
  for (int trial = 0; trial < 10; ++trial) {
    KalmanDesign design = random_design(random, 2, 1, 1, 0);
    if (trial % 2 == 0) design.plant.sampled.C = Eigen::RowVector3d::Unit(0);
    KalmanDesign two = design;
    two.plant = testing::with_idle_output(design.plant);
    two.R = Eigen::Vector2d(design.R(0, 0), 1.0).asDiagonal();
    const Eigen::VectorXd gamma = Eigen::Vector3d(1.0, 1.1, 1.3);
    const auto forgetting = [](Eigen::Index p) {
      return VfakfdDesign{Eigen::VectorXd::Constant(p, 4.0), Eigen::VectorXd::Constant(p, 0.2), 0.6,
                          0.98};
    };
    const auto error = [](Eigen::Index p) {
      return SensorError{Eigen::VectorXd::Constant(p, 0.4), Eigen::VectorXd::Constant(p, 0.1)};
    };
    Fakfd fakfd(design, gamma), fakfd_of_two(two, gamma);
    Vfakfd vfakfd(design, forgetting(1)), vfakfd_of_two(two, forgetting(2));
    Stf stf(design, error(1)), stf_of_two(two, error(2));
    double least = 1.0, most = 0.0, inflated = 1.0;  // range of λ
    for (int k = 0; k < 500; ++k) {
      const Eigen::VectorXd u = random.vector(1), y = random.vector(1, k % 50 == 0 ? 30.0 : 1.0);
      const auto expect_same = [&](KalmanEstimator& one, KalmanEstimator& of_two,
                                   const char* name) {
        one.update(u, y);
        of_two.update(u, Eigen::Vector2d(y(0), 0.0));
        EXPECT_LT((one.extended_state() - of_two.extended_state()).norm(),
                  1e-11 * (1.0 + one.extended_state().norm()))
            << name << " " << trial << " " << k;
        EXPECT_LT((one.P() - of_two.P()).norm(), 1e-11 * (1.0 + one.P().norm())) << name;
        EXPECT_NEAR(one.lambda(), of_two.lambda(), 1e-12) << name;
        EXPECT_EQ(one.P(), one.P().transpose()) << name;
      };
      expect_same(fakfd, fakfd_of_two, "FAKFD");
      expect_same(vfakfd, vfakfd_of_two, "VFAKFD");
      expect_same(stf, stf_of_two, "STF");
      least = std::min(least, vfakfd.lambda());
      most = std::max(most, vfakfd.lambda());
      inflated = std::min(inflated, stf.lambda());
    }
    EXPECT_NEAR(least, 0.6, 1e-12);
    EXPECT_NEAR(most, 0.98, 1e-12);
    EXPECT_LT(inflated, 1.0);
  }
}

TEST(AdaptiveFilters, WithoutForgettingEqualTheKalmanFilter) {
  Random random(5);
  for (int trial = 0; trial < 20; ++trial) {
    const Eigen::Index n = 1 + trial % 4, p = 1 + trial % 2;
    const KalmanDesign design = random_design(random, n, 1, p, n < 4 && p == 1 ? trial % 3 : 0);
    // The filters of the VFAKFD family use R = λ = 1 in the observer.
    KalmanDesign unit = design;
    unit.R.setIdentity(p, p);
    const SensorError coarse{Eigen::VectorXd::Constant(p, 1e300), Eigen::VectorXd::Zero(p)};
    Kfd plain(design), plain_unit(unit);
    Fakfd scalar(design, scalar_gamma(design.plant, 1.0));
    Fakfd diagonal(design, diagonal_gamma(design.plant, 1.0));
    Vfakfd variable(design, never_forgets(p));
    Stf gated(design, coarse);
    for (int k = 0; k < 300; ++k) {
      const Eigen::VectorXd u = random.vector(1), y = random.vector(p);
      for (DisturbanceEstimator* filter : std::initializer_list<DisturbanceEstimator*>{
               &plain, &plain_unit, &scalar, &diagonal, &variable, &gated}) {
        filter->update(u, y);
      }
      const double scale = 1.0 + plain.extended_state().norm();
      EXPECT_LT((scalar.extended_state() - plain.extended_state()).norm(), 1e-12 * scale);
      EXPECT_LT((diagonal.extended_state() - plain.extended_state()).norm(), 1e-12 * scale);
      EXPECT_LT((gated.extended_state() - plain.extended_state()).norm(), 1e-12 * scale);
      // With one output, the VFAKFD rounds differently: it divides once.
      EXPECT_LT((variable.extended_state() - plain_unit.extended_state()).norm(),
                (p == 1 ? 1e-11 : 1e-12) * (1.0 + plain_unit.extended_state().norm()));
      EXPECT_LT((gated.P() - plain.P()).norm(), 1e-12 * plain.P().norm());
      EXPECT_LT((variable.P() - plain_unit.P()).norm(), 1e-12 * plain_unit.P().norm());
    }
  }
}

TEST(Fakfd, HasTheSymmetricFormAndForScalarsEquation418) {
  Random random(6);
  const KalmanDesign design = random_design(random, 2, 1, 1, 1);
  Kfd one_step(design);
  for (const Eigen::VectorXd& gamma :
       {scalar_gamma(design.plant, 1.25), diagonal_gamma(design.plant, 1.25)}) {
    Fakfd filter(design, gamma);
    const Eigen::VectorXd u = random.vector(1), y = random.vector(1);
    one_step.reset(Eigen::Vector2d::Zero());
    one_step.update(u, y);
    filter.update(u, y);
    const Eigen::MatrixXd root = gamma.cwiseSqrt().asDiagonal();
    EXPECT_LT((filter.P() - root * one_step.P() * root).norm(), 1e-14);
    EXPECT_EQ(filter.lambda(), 0.8);
  }
  EXPECT_EQ(diagonal_gamma(design.plant, 1.25).head(2), Eigen::Vector2d::Ones());
  EXPECT_EQ(diagonal_gamma(design.plant, 1.25).tail(2), Eigen::Vector2d::Constant(1.25));
  for (const double gamma : {0.9, 1.1e6, std::nan("")}) {
    EXPECT_REFUSED(Fakfd(design, scalar_gamma(design.plant, gamma)));
  }
  EXPECT_REFUSED(Fakfd(design, Eigen::VectorXd::Ones(3)));
}

TEST(AsymmetricFakfd, IsEquation45AsPrintedAndItsLeftForm) {
  Random random(16);
  for (const CovarianceForm form : {CovarianceForm::printed, CovarianceForm::left}) {
    const KalmanDesign design = random_design(random, 2, 1, 1, 1);
    const StateSpace& s = design.plant.sampled;
    const Eigen::VectorXd gamma = diagonal_gamma(design.plant, 1.05);
    AsymmetricFakfd filter(design, gamma, form);
    const Eigen::MatrixXd G = gamma.asDiagonal();
    Eigen::VectorXd x = Eigen::VectorXd::Zero(4);
    Eigen::MatrixXd P = design.P0;
    for (int k = 0; k < 100; ++k) {
      const Eigen::VectorXd u = random.vector(1), y = random.vector(1);
      if (k > 0) {
        x = s.A * x + s.B * u;
        P = congruence(s.A, P) + design.Q;
      }
      const Eigen::MatrixXd K = kalman_gain(P, s.C, design.R);
      const Eigen::MatrixXd I = Eigen::MatrixXd::Identity(4, 4);
      x = x + K * (y - s.C * x);
      P = form == CovarianceForm::printed ? Eigen::MatrixXd((G - K * s.C) * P)
                                          : Eigen::MatrixXd(G * (I - K * s.C) * P);
      filter.update(u, y);
      EXPECT_LT((filter.extended_state() - x).norm(), 1e-10 * (1.0 + x.norm()));
      EXPECT_LT((filter.P() - P).norm(), 1e-10 * P.norm());
    }
    EXPECT_GT((P - P.transpose()).norm(), 1e-3 * P.norm()) << "no covariance";
    EXPECT_EQ(filter.lambda(), 1.0 / 1.05);
  }
  const KalmanDesign two = random_design(random, 3, 1, 2, 0);
  EXPECT_REFUSED(AsymmetricFakfd(two, Eigen::VectorXd::Ones(4), CovarianceForm::printed));
}

TEST(Vfakfd, LambdaFollowsEquation420) {
  Random random(7);
  KalmanDesign design = random_design(random, 2, 1, 1, 0);
  const double alpha = 0.3;
  Vfakfd filter(design, {Eigen::VectorXd::Constant(1, alpha), Eigen::VectorXd::Zero(1)});
  bool wide = false, narrow = false, between = false;
  for (int k = 0; k < 300; ++k) {
    const Eigen::MatrixXd P = filter.P();
    const Eigen::VectorXd x = filter.extended_state();
    const StateSpace& s = design.plant.sampled;
    const Eigen::VectorXd u = random.vector(1), y = random.vector(1, k % 3 == 0 ? 0.1 : 1.0);
    filter.update(u, y);
    const Eigen::MatrixXd prior = k > 0 ? Eigen::MatrixXd(congruence(s.A, P) + design.Q) : P;
    const Eigen::VectorXd predicted = k > 0 ? Eigen::VectorXd(s.A * x + s.B * u) : x;
    const double e = (y - s.C * predicted)(0);
    const double output_variance = congruence(s.C, prior)(0, 0);
    const double raw = 1.0 - e * e / alpha / (1.0 + output_variance);
    EXPECT_NEAR(filter.lambda(), std::min(1.0, std::max(0.8, raw)), 1e-12);
    EXPECT_NEAR(filter.innovation()(0), e, 1e-12);
    // Eqs. 4.18 and 4.19 with this λ(k).
    const Eigen::VectorXd K = prior * s.C.transpose() / (output_variance + filter.lambda());
    EXPECT_LT((filter.K() - K).norm(), 1e-12 * (1.0 + K.norm()));
    EXPECT_LT((filter.P() - (prior - K * s.C * prior) / filter.lambda()).norm(),
              1e-11 * prior.norm());
    narrow |= filter.lambda() == 0.8;
    wide |= filter.lambda() > 0.99;
    between |= filter.lambda() > 0.81 && filter.lambda() < 0.98;
  }
  EXPECT_TRUE(narrow && wide && between);
}

TEST(Vfakfd, RefusesNonsense) {
  Random random(8);
  const KalmanDesign design = random_design(random, 2, 1, 1, 0);
  const Eigen::VectorXd one = Eigen::VectorXd::Ones(1), zero = Eigen::VectorXd::Zero(1);
  EXPECT_REFUSED(Vfakfd(design, {zero, zero, 0.8, 1.0}));
  EXPECT_REFUSED(Vfakfd(design, {one, -one, 0.8, 1.0}));
  EXPECT_REFUSED(Vfakfd(design, {one, zero, 0.0, 1.0}));
  EXPECT_REFUSED(Vfakfd(design, {one, zero, 0.9, 0.8}));
  EXPECT_REFUSED(Vfakfd(design, {one, zero, 0.8, 1.1}));
  EXPECT_REFUSED(Vfakfd(design, {one * std::nan(""), zero, 0.8, 1.0}));
  EXPECT_REFUSED(Vfakfd(design, {Eigen::VectorXd::Ones(2), zero, 0.8, 1.0}));
}

TEST(Qvff, IgnoresInnovationsWithinTheSensorErrorOnly) {
  const ExtendedPlant plant = double_integrator(0.01);
  const double quantum = 0.02;
  const SensorError error = sensor(quantum);
  Vfakfd filter(variable_forgetting_design(plant, kQvffInitialCovariance), qvff_design(error));
  const Eigen::VectorXd u = Eigen::VectorXd::Zero(1);
  for (int k = 0; k < 50; ++k) {
    filter.update(u, Eigen::VectorXd::Constant(1, k % 2 == 0 ? 0.49 * quantum : -0.49 * quantum));
    EXPECT_EQ(filter.lambda(), 1.0);
  }
  filter.update(u, Eigen::VectorXd::Constant(1, 2.0 * quantum));
  EXPECT_LT(filter.lambda(), 0.9);
  EXPECT_REFUSED(qvff_design(sensor(-1.0)));
}

TEST(Stf, InflatesToHalfAStandardDeviation) {
  const double T = 0.01, quantum = 0.02;
  const ExtendedPlant plant = double_integrator(T);
  const SensorError error = sensor(quantum);
  const KalmanDesign design = stf_design(plant, error, T);
  EXPECT_NEAR(design.R(0, 0), quantum * quantum / 12.0, 1e-18);
  Stf filter(design, error);
  const Eigen::VectorXd u = Eigen::VectorXd::Zero(1);
  for (int k = 0; k < 20; ++k) filter.update(u, Eigen::VectorXd::Zero(1));
  EXPECT_EQ(filter.lambda(), 1.0);
  const Eigen::MatrixXd prior = congruence(plant.sampled.A, filter.P());
  const double y = 0.1;
  const double factor = 4.0 * y * y / (prior(0, 0) + design.R(0, 0));
  filter.update(u, Eigen::VectorXd::Constant(1, y));
  EXPECT_NEAR(1.0 / filter.lambda(), factor, 1e-9 * factor);
  EXPECT_NEAR(filter.K()(0, 0), factor * prior(0, 0) / (factor * prior(0, 0) + design.R(0, 0)),
              1e-9);
  EXPECT_REFUSED(stf_design(plant, error, 0.0));
}

// One estimator of each kind on the same plant. `quiet` is the design of those that adapt.
Filters one_of_each(const KalmanDesign& design, const KalmanDesign& quiet, double alpha,
                    const SensorError& error) {
  const Eigen::Index p = design.plant.outputs();
  Filters filters;
  filters.push_back(std::make_unique<Kfd>(design));
  filters.push_back(std::make_unique<Fakfd>(design, scalar_gamma(design.plant, 1.05)));
  filters.push_back(std::make_unique<Fakfd>(design, diagonal_gamma(design.plant, 1.05)));
  filters.push_back(std::make_unique<Vfakfd>(quiet, forgetting(alpha, p)));
  filters.push_back(std::make_unique<Vfakfd>(quiet, qvff_design(error)));
  filters.push_back(std::make_unique<Stf>(quiet, error));
  return filters;
}

TEST(KalmanEstimators, CovarianceStaysPositiveDefiniteForAMillionSamples) {
  const double T = 1e-3;
  const ExtendedPlant plant = double_integrator(T);
  KalmanDesign design{plant, input_noise(plant, 1e-2), 1e-4 * Eigen::MatrixXd::Identity(1, 1),
                      1e-4 * Eigen::MatrixXd::Identity(3, 3)};
  const double quantum = 1e-2;
  const SensorError error = sensor(quantum);
  Filters filters;
  filters.push_back(std::make_unique<Kfd>(design));
  filters.push_back(std::make_unique<Fakfd>(variable_forgetting_design(plant, 1e-8),
                                            scalar_gamma(plant, 1 / 0.95)));
  filters.push_back(std::make_unique<Fakfd>(design, diagonal_gamma(plant, 1.2)));
  filters.push_back(
      std::make_unique<Vfakfd>(variable_forgetting_design(plant, 1e-8), forgetting(quantum)));
  filters.push_back(
      std::make_unique<Vfakfd>(variable_forgetting_design(plant, 1e-4), qvff_design(error)));
  filters.push_back(std::make_unique<Stf>(stf_design(plant, error, T), error));
  Random random(9);
  for (int k = 0; k < 1'000'000; ++k) {
    const double d = (k / 50'000) % 2 == 0 ? 10.0 : -10.0;  // occasional jumps
    const double angle = 1e-3 * d + random.uniform(-quantum, quantum);
    const Eigen::Matrix<double, 1, 1> u(d), y(quantum * std::round(angle / quantum));
    for (const auto& filter : filters) filter->update(u, y);
    if (k % 997 != 0 && k != 999'999) continue;
    expect_covariances(filters, std::to_string(k));
    if (HasFatalFailure()) return;
  }
}

// Random stable plants with disturbance models of order 0 to 2 and one or two outputs. All states
// have process noise; without it the variance of a decaying state vanishes.
TEST(KalmanEstimators, CovarianceOfRandomPlantsStaysPositiveDefinite) {
  Random random(14);
  for (int trial = 0; trial < 6; ++trial) {
    const Eigen::Index p = 1 + trial / 3;
    const int order = trial % 3;
    KalmanDesign design = random_design(random, 2, 1, p, order);
    const Eigen::Index n = design.plant.states();
    design.Q = 1e-4 * Eigen::MatrixXd::Identity(n, n);
    Filters filters = one_of_each(design, design, 0.05, sensor(0.2, p));
    if (order == 2) filters.pop_back();  // the STF winds up, as its docstring says
    const StateSpace plant{design.plant.sampled.A.topLeftCorner(2, 2),
                           design.plant.sampled.B.topRows(2), design.plant.sampled.C.leftCols(2)};
    Eigen::VectorXd x = Eigen::VectorXd::Zero(2);
    for (int k = 0; k < 100'000; ++k) {
      const Eigen::VectorXd u = random.vector(1);
      const Eigen::VectorXd d = Eigen::VectorXd::Constant(1, (k / 5'000) % 2 == 0 ? 3.0 : -3.0);
      const Eigen::VectorXd y = plant.C * x + random.vector(p, 0.2);
      x = plant.A * x + plant.B * (u - d);
      for (const auto& filter : filters) filter->update(u, y);
      if (k % 499 != 0 && k != 99'999) continue;
      expect_covariances(filters, std::to_string(trial) + " " + std::to_string(k));
      if (HasFatalFailure()) return;
    }
  }
}

TEST(DisturbanceEstimators, FindAConstantDisturbanceOnTheNominalPlant) {
  Random random(10);
  for (int trial = 0; trial < 10; ++trial) {
    // A damped inertia on a spring.
    const double mass = random.uniform(0.2, 2.0);
    const StateSpace continuous{(Eigen::Matrix2d() << 0, 1, -random.uniform(0.0, 5.0) / mass,
                                 -random.uniform(0.0, 2.0) / mass)
                                    .finished(),
                                Eigen::Vector2d(0, 1 / mass), Eigen::RowVector2d(1, 0)};
    KalmanDesign design = random_design(random, 2, 1, 1, 0);
    design.plant = extend_by_disturbance_model(zero_order_hold(continuous, 0.1), 0, 0.1);
    const StateSpace& s = design.plant.sampled;
    KalmanDesign quiet = design;
    quiet.Q.setZero();
    for (const auto& filter : one_of_each(design, quiet, 1e-4, sensor(1e-2))) {
      Eigen::VectorXd x = Eigen::VectorXd::Zero(3);
      x(2) = 2.5;
      filter->reset(Eigen::Vector2d::Zero());
      Eigen::VectorXd u = Eigen::VectorXd::Zero(1);
      for (int k = 0; k < 2000; ++k) {
        filter->update(u, s.C * x);
        u = random.vector(1);
        x = s.A * x + s.B * u;
      }
      EXPECT_NEAR(filter->disturbance()(0), 2.5, 0.05) << trial;
    }
  }
}

TEST(ObserverPoles, AreEigenvaluesOfTheMatrixInBothPlanes) {
  const double T = 0.01;
  const StateSpace plant{(Eigen::Matrix2d() << 0, 1, 0, 0).finished(), Eigen::Vector2d(0, 1),
                         Eigen::RowVector2d(1, 0)};
  Idob idob(plant, {{-10.0, {-20.0, 5.0}, {-20.0, -5.0}}}, T);
  ObserverPoles poles(idob, T);
  poles.update();
  const std::vector<std::complex<double>> expected = {{-20.0, -5.0}, {-20.0, 5.0}, {-10.0, 0.0}};
  for (Eigen::Index i = 0; i < 3; ++i) {
    EXPECT_LT(std::abs(poles.continuous()(i) - expected[static_cast<std::size_t>(i)]), 1e-6);
    EXPECT_LT(std::abs(poles.discrete()(i) - std::exp(T * expected[static_cast<std::size_t>(i)])),
              1e-8);
    EXPECT_EQ(poles.signals()[0].values[static_cast<std::size_t>(i)], poles.discrete()(i).real());
    EXPECT_EQ(poles.signals()[3].values[static_cast<std::size_t>(i)], poles.continuous()(i).imag());
  }
  Mdob mdob({1.0, 100.0, 50.0}, T);
  ObserverPoles of_filters(mdob, T);
  of_filters.update();
  EXPECT_NEAR(of_filters.discrete()(0).real(), 0.5, 1e-12);        // 1/(1 + g_d T_s)
  EXPECT_NEAR(of_filters.discrete()(1).real(), 1.0 / 1.5, 1e-12);  // 1/(1 + g_w T_s)
  EXPECT_REFUSED(ObserverPoles(idob, 0.0));
}

// Filters with one output have a recursion of their own. It is compared with matrix products.

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

Filters filters(const ExtendedPlant& plant) {
  const Eigen::Index N = plant.states(), p = plant.outputs();
  const KalmanDesign design{plant, disturbance_noise(plant, 1e-2),
                            1e-6 * Eigen::MatrixXd::Identity(p, p),
                            Eigen::MatrixXd::Identity(N, N)};
  Filters all;
  all.push_back(std::make_unique<Kfd>(design));
  all.push_back(std::make_unique<Fakfd>(design, scalar_gamma(plant, 1.05)));
  all.push_back(std::make_unique<Vfakfd>(variable_forgetting_design(plant, kQvffInitialCovariance),
                                         qvff_design(sensor(1e-3, p, 1e-4))));
  all.push_back(std::make_unique<Stf>(stf_design(plant, sensor(1e-3, p, 1e-4), kPeriod),
                                      sensor(1e-3, p, 1e-4)));
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

// The steady states of the filters against SciPy's Riccati solutions.

// P(k|k) of the converged filter, compared with the Riccati solution X = P(k+1|k). A factor Γ makes
// it the solution for A √Γ, with P(k|k) = √Γ (X − X Cᵀ (C X Cᵀ + R)⁻¹ C X) √Γ.
TEST(KalmanEstimators, ConvergeToTheSolutionOfTheRiccatiEquation) {
  Random random(21);
  std::vector<testing::RiccatiProblem> problems;  // dual problem: Aᵀ, Cᵀ
  std::vector<Eigen::MatrixXd> settled, roots;
  for (int trial = 0; trial < 12; ++trial) {
    const Eigen::Index n = 1 + trial % 3, p = 1 + trial % 2;
    KalmanDesign design;
    design.plant =
        extend_by_disturbance_model(random_plant(random, n, 1, p), p == 1 ? trial % 3 : 0, 1.0);
    const Eigen::Index N = design.plant.states();
    design.Q = uniform_noise(design.plant, random.uniform(0.01, 1.0));
    design.R = random.uniform(0.1, 2.0) * Eigen::MatrixXd::Identity(p, p);
    design.P0 = Eigen::MatrixXd::Identity(N, N);
    for (const Eigen::VectorXd& gamma :
         {scalar_gamma(design.plant, 1.0), scalar_gamma(design.plant, 1.05),
          diagonal_gamma(design.plant, 1.1)}) {
      Fakfd filter(design, gamma);
      for (int k = 0; k < 5000; ++k) {
        filter.update(Eigen::VectorXd::Zero(1), Eigen::VectorXd::Zero(p));
      }
      roots.emplace_back(gamma.cwiseSqrt().asDiagonal());
      problems.push_back({(design.plant.sampled.A * roots.back()).transpose(),
                          design.plant.sampled.C.transpose(), design.Q, design.R});
      settled.emplace_back(filter.P());
    }
  }
  const std::vector<testing::RiccatiSolution> solutions = testing::solve_with_scipy(problems);
  for (std::size_t i = 0; i < problems.size(); ++i) {
    const Eigen::MatrixXd C = problems[i].B.transpose();
    const Eigen::MatrixXd& R = problems[i].R;
    const Eigen::MatrixXd& X = solutions[i].P;
    const Eigen::MatrixXd posterior = X - kalman_gain(X, C, R) * C * X;
    const Eigen::MatrixXd expected = congruence(roots[i], posterior);
    EXPECT_LT((settled[i] - expected).norm(), 1e-7 * expected.norm()) << i;
  }
}

// The error of an IDOB has exactly the placed poles, also on random plants.
TEST(Idob, ErrorOfRandomPlantsHasThePlacedPoles) {
  Random random(22);
  for (int trial = 0; trial < 20; ++trial) {
    const Eigen::Index n = 1 + trial % 3;
    const StateSpace plant{random.matrix(n, n), random.matrix(n, 1), random.matrix(1, n)};
    const double period = random.uniform(0.05, 0.3);
    PoleGroup continuous, sampled;
    for (Eigen::Index i = 0; i <= n; ++i) {
      continuous.emplace_back(-2.0 - 1.5 * static_cast<double>(i), 0.0);
      sampled.push_back(std::exp(continuous.back() * period));
    }
    const Idob observer(plant, {continuous}, period);
    // By Cayley and Hamilton the product of all F − z I is 0 if the z are the eigenvalues of F.
    // This test stays accurate for a plant that is hard to observe.
    Eigen::MatrixXd F(n + 1, n + 1);
    observer.pole_matrix(F);
    const Eigen::MatrixXd I = Eigen::MatrixXd::Identity(F.rows(), F.cols());
    Eigen::MatrixXd product = I;
    double scale = 1.0;
    for (const auto& z : sampled) {
      product = product * (F - z.real() * I);
      scale *= (F - z.real() * I).norm();
    }
    EXPECT_LT(product.norm(), 1e-11 * scale) << trial;
  }
}

StateSpace cart(double period_s) {
  return zero_order_hold(damped_inertia(0.625, 0.78), period_s);
}

TEST(DisturbanceModel, OrderZeroIsTheSampledContinuousExtension) {
  const double T = 0.1;
  const StateSpace continuous = damped_inertia(0.625, 0.78);
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
  EXPECT_TRUE(
      has(complaint_of([&] { extend_by_disturbance_model(plant, 0, 0.01); }), "rank 2 of 3"));
}

TEST(DisturbanceModel, RefusesNonsense) {
  EXPECT_REFUSED(extend_by_disturbance_model(cart(0.1), 3, 0.1));
  EXPECT_REFUSED(extend_by_disturbance_model(cart(0.1), -1, 0.1));
  EXPECT_REFUSED(extend_by_disturbance_model(cart(0.1), 0, 0.0));
}

TEST(KalmanDesign, RefusesAnInvalidCovariance) {
  const ExtendedPlant plant = extend_by_disturbance_model(cart(0.1), 0, 0.1);
  const Eigen::MatrixXd I3 = Eigen::MatrixXd::Identity(3, 3);
  const Eigen::MatrixXd I1 = Eigen::MatrixXd::Identity(1, 1);
  EXPECT_NO_THROW(check(KalmanDesign{plant, 0.0 * I3, I1, I3}));
  EXPECT_REFUSED(check(KalmanDesign{plant, -I3, I1, I3}));
  EXPECT_REFUSED(check(KalmanDesign{plant, I3, 0.0 * I1, I3}));
  EXPECT_REFUSED(check(KalmanDesign{plant, I3, I1, -I3}));
  EXPECT_REFUSED(check(KalmanDesign{plant, I3, 1e101 * I1, I3}));
  EXPECT_REFUSED(check(KalmanDesign{plant, I1, I1, I3}));
  Eigen::MatrixXd lopsided = I3;
  lopsided(0, 1) = 0.5;
  EXPECT_REFUSED(check(KalmanDesign{plant, I3, I1, lopsided}));
  EXPECT_REFUSED(check(KalmanDesign{plant, I3 * std::nan(""), I1, I3}));
}

}  // namespace breakwater::kalman_estimators_test
