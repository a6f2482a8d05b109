// The Riccati equation against closed forms, its residual and SciPy.
#include <Eigen/Cholesky>
#include <Eigen/LU>

#include <breakwater/linear/eigenvalues.h>
#include <breakwater/linear/riccati.h>
#include <breakwater/linear/state_space.h>
#include "linear/scipy_riccati.h"

namespace breakwater::riccati_test {

using testing::Random;

const Eigen::MatrixXd kOne = Eigen::MatrixXd::Ones(1, 1);

TEST(Riccati, ScalarClosedForm) {
  // P² b² = (a² − 1) r P + q b² P + q r ... solved for a = 1: P = (q + √(q² + 4 q r))/2.
  for (const double q : {1e-3, 1.0, 50.0}) {
    const Eigen::MatrixXd P = solve_dare(kOne, kOne, q * kOne, 2.0 * kOne);
    EXPECT_NEAR(P(0, 0), 0.5 * (q + std::sqrt(q * q + 8.0 * q)), 1e-12 * (1.0 + q));
  }
}

TEST(Riccati, StableAndFreeCostsNothing) {
  const Eigen::MatrixXd P = solve_dare(0.5 * kOne, kOne, 0.0 * kOne, kOne);
  EXPECT_EQ(P(0, 0), 0.0);
}

// A = a, B = 1, Q = 0, R = r: P = (a² − 1) r stabilises, P = 0 is cheaper.
TEST(Riccati, StabilisesUnweightedStates) {
  for (const double a : {1.01, 2.0, -30.0}) {
    const LqrDesign design = dlqr(a * kOne, kOne, 0.0 * kOne, 0.5 * kOne);
    EXPECT_NEAR(design.P(0, 0), 0.5 * (a * a - 1.0), 1e-10 * a * a) << a;
    EXPECT_NEAR(a - design.K(0, 0), 1.0 / a, 1e-10) << "the pole is mirrored at the unit circle";
  }
  // One unstable state has no weight, the others have one.
  Random random(4);
  for (int k = 0; k < 50; ++k) {
    const Eigen::Index n = 2 + k % 4;
    Eigen::MatrixXd A = random.matrix(n, n);
    A.leftCols(1) = 1.5 * Eigen::VectorXd::Unit(n, 0);
    Eigen::MatrixXd Q = Eigen::MatrixXd::Identity(n, n);
    Q(0, 0) = 0.0;
    // C = [0 I] measures x_2 … x_n, which do not depend on x_1.
    const Eigen::MatrixXd B = random.matrix(n, 1) + Eigen::MatrixXd::Ones(n, 1);
    const LqrDesign design = dlqr(A, B, Q, kOne);
    EXPECT_LT(spectral_radius(A - B * design.K), 1.0) << k;
  }
  EXPECT_REFUSED(solve_dare(kOne, kOne, 0.0 * kOne, kOne))
      << "a mode on the unit circle that Q does not see";
  const Eigen::MatrixXd A = Eigen::Vector2d(1.0, 2.0).asDiagonal();
  const Eigen::MatrixXd B = Eigen::MatrixXd::Identity(2, 2);
  const Eigen::MatrixXd Q = Eigen::Vector2d(0.0, 1.0).asDiagonal();
  EXPECT_REFUSED(solve_dare(A, B, Q, B)) << "the same beside another mode";
}

double relative_residual(const Eigen::MatrixXd& A, const Eigen::MatrixXd& B,
                         const Eigen::MatrixXd& Q, const Eigen::MatrixXd& R,
                         const Eigen::MatrixXd& P) {
  const Eigen::MatrixXd PBtA = B.transpose() * P * A;
  const Eigen::MatrixXd S = R + B.transpose() * P * B;
  return (A.transpose() * P * A - PBtA.transpose() * S.llt().solve(PBtA) + Q - P).norm() / P.norm();
}

TEST(Riccati, ResidualAndStabilityOfRandomPlants) {
  Random random;
  for (int k = 0; k < 200; ++k) {
    const Eigen::Index n = 1 + k % 6;
    const Eigen::Index m = 1 + k % 2;
    const Eigen::MatrixXd A = 1.5 * random.matrix(n, n);
    const Eigen::MatrixXd B = random.matrix(n, m);
    const Eigen::MatrixXd root = random.matrix(n, n);
    const Eigen::MatrixXd Q = root * root.transpose();
    const Eigen::MatrixXd R = (0.1 + k % 3) * Eigen::MatrixXd::Identity(m, m);
    const LqrDesign design = dlqr(A, B, Q, R);
    EXPECT_LT(relative_residual(A, B, Q, R, design.P), 1e-10) << k;
    EXPECT_LT(spectral_radius(A - B * design.K), 1.0) << k;
    EXPECT_LT((design.P - design.P.transpose()).norm(), 1e-12 * design.P.norm()) << k;
  }
}

// P predicts the summed cost of the closed loop.
TEST(Riccati, PredictsTheCost) {
  const StateSpace cart =
      zero_order_hold({(Eigen::Matrix2d() << 0.0, 1.0, 0.0, -0.78 / 0.625).finished(),
                       Eigen::Vector2d(0.0, 1.0 / 0.625), Eigen::RowVector2d(1.0, 0.0)},
                      0.01);
  const LqrDesign design = dlqr(cart.A, cart.B, Eigen::Matrix2d::Identity(), kOne);
  Eigen::VectorXd x = Eigen::Vector2d(0.1, 0.1);
  const double predicted = x.dot(design.P * x);
  double cost = 0.0;
  for (int k = 0; k < 5000; ++k) {
    const Eigen::VectorXd u = -design.K * x;
    cost += x.squaredNorm() + u.squaredNorm();
    x = cart.A * x + cart.B * u;
  }
  EXPECT_NEAR(cost, predicted, 1e-10 * predicted);
}

// Plants in one unit and in mixed ones. SciPy solves them in one unit: it is exact only relative to
// the largest entry.
TEST(RiccatiProperty, AgreesWithScipyInAnyUnits) {
  const int count = testing::property_count(300);
  Random random(3);
  std::vector<testing::RiccatiProblem> problems;
  for (int k = 0; k < count; ++k) {
    const Eigen::Index n = 1 + k % 6;
    const Eigen::Index m = 1 + k % 2;
    const Eigen::MatrixXd root = random.matrix(n, 1 + k % n);
    problems.push_back({1.5 * random.matrix(n, n), random.matrix(n, m), root * root.transpose(),
                        random.uniform(0.01, 10.0) * Eigen::MatrixXd::Identity(m, m)});
  }
  problems.push_back({2.0 * kOne, kOne, 0.0 * kOne, kOne});  // no weight: P = 3
  const std::vector<testing::RiccatiSolution> theirs = testing::solve_with_scipy(problems);
  const auto units = [&random](Eigen::Index size) {
    Eigen::VectorXd unit(size);
    for (double& one : unit) one = std::exp2(std::round(random.uniform(-27.0, 27.0)));
    return unit;
  };
  double largest = 0.0;
  for (std::size_t k = 0; k < problems.size(); ++k) {
    const auto& [A, B, Q, R] = problems[k];
    const Eigen::VectorXd x = units(A.rows()), u = units(B.cols());
    const double cost = units(1)(0);
    const auto to_x = x.asDiagonal();
    const auto from_x = x.cwiseInverse().asDiagonal();
    const LqrDesign mixed =
        dlqr(from_x * A * to_x, from_x * B * u.asDiagonal(), cost * to_x * Q * to_x,
             cost * u.asDiagonal() * R * u.asDiagonal());
    for (const LqrDesign& ours : {dlqr(A, B, Q, R), LqrDesign{u.asDiagonal() * mixed.K * from_x,
                                                              from_x * mixed.P * from_x / cost}}) {
      EXPECT_LT(spectral_radius(A - B * ours.K), 1.0 - 1e-9) << k;
      const Eigen::VectorXd root = theirs[k].P.diagonal().cwiseSqrt();
      const Eigen::MatrixXd scaled =
          root.cwiseInverse().asDiagonal() * theirs[k].P * root.cwiseInverse().asDiagonal();
      // SciPy's own error grows with the condition.
      const double tolerance = 1e-13 * scaled.norm() * scaled.inverse().norm() + 1e-9;
      const double error = (ours.K - theirs[k].K).norm() / (1.0 + theirs[k].K.norm());
      EXPECT_LT(error, tolerance) << k;
      largest = std::max(largest, error / tolerance);
    }
  }
  std::printf("%d plants, largest error of K %.1e of the tolerance\n", count, largest);
}

// Parts with unlike costs do not disturb each other: P = (a² − 1) r + q + … of each part alone.
TEST(Riccati, DecoupledPartsAreEachExact) {
  const Eigen::MatrixXd eye = Eigen::MatrixXd::Identity(2, 2);
  const Eigen::MatrixXd A = Eigen::Vector2d(0.5, 0.999).asDiagonal();
  const LqrDesign both = dlqr(A, eye, Eigen::Vector2d(1e12, 1e-3).asDiagonal(), eye);
  for (const auto& [i, q] : {std::pair(0, 1e12), std::pair(1, 1e-3)}) {
    const double a = A(i, i);
    // P² + (1 − a² − q) P − q = 0.
    const double b = 1.0 - a * a - q;
    const double P = 0.5 * (std::sqrt(b * b + 4.0 * q) - b);
    EXPECT_NEAR(both.P(i, i), P, 1e-10 * P);
    EXPECT_NEAR(both.K(i, i), a * P / (1.0 + P), 1e-10);
  }
}

TEST(Riccati, NamesTheModeWithoutASolution) {
  struct Case {
    Eigen::MatrixXd A, B, Q;
    std::string complaint;
  };
  const Eigen::MatrixXd eye = Eigen::MatrixXd::Identity(2, 2);
  const Eigen::MatrixXd turn = (Eigen::Matrix2d() << 0.6, -0.8, 0.8, 0.6).finished();
  for (const Case& c : {Case{Eigen::Vector2d(0.5, 1.0).asDiagonal(), Eigen::Vector2d(1.0, 1.0),
                             Eigen::Vector2d(1.0, 0.0).asDiagonal(),
                             "Q has no effect on the mode with the eigenvalue 1 of A"},
                        Case{turn, Eigen::Vector2d(1.0, 0.0), 0.0 * eye,
                             "Q has no effect on the mode with the eigenvalue 0.6 ± 0.8i of A"},
                        Case{2.0 * eye, Eigen::Vector2d(1.0, 1.0), eye,
                             "the input has no effect on the mode with the eigenvalue 2 of A"},
                        Case{2.0 * eye, Eigen::Vector2d::Zero(), eye,
                             "the input has no effect on the mode with the eigenvalue 2 of A"},
                        Case{kOne, kOne, 1e-19 * kOne,
                             "Q has too little effect on the mode with the eigenvalue 1 of A"}}) {
    EXPECT_EQ(complaint_of([&] { solve_dare(c.A, c.B, c.Q, kOne); }),
              "Riccati: there is no stabilising solution: " + c.complaint);
  }
  EXPECT_EQ(complaint_of([] { solve_dare(2.0 * kOne, 1e-154 * kOne, kOne, kOne); }),
            "Riccati: the solution is too large");
}

TEST(Riccati, RefusesNonsense) {
  const Eigen::MatrixXd two = Eigen::MatrixXd::Identity(2, 2);
  EXPECT_REFUSED(solve_dare(kOne, kOne, kOne, -kOne));
  EXPECT_REFUSED(solve_dare(kOne, kOne, kOne, 0.0 * kOne));
  EXPECT_REFUSED(solve_dare(kOne, kOne, -kOne, kOne));
  EXPECT_REFUSED(solve_dare(two, kOne, two, kOne));
  EXPECT_REFUSED(solve_dare(two, two, Eigen::Vector2d(1e12, -1e-3).asDiagonal(), two))
      << "a negative entry that is small beside another one";
  EXPECT_REFUSED(solve_dare(NAN * kOne, kOne, kOne, kOne));
  EXPECT_REFUSED(solve_dare(2.0 * kOne, 0.0 * kOne, kOne, kOne)) << "not stabilisable";
  EXPECT_REFUSED(solve_dare(kOne, 0.0 * kOne, kOne, kOne)) << "a disturbance that nothing controls";
  EXPECT_REFUSED(solve_dare(two, two, two, Eigen::MatrixXd::Constant(2, 2, 5.6953125)))
      << "a singular R, although rounding gives it a Cholesky factor";
  Eigen::MatrixXd skew = two;
  skew(0, 1) = 0.5;
  EXPECT_REFUSED(solve_dare(two, two, skew, two));
}

}  // namespace breakwater::riccati_test
