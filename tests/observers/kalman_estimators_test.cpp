// The Kalman filters with disturbance estimation, and refused designs of all observers.
// tests/python/observers_test.py has the equations of those with designs that Python reaches.
#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>

#include <breakwater/linear/eigenvalues.h>
#include <breakwater/observers/eso.h>
#include <breakwater/observers/fakfd.h>
#include <breakwater/observers/gsf.h>
#include <breakwater/observers/idob.h>
#include <breakwater/observers/immkf.h>
#include <breakwater/observers/kfd.h>
#include <breakwater/observers/mckf.h>
#include <breakwater/observers/mdob.h>
#include <breakwater/observers/mhe.h>
#include <breakwater/observers/multiple_model_estimator.h>
#include <breakwater/observers/observer_poles.h>
#include <breakwater/observers/raw_difference.h>
#include <breakwater/observers/stacked_estimator.h>
#include <breakwater/observers/state_observer.h>
#include <breakwater/observers/stf.h>
#include <breakwater/observers/tracking_differentiator.h>
#include <breakwater/observers/vbakf.h>
#include <breakwater/observers/vfakfd.h>
#include <breakwater/plants/damped_inertia.h>
#include "support.h"

namespace breakwater::kalman_estimators_test {

using testing::congruence;
using testing::Random;

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

Eigen::MatrixXd random_covariance(Random& random, Eigen::Index size, double scale) {
  const Eigen::MatrixXd root = random.matrix(size, size);
  return scale * (root * root.transpose() + 0.1 * Eigen::MatrixXd::Identity(size, size));
}

// With dense Q, R and P0, at each sample. One output has a recursion of its own.
TEST(KalmanEstimators, EqualMatrixProducts) {
  using Eigen::MatrixXd, Eigen::VectorXd;
  Random random(3);
  double least = 1.0, most = 0.0, inflated = 1.0;  // range of λ
  for (int trial = 0; trial < 24; ++trial) {
    const Eigen::Index n = 1 + trial % 4, p = 1 + trial / 4 % 2,
                       m = std::min(n, trial < 16 ? p : 1);
    StateSpace plant{random.matrix(n, n), random.matrix(n, m), random.matrix(p, n)};
    plant.A *= random.uniform(0.5, 0.98) / spectral_radius(plant.A);
    if (trial % 3 == 0) plant.C = MatrixXd::Identity(p, n);
    KalmanDesign design{extend_by_disturbance_model(plant, n < 4 && p == 1 ? trial % 3 : 0, 0.1)};
    const Eigen::Index N = design.plant.states();
    design.Q = random_covariance(random, N, 1e-2);
    design.R = random_covariance(random, p, 1.0);
    design.P0 = random_covariance(random, N, 1.0);
    // `adapt` may change P(k|k−1) and R, and gives λ. `after` gives P(k|k) of P and K C P.
    const auto expect_same = [&](const char* name, double close, KalmanEstimator&& filter,
                                 const auto& adapt, const auto& after) {
      const StateSpace& s = design.plant.sampled;
      VectorXd x = VectorXd::Zero(N);
      MatrixXd P = design.P0;
      for (int k = 0; k < 300; ++k) {
        const VectorXd u = random.vector(m), y = random.vector(p, k % 50 == 0 ? 30.0 : 1.0);
        if (k > 0) {
          x = s.A * x + s.B * u;
          P = congruence(s.A, P) + design.Q;
        }
        const VectorXd e = y - s.C * x;
        MatrixXd R = design.R;
        const double lambda = adapt(e, congruence(s.C, P), P, R);
        const MatrixXd K = testing::kalman_gain(P, s.C, R);
        x += K * e;
        P = after(P, K * s.C * P, lambda);
        filter.update(u, y);
        EXPECT_LT((filter.extended_state() - x).norm(), close * (1.0 + x.norm()))
            << name << " " << trial << " " << k;
        EXPECT_LT((filter.P() - P).norm(), close * (1.0 + P.norm())) << name << trial << " " << k;
        EXPECT_NEAR(filter.lambda(), lambda, close) << name;
      }
    };
    const auto unchanged = [](const VectorXd&, const MatrixXd&, MatrixXd&, MatrixXd&) {
      return 1.0;
    };
    const auto subtract = [](const MatrixXd& P, const MatrixXd& KCP, double) {
      return MatrixXd(P - KCP);
    };
    const SensorError coarse = sensor(1e300, p), fine = sensor(0.4, p, 0.1);
    expect_same("KFD", 1e-11, Kfd(design), unchanged, subtract);
    expect_same("FAKFD of 1", 1e-11, Fakfd(design, VectorXd::Ones(N)), unchanged, subtract);
    expect_same("STF of 1", 1e-11, Stf(design, coarse), unchanged, subtract);
    const VectorXd gamma = VectorXd::LinSpaced(N, 1.0, 1.3);
    const auto fixed = [](const VectorXd&, const MatrixXd&, MatrixXd&, MatrixXd&) {
      return 1 / 1.3;
    };
    expect_same("FAKFD", 1e-11, Fakfd(design, gamma), fixed,
                [&](const MatrixXd& P, const MatrixXd& KCP, double) {
                  const MatrixXd root = gamma.cwiseSqrt().asDiagonal();
                  return congruence(root, P - KCP);
                });
    const VectorXd slow = diagonal_gamma(design.plant, 1.05);
    const auto slowly = [](const VectorXd&, const MatrixXd&, MatrixXd&, MatrixXd&) {
      return 1 / 1.05;
    };
    for (const CovarianceForm form : {CovarianceForm::printed, CovarianceForm::left}) {
      if (p > 1 || N != n + 2) break;  // its rounding errors grow
      expect_same("Eq. 4.5", 1e-10, Fakfd(design, slow, form), slowly,
                  [&](const MatrixXd& P, const MatrixXd& KCP, double) {
                    const MatrixXd G = slow.asDiagonal();
                    return form == CovarianceForm::left ? MatrixXd(G * (P - KCP))
                                                        : MatrixXd(G * P - KCP);
                  });
    }
    for (const double dead_zone : {0.2, 1e300}) {
      const VfakfdDesign how{VectorXd::Constant(p, 4.0), VectorXd::Constant(p, dead_zone), 0.6,
                             dead_zone == 0.2 ? 0.98 : 1.0};
      expect_same(
          "VFAKFD", 1e-11, Vfakfd(design, how),
          [&](const VectorXd& e, const MatrixXd& S, MatrixXd&, MatrixXd& R) {
            const VectorXd size = (e.cwiseAbs().array() - dead_zone).cwiseMax(0.0) / 2.0;
            const VectorXd outside = size.cwiseProduct(e.cwiseSign());
            const MatrixXd I = MatrixXd::Identity(p, p);
            const double raw = how.lambda_max - outside.dot((I + S).llt().solve(outside));
            const double lambda = std::clamp(raw, how.lambda_min, how.lambda_max);
            R = lambda * I;
            least = std::min(least, lambda);
            if (dead_zone == 0.2) most = std::max(most, lambda);
            return lambda;
          },
          [](const MatrixXd& P, const MatrixXd& KCP, double lambda) {
            return MatrixXd((P - KCP) / lambda);
          });
    }
    expect_same(
        "STF", N == 3 && p == 1 ? 1e-11 : 1e-6, Stf(design, fine),
        [&](const VectorXd& e, const MatrixXd& S, MatrixXd& P, MatrixXd& R) {
          double factor = 1.0;
          for (Eigen::Index i = 0; i < p; ++i) {
            const double gate = 0.4 + 5.0 * 0.1 + 2.0 * std::sqrt(S(i, i));
            const double share = 4.0 * e(i) * e(i) / (S(i, i) + R(i, i));
            if (std::abs(e(i)) > gate) factor = std::max(factor, share);
          }
          P *= factor;
          inflated = std::min(inflated, 1.0 / factor);
          return 1.0 / factor;
        },
        subtract);
  }
  EXPECT_EQ(least, 0.6);
  EXPECT_EQ(most, 0.98);
  EXPECT_LT(inflated, 0.5);
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
    StateSpace plant{random.matrix(2, 2), random.matrix(2, 1), random.matrix(p, 2)};
    plant.A *= random.uniform(0.5, 0.98) / spectral_radius(plant.A);
    KalmanDesign design{extend_by_disturbance_model(plant, order, 0.1)};
    const Eigen::Index n = design.plant.states();
    const Eigen::MatrixXd R = random.matrix(p, p), P = random.matrix(n, n);
    design.Q = 1e-4 * Eigen::MatrixXd::Identity(n, n);
    design.R = R * R.transpose() + 0.1 * Eigen::MatrixXd::Identity(p, p);
    design.P0 = P * P.transpose() + 0.1 * Eigen::MatrixXd::Identity(n, n);
    const SensorError error = sensor(0.2, p);
    Filters filters;
    filters.push_back(std::make_unique<Kfd>(design));
    filters.push_back(std::make_unique<Fakfd>(design, scalar_gamma(design.plant, 1.05)));
    filters.push_back(std::make_unique<Fakfd>(design, diagonal_gamma(design.plant, 1.05)));
    filters.push_back(std::make_unique<Vfakfd>(design, forgetting(0.05, p)));
    filters.push_back(std::make_unique<Vfakfd>(design, qvff_design(error)));
    // With order 2 the STF winds up, as its docstring says.
    if (order < 2) filters.push_back(std::make_unique<Stf>(design, error));
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

TEST(Designs, AreRefusedIfTheyAreWrong) {
  const StateSpace axis = damped_inertia(1.0, 0.0);
  const ExtendedPlant plant = double_integrator(0.01);
  const Eigen::MatrixXd I = Eigen::MatrixXd::Identity(3, 3), one = Eigen::MatrixXd::Ones(1, 1);
  const Eigen::VectorXd alpha = one, zero = 0.0 * one;
  const KalmanDesign good{plant, I, one, I};
  EXPECT_NO_THROW(check(KalmanDesign{plant, 0.0 * I, one, I}));
  Eigen::MatrixXd lopsided = I;
  lopsided(0, 1) = 0.5;
  for (const KalmanDesign& wrong : std::vector<KalmanDesign>{{plant, -I, one, I},
                                                             {plant, I, 0.0 * one, I},
                                                             {plant, I, one, -I},
                                                             {plant, I, 1e101 * one, I},
                                                             {plant, one, one, I},
                                                             {plant, I, one, lopsided},
                                                             {plant, I * kNaN, one, I}}) {
    EXPECT_REFUSED(check(wrong));
  }
  for (const double gamma : {0.9, 1.1e6, kNaN}) {
    EXPECT_REFUSED(Fakfd(good, scalar_gamma(plant, gamma)));
  }
  EXPECT_REFUSED(Fakfd(good, Eigen::VectorXd::Ones(2)));
  KalmanDesign two = good;
  two.plant.sampled.C = I.topRows(2);
  two.R = I.topLeftCorner(2, 2);
  EXPECT_REFUSED(Fakfd(two, Eigen::VectorXd::Ones(3), CovarianceForm::printed));
  for (const VfakfdDesign& wrong : std::vector<VfakfdDesign>{{zero, zero},
                                                             {alpha, -alpha},
                                                             {alpha, zero, 0.0},
                                                             {alpha, zero, 0.9, 0.8},
                                                             {alpha, zero, 0.8, 1.1},
                                                             {alpha * kNaN, zero},
                                                             {Eigen::VectorXd::Ones(2), zero}}) {
    EXPECT_REFUSED(Vfakfd(good, wrong));
  }
  EXPECT_REFUSED(qvff_design(sensor(-1.0)));
  EXPECT_REFUSED(stf_design(plant, sensor(0.02), 0.0));

  using Poles = std::vector<PoleGroup>;
  EXPECT_REFUSED(Idob(axis, Poles{{-1.0, -2.0}}, 0.01));
  EXPECT_REFUSED(Idob(axis, Poles{{-1.0, -2.0, -3.0}}, -0.01));
  // A free integrator beside the measured one is unobservable.
  const StateSpace beside{Eigen::Matrix2d::Zero(), Eigen::Vector2d(1.0, 0.0),
                          Eigen::RowVector2d(1.0, 0.0)};
  EXPECT_TRUE(has(complaint_of([&] { Idob(beside, {{-1.0, -2.0, -3.0}}, 0.01); }), "rank 2 of 3"));
  for (const PoleGroup& group : {PoleGroup{-20.0, 5.0}, PoleGroup{-20.0, 0.0},
                                 PoleGroup{{0.1, 3.0}, {0.1, -3.0}}, PoleGroup{-20.0, kNaN}}) {
    EXPECT_REFUSED(StateObserver(axis, Poles{group}, 0.01));
  }
  for (const MdobDesign& wrong : std::vector<MdobDesign>{
           {0.0, 1.0, 1.0}, {1.0, -1.0, 1.0}, {1.0, 1.0, kNaN}, {1.0, 1.0, kInfinity}}) {
    EXPECT_REFUSED(Mdob(wrong, 1e-3));
  }
  EXPECT_REFUSED(Mdob({1.0, 1.0, 1.0}, 0.0));
  EXPECT_REFUSED(ObserverPoles(*std::make_unique<Mdob>(MdobDesign{1.0, 1.0, 1.0}, 1e-3), 0.0));
  StateSpace scaled = axis,
             two_axes{Eigen::MatrixXd::Identity(4, 4), Eigen::MatrixXd::Identity(4, 1),
                      Eigen::MatrixXd::Identity(1, 4)};
  scaled.C *= 2.0;
  EXPECT_REFUSED(RawDifference(two_axes, 0.5));
  EXPECT_REFUSED(RawDifference(scaled, 0.5));
  EXPECT_REFUSED(StackedEstimator{{}});
  std::vector<std::unique_ptr<DisturbanceEstimator>> no_axis;
  no_axis.push_back(
      std::make_unique<Idob>(StateSpace{zero, alpha, alpha}, Poles{{-1.0, -2.0}}, 0.1));
  EXPECT_REFUSED(StackedEstimator(std::move(no_axis)));
}

TEST(Designs, OfPublishedFiltersAreRefusedIfTheyAreWrong) {
  const StateSpace axis = damped_inertia(1.0, 0.4);
  const SensorError noisy = sensor(0.0, 1, 0.02);
  const KalmanDesign good = known_sensor_design(sample_with_disturbance_model(axis, 0, 0.01), noisy,
                                                0.1, Eigen::Vector3d(1e-2, 0.5, 2.0));
  for (const ImmDesign& imm : std::vector<ImmDesign>{{.noise_ratio = 0.0},
                                                     {.noise_ratio = INFINITY},
                                                     {.stays_quiet = 1.1},
                                                     {.stays_quiet = -0.1},
                                                     {.stays_busy = 1.1},
                                                     {.stays_busy = -0.1}}) {
    EXPECT_REFUSED(sized_immkf(good, noisy, imm));
  }
  EXPECT_NO_THROW(sized_immkf(good, noisy, {.stays_quiet = 1.0, .stays_busy = 0.0}));
  EXPECT_REFUSED(sized_mckf(good, noisy, {.kernel_width = 0.0}));
  EXPECT_REFUSED(sized_vbakf(good, {.forgetting = 0.0}));
  EXPECT_REFUSED(sized_vbakf(good, {.forgetting = 1.1}));
  EXPECT_REFUSED(sized_vbakf(good, {.prior_samples = 0.0}));
  EXPECT_REFUSED(sized_vbakf(good, {.iterations = 0}));
  for (const int parts : {0, 21}) {
    EXPECT_REFUSED(sized_gsf(good, noisy, parts));
  }
  EXPECT_REFUSED(Mhe(good, noisy, 0, true));
  EXPECT_REFUSED(Eso(axis, {0.0}, 0.01));
  EXPECT_REFUSED(TrackingDifferentiator({1.0, 0.0, 1.0, 10.0}, 0.01));
  KalmanDesign second_state = good;
  second_state.plant.sampled.C = Eigen::RowVector3d::Unit(1);
  EXPECT_REFUSED(sized_vbakf(second_state, {}));
}

}  // namespace breakwater::kalman_estimators_test
