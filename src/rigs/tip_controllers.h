// The controllers of an arm for any plant with a tip.
#pragma once

#include <vector>

#include <breakwater/rigs/axis_settings.h>
#include <breakwater/rigs/plant_parts.h>

namespace breakwater {

/// The task of a plant's tip. It is the site of tip.sensor, or the centre of the geom that touches.
/// The contact frame is that of the plane in tip.contact: x is opposite to the plane's normal. Each
/// joint from the world to the tip must have an axis with an actuator and a sensor at the joint.
/// There must be no other axis. Throws std::invalid_argument.
TipTask tip_task(const AxisPlant& plant);

/// An arm's controllers of the catalogue as controllers of a plant. Their estimator stands for each
/// joint by itself, with the nominal inertia of the joint's axis.
std::vector<PlantControllerKind> tip_controllers(const Catalogue& catalogue);

}  // namespace breakwater
