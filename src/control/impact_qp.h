// Impact-aware control: a quadratic program whose constraints foresee an impact.
#pragma once

#include <breakwater/control/energy_admittance.h>
#include <breakwater/linear/active_set.h>

namespace breakwater {

struct ImpactQpDesign {
  PathDesign path;
  Admittance admittance;
  double approach_speed_m_s = 0.5;  ///< v^ref of the task, before the constraints
  double preview_s = 1e-3;          ///< T_p: an impact may happen so long after this sample
  double restitution = 1.0;         ///< e of the impact
  double expected_from_m = 0.0;     ///< x from the start pose, from which an impact is foreseen
                                    ///< (a small negative one: always, also if the tip drifts)
  double posture_weight = 1e-6;     ///< ε: weight on the joint accelerations
};

/// The program of one sample:
///     minimise ½ ‖J q̈ − b‖² + ½ ε ‖q̈‖²,
/// where b is the wanted acceleration of the tip without J̇ q̇, subject to
///     lower ≤ q̈_i ≤ upper                           torque and velocity limits of each joint,
///     |(I − (1 + e) m J_n⁻¹ J_xᵀ J_x)(q̇ + T_p q̈)| ≤ q̇_max    velocity after a possible impact,
///     √(K m) J_x (q̇ + T_p q̈) ≤ F_max                 its force.
/// F_max is the smaller of F_peak and of the τ_lim,i/|J_x,i|. The jump of the velocity is that of a
/// rigid impact along x with the effective mass m = 1/(J_x J_n⁻¹ J_xᵀ). The rows of the impact are
/// soft, because the torques may not suffice to brake within T_p.
class ImpactProgram {
 public:
  /// Throws std::invalid_argument as ActiveSetQp does.
  ImpactProgram(const ArmSetup& arm, const ImpactQpDesign& design);

  struct State {
    const TaskJacobian& J;
    const Eigen::Ref<const Eigen::VectorXd>& dq;  ///< q̇, n
    const TipVector& wanted;                      ///< b
    /// Bounds of q̈ by the torque limits, n. For coupled joints they are those of M_n q̈ [N m], and
    /// the limits of the velocity must be infinite.
    const Eigen::VectorXd& lower;
    const Eigen::VectorXd& upper;
    const Eigen::VectorXd& recoil;  ///< M_n⁻¹ J_xᵀ (n) of coupled joints
    double mass_kg = 0.0;
    bool foresees_impact = true;  ///< whether the rows of the impact count
  };

  /// Returns q̈ (n). Allocates nothing. Throws ControlFailure if there is no solution.
  const Eigen::VectorXd& solve(const State& state);

  const ActiveSetQp& solver() const { return solver_; }
  const QpInput& input() const { return input_; }
  const QpSolution& solution() const { return solution_; }
  /// The force of a possible impact after the last solution [N].
  const double& foreseen_force_N() const { return foreseen_force_N_; }

 private:
  ArmSetup arm_;
  ImpactQpDesign design_;
  QpModel model_;
  ActiveSetQp solver_;
  QpInput input_;
  QpSolution solution_;
  Eigen::VectorXd after_;  // a row of the map to the velocities after the impact
  double foreseen_force_N_ = 0.0;
};

/// A controller that solves an ImpactProgram in each sample. Before contact its task is a speed
/// v^ref towards the wall; in contact it is an Admittance. y and φ are held.
///
/// Source: Y. Wang, N. Dehio, A. Tanguy, A. Kheddar, Int. J. Robotics Research 42 (2023) 1265–1282.
/// docs/explanation/methods/published-impact-control.md says what differs.
class ImpactQp final : public PathControl {
 public:
  /// Throws std::invalid_argument as the parts do, or if the speed, T_p or ε is not positive, or e
  /// is not between 0 and 1.
  ImpactQp(const ArmSetup& arm, const ImpactQpDesign& design);

 private:
  void decide(Eigen::Ref<Eigen::VectorXd> a) override;
  double path_acceleration() override;

  ImpactQpDesign design_;
  ImpactProgram program_;
  Eigen::VectorXd lower_, upper_;
  double along_wanted_ = 0.0;

  double iterations_ = 0.0;  // for the log
};

}  // namespace breakwater
