// Sampled plants, observability, pseudo-inverses and placed poles, by closed forms.
#include <Eigen/SVD>

#include <breakwater/linear/eigenvalues.h>
#include <breakwater/linear/high_pass.h>
#include <breakwater/linear/pole_placement.h>
#include <breakwater/linear/pseudo_inverse.h>
#include <breakwater/linear/state_space.h>
#include "python.h"
#include "support.h"

namespace breakwater::state_space_test {

TEST(ZeroOrderHold, DoubleIntegratorHasItsClosedForm) {
  const double T = 1e-3;
  const StateSpace plant{(Eigen::Matrix2d() << 0, 1, 0, 0).finished(), Eigen::Vector2d(0, 1 / 0.8),
                         Eigen::RowVector2d(1, 0)};
  const StateSpace sampled = zero_order_hold(plant, T);
  EXPECT_TRUE(sampled.A.isApprox((Eigen::Matrix2d() << 1, T, 0, 1).finished(), 1e-15));
  EXPECT_TRUE(sampled.B.isApprox(Eigen::Vector2d(T * T / 1.6, T / 0.8), 1e-14));
  EXPECT_EQ(sampled.C, plant.C);
}

TEST(ZeroOrderHold, TwoHalfStepsAreOneStep) {
  testing::Random random;
  for (int trial = 0; trial < 20; ++trial) {
    const StateSpace plant{random.matrix(4, 4), random.matrix(4, 2), random.matrix(1, 4)};
    const StateSpace half = zero_order_hold(plant, 0.05);
    const StateSpace whole = zero_order_hold(plant, 0.1);
    EXPECT_TRUE((half.A * half.A).isApprox(whole.A, 1e-13));
    EXPECT_TRUE((half.A * half.B + half.B).isApprox(whole.B, 1e-13));
  }
}

TEST(ZeroOrderHold, RefusesNonsense) {
  const StateSpace plant{Eigen::Matrix2d::Identity(), Eigen::Vector2d(0, 1),
                         Eigen::RowVector2d(1, 0)};
  EXPECT_REFUSED(zero_order_hold(plant, 0.0));
  EXPECT_REFUSED(zero_order_hold(plant, std::nan("")));
  StateSpace misshapen = plant;
  misshapen.B = Eigen::Vector3d(0, 0, 1);
  EXPECT_REFUSED(zero_order_hold(misshapen, 0.1));
  for (Eigen::MatrixXd StateSpace::*part : {&StateSpace::A, &StateSpace::B, &StateSpace::C}) {
    StateSpace infinite = plant;
    (infinite.*part)(0, 0) = INFINITY;
    EXPECT_EQ(complaint_of([&] { zero_order_hold(infinite, 0.1); }),
              "state space: A, B and C must be finite");
  }
}

TEST(ExtendByInputDisturbance, PutsMinusBBesideA) {
  testing::Random random;
  const StateSpace plant{random.matrix(3, 3), random.matrix(3, 2), random.matrix(1, 3)};
  const StateSpace extended = extend_by_input_disturbance(plant);
  // A disturbance equal to the input cancels it: x moves as if u were 0.
  const Eigen::VectorXd x = random.vector(3);
  const Eigen::VectorXd u = random.vector(2);
  Eigen::VectorXd extended_x(5);
  extended_x << x, u;
  const Eigen::VectorXd rate = extended.A * extended_x + extended.B * u;
  EXPECT_TRUE(rate.head(3).isApprox(plant.A * x, 1e-14));
  EXPECT_TRUE(rate.tail(2).isZero());
  EXPECT_TRUE((extended.C * extended_x).isApprox(plant.C * x, 1e-15));
}

double gain_at(double frequency_Hz, double cutoff_Hz, double period_s) {
  HighPass filter(cutoff_Hz, period_s);
  double largest = 0.0;
  for (int k = 0; k < 20000; ++k) {
    const double y = filter.update(std::sin(2 * M_PI * frequency_Hz * k * period_s));
    if (k > 10000) largest = std::max(largest, std::abs(y));
  }
  return largest;
}

TEST(HighPass, HasButterworthsGain) {
  // |H| = 1/√(1 + (w_c/w)⁴), in the bilinear transform's warped frequencies w = tan(π f T).
  const double T = 1e-3, cutoff = 150.0;
  for (const double f : {10.1, 40.3, 150.0, 301.7}) {
    const double ratio = std::tan(M_PI * cutoff * T) / std::tan(M_PI * f * T);
    EXPECT_NEAR(gain_at(f, cutoff, T), 1.0 / std::sqrt(1.0 + std::pow(ratio, 4)), 2e-3) << f;
  }
}

TEST(HighPass, RemovesAConstant) {
  HighPass filter(150.0, 1e-3);
  double y = 0.0;
  for (int k = 0; k < 1000; ++k) y = filter.update(7.0);
  EXPECT_NEAR(y, 0.0, 1e-12);
}

TEST(HighPass, RefusesNonsense) {
  EXPECT_REFUSED(HighPass(500.0, 1e-3));
  EXPECT_REFUSED(HighPass(0.0, 1e-3));
  EXPECT_REFUSED(HighPass(10.0, 0.0));
  EXPECT_REFUSED(HighPass(std::nan(""), 1e-3));
}

// Eq. 2.14: U_o = [1 0 0; 0 1 0; 0 −c/J −1/J] is regular unless the input has no effect.
TEST(Observability, ForTheMotorMatchesEq214) {
  Eigen::Matrix3d A;
  A << 0, 1, 0, 0, -0.3, -2.0, 0, 0, 0;
  EXPECT_EQ(observability_rank(A, Eigen::RowVector3d(1, 0, 0)), 3);
  A(1, 2) = 0.0;
  EXPECT_EQ(observability_rank(A, Eigen::RowVector3d(1, 0, 0)), 2);
}

TEST(Observability, RankDoesNotDependOnUnitsOrPeriod) {
  // The extended motor with decreasing sampling periods and units of the disturbance.
  for (const double period_s : {1e-1, 1e-3, 1e-5}) {
    for (const double J : {1e-6, 1.0, 1e6}) {
      const StateSpace motor{(Eigen::Matrix2d() << 0, 1, 0, 0).finished(),
                             Eigen::Vector2d(0, 1 / J), Eigen::RowVector2d(1, 0)};
      const StateSpace extended = zero_order_hold(extend_by_input_disturbance(motor), period_s);
      EXPECT_EQ(observability_rank(extended.A, extended.C), 3) << period_s << " " << J;
    }
  }
}

TEST(Observability, CountsUnobservableStates) {
  // Two separate oscillators. Only the first one is measured.
  Eigen::Matrix4d A = Eigen::Matrix4d::Zero();
  A.topLeftCorner<2, 2>() << 0, 1, -4, 0;
  A.bottomRightCorner<2, 2>() << 0, 1, -9, 0;
  EXPECT_EQ(observability_rank(A, Eigen::RowVector4d(1, 0, 0, 0)), 2);
  EXPECT_EQ(observability_rank(A, Eigen::RowVector4d(1, 0, 1, 0)), 4);
  EXPECT_EQ(observability_rank(A, Eigen::RowVector4d::Zero()), 0);
  // Velocity alone does not determine the position.
  EXPECT_EQ(
      observability_rank((Eigen::Matrix2d() << 0, 1, 0, 0).finished(), Eigen::RowVector2d(0, 1)),
      1);
}

using Jacobian = Eigen::Matrix<double, 3, Eigen::Dynamic>;
using Inverse = Eigen::Matrix<double, Eigen::Dynamic, 3>;

// A second implementation with Eigen's SVD and the same truncation.
Inverse by_svd(const Jacobian& J, double tolerance) {
  const Eigen::JacobiSVD<Eigen::MatrixXd> svd(J, Eigen::ComputeThinU | Eigen::ComputeThinV);
  Eigen::VectorXd inverse = svd.singularValues();
  for (double& s : inverse) s = s > tolerance ? 1.0 / s : 0.0;
  return svd.matrixV() * inverse.asDiagonal() * svd.matrixU().transpose();
}

TEST(PseudoInverse, AgreesWithTheSvd) {
  testing::Random random;
  for (int trial = 0; trial < 200; ++trial) {
    const Eigen::Index n = 3 + trial % 4;
    const Jacobian J = random.matrix(3, n);
    Inverse J_plus(n, 3);
    pseudo_inverse(J, 0.02, J_plus);
    EXPECT_TRUE(J_plus.isApprox(by_svd(J, 0.02), 1e-10)) << trial;
  }
}

TEST(PseudoInverse, DropsSmallSingularValues) {
  Jacobian J = Jacobian::Zero(3, 3);
  J(0, 0) = 1.0;
  J(1, 1) = 0.0199;
  J(2, 2) = 0.0201;
  Inverse P(3, 3);
  pseudo_inverse(J, 0.02, P);
  EXPECT_NEAR(P(0, 0), 1.0, 1e-14);
  EXPECT_NEAR(P(1, 1), 0.0, 1e-14);
  EXPECT_NEAR(P(2, 2), 1.0 / 0.0201, 1e-9);
  // With damping a small singular value counts as σ/tolerance².
  damped_pseudo_inverse(J, 0.02, P);
  EXPECT_NEAR(P(0, 0), 1.0, 1e-14);
  EXPECT_NEAR(P(1, 1), 0.0199 / 4e-4, 1e-9);
  EXPECT_NEAR(P(2, 2), 1.0 / 0.0201, 1e-9);
}

using testing::distance;

TEST(PolePlacement, PlacesRandomMultiOutputPlants) {
  testing::Random random;
  for (int trial = 0; trial < 50; ++trial) {
    const Eigen::MatrixXd A = random.matrix(6, 6);
    const Eigen::MatrixXd C = random.matrix(2, 6);
    const std::vector<PoleGroup> groups = {{-2.0, {-3.0, 1.5}, {-3.0, -1.5}}, {-2.5, -3.5, -5.0}};
    const Eigen::MatrixXd H = place_observer_poles(A, C, groups);
    PoleGroup all = groups[0];
    all.insert(all.end(), groups[1].begin(), groups[1].end());
    EXPECT_LT(distance(eigenvalues(A - H * C), all), 1e-6);
  }
}

TEST(PolePlacement, KeepsDecoupledChainsDecoupled) {
  // Two double integrators with different gains: each output corrects its own chain only.
  Eigen::Matrix4d A = Eigen::Matrix4d::Zero();
  A(0, 2) = 1.0;
  A(1, 3) = 5.0;
  Eigen::MatrixXd C = Eigen::MatrixXd::Zero(2, 4);
  C(0, 0) = C(1, 1) = 1.0;
  const Eigen::MatrixXd H = place_observer_poles(A, C, {{-1.0, -2.0}, {-3.0, -4.0}});
  Eigen::MatrixXd expected(4, 2);
  expected << 3, 0, 0, 7, 2, 0, 0, 12.0 / 5.0;
  EXPECT_TRUE(H.isApprox(expected, 1e-14));
}

// A pole of one group may be an eigenvalue of its own chain, of another one, or of both.
TEST(PolePlacement, APoleMayBeAnEigenvalueOfThePlant) {
  const Eigen::Matrix2d A = (Eigen::Matrix2d() << 0, 1, 0, -3).finished();
  const Eigen::RowVector2d C(1, 0);
  // s² + (3 + h1) s + (3 h1 + h2) = (s + 3)(s + 5).
  EXPECT_TRUE(
      place_observer_poles(A, C, {{-3.0, -5.0}}).isApprox(Eigen::Vector2d(5.0, 0.0), 1e-14));
  Eigen::MatrixXd both = Eigen::MatrixXd::Zero(4, 4), outputs = Eigen::MatrixXd::Zero(2, 4);
  both.topLeftCorner(2, 2) = both.bottomRightCorner(2, 2) = A;
  outputs(0, 0) = outputs(1, 2) = 1.0;
  const Eigen::MatrixXd H = place_observer_poles(both, outputs, {{-3.0, -5.0}, {-1.0, -2.0}});
  Eigen::MatrixXd expected = Eigen::MatrixXd::Zero(4, 2);
  expected.col(0).head(2) << 5.0, 0.0;
  expected.col(1).tail(2) << 0.0, 2.0;
  EXPECT_LT((H - expected).cwiseAbs().maxCoeff(), 1e-12) << H;
}

// Poles of the plant, deadbeat poles of a singular plant, poles 1e-7 apart and units of 1e-8 to
// 1e8, against Ackermann's formula with 60 digits.
TEST(PolePlacementProperty, AgreesWithAckermannInHighPrecision) {
  const int count = testing::property_count(300);
  testing::Random random(5);
  struct Problem {
    Eigen::MatrixXd A, C;
    PoleGroup poles;
    Eigen::VectorXd unit;
  };
  std::vector<Problem> problems;
  std::ostringstream input;
  input.precision(17);
  for (int k = 0; k < count; ++k) {
    const Eigen::Index n = 1 + k % 6;
    const int kind = k / 6 % 5;
    Problem p{random.matrix(n, n), random.matrix(1, n), {}, Eigen::VectorXd::Ones(n)};
    if (kind == 1) p.A.col(0).setZero();
    if (kind == 2) p.A = p.A.triangularView<Eigen::Upper>().toDenseMatrix();
    const double time = std::exp2(std::round(random.uniform(-27.0, 27.0)));
    const bool has_units = random.uniform(0.0, 1.0) < 0.5;
    const double close = random.uniform(-1.0, 1.0);
    for (Eigen::Index i = 0; i < n; ++i) {
      const double real = random.uniform(-1.0, 1.0);
      p.poles.emplace_back(kind == 1   ? 0.0
                           : kind == 2 ? p.A(i, i)
                           : kind == 3 ? close + 1e-7 * static_cast<double>(i)
                                       : real);
      if (has_units) p.unit(i) = std::exp2(std::round(random.uniform(-27.0, 27.0)));
    }
    if (kind == 4 && n > 1) p.poles[1] = std::conj(p.poles[0] = {close, 0.5});
    if (has_units) {
      p.A = time * p.unit.asDiagonal() * p.A * p.unit.cwiseInverse().asDiagonal();
      p.C = p.C * p.unit.cwiseInverse().asDiagonal();
      for (std::complex<double>& pole : p.poles) pole *= time;
      p.unit *= time;
    }
    input << n << '\n' << p.A << '\n' << p.C << '\n';
    for (const std::complex<double>& pole : p.poles) {
      input << pole.real() << ' ' << pole.imag() << '\n';
    }
    problems.push_back(p);
  }
  const std::vector<double> theirs = testing::run_python("linear/ackermann.py", input.str());
  std::size_t at = 0;
  double largest = 0.0;
  for (const Problem& p : problems) {
    const Eigen::VectorXd ours = place_observer_poles(p.A, p.C, {p.poles});
    const Eigen::Map<const Eigen::VectorXd> h(theirs.data() + at, ours.size());
    at += p.poles.size();
    ASSERT_LE(at, theirs.size());
    const double size = h.cwiseQuotient(p.unit).norm();
    const double error = (ours - h).cwiseQuotient(p.unit).norm();
    ASSERT_LE(error, 1e-8 * size + 1e-12) << p.A << "\n" << p.C;
    largest = std::max(largest, error / (size + 1e-4));
  }
  std::printf("%d placements, largest relative error %.1e\n", count, largest);
}

TEST(PolePlacement, SamplesPoles) {
  const auto sampled = sample_poles({{-40.0, {-3.0, 2.0}}}, 0.01);
  EXPECT_EQ(sampled[0][0], std::exp(-0.4));
  EXPECT_LT(std::abs(sampled[0][1] -
                     std::exp(-0.03) * std::complex<double>(std::cos(0.02), std::sin(0.02))),
            1e-15);
}

TEST(PolePlacement, RefusesImpossiblePoles) {
  const Eigen::MatrixXd one = Eigen::MatrixXd::Ones(1, 1);
  const Eigen::Matrix2d A = (Eigen::Matrix2d() << 0, 1, 0, 0).finished();
  const Eigen::RowVector2d C(1, 0);
  EXPECT_THROW(place_observer_poles(A, C, {{-1.0}}), std::invalid_argument);          // too few
  EXPECT_THROW(place_observer_poles(A, C, {{-1.0}, {-2.0}}), std::invalid_argument);  // groups
  EXPECT_THROW(place_observer_poles(A, C, {{{-1.0, 1.0}, -2.0}}), std::invalid_argument);  // pair
  EXPECT_THROW(place_observer_poles(A, C, {{std::nan(""), -2.0}}), std::invalid_argument);
  EXPECT_EQ(complaint_of([&] {
              place_observer_poles(A, C, {{{-1.0, INFINITY}, {-1.0, -INFINITY}}});
            }),
            "pole placement: a pole is not finite");
  EXPECT_THROW(place_observer_poles(A, Eigen::RowVector2d(0, 1), {{-1.0, -2.0}}),
               std::invalid_argument);  // not observable
  EXPECT_THROW(place_observer_poles(one, 1e-309 * one, {{-1.0}}), std::invalid_argument)
      << "the gain overflows";
}

}  // namespace breakwater::state_space_test
