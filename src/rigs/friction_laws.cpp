// Breakwater's friction laws: the keys of each, and how it is made of them.
#include <breakwater/rigs/drive_settings.h>

namespace breakwater {
namespace {

using Friction = std::unique_ptr<FrictionLaw>;

Friction make_coulomb(double) {
  return nullptr;
}

struct Stribeck {
  StribeckFriction::Curve curve;
  Bristles bristles;

  void bind(Fields& fields) {
    fields.number("friction.static_ratio", curve.static_ratio, between(1.0, 1e3),
                  "F_S/F_C: largest friction at rest, over the Coulomb friction");
    fields.number("friction.stribeck_velocity", curve.velocity, positive(),
                  "v_S: velocity at which the friction has fallen from F_S towards F_C [velocity]");
    fields.optional_number("friction.stribeck_exponent", curve.exponent, positive(),
                           "delta: exponent of the velocity over v_S");
  }
  Friction make(double coulomb) const {
    StribeckFriction::Curve known = curve;
    known.coulomb = coulomb;
    return std::make_unique<StribeckFriction>(known, bristles);
  }
};

struct LuGre : Stribeck {
  void bind(Fields& fields) {
    Stribeck::bind(fields);
    fields.number("friction.bristle_stiffness", bristles.stiffness, positive(),
                  "sigma_0: stiffness of the bristles [force per position]");
    fields.number("friction.bristle_damping", bristles.damping, not_negative(),
                  "sigma_1: damping of the bristles [force per velocity]");
  }
  Friction make(double coulomb) const { return Stribeck::make(coulomb); }
};

struct LoadDependent {
  double ratio = 0.0;

  void bind(Fields& fields) {
    fields.number("friction.load_ratio", ratio, between(0.0, 0.99),
                  "mu: friction that the transmitted force adds, over that force");
  }
  Friction make(double coulomb) const {
    return std::make_unique<LoadDependentFriction>(coulomb, ratio);
  }
};

}  // namespace

std::vector<FrictionKind> friction_laws() {
  return {{"coulomb", "a constant level, of the engine", make_coulomb},
          {"stribeck", "falls from its static level as the joint begins to slide", &Stribeck::make},
          {"lugre", "bristles bend before the joint slides", &LuGre::make},
          {"load_dependent", "grows with the transmitted force, as in a strain-wave gear",
           &LoadDependent::make}};
}

}  // namespace breakwater
