// The push experiment: the arm's recovery from a forced displacement.

#include <cmath>

#include "regression/run_case.h"

namespace breakwater {
namespace {

using testing::completed_run;
using testing::run_case;

TEST(Push, ProposedRecovers) {
  for (const char* name : {"proposed-link1", "proposed-link2", "proposed-link3"}) {
    for (const char* angle :
         {"push.angle_rad=1.5707963267948966", "push.angle_rad=-1.5707963267948966"}) {
      const Recording run = completed_run("arm_push", name, {angle});
      EXPECT_LT(*run.metric("settling_time_s"), 3.0) << name << angle;
      EXPECT_LE(*run.metric("reversal_count"), 2.0) << name << angle;
      EXPECT_LT(*run.metric("tip_error_m"), 0.01) << name << angle;
      // The joints may reach another posture. The tip hardly passes its start.
      EXPECT_LT(*run.metric("x_overshoot_m"), 1e-3) << name << angle;
      EXPECT_LT(*run.metric("y_overshoot_m"), 0.01) << name << angle;
      EXPECT_LT(*run.metric("posture_overshoot_rad"), 0.08) << name << angle;
    }
  }
}

TEST(Push, ProposedWithJointPositioningRecoversWithoutOvershoot) {
  for (const char* name : {"proposed-link1", "proposed-link2", "proposed-link3"}) {
    for (const char* angle :
         {"push.angle_rad=1.5707963267948966", "push.angle_rad=-1.5707963267948966"}) {
      const Recording run =
          completed_run("arm_push", name, {angle, "controller.positioning=joint"});
      EXPECT_NEAR(*run.metric("max_push_rad"), M_PI / 2, 0.02) << name << angle;
      EXPECT_LE(*run.metric("overshoot_rad"), 0.05) << name << angle;
      EXPECT_LT(*run.metric("settling_time_s"), 2.0) << name << angle;
      EXPECT_GT(*run.metric("saturated_time_s"), 1.0) << name << angle;
      EXPECT_LT(*run.metric("tip_error_m"), 0.01) << name << angle;
    }
  }
}

// The input of the observer matters, not the method. With the applied torque the conventional
// controllers recover; with the commanded torque they become unstable.
TEST(Push, ConventionalControllersNeedTheClippedFeed) {
  for (const char* name :
       {"hpfc-link1", "hpfc-link2", "hpfc-link3", "drac-link1", "drac-link2", "drac-link3"}) {
    const Recording unclipped = run_case("arm_push", name);
    const bool came_back = !unclipped.failure && unclipped.metric("settling_time_s").has_value();
    EXPECT_FALSE(came_back) << name;
    const Recording clipped = completed_run("arm_push", name, {"observer.feed=clipped"});
    ASSERT_TRUE(clipped.metric("settling_time_s")) << name;
    EXPECT_LT(*clipped.metric("settling_time_s"), 4.0) << name;
  }
}

// The proposed method is stable with the unclipped input too: PFC never exceeds the limit, so
// clipping has no effect.
TEST(Push, FeedDoesNotAffectTheProposedMethod) {
  const Recording clipped = run_case("arm_push", "proposed-link2");
  const Recording unclipped = run_case("arm_push", "proposed-link2", {"observer.feed=unclipped"});
  EXPECT_NEAR(*unclipped.metric("overshoot_rad"), *clipped.metric("overshoot_rad"), 1e-6);
  EXPECT_NEAR(*unclipped.metric("settling_time_s"), *clipped.metric("settling_time_s"), 1e-2);
}

TEST(Push, NoPushNoMotion) {
  const Recording run = run_case("arm_push", "proposed-link1", {"push.angle_rad=0"});
  EXPECT_LT(*run.metric("max_push_rad"), 1e-3);
  EXPECT_LT(*run.metric("tip_error_m"), 1e-3);
}

}  // namespace
}  // namespace breakwater
