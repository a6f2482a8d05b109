#include <breakwater/world/friction_law.h>

#include <cmath>

#include <breakwater/math/functions.h>
#include <breakwater/math/refuse_unless.h>

namespace breakwater {
StribeckFriction::StribeckFriction(const Curve& curve, const Bristles& bristles)
    : curve_(curve), bristles_(bristles) {
  refuse_unless(is_positive(curve.coulomb), "needs a Coulomb friction > 0");
  refuse_unless(is_positive(curve.velocity) && is_positive(curve.exponent) &&
                    std::isfinite(curve.static_ratio) && curve.static_ratio >= 1.0,
                "needs a velocity and an exponent > 0, and a static ratio >= 1");
  refuse_unless(is_not_negative(bristles.stiffness) && is_not_negative(bristles.damping),
                "stiffness and damping of the bristles must not be negative");
}

double StribeckFriction::level(double speed, double) const {
  const double ratio = math::pow(std::abs(speed) / curve_.velocity, curve_.exponent);
  return curve_.coulomb * (1.0 + (curve_.static_ratio - 1.0) * math::exp(-ratio));
}

LoadDependentFriction::LoadDependentFriction(double coulomb, double load_ratio)
    : coulomb_(coulomb), load_ratio_(load_ratio) {
  refuse_unless(is_positive(coulomb), "needs a Coulomb friction > 0");
  refuse_unless(load_ratio >= 0.0 && load_ratio < 1.0, "needs a load ratio from 0 to below 1");
}

double LoadDependentFriction::level(double, double transmitted) const {
  return coulomb_ + load_ratio_ * std::abs(transmitted);
}

BristleBend bend_after(double z, double displacement, double level, const Bristles& bristles) {
  const double sign = displacement > 0.0 ? 1.0 : displacement < 0.0 ? -1.0 : 0.0;
  const double most = level / bristles.stiffness;
  const double decay = math::exp(-std::abs(displacement) / most);
  return {sign == 0.0 ? z : sign * most + (z - sign * most) * decay,
          decay * (1.0 - sign * z / most)};
}

}  // namespace breakwater
