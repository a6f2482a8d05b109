#include <breakwater/linear/eigenvalues.h>
#include <breakwater/linear/pole_placement.h>

#include <cmath>
#include <sstream>

#include <breakwater/linear/state_space.h>
#include "python.h"
#include "support.h"

namespace breakwater::pole_placement_test {
namespace {

using testing::distance;

TEST(PolePlacement, TripleIntegratorHasItsClosedForm) {
  // det(s I − A + H C) of a chain of three integrators is s³ + h1 s² + h2 s + h3.
  Eigen::Matrix3d A;
  A << 0, 1, 0, 0, 0, 1, 0, 0, 0;
  const Eigen::MatrixXd H =
      place_observer_poles(A, Eigen::RowVector3d(1, 0, 0), {{-40.0, -43.0, -46.0}});
  EXPECT_NEAR(H(0), 40 + 43 + 46, 1e-11);
  EXPECT_NEAR(H(1), 40 * 43 + 40 * 46 + 43 * 46, 1e-9);
  EXPECT_NEAR(H(2), 40 * 43 * 46, 1e-8);
}

TEST(PolePlacement, RepeatedPolesHaveTheirClosedForm) {
  Eigen::Matrix3d A;
  A << 0, 1, 0, 0, 0, 1, 0, 0, 0;
  const Eigen::MatrixXd H =
      place_observer_poles(A, Eigen::RowVector3d(1, 0, 0), {{-18.4, -18.4, -18.4}});
  EXPECT_TRUE(H.isApprox(Eigen::Vector3d(3 * 18.4, 3 * 18.4 * 18.4, std::pow(18.4, 3)), 1e-13));
}

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

}  // namespace
}  // namespace breakwater::pole_placement_test
