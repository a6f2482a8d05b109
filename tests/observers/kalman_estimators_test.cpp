// All Kalman filters with disturbance estimation, on random stable plants.
#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <cmath>
#include <memory>
#include <stdexcept>

#include <breakwater/observers/fakfd.h>
#include <breakwater/observers/idob.h>
#include <breakwater/observers/kfd.h>
#include <breakwater/observers/mdob.h>
#include <breakwater/observers/observer_poles.h>
#include <breakwater/observers/qvff.h>
#include <breakwater/observers/stf.h>
#include <breakwater/observers/vfakfd.h>
#include "observers/idle_output.h"
#include "observers/random_plant.h"

namespace breakwater {
namespace {

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
        P = s.A * P * s.A.transpose() + design.Q;
      }
      const Eigen::MatrixXd G =
          P * s.C.transpose() * (s.C * P * s.C.transpose() + design.R).inverse();
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
    EXPECT_THROW(Fakfd(design, scalar_gamma(design.plant, gamma)), std::invalid_argument);
  }
  EXPECT_THROW(Fakfd(design, Eigen::VectorXd::Ones(3)), std::invalid_argument);
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
        P = s.A * P * s.A.transpose() + design.Q;
      }
      const Eigen::MatrixXd K =
          P * s.C.transpose() * (s.C * P * s.C.transpose() + design.R).inverse();
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
  EXPECT_THROW(AsymmetricFakfd(two, Eigen::VectorXd::Ones(4), CovarianceForm::printed),
               std::invalid_argument);
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
    const Eigen::MatrixXd prior = k > 0 ? Eigen::MatrixXd(s.A * P * s.A.transpose() + design.Q) : P;
    const Eigen::VectorXd predicted = k > 0 ? Eigen::VectorXd(s.A * x + s.B * u) : x;
    const double e = (y - s.C * predicted)(0);
    const double output_variance = (s.C * prior * s.C.transpose())(0, 0);
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
  EXPECT_THROW(Vfakfd(design, {zero, zero, 0.8, 1.0}), std::invalid_argument);
  EXPECT_THROW(Vfakfd(design, {one, -one, 0.8, 1.0}), std::invalid_argument);
  EXPECT_THROW(Vfakfd(design, {one, zero, 0.0, 1.0}), std::invalid_argument);
  EXPECT_THROW(Vfakfd(design, {one, zero, 0.9, 0.8}), std::invalid_argument);
  EXPECT_THROW(Vfakfd(design, {one, zero, 0.8, 1.1}), std::invalid_argument);
  EXPECT_THROW(Vfakfd(design, {one * std::nan(""), zero, 0.8, 1.0}), std::invalid_argument);
  EXPECT_THROW(Vfakfd(design, {Eigen::VectorXd::Ones(2), zero, 0.8, 1.0}), std::invalid_argument);
}

TEST(Qvff, IgnoresInnovationsWithinTheSensorErrorOnly) {
  const ExtendedPlant plant =
      extend_by_disturbance_model(zero_order_hold({(Eigen::Matrix2d() << 0, 1, 0, 0).finished(),
                                                   Eigen::Vector2d(0, 1), Eigen::RowVector2d(1, 0)},
                                                  0.01),
                                  0, 0.01);
  const double quantum = 0.02;
  const SensorError error{Eigen::VectorXd::Constant(1, quantum), Eigen::VectorXd::Zero(1)};
  Vfakfd filter(variable_forgetting_design(plant, kQvffInitialCovariance), qvff_design(error));
  const Eigen::VectorXd u = Eigen::VectorXd::Zero(1);
  for (int k = 0; k < 50; ++k) {
    filter.update(u, Eigen::VectorXd::Constant(1, k % 2 == 0 ? 0.49 * quantum : -0.49 * quantum));
    EXPECT_EQ(filter.lambda(), 1.0);
  }
  filter.update(u, Eigen::VectorXd::Constant(1, 2.0 * quantum));
  EXPECT_LT(filter.lambda(), 0.9);
  EXPECT_THROW(qvff_design({Eigen::VectorXd::Constant(1, -1.0), Eigen::VectorXd::Zero(1)}),
               std::invalid_argument);
}

