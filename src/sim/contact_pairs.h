// A list of the geoms that can touch, as a replacement for the engine's search.
#pragma once

#include <mujoco/mujoco.h>

namespace breakwater {

/// A copy of the model with a <pair> for each two geoms that can touch, or null. The contacts have
/// the same bits, without the engine's search among bodies: a tenth of a step in a model with one
/// moving geom. For mj_deleteModel().
///
/// Null unless the geoms of the world and of the only moving body form at most four pairs, without
/// <pair> and <exclude>. Both geoms of each pair must have equal contact parameters, because the
/// engine mixes them.
mjModel* with_contact_pairs(const mjModel& model);

/// Enables the pairs whose geoms match in contype and conaffinity, and disables the others.
void switch_contact_pairs(mjModel& model);

}  // namespace breakwater
