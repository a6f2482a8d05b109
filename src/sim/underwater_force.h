// Buoyancy, drag and waves on the quadrotor.
#pragma once

#include <array>

#include <breakwater/plants/quadrotor.h>
#include <breakwater/sim/external_force.h>
#include <breakwater/sim/model.h>
#include <breakwater/world/low_pass.h>
#include <breakwater/world/waves.h>

namespace breakwater {

enum class WaveMode {
  physical,  ///< Morison's equation with the water's motion around the vehicle
  thesis     ///< a scalar force along the body's z axis; torques by atan2
};

struct WaveLoadSetup {
  WaveMode mode = WaveMode::physical;
  SeaState sea;
  Eigen::Vector3d current_m_s = Eigen::Vector3d::Zero();  ///< constant; physical mode only
  double inertia_coefficient = 1.5;                       ///< C_m; 1 + C_a if there is added mass
  double buoyancy_arm_m = 0.05;  ///< z_B: height of the waves' pressure force above the mass
  double low_pass_s = 0.32;      ///< low-pass of the slope or the angle, before the torque
  double torque_per_angle_Nm_rad = 0.1;  ///< thesis
  double change_at_s = 0.0;              ///< time at which the peak period changes; 0: never
  double change_to_period_s = 0.0;       ///< the new peak period
  double change_within_s = 10.0;         ///< duration of the change

  /// The water of the sea with its change. Throws std::invalid_argument as Waves does.
  ChangingSea water() const;
};

/// Force of the waves and the current on a vehicle with this velocity, in the world [N]:
///     F = ρ V C_m a + D(v) − D(v − u).
Eigen::Vector3d wave_force(const QuadrotorParameters& parameters, const WaveLoadSetup& setup,
                           const WaterMotion& water, const Eigen::Vector3d& velocity);

/// Motion of a rigid body with the engine's free joint.
struct FreeMotion {
  FreeMotion(const double* qpos, const double* qvel);
  Eigen::Vector3d position;
  Eigen::Vector3d velocity;    ///< in the world
  Eigen::Vector3d body_rates;  ///< in the body
  Eigen::Matrix3d rotation;    ///< body to world
  Eigen::Vector3d euler;       ///< roll, pitch, yaw
};

/// All forces on the quadrotor except thrust and the engine's gravity: the rest of Eq. 3.15, and F.
///
/// Physical waves: with the water's velocity u and acceleration a at the vehicle,
///     F = ρ V C_m a + D(v) − D(v − u),   τ = z_B e_z × (−ρ g V s),
/// Together with the drag −D(v) in still water, this is the drag of the relative velocity. s is the
/// low-passed slope of the pressure.
///
/// Waves of the thesis (3.4.1.2): d_z = ρ V C_m a_z at the start position, F = d_z e_z and
///     τ_φ = K LP(atan2(F_y, F_z)),   τ_θ = K LP(atan2(F_x, F_z)),
/// with the body's z axis e_z. The angle jumps by π when d_z changes its sign. Its low-pass is a
/// state: advance() updates it once a step.
///
/// The drag −D acts on the velocity in the world frame and on the body's rates.
class UnderwaterForce final : public ExternalForce {
 public:
  /// The model needs a free body "quadrotor", whose mass in the model includes the added mass.
  /// `start` is the position for the thesis' scalar wave.
  /// Throws std::invalid_argument if there is no such body or the sea state is invalid.
  UnderwaterForce(const Model& model, const QuadrotorParameters& parameters,
                  QuadrotorPhysics physics, const WaveLoadSetup& waves,
                  const Eigen::Vector3d& start);

  void apply(double time_s, const mjModel& model, mjData& data) override;

  /// Force and torque of the waves and the current, in the world frame [N, N m].
  Vector6d wave_load(double time_s, const FreeMotion& motion) const;
  /// The elevation η at a position [m].
  double elevation(double time_s, double x_m, double y_m) const {
    return sea_.elevation(time_s, x_m, y_m);
  }

  /// Call it once after each step, with the state at its end.
  void advance(double time_s, const FreeMotion& motion);

 private:
  double thesis_force(double time_s) const;

  QuadrotorParameters parameters_;
  QuadrotorModel still_water_;
  WaveLoadSetup setup_;
  Eigen::Vector3d start_;
  ChangingSea sea_;
  std::array<LowPass, 2> angle_;
  int body_;
  int qpos_;
  int dof_;
};

}  // namespace breakwater
