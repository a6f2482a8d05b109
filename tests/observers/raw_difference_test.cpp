#include <breakwater/observers/raw_difference.h>

#include <stdexcept>

#include "support.h"

namespace breakwater {
namespace {

// Two positions, two velocities; the outputs are the positions in the other order.
StateSpace two_axes() {
  StateSpace plant;
  plant.A = Eigen::Matrix4d::Identity();
  plant.B = Eigen::MatrixXd::Zero(4, 2);
  plant.C = Eigen::MatrixXd::Zero(2, 4);
  plant.C(0, 1) = plant.C(1, 0) = 1.0;
  return plant;
}

TEST(RawDifference, DividesTheDifferenceByThePeriod) {
  RawDifference filter(two_axes(), 0.5);
  const Eigen::Vector2d u = Eigen::Vector2d::Zero();
  filter.reset(Eigen::Vector4d::Zero());
  filter.update(u, Eigen::Vector2d(1.0, 2.0));
  EXPECT_EQ(filter.state(), Eigen::Vector4d(2.0, 1.0, 0.0, 0.0));
  filter.update(u, Eigen::Vector2d(4.0, 2.5));
  EXPECT_EQ(filter.state(), Eigen::Vector4d(2.5, 4.0, 1.0, 6.0));
}

TEST(RawDifference, RefusesAPlantThatDoesNotMeasureEachPosition) {
  StateSpace one_output = two_axes(), scaled = two_axes();
  one_output.C = one_output.C.topRows(1).eval();
  scaled.C *= 2.0;
  EXPECT_THROW(RawDifference(one_output, 0.5), std::invalid_argument);
  EXPECT_THROW(RawDifference(scaled, 0.5), std::invalid_argument);
}

}  // namespace
}  // namespace breakwater
