#include <breakwater/control/contact_mpc.h>

#include <algorithm>
#include <cmath>

#include <breakwater/linear/riccati.h>
#include <breakwater/math/functions.h>
#include <breakwater/math/refuse_unless.h>

namespace breakwater {
namespace {

constexpr double kDepthSoftness = 1e-9;  // softness of the force's bound: 1/weight on m²

}  // namespace

LmpcDesign contact_problem(const ContactMpcDesign& design, double reference_N) {
  refuse_unless(
      design.acceleration_m_s2 > 0.0 && design.wall_correction_per_s >= 0.0,
      "contact prediction: the acceleration must be positive, the correction not negative");
  const double T = design.period_s;
  const Eigen::MatrixXd r = Eigen::MatrixXd::Constant(1, 1, design.r);
  LmpcDesign problem;
  problem.A = (Eigen::Matrix2d() << 1.0, T, 0.0, 1.0).finished();
  problem.B = Eigen::Vector2d(0.5 * T * T, T);
  problem.prediction_steps = problem.control_steps = design.prediction_steps;
  problem.Q = Eigen::Vector2d(design.q_position, design.q_velocity).asDiagonal();
  problem.Q_last = dlqr(problem.A, problem.B, problem.Q, r).P;
  problem.R = Eigen::MatrixXd::Zero(1, 1);
  problem.S = r;
  const double bound = design.acceleration_m_s2;
  const double deepest_m =
      design.path.impact.allowed_N(reference_N) / design.path.impact.stiffness_N_m;
  problem.input_bounds.push_back({0, -bound, bound, first_steps(design.prediction_steps)});
  problem.state_bounds.push_back(
      {0, -kNoBound, deepest_m, spread_steps(design.prediction_steps, design.prediction_steps)});
  problem.softness = kDepthSoftness;
  return problem;
}

ContactMpc::ContactMpc(const ArmSetup& arm, const ContactMpcDesign& design)
    : PathControl(arm, design.path),
      design_(design),
      samples_per_move_(samples_per_move(design.period_s, arm.period_s)),
      lmpc_(contact_problem(design, arm.task.force_reference_N)),
      forget_(arm.task.force_lag_s > 0.0 ? math::exp(-arm.period_s / arm.task.force_lag_s) : 0.0),
      wall_x_m_(arm.task.wall_x_m + design.wall_error_m) {
  refuse_unless(std::isfinite(wall_x_m_), "contact prediction: needs a wall whose place is known");
  for (Eigen::Index i = 0; i < 2 * design.prediction_steps; i += 2) {
    lmpc_.reference()(i) = arm.task.force_reference_N / design.path.impact.stiffness_N_m;
  }
  publish({"wall_hat_m", "m", "x of the wall, told and corrected by the force", view(wall_x_m_)});
  publish({"qp_iterations", "1", "changes of the active set", view(lmpc_.iterations())});
  publish({"softened_bounds", "1", "1 where the force's bound gave way",
           view(lmpc_.softened_bounds())});
}

void ContactMpc::restart() {
  PathControl::restart();
  lmpc_.reset();
  sample_ = 0;
  wall_x_m_ = task().wall_x_m + design_.wall_error_m;
  depth_f_m_ = 0.0;
}

double ContactMpc::path_acceleration() {
  correct_wall(X_hat_[0] - wall_x_m_);
  if (sample_++ % samples_per_move_ == 0) {
    // The bounds are on a_x itself, so each optimisation starts from any last input.
    lmpc_.optimise(Eigen::Vector2d(X_hat_[0] - wall_x_m_, velocity_[0]));
  }
  return lmpc_.u()(0);
}

void ContactMpc::correct_wall(double depth_m) {
  // Where the tip is behind the told place without a force, the wall is further away.
  if (!touches() && !(depth_m > 0.0)) {
    depth_f_m_ = 0.0;
    return;
  }
  depth_f_m_ = forget_ * depth_f_m_ + (1.0 - forget_) * std::max(0.0, depth_m);
  const double force_depth_m = force_N_ / path().impact.stiffness_N_m;
  wall_x_m_ -= design_.wall_correction_per_s * arm().period_s * (force_depth_m - depth_f_m_);
}

}  // namespace breakwater
