// What pictures of a model show of it.
#pragma once

#include <mujoco/mujoco.h>

namespace breakwater {

/// Geoms of groups below this are drawn: bodies, and what is for the eye alone. What is only for
/// the physics is in the others.
inline constexpr int kDrawnGroups = 3;

/// Where bodies, cameras, lights and tendons are at data.qpos. Positions only: forces are the log's
/// business.
inline void place_scene(const mjModel& model, mjData& data) {
  mj_kinematics(&model, &data);
  mj_comPos(&model, &data);
  mj_camlight(&model, &data);
  mj_tendon(&model, &data);
}

}  // namespace breakwater