TEST(Stf, InflatesToHalfAStandardDeviation) {
  const double T = 0.01, quantum = 0.02;
  const ExtendedPlant plant =
      extend_by_disturbance_model(zero_order_hold({(Eigen::Matrix2d() << 0, 1, 0, 0).finished(),
                                                   Eigen::Vector2d(0, 1), Eigen::RowVector2d(1, 0)},
                                                  T),
                                  0, T);
  const SensorError error{Eigen::VectorXd::Constant(1, quantum), Eigen::VectorXd::Zero(1)};
  const KalmanDesign design = stf_design(plant, error, T);
  EXPECT_NEAR(design.R(0, 0), quantum * quantum / 12.0, 1e-18);
  Stf filter(design, error);
  const Eigen::VectorXd u = Eigen::VectorXd::Zero(1);
  for (int k = 0; k < 20; ++k) filter.update(u, Eigen::VectorXd::Zero(1));
  EXPECT_EQ(filter.lambda(), 1.0);
  const Eigen::MatrixXd prior = plant.sampled.A * filter.P() * plant.sampled.A.transpose();
  const double y = 0.1;
  const double factor = 4.0 * y * y / (prior(0, 0) + design.R(0, 0));
  filter.update(u, Eigen::VectorXd::Constant(1, y));
  EXPECT_NEAR(1.0 / filter.lambda(), factor, 1e-9 * factor);
  EXPECT_NEAR(filter.K()(0, 0), factor * prior(0, 0) / (factor * prior(0, 0) + design.R(0, 0)),
              1e-9);
  EXPECT_THROW(stf_design(plant, error, 0.0), std::invalid_argument);
}

// One estimator of each kind on the same plant.
std::vector<std::unique_ptr<DisturbanceEstimator>> one_of_each(const KalmanDesign& design,
                                                               double alpha) {
  const Eigen::Index p = design.plant.outputs();
  const SensorError error{Eigen::VectorXd::Constant(p, std::sqrt(alpha)), Eigen::VectorXd::Zero(p)};
  KalmanDesign quiet = design;
  quiet.Q.setZero();
  std::vector<std::unique_ptr<DisturbanceEstimator>> filters;
  filters.push_back(std::make_unique<Kfd>(design));
  filters.push_back(std::make_unique<Fakfd>(design, scalar_gamma(design.plant, 1.05)));
  filters.push_back(std::make_unique<Fakfd>(design, diagonal_gamma(design.plant, 1.05)));
  filters.push_back(std::make_unique<Vfakfd>(
      quiet, VfakfdDesign{Eigen::VectorXd::Constant(p, alpha), Eigen::VectorXd::Zero(p)}));
  filters.push_back(std::make_unique<Vfakfd>(quiet, qvff_design(error)));
  filters.push_back(std::make_unique<Stf>(quiet, error));
  return filters;
}

