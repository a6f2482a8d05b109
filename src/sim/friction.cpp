#include <breakwater/sim/friction.h>

#include <cmath>
#include <stdexcept>

namespace breakwater {
namespace {

constexpr double kHardImpedance = 0.9999;     // d, the engine's largest
constexpr double kStepsOfTimeConstant = 2.0;  // the fewest that the engine accepts

}  // namespace

void author_friction(Model& model, int joint, double viscous, double coulomb) {
  const bool fits =
      std::isfinite(viscous) && viscous >= 0.0 && std::isfinite(coulomb) && coulomb >= 0.0;
  if (!fits) throw std::invalid_argument("friction: must be finite and not negative");
  mjModel& m = *model.get();
  if (m.jnt_type[joint] != mjJNT_SLIDE && m.jnt_type[joint] != mjJNT_HINGE) {
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
    const int type = model->jnt_type[joint];
    if (type != mjJNT_SLIDE && type != mjJNT_HINGE) continue;
    const int dof = model->jnt_dofadr[joint];
    author_friction(model, joint, model->dof_damping[dof], model->dof_frictionloss[dof]);
  }
}

void set_coulomb_friction(Model& model, int joint, double coulomb) {
  author_friction(model, joint, model->dof_damping[model->jnt_dofadr[joint]], coulomb);
}

}  // namespace breakwater
