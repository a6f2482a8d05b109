// A million steps (three hours) of the quadrotor's 24-state filters.
#include "control/quadrotor_endurance.h"

namespace breakwater::quadrotor_endurance_study {

TEST(QuadrotorEndurance, MillionStepsWithoutRepair) {
  testing::all_endure(1'000'000);
}

}  // namespace breakwater::quadrotor_endurance_study