TEST(KalmanEstimators, CovarianceStaysPositiveDefiniteForAMillionSamples) {
  const double T = 1e-3;
  const ExtendedPlant plant =
      extend_by_disturbance_model(zero_order_hold({(Eigen::Matrix2d() << 0, 1, 0, 0).finished(),
                                                   Eigen::Vector2d(0, 1), Eigen::RowVector2d(1, 0)},
                                                  T),
                                  0, T);
  KalmanDesign design{plant, input_noise(plant, 1e-2), 1e-4 * Eigen::MatrixXd::Identity(1, 1),
                      1e-4 * Eigen::MatrixXd::Identity(3, 3)};
  const double quantum = 1e-2;
  const SensorError error{Eigen::VectorXd::Constant(1, quantum), Eigen::VectorXd::Zero(1)};
  const VfakfdDesign vff{Eigen::VectorXd::Constant(1, quantum), Eigen::VectorXd::Zero(1)};
  Kfd kfd(design);
  Fakfd scalar(variable_forgetting_design(plant, 1e-8), scalar_gamma(plant, 1 / 0.95));
  Fakfd diagonal(design, diagonal_gamma(plant, 1.2));
  Vfakfd vfakfd(variable_forgetting_design(plant, 1e-8), vff);
  Vfakfd qvff(variable_forgetting_design(plant, 1e-4), qvff_design(error));
  Stf stf(stf_design(plant, error, T), error);
  Random random(9);
  const auto expect_covariance = [](const Eigen::Matrix3d& P, int k, const char* name) {
    ASSERT_EQ(P, P.transpose()) << name << " " << k;
    // Scaled to correlations, since T makes the scales of the states differ by 1e6.
    const Eigen::Vector3d scale = P.diagonal().cwiseSqrt().cwiseInverse();
    const Eigen::Matrix3d correlation = scale.asDiagonal() * P * scale.asDiagonal();
    ASSERT_EQ(Eigen::LLT<Eigen::Matrix3d>(correlation).info(), Eigen::Success) << name << " " << k;
  };
  for (int k = 0; k < 1'000'000; ++k) {
    const double d = (k / 50'000) % 2 == 0 ? 10.0 : -10.0;  // occasional jumps
    const double angle = 1e-3 * d + random.uniform(-quantum, quantum);
    const Eigen::Matrix<double, 1, 1> u(d), y(quantum * std::round(angle / quantum));
    for (DisturbanceEstimator* filter : std::initializer_list<DisturbanceEstimator*>{
             &kfd, &scalar, &diagonal, &vfakfd, &qvff, &stf}) {
      filter->update(u, y);
    }
    if (k % 997 != 0 && k != 999'999) continue;
    expect_covariance(kfd.P(), k, "KFD");
    expect_covariance(scalar.P(), k, "FAKFD");
    expect_covariance(diagonal.P(), k, "FAKFD diagonal");
    expect_covariance(vfakfd.P(), k, "VFAKFD");
    expect_covariance(qvff.P(), k, "QVFF");
    expect_covariance(stf.P(), k, "STF");
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
    const SensorError error{Eigen::VectorXd::Constant(p, 0.2), Eigen::VectorXd::Zero(p)};
    std::vector<std::unique_ptr<KalmanEstimator>> filters;
    filters.push_back(std::make_unique<Kfd>(design));
    filters.push_back(std::make_unique<Fakfd>(design, scalar_gamma(design.plant, 1.05)));
    filters.push_back(std::make_unique<Fakfd>(design, diagonal_gamma(design.plant, 1.05)));
    filters.push_back(std::make_unique<Vfakfd>(
        design, VfakfdDesign{Eigen::VectorXd::Constant(p, 0.05), Eigen::VectorXd::Zero(p)}));
    filters.push_back(std::make_unique<Vfakfd>(design, qvff_design(error)));
    // With order 2 it winds up, as its docstring says.
    if (order < 2) filters.push_back(std::make_unique<Stf>(design, error));
    const StateSpace plant{design.plant.sampled.A.topLeftCorner(2, 2),
                           design.plant.sampled.B.topRows(2), design.plant.sampled.C.leftCols(2)};
    Eigen::VectorXd x = Eigen::VectorXd::Zero(2);
    for (int k = 0; k < 100'000; ++k) {
      const Eigen::VectorXd u = random.vector(1);
      const Eigen::VectorXd d = Eigen::VectorXd::Constant(1, (k / 5'000) % 2 == 0 ? 3.0 : -3.0);
      const Eigen::VectorXd y = plant.C * x + random.vector(p, 0.2);
      x = plant.A * x + plant.B * (u - d);
      for (std::size_t i = 0; i < filters.size(); ++i) {
        filters[i]->update(u, y);
        if (k % 499 != 0 && k != 99'999) continue;
        const auto& P = filters[i]->P();
        ASSERT_EQ(P, P.transpose()) << trial << " " << i << " " << k;
        const Eigen::VectorXd scale = P.diagonal().cwiseSqrt().cwiseInverse();
        const Eigen::MatrixXd correlation = scale.asDiagonal() * P * scale.asDiagonal();
        const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(correlation);
        ASSERT_GT(eigen.eigenvalues()(0), 0.0) << trial << " " << i << " " << k;
      }
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
    for (const auto& filter : one_of_each(design, 1e-4)) {
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
  EXPECT_THROW(ObserverPoles(idob, 0.0), std::invalid_argument);
}

}  // namespace
}  // namespace breakwater
