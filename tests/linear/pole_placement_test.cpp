#include <breakwater/linear/pole_placement.h>

#include <cmath>

#include <breakwater/linear/state_space.h>
#include "support.h"

namespace breakwater {
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
  EXPECT_THROW(place_observer_poles(A, C, {{0.0, -2.0}}), std::invalid_argument);  // a pole of A
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
}  // namespace breakwater
