#include <breakwater/control/pfc.h>

#include <Eigen/Dense>
#include <cmath>

#include <breakwater/linear/eigenvalues.h>
#include "support.h"

namespace breakwater {
namespace {

constexpr double T_s = 1e-3;

TEST(Pfc, GainsFromOneSecondMatchEq286) {
  const Pfc pfc({1.0, T_s, 3, 3});
  EXPECT_EQ(pfc.coincidence_points(), (std::vector<int>{333, 500, 1000}));
  EXPECT_NEAR(pfc.alpha(), std::exp(-0.003), 1e-15);
  EXPECT_NEAR(pfc.k_p(), 27.297, 5e-4);
  EXPECT_NEAR(pfc.k_d(), 12.012, 5e-4);
}

// Applies an input u(i) = Σ μ_l (i T)^l to the double integrator of Eqs. 2.71 and 2.72 and returns
// the positions. It uses neither responses nor an inverse.
std::vector<double> play(const Eigen::VectorXd& mu, double q, double dq, int samples) {
  std::vector<double> positions = {q};
  for (int i = 0; i < samples; ++i) {
    double u = 0.0;
    for (int l = static_cast<int>(mu.size()) - 1; l >= 0; --l) u = u * i * T_s + mu(l);
    q += T_s * dq;
    dq += T_s * u;
    positions.push_back(q);
  }
  return positions;
}

TEST(Pfc, CollocationMeetsTheReferenceTrajectory) {
  // μ_1 is that of the controller. With suitable other coefficients the input meets the reference
  // at all three coincidence points. A least-squares fit of simulated responses finds them, so the
  // test checks all three equations.
  for (const double t_ref : {0.5, 0.7, 1.0, 1.2}) {
    const Pfc pfc({t_ref, T_s, 3, 3});
    const double s = 0.4, q = 0.1, dq = -0.3;
    const auto& h = pfc.coincidence_points();
    const double mu_1 = pfc.acceleration(s, q, dq);
    Eigen::Matrix<double, 3, 2> free;
    Eigen::Vector3d missing;
    const auto base = play(Eigen::Vector3d(mu_1, 0, 0), q, dq, h.back());
    const auto ramp = play(Eigen::Vector3d(0, 1, 0), 0, 0, h.back());
    const auto parabola = play(Eigen::Vector3d(0, 0, 1), 0, 0, h.back());
    for (int j = 0; j < 3; ++j) {
      const double target = s - std::pow(pfc.alpha(), h[j]) * (s - q);
      missing(j) = target - base[h[j]];
      free.row(j) << ramp[h[j]], parabola[h[j]];
    }
    const Eigen::Vector2d rest = free.colPivHouseholderQr().solve(missing);
    EXPECT_LT((free * rest - missing).cwiseAbs().maxCoeff(), 1e-10) << t_ref;
  }
}

TEST(Pfc, WithMorePointsIsTheLeastSquaresFit) {
  // The normal equations with eight points and two bases (Eqs. 2.78, 2.80).
  const Pfc pfc({0.8, T_s, 8, 2});
  const double s = -0.2, q = 0.3, dq = 0.5;
  Eigen::Matrix2d normal = Eigen::Matrix2d::Zero();
  Eigen::Vector2d right = Eigen::Vector2d::Zero();
  const auto& points = pfc.coincidence_points();
  const auto step = play(Eigen::Vector2d(1, 0), 0, 0, points.back());
  const auto ramp = play(Eigen::Vector2d(0, 1), 0, 0, points.back());
  for (const int h : points) {
    const Eigen::Vector2d y_b(step[h], ramp[h]);
    const double missing = (1 - std::pow(pfc.alpha(), h)) * (s - q) - h * T_s * dq;
    normal += y_b * y_b.transpose();
    right += y_b * missing;
  }
  const Eigen::Vector2d mu = normal.fullPivLu().solve(right);
  EXPECT_NEAR(pfc.acceleration(s, q, dq), mu(0), 1e-8 * std::abs(mu(0)));
}

TEST(Pfc, OnePointAndAStepHasItsClosedForm) {
  // h (h−1)/2 T² u = (1 − α^h)(s − q) − h T q̇
  const Pfc pfc({0.5, T_s, 1, 1});
  const double h = 500;
  EXPECT_NEAR(pfc.k_p(), (1 - std::exp(-3.0)) / (h * (h - 1) / 2 * T_s * T_s), 1e-10);
  EXPECT_NEAR(pfc.k_d(), 2 / ((h - 1) * T_s), 1e-12);
}

// Denominator of Eq. 2.87: (1 + T² k_p + T k_d) z² − (T k_d + 2) z + 1.
Eigen::Vector3d eq287_denominator(const Pfc& pfc) {
  return {1 + T_s * T_s * pfc.k_p() + T_s * pfc.k_d(), -(T_s * pfc.k_d() + 2), 1};
}

TEST(Pfc, Eq287IsTheBackwardDifferenceOfTheContinuousLoop) {
  // s² + k_d s + k_p with s = (1 − z⁻¹)/T, times T² z².
  const Pfc pfc({1.0, T_s, 3, 3});
  const Eigen::Vector3d denominator = eq287_denominator(pfc);
  for (const std::complex<double> z :
       {std::complex<double>(0.3, 0.7), {1.0, 0.0}, {-1.2, 0.1}, {0.997, 0.0}, {2.0, -3.0}}) {
    const std::complex<double> s = (1.0 - 1.0 / z) / T_s;
    const std::complex<double> expected = T_s * T_s * z * z * (s * s + pfc.k_d() * s + pfc.k_p());
    const std::complex<double> printed =
        denominator(0) * z * z + denominator(1) * z + denominator(2);
    EXPECT_LT(std::abs(printed - expected), 1e-12);
  }
}

TEST(Pfc, BothClosedLoopsAreStable) {
  const Pfc pfc({1.0, T_s, 3, 3});
  const Eigen::Vector3d d = eq287_denominator(pfc);
  Eigen::Matrix2d companion;
  companion << -d(1) / d(0), -d(2) / d(0), 1, 0;
  EXPECT_LT(testing::distance(eigenvalues(companion), {0.991111, 0.996966}), 1e-6);

  Eigen::Matrix2d A_q;
  A_q << 1, T_s, 0, 1;
  const Eigen::Vector2d B_q(0, T_s);
  const auto poles = eigenvalues(A_q - B_q * Eigen::RowVector2d(pfc.k_p(), pfc.k_d()));
  EXPECT_LT(testing::distance(poles, {0.991032, 0.996956}), 1e-6);
  for (const auto& pole : poles) EXPECT_LT(std::abs(pole), 1.0);
}

// At this time the reference's error is 5 %. The loop's error is that of its two poles.
TEST(Pfc, ErrorAtTheTargetResponseTimeMatchesThePoles) {
  const Pfc pfc({1.0, T_s, 3, 3});
  double q = 0.0, dq = 0.0;
  for (int k = 0; k < 1000; ++k) {
    const double u = pfc.acceleration(1.0, q, dq);
    q += T_s * dq;
    dq += T_s * u;
  }
  const double fast = std::sqrt(pfc.k_d() * pfc.k_d() / 4.0 - pfc.k_p());
  const double s_1 = -pfc.k_d() / 2.0 + fast;
  const double s_2 = -pfc.k_d() / 2.0 - fast;
  const double error = (s_1 * std::exp(s_2) - s_2 * std::exp(s_1)) / (s_1 - s_2);
  EXPECT_NEAR(error, 0.072, 0.002);
  EXPECT_NEAR(1.0 - q, error, 0.001);
}

TEST(Pfc, RefusesNonsense) {
  EXPECT_THROW(Pfc({0.0, T_s, 3, 3}), std::invalid_argument);
  EXPECT_THROW(Pfc({1.0, 0.0, 3, 3}), std::invalid_argument);
  EXPECT_THROW(Pfc({std::nan(""), T_s, 3, 3}), std::invalid_argument);
  EXPECT_THROW(Pfc({1.0, T_s, 2, 3}), std::invalid_argument);
  EXPECT_THROW(Pfc({1.0, T_s, 3, 0}), std::invalid_argument);
  EXPECT_THROW(Pfc({0.003, T_s, 3, 3}), std::invalid_argument);
  EXPECT_THROW(Pfc({1e9, T_s, 3, 3}), std::invalid_argument);
}

}  // namespace
}  // namespace breakwater
