// The published estimators against textbook forms, limit cases, closed forms, and a plant of one
// of the papers.
#include <Eigen/Cholesky>
#include <Eigen/LU>

#include <breakwater/linear/riccati.h>
#include <breakwater/observers/code_sensor.h>
#include <breakwater/observers/eso.h>
#include <breakwater/observers/gsf.h>
#include <breakwater/observers/immkf.h>
#include <breakwater/observers/kfd.h>
#include <breakwater/observers/mckf.h>
#include <breakwater/observers/mhe.h>
#include <breakwater/observers/tracking_differentiator.h>
#include <breakwater/observers/vbakf.h>
#include <breakwater/plants/damped_inertia.h>
#include "observers/motor_loop.h"
#include "support.h"

namespace breakwater::published_estimators_test {

using testing::congruence;
using testing::Random;
using Estimator = std::unique_ptr<DisturbanceEstimator>;

constexpr double kPeriod = 0.01;
constexpr double kNoise = 0.02;

SensorError sensor(double quantum, double noise_std = 0.0) {
  return {Eigen::VectorXd::Constant(1, quantum), Eigen::VectorXd::Constant(1, noise_std)};
}

KalmanDesign design(const SensorError& error, double q = 0.1, double period_s = kPeriod,
                    double friction = 0.4) {
  const ExtendedPlant plant =
      sample_with_disturbance_model(damped_inertia(1.0, friction), 0, period_s);
  return known_sensor_design(plant, error, q, Eigen::Vector3d(1e-2, 0.5, 2.0));
}

Eigen::VectorXd one(double value) {
  return Eigen::VectorXd::Constant(1, value);
}

Eigen::MatrixXd pole_matrix(const DisturbanceEstimator& estimator) {
  Eigen::MatrixXd F(estimator.poles(), estimator.poles());
  estimator.pole_matrix(F);
  return F;
}

// The estimates and the poles of both are the same for random inputs and outputs.
void expect_same(DisturbanceEstimator& a, DisturbanceEstimator& b, double tolerance,
                 double scale = 1.0) {
  Random random(3);
  for (int k = 0; k < 300; ++k) {
    const Eigen::VectorXd u = random.vector(1, 3.0 * scale), y = random.vector(1, 0.1 * scale);
    a.update(u, y);
    b.update(u, y);
    ASSERT_LE((a.state() - b.state()).norm(), tolerance * (1.0 + b.state().norm())) << k;
    ASSERT_LE((a.disturbance() - b.disturbance()).norm(),
              tolerance * (1.0 + b.disturbance().norm()))
        << k;
    const double e = published(b, "innovation")[0];
    ASSERT_NEAR(published(a, "innovation")[0], e, tolerance * (1.0 + std::abs(e))) << k;
    if (a.poles() == 0) continue;
    const Eigen::MatrixXd F = pole_matrix(b);
    ASSERT_LE((pole_matrix(a) - F).norm(), tolerance * (1.0 + F.norm())) << k;
  }
}

TEST(PublishedEstimators, EqualTheKalmanFilterInTheirLimits) {
  const SensorError noisy = sensor(0.0, kNoise);
  const KalmanDesign of_kalman = design(noisy);
  const StateSpace& plant = of_kalman.plant.sampled;
  KalmanDesign steady = of_kalman;
  steady.P0 = solve_dare(plant.A.transpose(), plant.C.transpose(), of_kalman.Q, of_kalman.R);
  struct Row {
    const char* name;
    Estimator estimator;
    const KalmanDesign& kalman;
    double tolerance;
  };
  std::vector<Row> rows;
  rows.push_back({"IMM of equal models", sized_immkf(of_kalman, noisy, {.noise_ratio = 1.0}),
                  of_kalman, 1e-10});
  rows.push_back(
      {"infinite kernel", sized_mckf(of_kalman, noisy, {.kernel_width = 1e12}), of_kalman, 1e-10});
  rows.push_back({"known covariances",
                  sized_vbakf(of_kalman, {.forgetting = 1.0, .prior_samples = 1e15}), of_kalman,
                  1e-10});
  rows.push_back({"one part, no quantisation", sized_gsf(of_kalman, noisy, 1), of_kalman, 1e-10});
  for (const int horizon : {1, 2, 7}) {
    rows.push_back({"horizon without constraints",
                    std::make_unique<Mhe>(of_kalman, noisy, horizon, false), steady, 1e-6});
    rows.push_back({"constraints without an encoder",
                    std::make_unique<Mhe>(of_kalman, noisy, horizon, true), steady, 1e-6});
  }
  for (const Row& row : rows) {
    SCOPED_TRACE(row.name);
    Kfd kalman(row.kalman);
    expect_same(*row.estimator, kalman, row.tolerance);
  }
}

// Two filters with dense matrices, inverses and densities.
TEST(Immkf, IsTheTextbookRecursion) {
  const SensorError noisy = sensor(0.0, kNoise);
  const KalmanDesign quiet = design(noisy, 1e-3);
  const double ratio = 1e8;
  const Estimator filter = sized_immkf(quiet, noisy, {ratio, 0.95, 0.6});
  const StateSpace& s = quiet.plant.sampled;
  const double R = quiet.R(0, 0);
  const double T[2][2] = {{0.95, 0.05}, {0.4, 0.6}};
  std::vector<Eigen::Vector3d> x(2, Eigen::Vector3d::Zero());
  std::vector<Eigen::Matrix3d> P(2, quiet.P0);
  std::vector<double> mu = {0.5, 0.5};
  Random random(8);
  double most = 0.0, least = 1.0;
  for (int k = 0; k < 400; ++k) {
    const double u = random.uniform(-1, 1);
    const double y =
        0.03 * std::sin(0.2 * k) + (k % 80 > 60 ? 0.3 : 0.0) + random.uniform(-kNoise, kNoise);
    auto x0 = x;
    auto P0 = P;
    std::vector<double> c = mu;
    if (k > 0) {
      for (int j = 0; j < 2; ++j) {
        c[j] = T[0][j] * mu[0] + T[1][j] * mu[1];
        x0[j] = (T[0][j] * mu[0] * x[0] + T[1][j] * mu[1] * x[1]) / c[j];
        P0[j].setZero();
        for (int i = 0; i < 2; ++i) {
          P0[j] += T[i][j] * mu[i] / c[j] * (P[i] + (x[i] - x0[j]) * (x[i] - x0[j]).transpose());
        }
        x0[j] = s.A * x0[j] + s.B * u;
        Eigen::Matrix3d Q = quiet.Q;
        if (j == 1) Q(2, 2) *= ratio;
        P0[j] = congruence(s.A, P0[j]) + Q;
      }
    }
    double sum = 0.0, innovation = 0.0;
    for (int j = 0; j < 2; ++j) {
      const double S = P0[j](0, 0) + R, e = y - x0[j](0);
      const Eigen::Vector3d K = P0[j].col(0) / S;
      x[j] = x0[j] + K * e;
      P[j] = P0[j] - K * P0[j].row(0);
      mu[j] = c[j] * std::exp(-0.5 * e * e / S) / std::sqrt(2.0 * std::numbers::pi * S);
      sum += mu[j];
      innovation += c[j] * e;
    }
    for (double& value : mu) value /= sum;
    const Eigen::Vector3d mean = mu[0] * x[0] + mu[1] * x[1];
    filter->update(one(u), one(y));
    EXPECT_NEAR(published(*filter, "model_weight")[1], mu[1], 1e-9) << k;
    EXPECT_NEAR(published(*filter, "innovation")[0], innovation, 1e-9) << k;
    EXPECT_LT((filter->state() - mean.head(2)).norm(), 1e-9 * (1.0 + mean.norm())) << k;
    EXPECT_NEAR(filter->disturbance()(0), mean(2), 1e-9 * (1.0 + mean.norm())) << k;
    most = std::max(most, mu[1]);
    least = std::min(least, mu[1]);
  }
  EXPECT_GT(most, 0.9);
  EXPECT_LT(least, 0.1);
}

// The paper's filter: a kernel for each row of the Cholesky factor of P(k|k−1), d first.
TEST(Mckf, IsTheMultiKernelFilterOfThePaper) {
  const SensorError noisy = sensor(0.0, kNoise);
  const KalmanDesign of_kalman = design(noisy, 1e-2);
  const double width = 1.5;
  const Estimator filter = sized_mckf(of_kalman, noisy, {.kernel_width = width});
  Eigen::Matrix3d order = Eigen::Matrix3d::Zero();  // [d; q; v] of [q; v; d]
  order(0, 2) = order(1, 0) = order(2, 1) = 1.0;
  const StateSpace& s = of_kalman.plant.sampled;
  const Eigen::Matrix3d F = congruence(order, s.A);
  const Eigen::Vector3d G = order * s.B;
  const Eigen::RowVector3d H = s.C * order.transpose();
  const Eigen::Matrix3d Q = congruence(order, of_kalman.Q);
  Eigen::Vector3d x = Eigen::Vector3d::Zero();
  Eigen::Matrix3d P = congruence(order, of_kalman.P0);
  const double R = of_kalman.R(0, 0);
  Random random(9);
  double least = 1.0;
  for (int k = 0; k < 300; ++k) {
    const double u = random.uniform(-1, 1);
    const double y = (k % 60 > 45 ? 0.4 : 0.0) + random.uniform(-kNoise, kNoise);
    Eigen::Vector3d predicted = x;
    if (k > 0) {
      predicted = F * x + G * u;
      P = congruence(F, P) + Q;
    }
    const Eigen::Matrix3d L = P.llt().matrixL();
    Eigen::Vector3d last = predicted, K;
    double weight = 1.0;
    for (int i = 0; i < 5; ++i) {
      const Eigen::Vector3d e = L.inverse() * (predicted - last);
      weight = std::max(1e-4, std::exp(-e(0) * e(0) / (2.0 * width * width)));
      const Eigen::Matrix3d raised =
          congruence(L, Eigen::Vector3d(1.0 / weight, 1.0, 1.0).asDiagonal());
      K = raised * H.transpose() / (H.dot(raised * H.transpose()) + R);
      last = predicted + K * (y - H * predicted);
    }
    x = last;
    const Eigen::Matrix3d rest = Eigen::Matrix3d::Identity() - K * H;
    P = congruence(rest, P) + K * R * K.transpose();
    filter->update(one(u), one(y));
    least = std::min(least, weight);
    EXPECT_NEAR(published(*filter, "lambda")[0], weight, 1e-7);
    EXPECT_LT((filter->state() - x.tail(2)).norm(), 1e-7 * (1.0 + x.norm())) << k;
    EXPECT_NEAR(filter->disturbance()(0), x(0), 1e-7 * (1.0 + x.norm())) << k;
  }
  EXPECT_LT(least, 0.1);
}

// Two ways through the same filter. Jumps put the estimate outside of the interval of the code.
TEST(Mckf, WithAnInfiniteKernelItIsTheImmOfEqualModelsForCodesToo) {
  const SensorError coarse = sensor(0.05, 1e-3);
  const KalmanDesign of_kalman = design(coarse, 1e-2);
  const Estimator kernel =
      sized_mckf(of_kalman, coarse, {.kernel_width = 1e12, .likelihood = Likelihood::code});
  const Estimator models =
      sized_immkf(of_kalman, coarse, {.noise_ratio = 1.0, .likelihood = Likelihood::code});
  expect_same(*kernel, *models, 1e-7);
}

// With a fixed prediction, it is the filter of Särkkä and Nummenmaa with R ~ IG(α, β).
TEST(Vbakf, IsTheFilterOfTheNoiseAloneForAStrongPrior) {
  const KalmanDesign of_kalman = design(sensor(0.0, kNoise), 1e-2);
  const double rho = 0.9;
  const Estimator filter =
      sized_vbakf(of_kalman, {.forgetting = rho, .prior_samples = 1e15, .iterations = 4});
  const StateSpace& s = of_kalman.plant.sampled;
  Eigen::Vector3d x = Eigen::Vector3d::Zero();
  Eigen::Matrix3d P = of_kalman.P0;
  double alpha = 0.5 / (1.0 - rho), beta = alpha * of_kalman.R(0, 0);
  Random random(10);
  for (int k = 0; k < 300; ++k) {
    const double u = random.uniform(-1, 1), y = random.uniform(-0.3, 0.3);
    if (k > 0) {
      x = s.A * x + s.B * u;
      P = congruence(s.A, P) + of_kalman.Q;
    }
    alpha = rho * alpha + 0.5;
    const double before = rho * beta;
    Eigen::Vector3d corrected = x;
    Eigen::Matrix3d variance = P;
    for (int i = 0; i < 4; ++i) {
      beta = before + 0.5 * std::pow(y - corrected(0), 2) + 0.5 * variance(0, 0);
      const Eigen::Vector3d K = P.col(0) / (P(0, 0) + beta / alpha);
      corrected = x + K * (y - x(0));
      variance = P - K * P.row(0);
    }
    x = corrected;
    P = variance;
    filter->update(one(u), one(y));
    EXPECT_NEAR(published(*filter, "noise_variance")[0], beta / alpha, 1e-9);
    EXPECT_LT((filter->state() - x.head(2)).norm(), 1e-9 * (1.0 + x.norm()));
    EXPECT_NEAR(filter->disturbance()(0), x(2), 1e-9 * (1.0 + x.norm()));
  }
}

// The filter of Huang et al. with the dense parameters of both inverse Wishart distributions.
TEST(Vbakf, IsTheFilterOfBothCovariances) {
  const KalmanDesign of_kalman = design(sensor(0.0, kNoise), 1e-2);
  const double rho = 0.9, tau = 3.0;
  const int n = 3, m = 1, iterations = 6;
  const Estimator filter = sized_vbakf(of_kalman, {rho, tau, iterations});
  const StateSpace& s = of_kalman.plant.sampled;
  Eigen::Vector3d x = Eigen::Vector3d::Zero();
  Eigen::Matrix3d P = of_kalman.P0;
  double u_R = m + 1.0 + 1.0 / (1.0 - rho);
  Eigen::MatrixXd U_R = (u_R - m - 1.0) * of_kalman.R;
  Random random(12);
  double farthest = 0.0;
  for (int k = 0; k < 300; ++k) {
    const double u = random.uniform(-1, 1);
    const double y = (k % 60 > 45 ? 0.4 : 0.0) + random.uniform(-kNoise, kNoise);
    if (k > 0) {
      x = s.A * x + s.B * u;
      P = congruence(s.A, P) + of_kalman.Q;
    }
    const double t_P = n + tau + 1.0;
    const Eigen::Matrix3d T_P = tau * P;
    const double u_before = rho * (u_R - m - 1.0) + m + 1.0;
    const Eigen::MatrixXd U_before = rho * U_R;
    Eigen::Vector3d corrected = x;
    Eigen::Matrix3d covariance = P, prior;
    for (int i = 0; i < iterations; ++i) {
      const Eigen::Matrix3d A_i = covariance + (corrected - x) * (corrected - x).transpose();
      prior = (T_P + A_i) / (t_P + 1.0 - n - 1.0);
      const Eigen::VectorXd e = one(y) - s.C * corrected;
      U_R = U_before + e * e.transpose() + congruence(s.C, covariance);
      u_R = u_before + 1.0;
      const Eigen::MatrixXd R = U_R / (u_R - m - 1.0);
      covariance = (prior.inverse() + s.C.transpose() * R.inverse() * s.C).inverse();
      corrected = x + covariance * s.C.transpose() * R.inverse() * (one(y) - s.C * x);
    }
    farthest = std::max(farthest, (prior - P).norm() / P.norm());
    x = corrected;
    P = covariance;
    filter->update(one(u), one(y));
    EXPECT_NEAR(published(*filter, "noise_variance")[0], U_R(0, 0) / (u_R - m - 1.0), 1e-8);
    EXPECT_LT((filter->state() - x.head(2)).norm(), 1e-7 * (1.0 + x.norm())) << k;
    EXPECT_NEAR(filter->disturbance()(0), x(2), 1e-7 * (1.0 + x.norm())) << k;
  }
  EXPECT_GT(farthest, 0.02) << "the prediction's covariance is not adapted";
}

// The arm of one joint in arXiv 2410.05061 (its public program): Euler steps of 10 ms, a pulse of
// 50, computed torque. The paper finds that both filters shorten the error after a jump and stay
// as smooth as the Kalman filter between.
struct PulseErrors {
  double pulse = 0.0;  // root mean square of d̂ − d within 0.5 s after both jumps
  double quiet = 0.0;  // and elsewhere
};

PulseErrors of_the_paper(DisturbanceEstimator& filter) {
  constexpr double m = 0.1, k = 0.1, b = 1.0, T = 0.01, w = 2.0 * std::numbers::pi * 0.2;
  std::mt19937_64 engine(42);
  std::normal_distribution<double> normal;
  PulseErrors errors;
  int in_pulse = 0, in_quiet = 0;
  double d = 0.0, v = 0.0, p = 0.0, u = 0.0;
  for (int i = 1; i <= 1000; ++i) {
    const double next_v =
        T / m * d + (1.0 - b * T / m) * v - k * T / m * p + T / m * u + 0.01 * normal(engine);
    p += T * v + 0.01 * normal(engine);
    v = next_v;
    d = (i >= 400 && i <= 600 ? 50.0 : 0.0) + 0.1 * normal(engine);
    filter.update(one(u), one(p + 0.01 * normal(engine)));
    const double d_hat = -filter.disturbance()(0);
    const bool is_jump = (i >= 400 && i < 450) || (i > 600 && i <= 650);
    (is_jump ? errors.pulse : errors.quiet) += (d_hat - d) * (d_hat - d);
    ++(is_jump ? in_pulse : in_quiet);
    const double t = (i - 1) * T, q = 15.0 * std::sin(w * t), dq = 15.0 * w * std::cos(w * t);
    u = m * -w * w * q + b * dq + k * q - d_hat + 100.0 * (q - filter.state()(0)) +
        10.0 * (dq - filter.state()(1));
  }
  return {std::sqrt(errors.pulse / in_pulse), std::sqrt(errors.quiet / in_quiet)};
}

TEST(PublishedEstimators, ShortenTheErrorAfterAJumpOnThePlantOfTheirPaper) {
  constexpr double m = 0.1, k = 0.1, b = 1.0, T = 0.01;
  StateSpace arm{Eigen::MatrixXd::Zero(2, 2), Eigen::Vector2d(0.0, T / m),
                 Eigen::RowVector2d(1.0, 0.0)};
  arm.A << 1.0, T, -k * T / m, 1.0 - b * T / m;
  const KalmanDesign of_paper{extend_by_disturbance_model(arm, 0, T),
                              Eigen::Vector3d(1e-4, 1e-4, 1e-2).asDiagonal(),
                              Eigen::MatrixXd::Constant(1, 1, 1e-4), Eigen::Matrix3d::Identity()};
  const SensorError noisy = sensor(0.0, 0.01);
  Kfd kalman(of_paper);
  const PulseErrors plain = of_the_paper(kalman);
  const PulseErrors imm = of_the_paper(*sized_immkf(of_paper, noisy, {std::exp(4.0), 0.98, 0.5}));
  const PulseErrors correntropy = of_the_paper(*sized_mckf(of_paper, noisy, {.kernel_width = 1.5}));
  KalmanDesign busy = of_paper;
  busy.Q(2, 2) *= std::exp(4.0);
  Kfd wide(busy);
  const PulseErrors fast = of_the_paper(wide);
  for (const PulseErrors& errors : {imm, correntropy}) {
    EXPECT_LT(errors.pulse, 0.85 * plain.pulse);
    EXPECT_LT(errors.quiet, 0.5 * fast.quiet);
  }
}

TEST(PublishedEstimators, TheLikelihoodOfACodeIsADensityBehindWhiteNoise) {
  const SensorError noisy = sensor(0.0, kNoise);
  const KalmanDesign of_kalman = design(noisy, 1e-3);
  const Estimator imm = sized_immkf(of_kalman, noisy, {.noise_ratio = 1e3});
  const Estimator imm_code =
      sized_immkf(of_kalman, noisy, {.noise_ratio = 1e3, .likelihood = Likelihood::code});
  expect_same(*imm_code, *imm, 1e-9, 0.01);  // within the gate of the code
  const Estimator mckf = sized_mckf(of_kalman, noisy, {.kernel_width = 1.0});
  const Estimator mckf_code =
      sized_mckf(of_kalman, noisy, {.kernel_width = 1.0, .likelihood = Likelihood::code});
  expect_same(*mckf_code, *mckf, 1e-9, 0.01);
}

// A step of 10 N m at 1 s behind an encoder of 8 bits that rounds.
double velocity_error(DisturbanceEstimator& estimator) {
  testing::MotorLoop loop;
  const double quantum = 2.0 * std::numbers::pi / 256.0;
  loop.encoder = {.quantum = quantum, .phase = 0.2 * quantum};
  loop.disturbance = {DisturbanceKind::step, 10.0, 0.0, 1.0};
  return testing::run_motor(loop, estimator).velocity;
}

TEST(PublishedEstimators, TheLikelihoodOfACodeReducesTheErrorBehindACoarseEncoder) {
  const SensorError coarse = sensor(2.0 * std::numbers::pi / 256.0);
  const auto of_kalman = [&](double q) { return design(coarse, q, 1e-3, 0.0); };
  for (const auto& make : std::vector<std::function<Estimator(Likelihood)>>{
           [&](Likelihood kind) {
             return sized_immkf(of_kalman(1e-8), coarse,
                                {.noise_ratio = 1e4, .stays_quiet = 0.999, .likelihood = kind});
           },
           [&](Likelihood kind) {
             return sized_mckf(of_kalman(1e-6), coarse, {.kernel_width = 3.0, .likelihood = kind});
           }}) {
    const double gauss = velocity_error(*make(Likelihood::gauss));
    const double code = velocity_error(*make(Likelihood::code));
    EXPECT_LT(code, 0.3 * gauss);
  }
}

// An edge passed in a gap of measurements is not dated to the last period.
TEST(PublishedEstimators, TheFirstCodeAfterAGapIsAWholeInterval) {
  const double quantum = 0.1, speed = 0.3;
  const SensorError coarse = sensor(quantum);
  const KalmanDesign of_kalman = design(coarse, 1e-8, kPeriod, 0.0);
  for (const Estimator& estimator :
       {sized_immkf(of_kalman, coarse, {.likelihood = Likelihood::code}),
        sized_mckf(of_kalman, coarse, {.likelihood = Likelihood::code})}) {
    double q = 0.0, code = 0.0;
    const auto pass = [&](bool is_measured) {
      q += speed * kPeriod;
      code = quantum * std::round(q / quantum);
      estimator->update(one(0.0), one(is_measured ? code : kNaN));
    };
    for (int k = 0; k < 1000; ++k) pass(true);
    while (code - q > 0.0) pass(true);  // to the middle of a code
    const double before = code;
    for (int k = 0; k < 20; ++k) pass(false);
    pass(true);
    ASSERT_NEAR(code - before, quantum, 1e-9) << "no edge was passed";
    EXPECT_NEAR(estimator->state()(0), q, 2e-3);
    EXPECT_NEAR(estimator->state()(1), speed, 0.05 * speed);
  }
}

// The first code against the moments of the truncated normal distribution.
TEST(Gsf, ApproximatesTheTruncatedDensity) {
  for (const double y : {0.0, 0.1}) {
    const double quantum = 0.1;
    KalmanDesign wide = design(sensor(quantum));
    wide.P0(0, 0) = quantum * quantum;
    Gsf<3> filter(wide, sensor(quantum), 20);
    filter.update(one(0.0), one(y));
    const auto [mean, variance] =
        CodeInterval((y - 0.5 * quantum) / quantum, (y + 0.5 * quantum) / quantum).moments();
    EXPECT_NEAR(filter.state()(0), quantum * mean, 0.01 * quantum) << y;
    EXPECT_NEAR(filter.P()(0, 0) / (quantum * quantum * variance), 1.0, 0.1) << y;
  }
}

// With the nodes and weights in closed form.
TEST(Gsf, TheFirstCodeIsTheSumOverTheNodes) {
  const double quantum = 0.1, y = 0.1;
  KalmanDesign wide = design(sensor(quantum));
  const double P = wide.P0(0, 0) = 0.5 * quantum * quantum;
  std::vector<std::pair<double, double>> nodes = {{0.0, 64.0 / 225.0}};  // and weights
  for (const double sign : {-1.0, 1.0}) {
    const double node = std::sqrt(5.0 + 2.0 * sign * std::sqrt(10.0 / 7.0)) / 3.0;
    const double weight = (322.0 - 13.0 * sign * std::sqrt(70.0)) / 1800.0;
    nodes.insert(nodes.end(), {{node, weight}, {-node, weight}});
  }
  double sum = 0.0, first = 0.0, second = 0.0;
  for (const auto& [node, weight] : nodes) {
    const double e = y + 0.5 * quantum * node;
    const double S = P + std::pow(weight * quantum, 2) / 12.0;
    const double share = weight * std::exp(-0.5 * e * e / S) / std::sqrt(S);
    sum += share;
    first += share * P / S * e;
    second += share * (P - P * P / S + std::pow(P / S * e, 2));
  }
  Gsf<3> filter(wide, sensor(quantum), 20);
  filter.update(one(0.0), one(y));
  EXPECT_NEAR(filter.state()(0), first / sum, 1e-12);
  EXPECT_NEAR(filter.P()(0, 0), second / sum - std::pow(first / sum, 2), 1e-12);
}

// The first code makes five parts of one. Their union keeps the moments of the sum.
TEST(Gsf, TheReductionKeepsTheMeanAndTheCovariance) {
  const SensorError coarse = sensor(0.1);
  KalmanDesign wide = design(coarse);
  wide.P0(0, 0) = 0.01;
  wide.P0(0, 1) = wide.P0(1, 0) = 0.02;
  Gsf<3> all(wide, coarse, 20);
  all.update(one(0.0), one(0.1));
  for (const int parts : {1, 2, 4}) {
    Gsf<3> few(wide, coarse, parts);
    few.update(one(0.0), one(0.1));
    EXPECT_LT((few.extended_state() - all.extended_state()).norm(), 1e-14) << parts;
    EXPECT_LT((few.P() - all.P()).norm(), 1e-14) << parts;
  }
}

TEST(Gsf, MorePartsComeNearerToTheSum) {
  const double quantum = 0.1;
  const SensorError coarse = sensor(quantum);
  const KalmanDesign of_kalman = design(coarse, 1e-4);
  Gsf<3> one_part(of_kalman, coarse, 1), five(of_kalman, coarse, 5), twenty(of_kalman, coarse, 20);
  double of_one = 0.0, of_five = 0.0;
  for (int k = 0; k < 400; ++k) {
    const double y = quantum * std::round(8.0 * std::sin(0.01 * k));
    for (Gsf<3>* filter : {&one_part, &five, &twenty}) filter->update(one(0.0), one(y));
    of_one += std::pow(one_part.state()(0) - twenty.state()(0), 2);
    of_five += std::pow(five.state()(0) - twenty.state()(0), 2);
  }
  EXPECT_LT(of_five, 0.5 * of_one);
  EXPECT_LT(std::sqrt(of_five / 400.0), 0.05 * quantum);
}

TEST(Mhe, KeepsTheEstimateWithinTheCode) {
  const double quantum = 0.1;
  const SensorError coarse = sensor(quantum);
  Mhe bounded(design(coarse, 1e-4), coarse, 12, true);
  Mhe free(design(coarse, 1e-4), coarse, 12, false);
  double outside = 0.0, free_outside = 0.0;
  for (int k = 0; k < 600; ++k) {
    const double q = 0.8 * std::sin(0.01 * k);
    const double y = quantum * std::round(q / quantum);
    for (Mhe* estimator : {&bounded, &free}) estimator->update(one(0.0), one(y));
    outside = std::max(outside, std::abs(bounded.state()(0) - y) - 0.5 * quantum);
    free_outside = std::max(free_outside, std::abs(free.state()(0) - y) - 0.5 * quantum);
  }
  EXPECT_LT(outside, 0.01 * quantum);
  EXPECT_GT(free_outside, 0.1 * quantum);
}

TEST(Eso, HasItsPolesAtTheBandwidthAndTheErrorOfARamp) {
  constexpr double kBandwidth = 20.0, kSlope = 5.0, T = 1e-4;
  Eso eso(damped_inertia(2.0, 0.3), {kBandwidth}, T);
  Eigen::MatrixXd F(3, 3);
  eso.pole_matrix(F);
  const Eigen::Matrix3d shifted = F - std::exp(-kBandwidth * T) * Eigen::Matrix3d::Identity();
  EXPECT_LT((shifted * shifted * shifted).norm(), 1e-9);
  EXPECT_GT((shifted * shifted).norm(), 1e-9);
  // (s² + 3 ω s + 3 ω²) s/(s + ω)³ of a ramp ends at 3 slope/ω.
  const StateSpace plant = zero_order_hold(damped_inertia(2.0, 0.3), T);
  Eigen::Vector2d x = Eigen::Vector2d::Zero();
  double d = 0.0;
  for (int k = 0; k < 20000; ++k) {
    eso.update(one(0.0), one(x(0)));
    d = kSlope * k * T;
    x = plant.A * x - plant.B * d;
  }
  EXPECT_NEAR((d - eso.disturbance()(0)) / (3.0 * kSlope / kBandwidth), 1.0, 0.01);
}

TEST(Eso, HasHansGainsBeyondTheLinearZone) {
  EXPECT_EQ(scaled_fal(0.3, 0.5, 0.4), 0.3);
  EXPECT_NEAR(scaled_fal(-1.6, 0.5, 0.4), -0.8, 1e-15);
  EXPECT_NEAR(scaled_fal(6.4, 0.25, 0.4), 0.8, 1e-15);
  Eso linear(damped_inertia(1.0, 0.0), {30.0}, kPeriod);
  Eso wide(damped_inertia(1.0, 0.0), {30.0, 1e6}, kPeriod);
  Eso narrow(damped_inertia(1.0, 0.0), {30.0, 1e-3}, kPeriod);
  for (int k = 0; k < 10; ++k) {
    for (Eso* eso : {&linear, &wide, &narrow}) eso->update(one(0.0), one(0.01 * k * k));
  }
  EXPECT_EQ(linear.disturbance()(0), wide.disturbance()(0));
  EXPECT_LT(std::abs(narrow.disturbance()(0)), 0.5 * std::abs(linear.disturbance()(0)));
}

// The double integrator reaches 1 in the time 2 √(1/r), with the acceleration r half of it.
TEST(TrackingDifferentiator, ReachesAStepInTheOptimalTime) {
  constexpr double T = 1e-3, r = 4.0;
  TrackingDifferentiator differentiator({1.0, r, 1.0, 10.0}, T);
  differentiator.reset(Eigen::Vector2d::Zero());
  double last = 0.0, fastest = 0.0;
  int reached = 0;
  for (int k = 1; k <= 2000; ++k) {
    differentiator.update(one(0.0), one(1.0));
    const double v = differentiator.state()(1);
    EXPECT_LE(std::abs(v - last), r * T * (1.0 + 1e-9));
    last = v;
    fastest = std::max(fastest, v);
    EXPECT_LE(differentiator.state()(0), 1.0 + 1e-5);
    if (reached == 0 && differentiator.state()(0) > 1.0 - r * T * T) reached = k;
  }
  EXPECT_NEAR(reached * T, 2.0 * std::sqrt(1.0 / r), 5.0 * T);
  EXPECT_NEAR(fastest, std::sqrt(r), 5.0 * r * T);
}

TEST(TrackingDifferentiator, FindsAConstantDisturbance) {
  constexpr double T = 1e-3;
  TrackingDifferentiator differentiator({2.0, 100.0, 3.0, 10.0}, T);
  differentiator.reset(Eigen::Vector2d::Zero());
  for (int k = 0; k < 3000; ++k) {
    const double t = k * T;
    differentiator.update(one(1.0), one(-0.5 * 0.25 * t * t));  // 2·(−0.25) = 1 − 1.5
  }
  const double found = differentiator.disturbance()(0);
  EXPECT_NEAR(found, 1.5, 0.01);
  for (int k = 0; k < 500; ++k) differentiator.update(one(5.0), one(kNaN));
  EXPECT_EQ(differentiator.disturbance()(0), found) << "without measurements";
}

TEST(PublishedEstimators, OnlyPredictWithoutAMeasurementAndStartAgainAfterAnOverflow) {
  const SensorError coarse = sensor(0.01, 1e-3);
  const KalmanDesign of_kalman = design(coarse);
  std::vector<Estimator> estimators;
  for (const Likelihood kind : {Likelihood::gauss, Likelihood::code}) {
    estimators.push_back(sized_immkf(of_kalman, coarse, {.noise_ratio = 10.0, .likelihood = kind}));
    estimators.push_back(sized_mckf(of_kalman, coarse, {.likelihood = kind}));
  }
  estimators.push_back(sized_vbakf(of_kalman, {}));
  estimators.push_back(sized_gsf(of_kalman, coarse, 4));
  estimators.push_back(std::make_unique<Mhe>(of_kalman, coarse, 5, true));
  estimators.push_back(std::make_unique<Eso>(damped_inertia(1.0, 0.4), EsoDesign{20.0}, kPeriod));
  const StateSpace plant = zero_order_hold(damped_inertia(1.0, 0.4), kPeriod);
  for (std::size_t i = 0; i < estimators.size(); ++i) {
    SCOPED_TRACE(i);
    DisturbanceEstimator& estimator = *estimators[i];
    estimator.reset(Eigen::Vector2d(0.1, 0.2));
    for (int k = 0; k < 20; ++k) estimator.update(one(0.3), one(0.1 + 0.002 * k));
    const Eigen::Vector2d before = estimator.state();
    const double d = estimator.disturbance()(0);
    const double u = 0.7;
    estimator.update(one(u), one(kNaN));
    const Eigen::Vector2d expected = plant.A * before + plant.B * (u - d);
    EXPECT_LT((estimator.state() - expected).norm(), 1e-6);
    EXPECT_NEAR(estimator.disturbance()(0), d, 1e-6);
    estimator.update(one(kNaN), one(0.15));
    EXPECT_TRUE(estimator.state().allFinite());
    for (const double y : {1e308, -1e308, 0.1}) {
      estimator.update(one(0.0), one(y));
      EXPECT_TRUE(estimator.state().allFinite()) << y;
      EXPECT_TRUE(estimator.disturbance().allFinite()) << y;
    }
  }
}

// In millimetres and in metres.
TEST(PublishedEstimators, DoNotDependOnTheUnit) {
  constexpr double kUnit = 1000.0;
  const SensorError metres = sensor(0.05, 1e-3), millimetres = sensor(0.05 * kUnit, 1e-3 * kUnit);
  const KalmanDesign small = design(metres, 1e-2);
  KalmanDesign large = small;
  for (Eigen::MatrixXd* of_squares : {&large.Q, &large.R, &large.P0}) *of_squares *= kUnit * kUnit;
  for (const Likelihood kind : {Likelihood::gauss, Likelihood::code}) {
    std::vector<std::pair<Estimator, Estimator>> pairs;
    pairs.emplace_back(sized_immkf(small, metres, {.likelihood = kind}),
                       sized_immkf(large, millimetres, {.likelihood = kind}));
    pairs.emplace_back(sized_mckf(small, metres, {.likelihood = kind}),
                       sized_mckf(large, millimetres, {.likelihood = kind}));
    pairs.emplace_back(sized_gsf(small, metres, 5), sized_gsf(large, millimetres, 5));
    for (const auto& [one_unit, other_unit] : pairs) {
      for (int k = 0; k < 300; ++k) {
        const double u = std::sin(0.1 * k), y = 0.05 * std::round(6.0 * std::sin(0.05 * k));
        one_unit->update(one(u), one(y));
        other_unit->update(one(kUnit * u), one(kUnit * y));
        ASSERT_LT((other_unit->state() / kUnit - one_unit->state()).norm(), 1e-6) << k;
      }
    }
  }
}

TEST(PublishedEstimators, RefuseWrongDesigns) {
  const SensorError noisy = sensor(0.0, kNoise);
  const KalmanDesign good = design(noisy);
  for (const ImmDesign& imm : std::vector<ImmDesign>{{.noise_ratio = 0.0},
                                                     {.noise_ratio = INFINITY},
                                                     {.stays_quiet = 1.1},
                                                     {.stays_quiet = -0.1},
                                                     {.stays_busy = 1.1},
                                                     {.stays_busy = -0.1}}) {
    EXPECT_THROW(sized_immkf(good, noisy, imm), std::invalid_argument);
  }
  EXPECT_NO_THROW(sized_immkf(good, noisy, {.stays_quiet = 1.0, .stays_busy = 0.0}));
  EXPECT_THROW(sized_mckf(good, noisy, {.kernel_width = 0.0}), std::invalid_argument);
  EXPECT_THROW(sized_vbakf(good, {.forgetting = 0.0}), std::invalid_argument);
  EXPECT_THROW(sized_vbakf(good, {.forgetting = 1.1}), std::invalid_argument);
  EXPECT_THROW(sized_vbakf(good, {.prior_samples = 0.0}), std::invalid_argument);
  EXPECT_THROW(sized_vbakf(good, {.iterations = 0}), std::invalid_argument);
  for (const int parts : {0, 21}) {
    EXPECT_THROW(sized_gsf(good, noisy, parts), std::invalid_argument);
  }
  EXPECT_THROW(Mhe(good, noisy, 0, true), std::invalid_argument);
  EXPECT_THROW(Eso(damped_inertia(1.0, 0.0), {0.0}, kPeriod), std::invalid_argument);
  EXPECT_THROW(TrackingDifferentiator({1.0, 0.0, 1.0, 10.0}, kPeriod), std::invalid_argument);
  KalmanDesign second_state = good;
  second_state.plant.sampled.C = Eigen::RowVector3d::Unit(1);
  EXPECT_THROW(sized_vbakf(second_state, {}), std::invalid_argument);
}

}  // namespace breakwater::published_estimators_test
