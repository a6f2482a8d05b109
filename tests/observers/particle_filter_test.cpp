// The particle filter, and the motor without an engine, for tests of estimators.
#include "particle_filter.h"
#include <breakwater/linear/riccati.h>
#include "observers/motor_loop.h"
#include "support.h"

namespace breakwater::particle_filter_test {

constexpr double kPeriod_s = 0.01;

TEST(ParticleFilter, IsTheKalmanFilterOfALinearGaussianMotion) {
  constexpr double kNoise = 0.01, kWalk = 0.5;
  using Matrix = Eigen::Matrix<double, 3, 3, Eigen::RowMajor>;
  Matrix A;
  A << 1.0, kPeriod_s, -0.5 * kPeriod_s * kPeriod_s,  //
      0.0, 1.0, -kPeriod_s,                           //
      0.0, 0.0, 0.98;
  const Eigen::Vector3d B(0.5 * kPeriod_s * kPeriod_s, kPeriod_s, 0.0), D(0.0, 0.0, 1.0);
  const Eigen::Vector3d start(0.0, 0.0, kWalk / std::sqrt(1.0 - 0.98 * 0.98));
  const GeneratedMotion motion{3,  A.data(), B.data(), D.data(), start.data(),
                               -1, 0.0,      0.0,      2,        kWalk};
  const Eigen::RowVector3d C(1.0, 0.0, 0.0);
  const Eigen::MatrixXd Q = kWalk * kWalk * D * D.transpose();
  const Eigen::MatrixXd R = Eigen::MatrixXd::Constant(1, 1, kNoise * kNoise);
  const Eigen::MatrixXd P = solve_dare(A.transpose(), C.transpose(), Q, R);
  const Eigen::Vector3d K = P * C.transpose() / ((C * P * C.transpose())(0) + R(0, 0));
  const Eigen::VectorXd floor = (P - K * C * P).diagonal().cwiseSqrt();

  constexpr int kSamples = 3000, kFrom = 300;
  std::mt19937_64 bits(1);
  std::normal_distribution<double> normal;
  Eigen::Vector3d x(0.0, 0.0, start(2) * normal(bits)), estimate = Eigen::Vector3d::Zero();
  std::vector<double> u(kSamples), y(kSamples), v(kSamples), d(kSamples);
  std::vector<Eigen::Vector3d> truth, kalman;
  for (std::size_t k = 0; k < kSamples; ++k) {
    y[k] = x(0) + kNoise * normal(bits);
    estimate += K * (y[k] - estimate(0));
    truth.push_back(x);
    kalman.push_back(estimate);
    u[k] = -10.0 * estimate(0) - 3.0 * estimate(1) + estimate(2);
    estimate = A * estimate + B * u[k];
    x = A * x + B * u[k];
    x(2) += kWalk * normal(bits);
  }
  EXPECT_EQ(0, breakwater_particle_filter(&motion, kSamples, u.data(), y.data(), y.data(), kNoise,
                                          2000, 1, v.data(), d.data()));
  Eigen::Vector2d apart(0.0, 0.0), error(0.0, 0.0);
  for (std::size_t k = kFrom; k < kSamples; ++k) {
    const Eigen::Vector2d found(v[k], d[k]);
    apart += (found - kalman[k].tail<2>()).cwiseAbs2();
    error += (found - truth[k].tail<2>()).cwiseAbs2();
  }
  for (int i = 0; i < 2; ++i) {
    EXPECT_LT(std::sqrt(apart(i) / (kSamples - kFrom)), 0.1 * floor(1 + i));
    EXPECT_NEAR(std::sqrt(error(i) / (kSamples - kFrom)), floor(1 + i), 0.1 * floor(1 + i));
  }
}

TEST(ParticleFilter, IsTheIntegralOverTheIntervalsOfTheCodes) {
  // A constant velocity N(0, 1), and counts of 1.
  const double A[] = {1.0, kPeriod_s, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0};
  const double zero[] = {0.0, 0.0, 0.0}, start[] = {0.0, 1.0, 0.0};
  const GeneratedMotion motion{3, A, zero, zero, start, -1, 0.0, 0.0, -1, 0.0};
  constexpr int kSamples = 200;
  std::vector<double> u(kSamples, 0.0), lower, upper, v(kSamples), d(kSamples);
  for (int k = 0; k < kSamples; ++k) {
    lower.push_back(std::round(0.2 + 0.7 * k * kPeriod_s) - 0.5);
    upper.push_back(lower.back() + 1.0);
  }
  EXPECT_EQ(0, breakwater_particle_filter(&motion, kSamples, u.data(), lower.data(), upper.data(),
                                          0.0, 4000, 1, v.data(), d.data()));
  for (const int last : {30, 100, 180}) {
    double weight = 0.0, mean = 0.0, square = 0.0;
    for (double q = -0.4995; q < 0.5; q += 0.001) {
      for (double speed = -4.0; speed < 4.0; speed += 0.002) {
        bool is_inside = true;
        for (int k = 0; k <= last && is_inside; ++k) {
          const double at = q + speed * k * kPeriod_s;
          const auto i = static_cast<std::size_t>(k);
          is_inside = at >= lower[i] && at <= upper[i];
        }
        if (!is_inside) continue;
        const double density = std::exp(-0.5 * speed * speed);
        weight += density;
        mean += density * speed;
        square += density * speed * speed;
      }
    }
    mean /= weight;
    EXPECT_NEAR(v[static_cast<std::size_t>(last)], mean,
                0.15 * std::sqrt(square / weight - mean * mean))
        << last;
  }
}

// The motor without an engine, for tests of estimators.

// Starts at 3 rad/s with only 2 N m of dry friction on 0.5 kg m²: a = −4 until rest.
TEST(MotorLoop, DryFrictionStopsTheShaftAndHoldsIt) {
  double q = 0.0, v = 3.0;
  for (int i = 0; i < 100; ++i) testing::slide(q, v, 0.0, 2.0, 0.5, 0.01);
  EXPECT_NEAR(q, 3.0 * 3.0 / (2.0 * 4.0), 1e-12);
  EXPECT_EQ(v, 0.0);
  const double at_rest = q;
  testing::slide(q, v, -1.99, 2.0, 0.5, 0.01);
  EXPECT_EQ(q, at_rest);
  testing::slide(q, v, -3.0, 2.0, 0.5, 0.01);  // breaks away with the remaining 1 N m
  EXPECT_DOUBLE_EQ(v, -1.0 / 0.5 * 0.01);
}

// A torque against the motion: the shaft stops and turns back within one step.
TEST(MotorLoop, DryFrictionTurnsWithTheShaft) {
  double q = 0.0, v = 1.0;
  testing::slide(q, v, -3.0, 1.0, 1.0, 0.5);  // a = −4 for ¼ s, then −2
  EXPECT_DOUBLE_EQ(v, -0.5);
  EXPECT_DOUBLE_EQ(q, 0.125 - 0.0625);
}

}  // namespace breakwater::particle_filter_test
