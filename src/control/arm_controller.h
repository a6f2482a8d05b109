// The common part of the arm's controllers: estimation, kinematics, phases, torque, signals.
#pragma once

#include <Eigen/Core>
#include <limits>

#include <breakwater/control/acceleration_control.h>
#include <breakwater/control/controller.h>
#include <breakwater/plants/tip_chain.h>

namespace breakwater {

/// The task of the arm: hold a pose, then push along the first coordinate x with a force (2.4.3.2).
struct ArmTask {
  TipVector start_pose;  ///< X_0^ref (c); force control keeps all coordinates but the first
  Eigen::VectorXd start_angles_rad;  ///< q_0^ref: the posture, and the start of the observer
  double force_control_from_s = std::numeric_limits<double>::infinity();
  double force_reference_N = 0.0;  ///< F_x^ref, positive when the tip presses towards +x
  double convert_gain_N_m = 1.0;   ///< K_f of the implicit force control
  double force_lag_s = 0.0;        ///< τ_F, time constant of the force sensor's low-pass
  /// x of the wall's face, for controllers that are told it; infinite: there is none.
  double wall_x_m = std::numeric_limits<double>::infinity();
  /// The stiffness to the start angles of the motion that the tip does not feel, if there are more
  /// joints than held coordinates. Its damping is critical [1/s²].
  double k_posture = 25.0;
};

/// The data for a controller of the arm, without the true properties of the arm and the wall.
struct ArmSetup {
  TipChain chain;                          ///< the nominal kinematics
  AccelerationControlDesign acceleration;  ///< for the joints, with their observer
  ArmTask task;                            ///< the task, and the time at which force control begins
  double period_s = 0.0;                   ///< sampling period T_s
};

/// Expects samples y = [q (n) [rad]; F_x [N]; F_x before the sensor's low-pass [N]], where the last
/// entry is optional. Writes torques u (n) [N m]. A derived class chooses the acceleration of the
/// joints, and AccelerationControl realises it.
///
/// Implicit force control is x^ref = x + (F_x^ref − F_x)/K_f (Eqs. 2.60–2.62). It converts a force
/// error into a position error, so the position loop does not need the environment's stiffness.
///
/// The observer starts at q_0^ref, not at the measurement (2.4.3.1). The arm starts stretched: the
/// Jacobian is singular there, and the workspace controllers would never leave this pose.
class ArmController : public Controller {
  // Declared before the views of its estimates.
  ArmSetup arm_;
  AccelerationControl acceleration_control_;

 public:
  void reset(const Sample& first) final;
  void update(const Sample& y, Eigen::Ref<Eigen::VectorXd> u) final;

 protected:
  /// Throws std::invalid_argument if sizes differ, if there are fewer joints than held coordinates,
  /// or if K_f is not positive.
  explicit ArmController(const ArmSetup& arm);

  /// Forgets the run before this one. Called by reset().
  virtual void restart() {}
  /// Writes a^ref (n) [rad/s²] from the members below.
  virtual void decide(Eigen::Ref<Eigen::VectorXd> a) = 0;

  const ArmSetup& arm() const { return arm_; }
  const ArmTask& task() const { return arm_.task; }
  AccelerationControl& joints() { return acceleration_control_; }
  const AccelerationControl& joints() const { return acceleration_control_; }
  const TipKinematics& chain() const { return *arm_.chain; }
  /// J⁺ of this sample (n×c), damped near singular postures. Computed when it is first asked for.
  const Eigen::MatrixXd& damped_inverse();

  // The estimates and references of this sample, for decide().
  AccelerationControl::View q_hat_;
  AccelerationControl::View dq_hat_;
  AccelerationControl::View d_hat_;
  bool force_control_ = false;
  double force_N_ = 0.0;
  double raw_force_N_ = 0.0;  // before the sensor's low-pass
  TipVector X_hat_;           // forward kinematics of q̂
  TipVector X_ref_;           // the start pose, or implicit force control
  TaskJacobian J_;            // J_aco(q̂)

 private:
  void hold_posture();

  Eigen::VectorXd acceleration_ref_;
  Eigen::VectorXd posture_;
  Eigen::MatrixXd J_damped_;
  bool has_inverse_ = false;
};

}  // namespace breakwater
