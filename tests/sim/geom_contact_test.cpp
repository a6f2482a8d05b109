#include <breakwater/sim/contact.h>

#include <breakwater/sim/named_elements.h>
#include "sim/small_models.h"

namespace breakwater {
namespace {

TEST(GeomContact, IsTheWeightOfTheBallThatRests) {
  const Model model = testing::model_of(R"(<mujoco><worldbody>
      <geom name="floor" type="plane" size="1 1 1"/>
      <body pos="0 0 0.1"><joint type="slide" axis="0 0 1" damping="20"/>
        <geom name="light" type="sphere" size="0.1" mass="1"/></body>
      <body pos="0.5 0 0.1"><joint type="slide" axis="0 0 1" damping="20"/>
        <geom name="heavy" type="sphere" size="0.1" mass="3"/><site name="tip"/></body>
      </worldbody></mujoco>)");
  const DataPointer data = model.make_data();
  for (int k = 0; k < 2000; ++k) mj_step(model.get(), data.get());
  const auto force_N = [&](const char* one, const char* other) {
    return GeomContact(model, one, other).force_N(model, *data);
  };
  EXPECT_NEAR(force_N("light", "floor"), 9.81, 1e-3);
  EXPECT_NEAR(force_N("floor", "light"), 9.81, 1e-3);
  EXPECT_NEAR(force_N("heavy", "floor"), 29.43, 1e-3);
  EXPECT_EQ(force_N("heavy", "light"), 0.0);
  EXPECT_EQ(geom_id(model, "heavy"), 2);
  EXPECT_EQ(site_id(model, "tip"), 0);
  EXPECT_TRUE(has_geom(model, "floor"));
  EXPECT_FALSE(has_geom(model, "tip"));
}

}  // namespace
}  // namespace breakwater
