// Friction of a joint in SI units.
#pragma once

#include <breakwater/sim/model.h>

namespace breakwater {

/// Sets viscous and Coulomb friction, τ_f = −c q̇ − F_C sign(q̇). Units: N s/m and N for a slide,
/// N m s/rad and N m for a hinge.
///
/// MuJoCo's dry friction is a soft constraint. Under a load F < F_C the joint creeps at F R/b with
/// R = (1 − d)/d·w and b = 2/(d·timeconst), where w is the joint's invweight0. The default
/// impedance d = 0.9 gives millimetres per second on a light cart. d = 0.9999 and a time constant
/// of two steps give micrometres per second.
///
/// Throws std::invalid_argument if a friction is negative or the joint is no slide or hinge.
void author_friction(Model& model, int joint, double viscous, double coulomb);

/// The same for each slide and hinge, with the numbers of the model file.
void author_friction(Model& model);

/// The same with the joint's own viscous friction.
void set_coulomb_friction(Model& model, int joint, double coulomb);

}  // namespace breakwater
