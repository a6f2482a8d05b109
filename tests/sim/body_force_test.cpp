#include <breakwater/sim/held_force.h>

#include <stdexcept>

#include "sim/small_models.h"

namespace breakwater {
namespace {

TEST(BodyForce, AddsAForceAlongItsDirectionWithoutATorque) {
  const Model model = testing::model_of(R"(<mujoco><worldbody><body name="a"><freejoint/>
      <geom size="0.1"/></body><body name="b"><freejoint/><geom size="0.1"/></body></worldbody>
      </mujoco>)");
  BodyForce force(model, "b", {0.0, 3.0, 4.0});
  force.hold(2.0);
  const DataPointer data = model.make_data();
  force.apply(0.0, *model.get(), *data);
  force.apply(0.0, *model.get(), *data);
  const double expected[] = {0.0, 2.4, 3.2, 0.0, 0.0, 0.0};
  for (int i = 0; i < 6; ++i) {
    EXPECT_EQ(data->xfrc_applied[6 + i], 0.0) << "another body, " << i;
    EXPECT_NEAR(data->xfrc_applied[12 + i], expected[i], 1e-15) << i;
  }
  EXPECT_THROW(BodyForce(model, "b", Eigen::Vector3d::Zero()), std::invalid_argument);
  EXPECT_THROW(BodyForce(model, "c", {1.0, 0.0, 0.0}), std::invalid_argument);
}

}  // namespace
}  // namespace breakwater
