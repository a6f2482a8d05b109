// Friction of a joint in SI units.
#pragma once

#include <breakwater/sim/model.h>

namespace breakwater {

/// Gives a slide or hinge viscous and Coulomb friction, τ_f = −c q̇ − F_C sign(q̇), in N s/m and N or
/// N m s/rad and N m.
///
/// MuJoCo's dry friction is a soft constraint: under a load F < F_C the joint creeps at F R/b, with
/// R = (1 − d)/d·w, b = 2/(d·timeconst) and w the joint's invweight0. Its default impedance d = 0.9
/// makes that millimetres per second on a light cart; d = 0.9999 and a time constant of two steps
/// make it micrometres.
///
/// Throws std::invalid_argument if a friction is negative, or the joint is no slide or hinge.
void author_friction(Model& model, int joint, double viscous, double coulomb);

/// Gives it Coulomb friction alone, as soft as the model file has it. Throws as author_friction.
void set_coulomb_friction(Model& model, int joint, double coulomb);

}  // namespace breakwater
