// The engine told which geoms can touch, where they are few.
#pragma once

#include <mujoco/mujoco.h>

namespace breakwater {

/// The same model with a <pair> for each two geoms that could touch, and no others looked at: the
/// same contacts to the bit, without the engine's search among bodies, which in a model with one
/// moving geom is a tenth of a step. For mj_deleteModel(); null where that does not fit.
///
/// It fits where the world's own geoms and those of one moving body make at most four pairs, there
/// are no others, no <pair> and no <exclude>, and what a contact's numbers are mixed of is the same
/// in both geoms, so that the mixture is, too.
mjModel* with_contact_pairs(const mjModel& model);

/// Switches the pairs on whose geoms' contype and conaffinity match, and the others off.
void switch_contact_pairs(mjModel& model);

}  // namespace breakwater
