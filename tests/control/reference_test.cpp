#include <breakwater/control/reference.h>

#include <cmath>

#include "support.h"

namespace breakwater {
namespace {

TEST(Reference, HasItsShapes) {
  Reference r{.value = 2.0,
              .from_s = 1.0,
              .reversed_from_s = 3.0,
              .before = 0.5,
              .frequency_rad_s = 4.0,
              .table = {.times_s = {0.0, 1.0}, .values = {1.0, 3.0}}};
  const auto expect = [&](ReferenceShape kind, std::initializer_list<double> values) {
    r.kind = kind;
    double time_s = 0.0;
    for (const double value : values) {
      EXPECT_DOUBLE_EQ(r.at(time_s), value) << time_s;
      time_s += 0.5;
    }
  };
  expect(ReferenceShape::hold, {0.5, 0.5, 0.5, 0.5});
  expect(ReferenceShape::step, {0.5, 0.5, 2.0, 2.0, 2.0, 2.0, -2.0});
  expect(ReferenceShape::sine, {0.5, 0.5, 0.5, 0.5 + 2.0 * std::sin(2.0)});
  expect(ReferenceShape::csv, {0.5, 0.5, 1.0, 2.0, 3.0, 3.0});
}

}  // namespace
}  // namespace breakwater
