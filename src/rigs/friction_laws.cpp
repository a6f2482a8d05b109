// Breakwater's friction laws: the keys of each, and how it is made of them.
#include <breakwater/rigs/drive_settings.h>

namespace breakwater {
namespace {

using Friction = std::unique_ptr<FrictionLaw>;

struct Nothing {};

void bind_nothing(Fields&, Nothing&) {}

Friction make_coulomb(const Nothing&, double) {
  return nullptr;
}

struct Curved {
  StribeckFriction::Curve curve;
  Bristles bristles;
};

void bind_stribeck(Fields& fields, Curved& settings) {
  fields.number("friction.static_ratio", settings.curve.static_ratio, between(1.0, 1e3),
                "F_S/F_C: largest friction at rest, over the Coulomb friction");
  fields.number("friction.stribeck_velocity", settings.curve.velocity, positive(),
                "v_S: velocity at which the friction has fallen from F_S towards F_C [velocity]");
  fields.number("friction.stribeck_exponent", settings.curve.exponent, positive(),
                "delta: exponent of the velocity over v_S");
  fields.standard("friction.stribeck_exponent", {2.0});
}

void bind_lugre(Fields& fields, Curved& settings) {
  bind_stribeck(fields, settings);
  fields.number("friction.bristle_stiffness", settings.bristles.stiffness, positive(),
                "sigma_0: stiffness of the bristles [force per position]");
  fields.number("friction.bristle_damping", settings.bristles.damping, not_negative(),
                "sigma_1: damping of the bristles [force per velocity]");
}

Friction make_curved(const Curved& settings, double coulomb) {
  StribeckFriction::Curve curve = settings.curve;
  curve.coulomb = coulomb;
  return std::make_unique<StribeckFriction>(curve, settings.bristles);
}

struct Loaded {
  double ratio = 0.0;
};

void bind_loaded(Fields& fields, Loaded& settings) {
  fields.number("friction.load_ratio", settings.ratio, between(0.0, 0.99),
                "mu: friction that the transmitted force adds, over that force");
}

Friction make_loaded(const Loaded& settings, double coulomb) {
  return std::make_unique<LoadDependentFriction>(coulomb, settings.ratio);
}

}  // namespace

std::vector<FrictionKind> friction_laws() {
  return {{"coulomb", "a constant level, of the engine", bind_nothing, make_coulomb},
          {"stribeck", "falls from its static level as the joint begins to slide", bind_stribeck,
           make_curved},
          {"lugre", "bristles bend before the joint slides", bind_lugre, make_curved},
          {"load_dependent", "grows with the transmitted force, as in a strain-wave gear",
           bind_loaded, make_loaded}};
}

}  // namespace breakwater
