#include <breakwater/sim/linear_model.h>

#include <algorithm>
#include <stdexcept>

#include <breakwater/linear/eigenvalues.h>
#include <breakwater/sim/engine_guard.h>

namespace breakwater {
namespace {

constexpr double kDifference = 1e-6;  // rad, m, rad/s, m/s, or an actuator's unit

Eigen::Map<Eigen::VectorXd> view_of(mjtNum* values, int count) {
  return {values, count};
}

void forward(const Model& model, mjData& data) {
  check_engine(model.file(), call_engine([&] { mj_forward(model.get(), &data); }));
}

}  // namespace

Eigen::MatrixXd joint_inertia(const Model& model, std::span<const double> qpos) {
  const DataPointer data = model.make_data();
  std::copy(qpos.begin(), qpos.end(), data->qpos);
  forward(model, *data);
  Eigen::MatrixXd M(model->nv, model->nv);  // symmetric
  mj_fullM(model.get(), M.data(), data->qM);
  return M;
}

LinearModel linearise(Model model, std::span<const double> qpos, const std::vector<int>& joints,
                      const std::vector<int>& actuators,
                      const std::vector<SpringOnJoint>& springs) {
  const int n = model->nv;
  const bool has_only_axes =
      std::all_of(model->jnt_type, model->jnt_type + model->njnt,
                  [](int type) { return type == mjJNT_HINGE || type == mjJNT_SLIDE; });
  if (!has_only_axes) {
    throw std::invalid_argument(model.file() +
                                ": only a model of hinges and slides has a linear model");
  }
  model.get()->opt.disableflags |=
      mjDSBL_LIMIT | mjDSBL_CONTACT | mjDSBL_FRICTIONLOSS | mjDSBL_WARMSTART;
  const DataPointer data = model.make_data();
  std::copy(qpos.begin(), qpos.end(), data->qpos);
  const auto acceleration = [&]() -> Eigen::VectorXd {
    forward(model, *data);
    if (!springs.empty()) {
      mju_zero(data->qfrc_applied, n);
      for (const SpringOnJoint& spring : springs) spring.force->apply(0.0, *model.get(), *data);
      forward(model, *data);
    }
    return view_of(data->qacc, n);
  };
  const auto derivative = [&](mjtNum& value) -> Eigen::VectorXd {
    const mjtNum middle = value;
    value = middle + kDifference;
    const Eigen::VectorXd above = acceleration();
    value = middle - kDifference;
    const Eigen::VectorXd below = acceleration();
    value = middle;
    return (above - below) / (2.0 * kDifference);
  };
  const auto inputs = static_cast<Eigen::Index>(actuators.size());
  const auto outputs = static_cast<Eigen::Index>(joints.size());
  LinearModel linear;
  linear.plant.A.setZero(2 * n, 2 * n);
  linear.plant.B.setZero(2 * n, inputs);
  linear.plant.C.setZero(outputs, 2 * n);
  linear.held_input.setZero(inputs);
  // The pose must be held before it is varied: an unbalanced force depends on it too. The drives
  // and the twists of the springs hold it.
  const auto twists = static_cast<Eigen::Index>(springs.size());
  const auto position = [&](const SpringOnJoint& spring) -> mjtNum& {
    return data->qpos[model->jnt_qposadr[spring.joint]];
  };
  Eigen::MatrixXd held(n, inputs + twists);
  Eigen::Index next = 0;
  for (const int actuator : actuators) held.col(next++) = derivative(data->ctrl[actuator]);
  for (const SpringOnJoint& one : springs) held.col(next++) = derivative(position(one));
  linear.plant.B.bottomRows(n) = held.leftCols(inputs);
  Eigen::VectorXd remaining = acceleration();
  if (held.cols() > 0) {
    const Eigen::VectorXd holds = -least_squares(held, remaining);
    linear.held_input = holds.head(inputs);
    next = 0;
    for (const int actuator : actuators) data->ctrl[actuator] = holds(next++);
    for (const SpringOnJoint& one : springs) position(one) += holds(next++);
    remaining = acceleration();
  }
  linear.qpos = view_of(data->qpos, n);
  linear.acceleration = n > 0 ? remaining.cwiseAbs().maxCoeff() : 0.0;
  linear.plant.A.topRightCorner(n, n).setIdentity();
  for (int i = 0; i < n; ++i) {
    linear.plant.A.col(i).tail(n) = derivative(data->qpos[i]);
    linear.plant.A.col(n + i).tail(n) = derivative(data->qvel[i]);
  }
  next = 0;
  for (const int joint : joints) linear.plant.C(next++, model->jnt_dofadr[joint]) = 1.0;
  return linear;
}

ApparentMass::ApparentMass(const Model& model, const std::string& site,
                           const Eigen::Vector3d& direction)
    : site_(model.id(mjOBJ_SITE, site)),
      direction_(direction),
      jacobian_(3, model->nv),
      inertia_(model->nv, model->nv),
      cholesky_(model->nv),
      along_(model->nv),
      recoil_(model->nv) {
  if (model->nv == 0) throw std::invalid_argument(model.file() + ": has no joint");
}

double ApparentMass::operator()(const Model& model, const mjData& data) {
  mj_jacSite(model.get(), &data, jacobian_.data(), nullptr, site_);
  mj_fullM(model.get(), inertia_.data(), data.qM);
  cholesky_.compute(inertia_);
  along_.noalias() = jacobian_.transpose() * direction_;
  recoil_ = along_;
  cholesky_.solveInPlace(recoil_);
  return 1.0 / along_.dot(recoil_);
}

}  // namespace breakwater
