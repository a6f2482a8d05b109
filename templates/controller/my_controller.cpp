#include "my_controller.h"

#include <cmath>
#include <memory>
#include <stdexcept>

#include <breakwater/linear/pseudo_inverse.h>

namespace my_controller_lab {

using breakwater::ArmSetup;
using breakwater::Fields;
using breakwater::TipVector;

MyController::MyController(const ArmSetup& arm, const MyControllerDesign& design)
    : ArmController(arm), design_(design), J_plus_(arm.chain->joints(), 3) {
  if (!(design.virtual_mass_kg > 0.0) || !(design.virtual_damping_Ns_m > 0.0) ||
      !(design.k_p >= 0.0) || !(design.singular_value_floor >= 0.0)) {
    throw std::invalid_argument(
        "mass and damping must be positive, and the gains must not be negative");
  }
  publish({"virtual_acceleration_m_s2", "m/s^2", "acceleration of the tip in x by the admittance",
           breakwater::view(virtual_acceleration_m_s2_)});
}

void MyController::decide(Eigen::Ref<Eigen::VectorXd> a) {
  const double k_d = 2.0 * std::sqrt(design_.k_p);
  if (!force_control_) {
    a.noalias() = design_.k_p * (task().start_angles_rad - q_hat_) - k_d * dq_hat_;
    return;
  }
  const TipVector velocity = J_ * dq_hat_;
  TipVector acceleration = design_.k_p * (task().start_pose - X_hat_) - k_d * velocity;
  virtual_acceleration_m_s2_ =
      (task().force_reference_N - force_N_ - design_.virtual_damping_Ns_m * velocity[0]) /
      design_.virtual_mass_kg;
  acceleration[0] = virtual_acceleration_m_s2_;
  breakwater::pseudo_inverse(J_, design_.singular_value_floor, J_plus_);
  a.noalias() = J_plus_ * (acceleration - chain().tip_bias_acceleration(q_hat_, dq_hat_));
}

namespace {

// Keys with the names of Breakwater's own controllers: a file needs each value only once.
void bind(Fields& fields, MyControllerDesign& design) {
  fields.optional_number("controller.virtual_mass_kg", design.virtual_mass_kg,
                         breakwater::positive(), "M: mass of the admittance [kg]");
  fields.optional_number(
      "controller.virtual_damping_Ns_m", design.virtual_damping_Ns_m, breakwater::positive(),
      "D: damping of the admittance; the speed of free motion is F^ref/D [N s/m]");
  fields.number("controller.k_position", design.k_p, breakwater::not_negative(),
                "K_p: position gain; the velocity gain is 2 sqrt(K_p) [1/s^2]");
  fields.number("controller.singular_value_floor", design.singular_value_floor,
                breakwater::not_negative(),
                "singular values below this count as 0 in the pseudo-inverse");
}

std::unique_ptr<breakwater::Controller> make(const MyControllerDesign& design,
                                             const ArmSetup& arm) {
  return std::make_unique<MyController>(arm, design);
}

}  // namespace

breakwater::ArmControllerKind my_controller_kind() {
  return {"my_controller",
          "admittance control: the tip as a mass and damper, driven by the force error", bind,
          make};
}

}  // namespace my_controller_lab
