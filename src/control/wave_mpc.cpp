#include <breakwater/control/wave_mpc.h>

#include <algorithm>
#include <utility>

#include <breakwater/linear/riccati.h>
#include <breakwater/math/refuse_unless.h>

namespace breakwater {
namespace {

LmpcDesign axis_problem(const StateSpace& sampled, const WaveMpcDesign& design, double r,
                        double lower, double upper) {
  const Eigen::Index n = sampled.states();
  const Eigen::MatrixXd change = Eigen::MatrixXd::Constant(1, 1, r);
  LmpcDesign lmpc;
  lmpc.A = sampled.A;
  lmpc.B = sampled.B.col(0);
  lmpc.prediction_steps = lmpc.control_steps = design.prediction_steps;
  Eigen::VectorXd weights = Eigen::VectorXd::Zero(n);
  weights.head<2>() << 1.0, design.q_velocity;
  lmpc.Q = weights.asDiagonal();
  // The regulator with changes of the input has the states [x; u].
  Eigen::MatrixXd A = Eigen::MatrixXd::Identity(n + 1, n + 1);
  A.topLeftCorner(n, n) = lmpc.A;
  A.topRightCorner(n, 1) = lmpc.B;
  Eigen::MatrixXd B = Eigen::MatrixXd::Ones(n + 1, 1);
  B.topRows(n) = lmpc.B;
  Eigen::MatrixXd Q = Eigen::MatrixXd::Zero(n + 1, n + 1);
  Q.topLeftCorner(n, n) = lmpc.Q;
  lmpc.Q_last = dlqr(A, B, Q, change).P.topLeftCorner(n, n);
  lmpc.R = change;
  lmpc.input_bounds.push_back({0, lower, upper, first_steps(design.prediction_steps)});
  return lmpc;
}

}  // namespace

StateSpace horizontal_axis(const QuadrotorParameters& parameters, double alpha, double alpha_rate) {
  const double m = parameters.moving_mass_kg();
  const double stiffness = 1.0 + alpha * alpha_rate;
  StateSpace axis;
  axis.A.setZero(4, 4);
  axis.A(0, 1) = 1.0;
  axis.A(1, 1) = -parameters.linear_drag(0) / m;
  axis.A(1, 2) = 1.0 / m;
  axis.A(2, 3) = 1.0;
  axis.A.row(3) << 0.0, 0.0, -stiffness, -(alpha + alpha_rate);
  axis.B.setZero(4, 2);
  axis.B(3, 0) = stiffness;
  axis.B(1, 1) = 1.0 / m;
  axis.C.setIdentity(1, 4);
  return axis;
}

StateSpace vertical_axis(const QuadrotorParameters& parameters) {
  const double m = parameters.moving_mass_kg();
  StateSpace axis;
  axis.A = (Eigen::Matrix2d() << 0.0, 1.0, 0.0, -parameters.linear_drag(2) / m).finished();
  axis.B = (Eigen::Matrix2d() << 0.0, 0.0, 1.0 / m, 1.0 / m).finished();
  axis.C.setIdentity(1, 2);
  return axis;
}

AxisMpc::AxisMpc(const StateSpace& axis, const WaveMpcDesign& design, double r, double lower,
                 double upper)
    : sampled_(zero_order_hold(axis, design.period_s)),
      lower_(lower),
      upper_(upper),
      lmpc_(axis_problem(sampled_, design, r, lower, upper)),
      pushed_(Eigen::VectorXd::Zero(axis.states())),
      next_(pushed_) {}

double AxisMpc::input(const Eigen::Ref<const Eigen::VectorXd>& state,
                      const Eigen::Ref<const Eigen::RowVectorXd>& disturbance) {
  const Eigen::Index n = sampled_.states();
  pushed_.setZero();
  for (Eigen::Index i = 0; i + 1 < disturbance.size(); ++i) {
    next_.noalias() = sampled_.A * pushed_;
    next_ += 0.5 * (disturbance(i) + disturbance(i + 1)) * sampled_.B.col(1);
    pushed_ = next_;
    lmpc_.reference().segment(n * i, n) = -pushed_;
  }
  lmpc_.optimise(state);
  double& input = lmpc_.u()(0);
  input = std::clamp(input, lower_, upper_);
  return input;
}

WaveMpc::WaveMpc(const Backstepping& law, std::shared_ptr<QuadrotorEstimator> estimator,
                 std::unique_ptr<ForceForecast> forecast, const WaveMpcDesign& design,
                 double sampling_s)
    : QuadrotorController(law, std::move(estimator)),
      forecast_(std::move(forecast)),
      samples_per_move_(samples_per_move(design.period_s, sampling_s)),
      x_(horizontal_axis(law.nominal().parameters(), law.design().alpha(3), law.design().alpha(9)),
         design, design.r_horizontal, -law.largest_tilt_force_N(), law.largest_tilt_force_N()),
      y_(horizontal_axis(law.nominal().parameters(), law.design().alpha(4), law.design().alpha(10)),
         design, design.r_horizontal, -law.largest_tilt_force_N(), law.largest_tilt_force_N()),
      z_(vertical_axis(law.nominal().parameters()), design, design.r_vertical,
         law.design().thrust_floor_N - law.nominal().parameters().net_weight_N(),
         2.0 * law.nominal().parameters().thrust_limit_N),
      forces_(ForceTable::Zero(3, design.prediction_steps + 1)) {
  refuse_unless(
      this->estimator().models_world_force(),
      "wave prediction: the estimator must model a force in the world: resonator or spectrum");
  publish({"force_forecast_N", "N", "disturbing force at the end of the horizon, as foreseen",
           view(furthest_)});
  publish({"qp_iterations", "1", "changes of the active sets of all axes", view(iterations_)});
}

void WaveMpc::reset(const Sample& first) {
  QuadrotorController::reset(first);
  forecast_->reset(first.time_s);
  for (AxisMpc* axis : {&x_, &y_, &z_}) axis->reset();
  sample_ = 0;
  held_.setZero();
}

void WaveMpc::move(double time_s) {
  const AttitudeTrig attitude(motion_.segment<3>(3));
  const double clamp_m = law().position_clamp_m();
  const Eigen::Vector3d off =
      (motion_.head<3>() - law().design().reference.head<3>()).cwiseMax(-clamp_m).cwiseMin(clamp_m);
  forecast_->update(time_s, estimator(), forces_);
  furthest_ = forces_.rightCols<1>();
  held_.z() = z_.input(Eigen::Vector2d(off.z(), motion_(8)), forces_.row(2));
  // The tilt gives the horizontal force, and its rate too; near level and for a small yaw.
  const double up = held_.z() + law().nominal().parameters().net_weight_N();
  const Eigen::Vector3d tilt = attitude.thrust_axis();
  held_.x() = x_.input(Eigen::Vector4d(off.x(), motion_(6), up * tilt.x(), up * motion_(10)),
                       forces_.row(0));
  held_.y() = y_.input(Eigen::Vector4d(off.y(), motion_(7), up * tilt.y(), -up * motion_(9)),
                       forces_.row(1));
  iterations_ = x_.lmpc().iterations() + y_.lmpc().iterations() + z_.lmpc().iterations();
}

Eigen::Vector4d WaveMpc::wrench(double time_s) {
  if (sample_++ % samples_per_move_ == 0) move(time_s);
  const AttitudeTrig attitude(motion_.segment<3>(3));
  return law().wrench_of_force(
      motion_, attitude, held_ + law().nominal().weight_and_coriolis(attitude, Vector6d::Zero()));
}

}  // namespace breakwater
