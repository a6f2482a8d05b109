#include <breakwater/sim/transmission.h>

#include <algorithm>
#include <cmath>
#include <span>
#include <sstream>
#include <stdexcept>

#include <breakwater/math/functions.h>
#include <breakwater/math/refuse_unless.h>
#include <breakwater/sim/contact.h>
#include <breakwater/sim/linear_model.h>

namespace breakwater {
namespace {

void check(const TransmissionDesign& design) {
  refuse_unless(is_positive(design.stiffness) && is_not_negative(design.damping) &&
                    is_not_negative(design.backlash) && std::isfinite(design.ratio) &&
                    design.ratio != 0.0 && std::isfinite(design.kinematic_error) &&
                    std::isfinite(design.error_per_turn),
                "transmission: needs a stiffness > 0, damping and backlash >= 0, and a ratio that "
                "is not 0, all finite");
}

}  // namespace

Transmission::Transmission(const Model& model, const std::string& motor, const std::string& load,
                           const TransmissionDesign& design)
    : design_(design) {
  check(design);
  const int motor_joint = model.axis(motor), load_joint = model.axis(load);
  refuse_unless(motor_joint != load_joint, "transmission: motor and load must be two joints");
  motor_ = model->jnt_qposadr[motor_joint];
  load_ = model->jnt_qposadr[load_joint];
  motor_dof_ = model->jnt_dofadr[motor_joint];
  load_dof_ = model->jnt_dofadr[load_joint];
}

void Transmission::check_stability(const Model& model) const {
  Eigen::VectorXd along = Eigen::VectorXd::Zero(model->nv);
  along(motor_dof_) =
      std::abs(1.0 / design_.ratio) + std::abs(design_.kinematic_error * design_.error_per_turn);
  along(load_dof_) = -1.0;
  const auto pose = std::span(model->qpos0, static_cast<std::size_t>(model->nq));
  const Eigen::LLT<Eigen::MatrixXd> inertia(joint_inertia(model, pose));
  const ContactSlopes slopes{.stiffness_N_m = design_.stiffness,
                             .damping_Ns_m = design_.damping,
                             .mass_kg = 1.0 / along.dot(inertia.solve(along))};
  const Integrator integrator = model.integrator();
  const double timestep_s = model->opt.timestep;
  if (is_stable(integrator, timestep_s, slopes)) return;
  std::ostringstream text;
  text.precision(6);
  text << "transmission to joint \"" << model.name(mjOBJ_JOINT, model->dof_jntid[load_dof_])
       << "\": a stiffness of " << design_.stiffness << " and damping of " << design_.damping
       << " between the motor and the load, with an inertia of " << slopes.mass_kg
       << " of both together, are beyond the stability limit for a timestep of " << timestep_s
       << " s; the longest stable physics.timestep_s that divides it is "
       << dividing_timestep_s(integrator, timestep_s, slopes);
  throw std::invalid_argument(text.str());
}

double Transmission::twist(double motor, double load) const {
  return motor / design_.ratio +
         design_.kinematic_error * math::sin(design_.error_per_turn * motor) - load;
}

double Transmission::slope(double motor) const {
  return 1.0 / design_.ratio + design_.kinematic_error * design_.error_per_turn *
                                   math::cos(design_.error_per_turn * motor);
}

double Transmission::torque(double motor, double motor_rate, double load, double load_rate) const {
  const double angle = twist(motor, load);
  const double resistance = design_.damping * (slope(motor) * motor_rate - load_rate);
  if (design_.backlash == 0.0) return design_.stiffness * angle + resistance;
  const double play = 0.5 * design_.backlash;
  if (angle > play) return std::max(design_.stiffness * (angle - play) + resistance, 0.0);
  if (angle < -play) return std::min(design_.stiffness * (angle + play) + resistance, 0.0);
  return 0.0;
}

double Transmission::torque(const double* qpos, const double* qvel) const {
  return torque(qpos[motor_], qvel[motor_dof_], qpos[load_], qvel[load_dof_]);
}

void Transmission::apply(double, const mjModel&, mjData& data) {
  const double T = torque(data.qpos, data.qvel);
  data.qfrc_applied[load_dof_] += T;
  data.qfrc_applied[motor_dof_] -= T * slope(data.qpos[motor_]);
}

}  // namespace breakwater
