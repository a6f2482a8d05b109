// Laws of the dry friction of a joint.
#pragma once

#include <breakwater/math/interface.h>

namespace breakwater {

/// The bristles between two rough bodies, which bend before the bodies slide.
struct Bristles {
  double stiffness = 0.0;  ///< σ₀ [force per position]; 0: there are none
  double damping = 0.0;    ///< σ₁ [force per velocity]

  bool is_on() const { return stiffness > 0.0; }
};

/// The dry friction of a joint. Without bristles, friction is at its level where the joint slides,
/// and holds the joint where a smaller force suffices. With bristles it is the model of LuGre,
///     F = σ₀ z + σ₁ ż,   ż = v − σ₀ |v|/g z,
/// where g is the level. Viscous friction is no part of it.
///
/// Source of the bristles: C. Canudas de Wit, H. Olsson, K. J. Åström and P. Lischinsky, IEEE
/// Trans. Autom. Control 40 (1995) 419–425.
class FrictionLaw : public Interface {
 public:
  /// The level [N or N m], which must be positive. `speed` is the joint's velocity and
  /// `transmitted` the force of actuator and transmission. It is called at every stage of the
  /// integrator, so it must not allocate or throw.
  virtual double level(double speed, double transmitted) const = 0;

  virtual Bristles bristles() const { return {}; }
};

/// g = F_C + (F_S − F_C) exp(−|v/v_S|^δ).
///
/// Source: R. Stribeck, Z. VDI 46 (1902), in the form of B. Armstrong-Hélouvry, P. Dupont and
/// C. Canudas de Wit, Automatica 30 (1994) 1083–1138.
class StribeckFriction final : public FrictionLaw {
 public:
  struct Curve {
    double coulomb = 0.0;       ///< F_C
    double static_ratio = 1.0;  ///< F_S/F_C
    double velocity = 1.0;      ///< v_S
    double exponent = 2.0;      ///< δ
  };
  /// Throws std::invalid_argument unless F_C, v_S and δ are positive, F_S ≥ F_C, and the bristles
  /// are not negative.
  explicit StribeckFriction(const Curve& curve, const Bristles& bristles = {});

  double level(double speed, double) const override;
  Bristles bristles() const override { return bristles_; }

 private:
  Curve curve_;
  Bristles bristles_;
};

/// g = F_C + μ |τ|, where τ is the transmitted force: a gear presses its teeth together.
class LoadDependentFriction final : public FrictionLaw {
 public:
  /// Throws std::invalid_argument unless F_C > 0 and 0 ≤ μ < 1. At μ = 1 no force would move it.
  LoadDependentFriction(double coulomb, double load_ratio);

  double level(double, double transmitted) const override;

 private:
  double coulomb_;
  double load_ratio_;
};

/// The bend of the bristles after a displacement u, and its derivative with respect to u. Where
/// the level is constant, ż is a linear equation in the displacement, with the exact solution
///     z(u) = s g/σ₀ + (z − s g/σ₀) exp(−σ₀ |u|/g),   s = sign u.
/// So no step is too long, and what does not move does not creep.
struct BristleBend {
  double z;
  double slope;
};
BristleBend bend_after(double z, double displacement, double level, const Bristles& bristles);

}  // namespace breakwater
