// What of a model its motion depends on.
#pragma once

#include <mujoco/mujoco.h>

#include <string>
#include <vector>

namespace breakwater {

/// A smaller model of the same motion, to the bit, for mj_deleteModel(); null, and `fatal` says
/// why, if the engine cannot make one.
///
/// It lacks cameras, lights, textures, materials, skins and the geoms that can touch nothing, as
/// they stand in the file, but for those of `geoms`, which can touch whatever touches anything.
/// What a sensor, tendon, <pair> or tuple names stays, and so does each geom that a fluid acts on,
/// and all if there is a sensor that sees geoms (a rangefinder, a user's own). Memory for
/// constraints and contacts is cut to what there can be. All other numbers are the compiled model's
/// own, masses and inertias included, whichever geoms they were derived from; the ids of geoms
/// alone differ.
mjModel* physics_part(const mjModel& full, const std::vector<int>& geoms, std::string& fatal);

/// While one lives, models are left whole and contacts are searched for by the engine, in this
/// process: so that it shows that neither changes a bit of any run.
class WholeModels {
 public:
  WholeModels();
  ~WholeModels();
  WholeModels(const WholeModels&) = delete;
  WholeModels& operator=(const WholeModels&) = delete;

  static bool are_wanted();
};

}  // namespace breakwater
