// The Gaussian-sum filter's covariance, and the plant of a paper. tests/python/observers_test.py
// has the equations of the published estimators.
#include <breakwater/observers/code_sensor.h>
#include <breakwater/observers/gsf.h>
#include <breakwater/observers/immkf.h>
#include <breakwater/observers/kfd.h>
#include <breakwater/observers/mckf.h>
#include <breakwater/plants/damped_inertia.h>
#include "support.h"

namespace breakwater::published_estimators_test {

SensorError sensor(double quantum, double noise_std = 0.0) {
  return {Eigen::VectorXd::Constant(1, quantum), Eigen::VectorXd::Constant(1, noise_std)};
}

KalmanDesign design(const SensorError& error, double q = 0.1) {
  const ExtendedPlant plant = sample_with_disturbance_model(damped_inertia(1.0, 0.4), 0, 0.01);
  return known_sensor_design(plant, error, q, Eigen::Vector3d(1e-2, 0.5, 2.0));
}

Eigen::VectorXd one(double value) {
  return Eigen::VectorXd::Constant(1, value);
}

// The first code against the moments of the truncated normal distribution.
TEST(Gsf, ApproximatesTheTruncatedDensity) {
  for (const double y : {0.0, 0.1}) {
    const double quantum = 0.1;
    KalmanDesign wide = design(sensor(quantum));
    wide.P0(0, 0) = quantum * quantum;
    const auto filter = sized_gsf(wide, sensor(quantum), 20);
    filter->update(one(0.0), one(y));
    const auto [mean, variance] =
        CodeInterval((y - 0.5 * quantum) / quantum, (y + 0.5 * quantum) / quantum).moments();
    EXPECT_NEAR(filter->state()(0), quantum * mean, 0.01 * quantum) << y;
    EXPECT_NEAR(filter->P()(0, 0) / (quantum * quantum * variance), 1.0, 0.1) << y;
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
  const auto filter = sized_gsf(wide, sensor(quantum), 20);
  filter->update(one(0.0), one(y));
  EXPECT_NEAR(filter->state()(0), first / sum, 1e-12);
  EXPECT_NEAR(filter->P()(0, 0), second / sum - std::pow(first / sum, 2), 1e-12);
}

// The first code makes five parts of one. Their union keeps the moments of the sum.
TEST(Gsf, TheReductionKeepsTheMeanAndTheCovariance) {
  const SensorError coarse = sensor(0.1);
  KalmanDesign wide = design(coarse);
  wide.P0(0, 0) = 0.01;
  wide.P0(0, 1) = wide.P0(1, 0) = 0.02;
  const auto all = sized_gsf(wide, coarse, 20);
  all->update(one(0.0), one(0.1));
  for (const int parts : {1, 2, 4}) {
    const auto few = sized_gsf(wide, coarse, parts);
    few->update(one(0.0), one(0.1));
    EXPECT_LT((few->extended_state() - all->extended_state()).norm(), 1e-14) << parts;
    EXPECT_LT((few->P() - all->P()).norm(), 1e-14) << parts;
  }
}

TEST(Gsf, MorePartsComeNearerToTheSum) {
  const double quantum = 0.1;
  const SensorError coarse = sensor(quantum);
  const KalmanDesign of_kalman = design(coarse, 1e-4);
  const auto one_part = sized_gsf(of_kalman, coarse, 1), five = sized_gsf(of_kalman, coarse, 5),
             twenty = sized_gsf(of_kalman, coarse, 20);
  double of_one = 0.0, of_five = 0.0;
  for (int k = 0; k < 400; ++k) {
    const double y = quantum * std::round(8.0 * std::sin(0.01 * k));
    for (const auto& filter : {&one_part, &five, &twenty}) (*filter)->update(one(0.0), one(y));
    of_one += std::pow(one_part->state()(0) - twenty->state()(0), 2);
    of_five += std::pow(five->state()(0) - twenty->state()(0), 2);
  }
  EXPECT_LT(of_five, 0.5 * of_one);
  EXPECT_LT(std::sqrt(of_five / 400.0), 0.05 * quantum);
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

}  // namespace breakwater::published_estimators_test
