#include <breakwater/control/energy_admittance.h>

#include <cmath>

#include <breakwater/math/refuse_unless.h>

namespace breakwater {

double peak_per_speed_Ns_m(double stiffness_N_m, double mass_kg) {
  return std::sqrt(stiffness_N_m * mass_kg);
}

void check(const Admittance& admittance) {
  refuse_unless(admittance.mass_kg > 0.0 && admittance.damping_Ns_m >= 0.0,
                "admittance: the mass must be positive, the damping not negative");
}

EnergyAdmittance::EnergyAdmittance(const ArmSetup& arm, const EnergyAdmittanceDesign& design)
    : PathControl(arm, design.path), design_(design) {
  check(design.admittance);
  publish({"effective_mass_kg", "kg", "nominal effective mass of the tip along x", view(mass_kg_)});
  publish({"speed_cap_m_s", "m/s", "allowed impact velocity", view(speed_m_s_)});
}

double EnergyAdmittance::path_acceleration() {
  if (touches()) {
    return design_.admittance.acceleration_m_s2(task().force_reference_N - force_N_, velocity_[0]);
  }
  mass_kg_ = effective_mass_kg();
  speed_m_s_ = path().impact.allowed_N(task().force_reference_N) /
               peak_per_speed_Ns_m(path().impact.stiffness_N_m, mass_kg_);
  return path().approach.k_d() * (speed_m_s_ - velocity_[0]);
}

}  // namespace breakwater
