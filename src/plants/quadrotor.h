// The underwater quadrotor: thesis 3.4.1.1.
#pragma once

#include <Eigen/Core>

#include <breakwater/linear/state_space.h>

namespace breakwater {

using Vector6d = Eigen::Matrix<double, 6, 1>;

/// Units of a pose ζ and of a motion [ζ; ζ̇] in a log.
inline constexpr const char* kPoseUnits = "m, m, m, rad, rad, rad";
inline constexpr const char* kMotionUnits =
    "m, m, m, rad, rad, rad, m/s, m/s, m/s, rad/s, rad/s, rad/s";

/// Table 3.4. Its buoyancy and weight follow from g = 9.806 m/s².
struct QuadrotorParameters {
  double mass_kg = 1.38;
  Eigen::Vector3d inertia_kgm2{0.8540, 0.8540, 0.9361};
  /// D(ζ̇) = linear·ζ̇ + quadratic·|ζ̇|·ζ̇ with the table's D_m, F_m for x, y, ψ and D_p, F_p for
  /// z, φ, θ, as in the printed D(ζ). Units: N/(m/s), N m/(rad/s); N/(m/s)², N m/(rad/s)².
  Vector6d linear_drag{0.0436, 0.0436, 0.0082, 0.0082, 0.0082, 0.0436};
  Vector6d quadratic_drag{0.0196, 0.0196, 0.1037, 0.1037, 0.1037, 0.0196};
  double thruster_arm_m = 0.1090;  ///< h
  double gravity_m_s2 = 9.806;     ///< g
  double water_density_kg_m3 = 1000.0;
  double volume_m3 = 0.0011;            ///< V_r
  double added_mass_coefficient = 0.0;  ///< C_a; the thesis has no added mass
  double thrust_limit_N = 25.0;         ///< T_lim of each thruster, in both directions

  double displaced_kg() const { return water_density_kg_m3 * volume_m3; }
  /// ρ V C_a: water that translates with the vehicle. It has inertia, but no weight.
  double added_mass_kg() const { return displaced_kg() * added_mass_coefficient; }
  double moving_mass_kg() const { return mass_kg + added_mass_kg(); }
  double buoyancy_N() const { return volume_m3 * water_density_kg_m3 * gravity_m_s2; }
  /// Net weight in water, mg − B = 2.7457 N: |G_z| of the table.
  double net_weight_N() const { return mass_kg * gravity_m_s2 - buoyancy_N(); }
  /// The diagonal of M: three times the moving mass, and the inertia.
  Vector6d inertia6() const;
  /// D(ζ̇) at a velocity relative to the water.
  Vector6d drag(const Vector6d& velocity) const;
};

enum class QuadrotorPhysics {
  physical,  ///< G = [0, 0, mg − B]; no Coriolis force in the world frame
  thesis     ///< G(ζ) and C(ζ̇) as printed, with a downward net weight
};

/// sin and cos of roll, pitch and yaw, shared by the model's terms.
struct AttitudeTrig {
  explicit AttitudeTrig(const Eigen::Ref<const Eigen::Vector3d>& roll_pitch_yaw);
  double sin_roll, cos_roll, sin_pitch, cos_pitch, sin_yaw, cos_yaw;
  /// The body's z axis in the world frame: the first column of E(ζ). Its first row has sin φ sin ψ
  /// (printed: sin θ sin ψ).
  Eigen::Vector3d thrust_axis() const;
};

/// The quadrotor's model in the thesis (Eqs. 3.13–3.15): M ζ̈ = E(ζ) U − D(ζ̇) − C − G(ζ) + F.
///
/// ζ = [x y z φ θ ψ]: position in the world with z up [m], and roll, pitch, yaw [rad] of R = Rz Ry
/// Rx. U = B_tcm T = [U_z τ_φ τ_θ τ_ψ] [N, N m]. F is an external force and torque. The angles'
/// rates count as the body's rates, which holds near level flight.
class QuadrotorModel {
 public:
  QuadrotorModel(const QuadrotorParameters& parameters, QuadrotorPhysics physics)
      : parameters_(parameters),
        physics_(physics),
        inverse_inertia_(parameters.inertia6().cwiseInverse()) {}

  /// G(ζ) and the translational part of C(ζ̇), in the world frame.
  Eigen::Vector3d weight_and_coriolis(const AttitudeTrig& attitude, const Vector6d& velocity) const;

  /// ζ̈ (Eq. 3.15).
  Vector6d acceleration(const AttitudeTrig& attitude, const Vector6d& velocity,
                        const Eigen::Vector4d& U, const Vector6d& outside = Vector6d::Zero()) const;

  /// ζ̈ of the rigid body. Unlike in acceleration(), drag, torques and the gyroscopic term act on
  /// its body rates ω = [p q r]. The angles' rates follow from φ̇ = p + ψ̇ sin θ, θ̇ = q cos φ − r
  /// sin φ, ψ̇ = (q sin φ + r cos φ)/cos θ. Near a pitch of ±90° the cosine is limited to 1e-6.
  Vector6d rigid_acceleration(const AttitudeTrig& attitude, const Vector6d& velocity,
                              const Eigen::Vector4d& U) const;

  const QuadrotorParameters& parameters() const { return parameters_; }
  QuadrotorPhysics physics() const { return physics_; }

 private:
  QuadrotorParameters parameters_;
  QuadrotorPhysics physics_;
  Vector6d inverse_inertia_;
};

/// B_tcm (thesis 3.4.1.1): U = B_tcm T.
Eigen::Matrix4d thruster_matrix(double arm_m);

/// Linear model of [ζ; ζ̇] near level rest, with six forces and torques as inputs and linear
/// friction. It is the design model of the DLQR (3.4.3.1).
StateSpace quadrotor_axes(const QuadrotorParameters& parameters);

/// Roll, pitch, yaw of a unit quaternion [w x y z].
Eigen::Vector3d roll_pitch_yaw(const Eigen::Ref<const Eigen::Vector4d>& quaternion);

/// φ̇, θ̇, ψ̇ from body rates. Near a pitch of ±90° the cosine is limited to 1e-6.
Eigen::Vector3d attitude_rates(const AttitudeTrig& attitude,
                               const Eigen::Ref<const Eigen::Vector3d>& body_rates);

}  // namespace breakwater
