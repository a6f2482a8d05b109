// The visible parts of a model, and their poses.
#pragma once

#include <mujoco/mujoco.h>

namespace breakwater {

/// Geoms of groups below this are drawn: bodies and decoration. The others are for the physics.
inline constexpr int kDrawnGroups = 3;

/// Computes the poses of bodies, cameras, lights and tendons at data.qpos. Forces are in the log.
inline void place_scene(const mjModel& model, mjData& data) {
  mj_kinematics(&model, &data);
  mj_comPos(&model, &data);
  mj_camlight(&model, &data);
  mj_tendon(&model, &data);
}

}  // namespace breakwater
