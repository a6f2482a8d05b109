// Smaller and faster forms of a model, with the same motion.
#pragma once

#include <atomic>
#include <string>
#include <vector>

#include <breakwater/sim/model.h>

namespace breakwater {

/// A smaller model with the same motion, to the bit. Throws as made_by_engine() does.
///
/// Model::load_physics() says what is missing. If a sensor sees geoms (a rangefinder, a user
/// sensor), all geoms stay. Memory for constraints and contacts is cut to the largest number
/// possible. All other numbers are those of the full model, also masses and inertias that the
/// compiler derived from missing geoms. Only the ids of geoms differ.
ModelPointer physics_part(const mjModel& full, const std::vector<int>& geoms,
                          const std::string& file);

/// Models in this process stay whole and the engine searches for contacts. A test uses it to show
/// that neither optimisation changes a bit of a run.
inline std::atomic<bool> models_stay_whole = false;

/// A copy of the model with a <pair> for each two geoms that can touch, or null. The contacts have
/// the same bits, without the engine's search among bodies: a tenth of a step in a model with one
/// moving geom. Throws as made_by_engine() does.
///
/// Null unless the geoms of the world and of the only moving body form at most four pairs, without
/// <pair> and <exclude>. Both geoms of each pair must have equal contact parameters, because the
/// engine mixes them.
ModelPointer with_contact_pairs(const mjModel& model, const std::string& file);

/// Enables the pairs whose geoms match in contype and conaffinity, and disables the others.
void switch_contact_pairs(mjModel& model);

}  // namespace breakwater
