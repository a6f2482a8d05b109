// EKF and UKF against the linear Kalman filter, each other, and statistics.
#include <breakwater/observers/ekf.h>
#include <breakwater/observers/ukf.h>
#include "support.h"

namespace breakwater::nonlinear_kalman_test {

// A pendulum with an unknown constant torque: x = [angle, rate, torque].
struct Pendulum : ProcessTypes<3, 1, 1> {
  static constexpr int kStates = 3, kInputs = 1, kFirstRow = 1, kRows = 1, kArguments = 1;
  using Square = Eigen::Matrix3d;

  void nonlinear(const State& x, const Input& u, Nonlinear& g) const {
    g(0) = dt * (-9.81 * std::sin(x(0)) + u(0));
  }
  const Square& linear() const { return A; }

  double dt = 0.01;
  Square A = (Square() << 1, 0.01, 0, 0, 1, 0.01, 0, 0, 1).finished();
};

// A linear process of an odd number of states: the nonlinear part is linear too.
struct Linear : ProcessTypes<5, 2, 2> {
  static constexpr int kStates = 5, kInputs = 2, kFirstRow = 3, kRows = 2, kArguments = 3;
  using Square = Eigen::Matrix<double, 5, 5>;

  void nonlinear(const State& x, const Input& u, Nonlinear& g) const { g = G * x.head<3>() + u; }
  const Square& linear() const { return A; }
  Eigen::MatrixXd whole() const {
    Eigen::MatrixXd F = A;
    F.block(3, 0, 2, 3) += G;
    return F;
  }

