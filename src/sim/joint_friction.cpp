#include <breakwater/sim/joint_friction.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include <breakwater/math/refuse_unless.h>

namespace breakwater {
namespace {

constexpr double kHardImpedance = 0.9999;     // d, the engine's largest
constexpr double kStepsOfTimeConstant = 2.0;  // the fewest that the engine accepts

// A displacement in a step, in bends at which the bristles slide, whose tangent is exact enough.
constexpr double kSmallBend = 0.05;

int row_of(const mjData& data, int dof) {
  for (int row = data.ne; row < data.ne + data.nf; ++row) {
    if (data.efc_type[row] == mjCNSTR_FRICTION_DOF && data.efc_id[row] == dof) return row;
  }
  throw std::logic_error("the joint has no friction constraint");
}

}  // namespace

void author_friction(Model& model, int joint, double viscous, double coulomb) {
  refuse_unless(is_not_negative(viscous) && is_not_negative(coulomb),
                "friction: must be finite and not negative");
  mjModel& m = *model.get();
  if (!model.is_axis(joint)) {
    throw std::invalid_argument(model.file() + ": friction needs a slide or a hinge");
  }
  const int dof = m.jnt_dofadr[joint];
  m.dof_damping[dof] = viscous;
  m.dof_frictionloss[dof] = coulomb;
  mjtNum* solref = m.dof_solref + static_cast<ptrdiff_t>(mjNREF) * dof;
  mjtNum* solimp = m.dof_solimp + static_cast<ptrdiff_t>(mjNIMP) * dof;
  solref[0] = kStepsOfTimeConstant * m.opt.timestep;
  solimp[0] = solimp[1] = kHardImpedance;
}

void author_friction(Model& model) {
  for (int joint = 0; joint < model->njnt; ++joint) {
    if (!model.is_axis(joint)) continue;
    const int dof = model->jnt_dofadr[joint];
    author_friction(model, joint, model->dof_damping[dof], model->dof_frictionloss[dof]);
  }
}

void set_coulomb_friction(Model& model, int joint, double coulomb) {
  author_friction(model, joint, model->dof_damping[model->jnt_dofadr[joint]], coulomb);
}

JointFriction::JointFriction(Model& model, const std::string& joint,
                             std::unique_ptr<FrictionLaw> law, const Transmission* transmission)
    : law_(std::move(law)), bristles_(law_->bristles()), transmission_(transmission) {
  const int id = model.id(mjOBJ_JOINT, joint);
  set_coulomb_friction(model, id, law_->level(0.0, 0.0));
  dof_ = model->jnt_dofadr[id];
  position_ = model->jnt_qposadr[id];
  step_s_ = model->opt.timestep;
  inverse_mass_ = model->dof_invweight0[dof_];
  for (int i = 0; i < model->nu; ++i) {
    if (model.drives(i, id)) {
      actuators_.emplace_back(i, model->actuator_gear[static_cast<std::ptrdiff_t>(6) * i]);
    }
  }
  if (bristles_.is_on() && (model->opt.solver == mjSOL_PGS || model->opt.noslip_iterations > 0)) {
    throw std::invalid_argument(model.file() +
                                ": friction with bristles needs the solver Newton or CG, and no "
                                "noslip_iterations");
  }
}

// Other forces on the joint, a disturbance for example, do not pass through its gear.
double JointFriction::transmitted(const mjData& data) const {
  double force = transmission_ != nullptr ? transmission_->torque(data.qpos, data.qvel) : 0.0;
  for (const auto& [actuator, gear] : actuators_) force += gear * data.ctrl[actuator];
  return force;
}

void JointFriction::begin_step() {
  stage_ = 0;
}

void JointFriction::apply(double, const mjModel&, mjData& data) {
  // The force of the first stage is there until the solver of the second one.
  if (stage_ == 1) force_ = applied_ + data.efc_force[row_];
  row_ = row_of(data, dof_);
  if (stage_ == 0) {
    position_then_ = data.qpos[position_];
    transmitted_ = transmitted(data);
  }
  if (bristles_.is_on()) {
    bend(data, row_);
  } else {
    data.efc_frictionloss[row_] = law_->level(data.qvel[dof_], transmitted(data));
  }
  ++stage_;
}

// The force is a function of the velocity v⁺ = v + h q̈ at the end of the step. It falls from
// middle + range to middle − range. The solver gets one line of it.
void JointFriction::bend(mjData& data, int row) {
  const double speed = data.qvel[dof_];
  const double level = law_->level(speed, transmitted(data));
  const double stiffness = bristles_.stiffness + bristles_.damping / step_s_;
  double force, inertia;
  const double most = level / bristles_.stiffness;
  const bool may_reverse =
      std::abs(speed) <= step_s_ * (std::abs(data.qacc[dof_]) + 2.0 * level * inverse_mass_);
  if (may_reverse && step_s_ * std::abs(speed) > kSmallBend * most) {
    // The steepest line at v⁺ = 0, within the range: it does not pass the standstill.
    const double middle = bristles_.damping / step_s_ * z_;
    const double range = stiffness * most;
    const double slope = 1.0 + std::abs(z_) / most;
    inertia = stiffness * slope * step_s_ * step_s_;
    force = middle;
    data.efc_aref[row] = (-stiffness * z_) / inertia - speed / step_s_;
    data.efc_frictionloss[row] = range;
  } else {
    // The tangent at v⁺ = v.
    const BristleBend next = bend_after(z_, step_s_ * speed, level, bristles_);
    inertia = std::max(stiffness * next.slope * step_s_ * step_s_, mjMINVAL);
    force = bristles_.damping / step_s_ * z_ - stiffness * next.z;
    data.efc_aref[row] = 0.0;
    data.efc_frictionloss[row] = mjMAXVAL;
  }
  data.qfrc_applied[dof_] += force;
  if (stage_ == 0) applied_ = force;
  data.efc_D[row] = inertia;
  data.efc_R[row] = 1.0 / inertia;
}

void JointFriction::end_step(const mjModel&, const mjData& data) {
  if (stage_ == 1) force_ = applied_ + data.efc_force[row_];
  if (!bristles_.is_on()) return;
  const double displacement = data.qpos[position_] - position_then_;
  const double level = law_->level(displacement / step_s_, transmitted_);
  z_ = bend_after(z_, displacement, level, bristles_).z;
}

}  // namespace breakwater
