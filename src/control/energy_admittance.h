// The simple candidate for an impact: a speed from the energy of the impact, then admittance.
#pragma once

#include <breakwater/control/path_control.h>

namespace breakwater {

/// The largest force of a mass m that meets a spring of stiffness K at unit speed, without drive:
/// √(K m) [N s/m]. The kinetic energy becomes that of the spring:
/// ½ m v² = F²/(2 K).
double peak_per_speed_Ns_m(double stiffness_N_m, double mass_kg);

/// An admittance: the tip moves in x like a mass with a damper under the force error,
///     M ẍ + D ẋ = F^ref − F.
struct Admittance {
  double mass_kg = 20.0;        ///< M
  double damping_Ns_m = 280.0;  ///< D

  double acceleration_m_s2(double force_error_N, double speed_m_s) const {
    return (force_error_N - damping_Ns_m * speed_m_s) / mass_kg;
  }
};

struct EnergyAdmittanceDesign {
  PathDesign path;
  Admittance admittance;
};

/// Approaches the wall with v = F_peak/√(K m), where m is the effective mass of the tip along x and
/// F_peak = F^ref + margin. In contact it is an Admittance. The filtered force enters.
///
/// docs/explanation/methods/published-impact-control.md.
class EnergyAdmittance final : public PathControl {
 public:
  /// Throws std::invalid_argument as the parts do, or if M is not positive or D is negative.
  EnergyAdmittance(const ArmSetup& arm, const EnergyAdmittanceDesign& design);

 private:
  double path_acceleration() override;

  EnergyAdmittanceDesign design_;
  double speed_m_s_ = 0.0;
  double mass_kg_ = 0.0;
};

/// Throws std::invalid_argument unless M is positive and D is not negative.
void check(const Admittance& admittance);

}  // namespace breakwater