  Square A = (Square() << 0.9, 0.1, 0, 0, 0, 0, 0.8, 0.2, 0, 0, 0, 0, 0.5, 0.1, 0, 0, 0, 0, 0.4,
              0.3, 0, 0, 0, 0, 0.6)
                 .finished();
  Eigen::Matrix<double, 2, 3> G =
      (Eigen::Matrix<double, 2, 3>() << 0.1, -0.2, 0.3, 0.05, 0.1, -0.1).finished();
};

template <int N, int p>
NonlinearKalmanDesign<N, p> design(double q, double r, double p0) {
  NonlinearKalmanDesign<N, p> d;
  d.Q = q * Eigen::Matrix<double, N, N>::Identity();
  d.R = r * Eigen::Matrix<double, p, p>::Identity();
  d.P0 = p0 * Eigen::Matrix<double, N, N>::Identity();
  return d;
}

TEST(NonlinearKalman, AllEqualTheKalmanFilterForALinearProcess) {
  const Linear process;
  const auto d = design<5, 3>(0.01, 0.1, 1.0);
  Ekf<Linear, 3> ekf(process, d, 0.0);
  Ukf<Linear, 3> ukf(process, d);
  // Matrices of any size compile sooner: their kernels exist.
  const Eigen::MatrixXd F = process.whole(), C = Eigen::MatrixXd::Identity(3, 5);
  Eigen::VectorXd x = Eigen::VectorXd::Zero(5);
  Eigen::MatrixXd P = d.P0;
  testing::Random random;
  for (int k = 0; k < 300; ++k) {
    const Eigen::Vector2d u = random.vector(2);
    const Eigen::Vector3d y = random.vector(3);
    x = F * x;
    x.tail<2>() += u;
    P = testing::congruence(F, P) + d.Q;
    const Eigen::MatrixXd K = testing::kalman_gain(P, C, d.R);
    x += K * (y - C * x);
    P -= K * C * P;
    ekf.predict(u);
    ekf.correct(y);
    ukf.predict(u);
    ukf.correct(y);
    ASSERT_NEAR((ekf.x() - x).norm(), 0.0, 1e-10);
    ASSERT_NEAR((ukf.x() - x).norm(), 0.0, 1e-10);
    ASSERT_NEAR((ekf.P() - P).norm(), 0.0, 1e-10);
    ASSERT_NEAR((ukf.P() - P).norm(), 0.0, 1e-10);
    ASSERT_TRUE(ukf.P() == ukf.P().transpose()) << k;  // to the bit
  }
}

// Also at entries that were 0: the filter predicts with nonzero entries only.
TEST(NonlinearKalman, PredictsWithTheChangedProcess) {
  Linear process;
  const auto d = design<5, 3>(0.01, 0.1, 1.0);
  Ukf<Linear, 3> changed(process, d);
  changed.change_process([](Linear& p) { p.A(0, 3) = 0.7; });
  process.A(0, 3) = 0.7;
  Ukf<Linear, 3> made_anew(process, d);
  Ukf<Linear, 3> unchanged(Linear(), d);
  const Eigen::Vector2d u(0.3, -0.2);
  changed.predict(u);
  made_anew.predict(u);
  unchanged.predict(u);
  EXPECT_EQ(changed.P(), made_anew.P());
  EXPECT_GT((changed.P() - unchanged.P()).norm(), 0.1);
}

// One step against the textbook algorithm with all 2n points, which are drawn again for the
// measurement.
TEST(NonlinearKalman, UkfEqualsTheTextbook) {
  const Pendulum process;
  const auto d = design<3, 1>(1e-4, 0.01, 0.3);
  Ukf<Pendulum, 1> ukf(process, d);
  ukf.reset(Eigen::Vector3d(1.0, -2.0, 0.3));
  Eigen::VectorXd x = Eigen::Vector3d(1.0, -2.0, 0.3);
  Eigen::MatrixXd P = d.P0;
  for (int k = 0; k < 50; ++k) {
    const Eigen::Matrix<double, 1, 1> u(std::sin(0.1 * k)), y(1.0 - 0.01 * k);
    const auto points = [&] {
      const Eigen::MatrixXd L = P.llt().matrixL();
      Eigen::MatrixXd X(3, 6);
      X << std::sqrt(3.0) * L, -std::sqrt(3.0) * L;
      return Eigen::MatrixXd(X.colwise() + x);
    };
    Eigen::MatrixXd X = points();
    for (int j = 0; j < 6; ++j) {
      Pendulum::Nonlinear g;
      process.nonlinear(X.col(j), u, g);
      X.col(j) = process.A * X.col(j).eval();
      X(1, j) += g(0);
    }
    x = X.rowwise().mean();
    const Eigen::MatrixXd off = X.colwise() - x;
    P = testing::congruence(off, Eigen::MatrixXd::Identity(6, 6)) / 6.0 + d.Q;
    X = points();
    const Eigen::VectorXd Y = X.row(0).transpose().array() - X.row(0).mean();
    const double S = Y.squaredNorm() / 6.0 + d.R(0, 0);
    const Eigen::VectorXd K = (X.colwise() - x) * Y / (6.0 * S);
    x += K * (y(0) - X.row(0).mean());
    P -= S * K * K.transpose();
    ukf.predict(u);
    ukf.correct(y);
    ASSERT_NEAR((ukf.x() - x).norm(), 0.0, 1e-10);
    ASSERT_NEAR((ukf.P() - P).norm(), 0.0, 1e-10);
  }
}

// The NEES is χ² if the model is true. Its mean over M runs of n states lies in n ± 1.96 √(2n/M) in
// 95 of 100 cases.
TEST(NonlinearKalman, NeesIsInItsBandWithATrueModel) {
  const Pendulum process;
  auto d = design<3, 1>(0.0, 1e-4, 0.01);
  d.Q.diagonal() << 1e-8, 1e-5, 1e-6;
  std::mt19937_64 engine(7);
  std::normal_distribution<double> normal;
  const auto draw = [&] { return Eigen::Vector3d(normal(engine), normal(engine), normal(engine)); };
  const int runs = 400;
  double ukf_nees = 0.0, ekf_nees = 0.0;
  for (int run = 0; run < runs; ++run) {
    Ukf<Pendulum, 1> ukf(process, d);
    Ekf<Pendulum, 1> ekf(process, d, 0.0);
    const Eigen::Vector3d first(0.8, 0.0, 0.5);
    Eigen::Vector3d x = first + 0.1 * draw();
    ukf.reset(first);
    ekf.reset(first);
    for (int k = 0; k < 200; ++k) {
      const Eigen::Matrix<double, 1, 1> u(2.0 * std::sin(0.03 * k));
      Pendulum::Nonlinear g;
      process.nonlinear(x, u, g);
      const Eigen::Vector3d linear = process.A * x;
      x = linear + d.Q.diagonal().cwiseSqrt().cwiseProduct(draw());
      x(1) += g(0);
      const Eigen::Matrix<double, 1, 1> y(x(0) + 1e-2 * normal(engine));
      ukf.predict(u);
      ukf.correct(y);
      ekf.predict(u);
      ekf.correct(y);
    }
    ukf_nees += (x - ukf.x()).dot(ukf.P().llt().solve(x - ukf.x())) / runs;
    ekf_nees += (x - ekf.x()).dot(ekf.P().llt().solve(x - ekf.x())) / runs;
  }
  const double half_band = 1.96 * std::sqrt(2.0 * 3.0 / runs);
  EXPECT_NEAR(ukf_nees, 3.0, half_band);
  EXPECT_NEAR(ekf_nees, 3.0, half_band);
}

// A matrix with a negative eigenvalue keeps its eigenvectors and the other eigenvalues.
TEST(NonlinearKalman, RaisesSmallEigenvalues) {
  const double sine = std::sin(0.7), cosine = std::cos(0.7);
  Eigen::Matrix3d vectors;
  vectors << cosine, -sine, 0, sine, cosine, 0, 0, 0, 1;
  const auto with = [&](double smallest) {
    return Eigen::Matrix3d(vectors * Eigen::Vector3d(smallest, 2.0, 5.0).asDiagonal() *
                           vectors.transpose());
  };
  Eigen::Matrix3d raised = with(-1e-3);
  raise_eigenvalues(raised, 1e-2);
  EXPECT_LT((raised - with(5e-2)).norm(), 1e-14);
  Eigen::Matrix3d kept = with(1.0);
  raise_eigenvalues(kept, 1e-2);
  EXPECT_LT((kept - with(1.0)).norm(), 1e-14);
}

TEST(NonlinearKalman, MillionStepsWithoutRepair) {
  const Pendulum process;
  Ukf<Pendulum, 1> ukf(process, design<3, 1>(1e-9, 1e-6, 1.0));
  for (int k = 0; k < 1000000; ++k) {
    ukf.predict(Eigen::Matrix<double, 1, 1>(std::sin(1e-3 * k)));
    ukf.correct(Eigen::Matrix<double, 1, 1>(0.1 * std::sin(2e-3 * k)));
  }
  EXPECT_EQ(ukf.repairs(), 0);
  EXPECT_TRUE(ukf.P() == ukf.P().transpose());
  EXPECT_TRUE(ukf.x().allFinite());
}

// W_s enters through the input: with one input on one state as W_s (∂f/∂u)².
TEST(NonlinearKalman, InputNoiseEntersAsTheInputDoes) {
  const Pendulum process;
  auto d = design<3, 1>(0.0, 0.01, 0.3);
  Ekf<Pendulum, 1> with(process, d, 0.5);
  d.Q(1, 1) = 0.5 * 0.01 * 0.01;
  Ekf<Pendulum, 1> same(process, d, 0.0);
  const Eigen::Matrix<double, 1, 1> one(1.0);
  with.predict(one);
  same.predict(one);
  EXPECT_NEAR((with.P() - same.P()).norm(), 0.0, 1e-10);
}

TEST(NonlinearKalman, RefusesNonsense) {
  auto d = design<3, 1>(1e-4, 0.01, 0.3);
  EXPECT_THROW((Ekf<Pendulum, 1>(Pendulum(), d, -1.0)), std::invalid_argument);
  d.R(0, 0) = 0.0;
  EXPECT_THROW((Ukf<Pendulum, 1>(Pendulum(), d)), std::invalid_argument);
  d = design<3, 1>(-1e-4, 0.01, 0.3);
  EXPECT_THROW((Ukf<Pendulum, 1>(Pendulum(), d)), std::invalid_argument);
}

}  // namespace breakwater::nonlinear_kalman_test
