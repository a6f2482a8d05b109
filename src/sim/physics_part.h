// The part of a model that affects its motion.
#pragma once

#include <mujoco/mujoco.h>

#include <string>
#include <vector>

namespace breakwater {

/// A smaller model with the same motion, to the bit, for mj_deleteModel(). If the engine cannot
/// make it, returns null and sets `fatal` to the reason.
///
/// Model::load_physics() says what is missing. If a sensor sees geoms (a rangefinder, a user
/// sensor), all geoms stay. Memory for constraints and contacts is cut to the largest number
/// possible. All other numbers are those of the full model, also masses and inertias that the
/// compiler derived from missing geoms. Only the ids of geoms differ.
mjModel* physics_part(const mjModel& full, const std::vector<int>& geoms, std::string& fatal);

/// During its lifetime, models in this process stay whole and the engine searches for contacts. A
/// test uses it to show that neither optimisation changes a bit of a run.
class WholeModels {
 public:
  WholeModels();
  ~WholeModels();
  WholeModels(const WholeModels&) = delete;
  WholeModels& operator=(const WholeModels&) = delete;

  static bool are_wanted();
};

}  // namespace breakwater
