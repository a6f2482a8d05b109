// Observer-based acceleration control of independent joints: thesis 2.4.2.1 and 2.4.2.7.
#pragma once

#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <memory>
#include <vector>

#include <breakwater/linear/pole_placement.h>
#include <breakwater/observers/disturbance_estimator.h>

namespace breakwater {

/// The torque that the observer gets.
enum class ObserverFeed {
  clipped,   ///< the torque after saturation, which really acted (the proposed method)
  unclipped  ///< the torque before saturation, as Eqs. 2.88 and 2.92 imply; winds up in saturation
};

struct AccelerationControlDesign {
  Eigen::VectorXd nominal_inertia_kgm2;  ///< diagonal of J_n, n
  /// M_n (n×n) of joints that are coupled; empty: they are independent, and M_n = J_n.
  Eigen::MatrixXd nominal_mass_matrix_kgm2 = {};
  Eigen::VectorXd torque_limit_Nm;  ///< τ_limit, n (Eq. 2.81)
  /// An estimator of all joints: x̂ = [q; q̇] (2n), d̂ (n), from torques and measured angles.
  std::shared_ptr<DisturbanceEstimator> observer;
  ObserverFeed feed = ObserverFeed::clipped;
};

/// An IDOB for each of n decoupled joints J_n q̈ = τ − d with measured angles (Eqs. 2.56–2.58).
/// Three poles [1/s] per joint. Throws std::invalid_argument as Idob does, or if sizes differ.
std::unique_ptr<DisturbanceEstimator> joint_idobs(const Eigen::VectorXd& nominal_inertia_kgm2,
                                                  const std::vector<PoleGroup>& poles,
                                                  double period_s);

/// Makes each joint of a manipulator a double integrator q̈ = a. It cancels the estimated
/// disturbance: coupling, friction and external torques (Eqs. 2.53–2.58; the thesis uses an IDOB):
///     τ = J_n a + τ̂_d   (Eq. 2.82; 2.88 and 2.92 must read so too).
/// Eq. 2.15 is this disturbance for one joint, with the other sign.
///
/// Joints that are coupled have a nominal mass matrix M_n. Then J_n is that of the observers alone.
/// They get J_n M_n⁻¹ τ as torque, and
///     τ = M_n (a + J_n⁻¹ τ̂_d).
///
/// Each sample: update(q), read the estimates, choose a, then command(a).
class AccelerationControl {
 public:
  /// Throws std::invalid_argument unless the sizes fit, inertias and limits are positive, and M_n
  /// is positive definite.
  explicit AccelerationControl(const AccelerationControlDesign& design);

  /// Starts the observer at rest at `q` with no disturbance.
  void reset(const Eigen::Ref<const Eigen::VectorXd>& q_rad);

  /// Updates the observer with the last command and the present measurement.
  void update(const Eigen::Ref<const Eigen::VectorXd>& measured_q_rad);

  /// The estimates of this sample, at addresses that do not change.
  using View = DisturbanceEstimator::View;
  View q_hat() const { return {observer_->state().data(), joints()}; }
  View dq_hat() const { return {observer_->state().data() + joints(), joints()}; }
  View d_hat() const { return observer_->disturbance(); }

  /// Bounds of limited_part() that keep a joint's torque within its limits: of the acceleration if
  /// the joints are independent (Eqs. 2.83, 2.84) [rad/s²].
  double lower(Eigen::Index joint) const { return bound(joint, -torque_limit_(joint)); }
  double upper(Eigen::Index joint) const { return bound(joint, torque_limit_(joint)); }
  /// The largest share of `more`, up to 1, that the limits leave beside an acceleration.
  double share_within_limits(const Eigen::Ref<const Eigen::VectorXd>& a_rad_s2,
                             const Eigen::Ref<const Eigen::VectorXd>& more_rad_s2);
  /// Makes an acceleration respect the bounds, each by itself.
  void limit(Eigen::Ref<Eigen::VectorXd> a_rad_s2);

  /// The part of an acceleration a that the drives limit: a, or M_n a if the joints are coupled.
  void limited_part(const Eigen::Ref<const Eigen::VectorXd>& a_rad_s2,
                    Eigen::Ref<Eigen::VectorXd> part) const;

  bool is_coupled() const { return mass_matrix_.size() > 0; }
  /// x becomes M_n⁻¹ x.
  void divide_by_mass(Eigen::Ref<Eigen::VectorXd> x) const { factor_.solveInPlace(x); }

  /// Writes the torque for the acceleration `a`.
  void command(const Eigen::Ref<const Eigen::VectorXd>& a_rad_s2,
               Eigen::Ref<Eigen::VectorXd> torque_Nm);

  Eigen::Index joints() const { return nominal_inertia_.size(); }
  const DisturbanceEstimator& observer() const { return *observer_; }

 private:
  double bound(Eigen::Index joint, double torque_Nm) const;

  Eigen::VectorXd nominal_inertia_;
  Eigen::VectorXd torque_limit_;
  Eigen::MatrixXd mass_matrix_;  // M_n of coupled joints
  Eigen::LLT<Eigen::MatrixXd> factor_;
  Eigen::VectorXd held_;  // M_n J_n⁻¹ d̂ of coupled joints
  Eigen::VectorXd torque_;
  Eigen::VectorXd more_;
  ObserverFeed feed_;
  std::shared_ptr<DisturbanceEstimator> observer_;
  Eigen::VectorXd fed_torque_;
  Eigen::VectorXd start_;  // [q; 0]
};

}  // namespace breakwater
