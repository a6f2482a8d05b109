// Laws of a contact: the force as a function of penetration and speed.
#pragma once

#include <array>
#include <cstddef>
#include <utility>
#include <vector>

#include <breakwater/math/interface.h>

namespace breakwater {

class KelvinVoigt;

/// The internal state of a contact law, such as the stretch of a damper inside the material. It
/// begins with zeros. The simulation integrates it by the same stages as the plant.
struct ContactState {
  static constexpr std::size_t kMost = 4;
  std::array<double, kMost> value{};
  std::array<double, kMost> rate{};  ///< d value/dt: the law writes it
};

/// The normal force of a contact.
class ContactForceLaw : public Interface {
 public:
  /// The force [N] that separates the bodies. `penetration_m` is not negative; `speed_m_s` is its
  /// rate, positive during compression. A negative force counts as 0: a contact never pulls. It is
  /// called at every stage of the integrator, so it must not allocate or throw.
  virtual double force(double penetration_m, double speed_m_s, ContactState& state) const = 0;

  /// The number of values of the state that the law uses, at most ContactState::kMost. A law with a
  /// state is also called outside the contact, with penetration and speed 0, so that it relaxes.
  virtual std::size_t states() const { return 0; }

  /// The law for MuJoCo's own contact; null: the law is applied as a force.
  virtual const KelvinVoigt* for_engine() const { return nullptr; }
};

/// F = K x + B ẋ.
class KelvinVoigt final : public ContactForceLaw {
 public:
  enum class By { engine, force };
  /// Throws std::invalid_argument unless K > 0 and B ≥ 0.
  KelvinVoigt(double stiffness_N_m, double damping_Ns_m, By by = By::engine);
  /// The same law by another way.
  KelvinVoigt(const KelvinVoigt& law, By by)
      : KelvinVoigt(law.stiffness_N_m_, law.damping_Ns_m_, by) {}

  double force(double penetration_m, double speed_m_s, ContactState&) const override {
    return stiffness_N_m_ * penetration_m + damping_Ns_m_ * speed_m_s;
  }
  const KelvinVoigt* for_engine() const override { return by_ == By::engine ? this : nullptr; }
  double stiffness_N_m() const { return stiffness_N_m_; }
  double damping_Ns_m() const { return damping_Ns_m_; }

 private:
  double stiffness_N_m_;
  double damping_Ns_m_;
  By by_;
};

/// F = k xⁿ (1 + α ẋ). Hertz' law has n = 1.5 and α = 0.
///
/// Source: K. H. Hunt and F. R. E. Crossley, J. Appl. Mech. 42 (1975) 440–445.
class HuntCrossley final : public ContactForceLaw {
 public:
  /// k [N/mⁿ], α [s/m]. Throws std::invalid_argument unless k > 0, n ≥ 1 and α ≥ 0.
  HuntCrossley(double stiffness_N_mn, double exponent, double dissipation_s_m);

  double force(double penetration_m, double speed_m_s, ContactState&) const override;

 private:
  double stiffness_;
  double exponent_;
  double dissipation_;
};

/// The α [s/m] of a Hunt–Crossley law with the restitution e at the impact speed v [m/s]. It holds
/// for any exponent: with β = α v, β (1 + e) = ln((1 + β)/(1 − e β)).
/// Throws std::invalid_argument unless 0 < e ≤ 1 and v > 0.
double dissipation_of_restitution(double restitution, double speed_m_s);

/// F = f(x) (1 + α ẋ), with f piecewise linear from (0, 0) through points of a table; the last
/// slope goes on.
class LayeredContact final : public ContactForceLaw {
 public:
  using Point = std::pair<double, double>;  ///< depth [m], force [N]
  /// Throws std::invalid_argument unless there is a point, depths and forces rise from 0, and
  /// α ≥ 0.
  LayeredContact(std::vector<Point> points, double dissipation_s_m);

  double force(double penetration_m, double speed_m_s, ContactState&) const override;

 private:
  std::vector<Point> points_;
  double dissipation_;
};

/// A spring K in parallel with a Maxwell arm (a spring K₁ in series with a damper η = K₁ τ):
///     F = K x + K₁ (x − z),   ż = (x − z)/τ.
/// Outside the contact the surface is free: K x + K₁ (x − z) = 0, so ż = −z K/((K + K₁) τ).
class StandardLinearSolid final : public ContactForceLaw {
 public:
  /// Throws std::invalid_argument unless all are positive.
  StandardLinearSolid(double stiffness_N_m, double maxwell_stiffness_N_m, double relaxation_s);

  double force(double penetration_m, double speed_m_s, ContactState& state) const override;
  std::size_t states() const override { return 1; }

 private:
  double stiffness_N_m_;
  double maxwell_N_m_;
  double relaxation_s_;
};

}  // namespace breakwater
