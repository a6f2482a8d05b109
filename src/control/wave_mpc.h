// Predictive control of the quadrotor's position with a forecast of the disturbing force.
#pragma once

#include <memory>

#include <breakwater/control/backstepping.h>
#include <breakwater/control/force_forecast.h>
#include <breakwater/control/lmpc.h>

namespace breakwater {

struct WaveMpcDesign {
  double period_s = 0.1;      ///< T: from one optimisation to the next
  int prediction_steps = 30;  ///< N_p = N_u
  double q_velocity = 0.3;    ///< weight on the velocity; that on the position is 1
  double r_horizontal = 0.2;  ///< weight on the change of the horizontal force in one step
  double r_vertical = 0.2;    ///< the same of the vertical force
};

/// The model of a horizontal axis, [p, v, g, ġ] with the force g that the tilt gives:
///     ṗ = v,  m v̇ = −D v + g + w,  g̈ = κ (u − g) − c ġ,   κ = 1 + α α',  c = α + α',
/// with the linear drag D, the disturbance w and the attitude's gains α and α' (Backstepping). The
/// inputs are u and w.
StateSpace horizontal_axis(const QuadrotorParameters& parameters, double alpha, double alpha_rate);
/// The vertical axis, [p, v] with m v̇ = −D v + u + w and the same inputs.
StateSpace vertical_axis(const QuadrotorParameters& parameters);

/// Linear predictive control of one axis that starts from u(k−1). With the forecast w_0 … w_{N_p},
/// whose mean over a step is w̅_i = (w_i + w_{i+1})/2, it minimises
///     Σ p_i² + q_v v_i² + r Δu_i²   for   x_{i+1} = A x_i + B u_i + E w̅_i
/// with lower ≤ u_i ≤ upper. The last weight is the regulator's Riccati solution for the state.
class AxisMpc {
 public:
  /// `axis` is horizontal_axis() or vertical_axis(). Throws std::invalid_argument as Lmpc does.
  AxisMpc(const StateSpace& axis, const WaveMpcDesign& design, double r, double lower,
          double upper);

  void reset() { lmpc_.reset(); }
  /// The next input from the state, whose position is relative to the reference, and the forecast
  /// (N_p + 1). Allocates nothing. Throws ControlFailure as Lmpc does.
  double input(const Eigen::Ref<const Eigen::VectorXd>& state,
               const Eigen::Ref<const Eigen::RowVectorXd>& disturbance);

  const Lmpc& lmpc() const { return lmpc_; }

 private:
  StateSpace sampled_;
  double lower_;
  double upper_;
  Lmpc lmpc_;
  Eigen::VectorXd pushed_;  // the disturbance's own response in one step
  Eigen::VectorXd next_;
};

/// Predictive control of the position; the attitude has the gains of Backstepping. The forces of
/// the three axes are optimised in each period T and held between. A position error counts up to
/// the clamp. The bounds keep U_z between the thrust floor and half of all thrust. They keep the
/// horizontal forces within the largest tilt at the weight in water.
///
/// docs/explanation/methods/published-wave-control.md.
class WaveMpc final : public QuadrotorController {
 public:
  /// Throws std::invalid_argument as the parts do. The period must be a multiple of `sampling_s`,
  /// and the estimator must model a force in the world.
  WaveMpc(const Backstepping& law, std::shared_ptr<QuadrotorEstimator> estimator,
          std::unique_ptr<ForceForecast> forecast, const WaveMpcDesign& design, double sampling_s);

  void reset(const Sample& first) override;

 private:
  Eigen::Vector4d wrench(double time_s) override;
  void move(double time_s);

  std::unique_ptr<ForceForecast> forecast_;
  int samples_per_move_;
  std::int64_t sample_ = 0;
  AxisMpc x_, y_, z_;
  ForceTable forces_;
  Eigen::Vector3d held_ = Eigen::Vector3d::Zero();      // the vehicle's own force, without weight
  Eigen::Vector3d furthest_ = Eigen::Vector3d::Zero();  // forecast at the end of the horizon
  double iterations_ = 0.0;
};

}  // namespace breakwater
