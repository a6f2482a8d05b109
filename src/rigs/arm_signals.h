// The log and the pictures of a scenario with a planar arm.
#pragma once

#include <string>

#include <breakwater/rigs/axis_scenario.h>

namespace breakwater {

/// Shows or hides the geoms with this prefix in pictures. They must be decoration alone.
void show_geoms(Model& model, const std::string& prefix, bool visible);

/// The signals of an arm, with the values of all joints side by side, in place of those of the
/// axes. A warning says if the tip is not at its start pose in the window `holds`. `plant` must
/// outlive the run.
void log_arm(RigRun& run, AxisRig& rig, const AxisLoop& loop, const AxisPlant& plant,
             const TimeWindow& holds);

}  // namespace breakwater
