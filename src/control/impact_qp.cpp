#include <breakwater/control/impact_qp.h>

#include <algorithm>
#include <cmath>

#include <breakwater/math/refuse_unless.h>

namespace breakwater {
namespace {

constexpr double kImpactSoftness = 1e-3;  // the impact's rows: 1/weight on (m/s²)², (rad/s²)²
constexpr int kMostChanges = 200;

QpModel first_model(const ArmSetup& arm) {
  const Eigen::Index joints = arm.chain->joints();
  QpModel model;
  model.H = Eigen::MatrixXd::Identity(joints, joints);
  model.Omega = QpModel::RowMajor::Zero(2 * joints + 1, joints);
  model.Omega.topRows(joints).setIdentity();
  const Eigen::MatrixXd& mass_matrix = arm.acceleration.nominal_mass_matrix_kgm2;
  if (mass_matrix.size() > 0) model.Omega.topRows(joints) = mass_matrix;
  return model;
}

}  // namespace

ImpactProgram::ImpactProgram(const ArmSetup& arm, const ImpactQpDesign& design)
    : arm_(arm),
      design_(design),
      model_(first_model(arm)),
      solver_(model_, kMostChanges),
      input_(model_.Omega.cols(), model_.Omega.rows()),
      solution_(model_.Omega.cols(), model_.Omega.rows()),
      after_(model_.Omega.cols()) {
  input_.softness.tail(after_.size() + 1).setConstant(kImpactSoftness);
}

const Eigen::VectorXd& ImpactProgram::solve(const State& state) {
  const Eigen::Index n = state.dq.size();
  const auto along = state.J.row(0);
  const AccelerationControlDesign& joints = arm_.acceleration;
  const bool is_coupled = joints.nominal_mass_matrix_kgm2.size() > 0;
  const Eigen::VectorXd& velocity_limit = arm_.chain->velocity_limits_rad_s();
  const ImpactModel& impact = design_.path.impact;
  const double bounce = 1.0 + design_.restitution;
  model_.H.noalias() = state.J.transpose() * state.J;
  model_.H.diagonal().array() += design_.posture_weight;
  input_.g.noalias() = state.J.transpose() * -state.wanted;

  double largest_N = impact.allowed_N(arm_.task.force_reference_N);
  for (Eigen::Index i = 0; i < n; ++i) {
    // A joint that is too fast brakes as hard as it can.
    const double slowest = (-velocity_limit(i) - state.dq(i)) / arm_.period_s;
    const double fastest = (velocity_limit(i) - state.dq(i)) / arm_.period_s;
    input_.lower(i) = std::clamp(slowest, state.lower(i), state.upper(i));
    input_.upper(i) = std::clamp(fastest, state.lower(i), state.upper(i));
    const double lever = std::abs(along(i));
    const double most_Nm = joints.torque_limit_Nm(i);
    if (lever * largest_N > most_Nm) largest_N = most_Nm / lever;

    after_ = (is_coupled ? -bounce * state.mass_kg * state.recoil(i)
                         : -bounce * state.mass_kg / joints.nominal_inertia_kgm2(i) * along(i)) *
             along.transpose();
    after_(i) += 1.0;
    const double now = after_.dot(state.dq);
    // The impact's rows are divided by T_p: all rows are accelerations, of similar size.
    model_.Omega.row(n + i) = after_.transpose();
    input_.lower(n + i) = (-velocity_limit(i) - now) / design_.preview_s;
    input_.upper(n + i) = (velocity_limit(i) - now) / design_.preview_s;
  }
  const double force_per_speed = peak_per_speed_Ns_m(impact.stiffness_N_m, state.mass_kg);
  const double now_N = force_per_speed * along.dot(state.dq);
  model_.Omega.row(2 * n) = along;
  input_.upper(2 * n) = (largest_N - now_N) / (force_per_speed * design_.preview_s);
  if (!state.foresees_impact) {
    input_.lower.tail(n + 1).setConstant(-kNoBound);
    input_.upper.tail(n + 1).setConstant(kNoBound);
  }
  solver_.set_matrices(model_.H, model_.Omega);
  solver_.solve(input_, solution_);
  if (solution_.status != QpStatus::solved && solution_.status != QpStatus::inaccurate) {
    throw ControlFailure("impact-aware control: the quadratic program has no solution");
  }
  foreseen_force_N_ = now_N + force_per_speed * design_.preview_s * along.dot(solution_.z);
  return solution_.z;
}

ImpactQp::ImpactQp(const ArmSetup& arm, const ImpactQpDesign& design)
    : PathControl(arm, design.path),
      design_(design),
      program_(arm, design),
      lower_(Eigen::VectorXd::Zero(arm.chain->joints())),
      upper_(lower_) {
  check(design.admittance);
  refuse_unless(
      design.approach_speed_m_s > 0.0 && design.preview_s > 0.0 && design.posture_weight > 0.0,
      "impact-aware control: the speed, the preview and the weight must be positive");
  refuse_unless(design.restitution >= 0.0 && design.restitution <= 1.0,
                "impact-aware control: the restitution must be between 0 and 1");
  publish({"foreseen_force_N", "N", "force of an impact at the next sample, as foreseen",
           view(program_.foreseen_force_N())});
  publish({"qp_iterations", "1", "changes of the active set", view(iterations_)});
  publish({"qp_kkt_residual", "1", "KKT residual of the solution",
           view(program_.solution().kkt_residual)});
}

double ImpactQp::path_acceleration() {
  along_wanted_ = touches() ? design_.admittance.acceleration_m_s2(
                                  task().force_reference_N - force_N_, velocity_[0])
                            : path().approach.k_d() * (design_.approach_speed_m_s - velocity_[0]);
  return along_wanted_;
}

void ImpactQp::decide(Eigen::Ref<Eigen::VectorXd> a) {
  PathControl::decide(a);
  if (!force_control_) return;
  const double mass_kg = effective_mass_kg();
  for (Eigen::Index i = 0; i < a.size(); ++i) {
    lower_(i) = joints().lower(i);
    upper_(i) = joints().upper(i);
  }
  wanted_[0] += along_wanted_;
  const Eigen::Ref<const Eigen::VectorXd> dq(dq_hat_);
  a = program_.solve({.J = J_,
                      .dq = dq,
                      .wanted = wanted_,
                      .lower = lower_,
                      .upper = upper_,
                      .recoil = recoil_,
                      .mass_kg = mass_kg,
                      .foresees_impact = !touches() && X_hat_[0] >= task().start_pose[0] +
                                                                        design_.expected_from_m});
  iterations_ = program_.solution().iterations;
}

}  // namespace breakwater
