#include <breakwater/sim/underwater_force.h>

#include <Eigen/Geometry>
#include <stdexcept>

#include <breakwater/math/functions.h>

namespace breakwater {

ChangingSea WaveLoadSetup::water() const {
  return {sea, low_pass_s, {change_at_s, change_to_period_s, change_within_s}};
}

Eigen::Vector3d wave_force(const QuadrotorParameters& parameters, const WaveLoadSetup& setup,
                           const WaterMotion& water, const Eigen::Vector3d& velocity) {
  Vector6d still = Vector6d::Zero();
  still.head<3>() = velocity;
  Vector6d relative = still;
  relative.head<3>() -= water.velocity + setup.current_m_s;
  const Vector6d drag = parameters.drag(still) - parameters.drag(relative);
  return drag.head<3>() +
         parameters.displaced_kg() * setup.inertia_coefficient * water.acceleration;
}

FreeMotion::FreeMotion(const double* qpos, const double* qvel)
    : position(qpos[0], qpos[1], qpos[2]),
      velocity(qvel[0], qvel[1], qvel[2]),
      body_rates(qvel[3], qvel[4], qvel[5]),
      rotation(
          Eigen::Quaterniond(qpos[3], qpos[4], qpos[5], qpos[6]).normalized().toRotationMatrix()),
      euler(roll_pitch_yaw(Eigen::Vector4d(qpos[3], qpos[4], qpos[5], qpos[6]).normalized())) {}

UnderwaterForce::UnderwaterForce(const Model& model, const QuadrotorParameters& parameters,
                                 QuadrotorPhysics physics, const WaveLoadSetup& waves,
                                 const Eigen::Vector3d& start)
    : parameters_(parameters),
      still_water_(parameters, physics),
      setup_(waves),
      start_(start),
      sea_(waves.water()),
      angle_{LowPass(waves.low_pass_s, model->opt.timestep),
             LowPass(waves.low_pass_s, model->opt.timestep)},
      body_(model.id(mjOBJ_BODY, "quadrotor")),
      qpos_(0),
      dof_(0) {
  const int joint = model->body_jntadr[body_];
  if (joint < 0 || model->jnt_type[joint] != mjJNT_FREE) {
    throw std::invalid_argument(model.file() + ": body \"quadrotor\" needs a free joint");
  }
  qpos_ = model->jnt_qposadr[joint];
  dof_ = model->jnt_dofadr[joint];
}

double UnderwaterForce::thesis_force(double time_s) const {
  return parameters_.displaced_kg() * setup_.inertia_coefficient *
         sea_.water(time_s, start_).acceleration.z();
}

Vector6d UnderwaterForce::wave_load(double time_s, const FreeMotion& motion) const {
  Vector6d load = Vector6d::Zero();
  if (setup_.mode == WaveMode::thesis) {
    load.head<3>() = thesis_force(time_s) * motion.rotation.col(2);
    load.tail<3>() = motion.rotation * Eigen::Vector3d(angle_[0].value(), angle_[1].value(), 0.0) *
                     setup_.torque_per_angle_Nm_rad;
    return load;
  }
  const WaterMotion water = sea_.water(time_s, motion.position);
  load.head<3>() = wave_force(parameters_, setup_, water, motion.velocity);
  const Eigen::Vector3d pressure(-parameters_.buoyancy_N() * water.slope.x(),
                                 -parameters_.buoyancy_N() * water.slope.y(), 0.0);
  load.tail<3>() = setup_.buoyancy_arm_m * motion.rotation.col(2).cross(pressure);
  return load;
}

void UnderwaterForce::advance(double time_s, const FreeMotion& motion) {
  if (setup_.mode != WaveMode::thesis) return;
  const double d_z = thesis_force(time_s);
  if (d_z == 0.0) return;  // the angle is undefined
  const Eigen::Vector3d force = d_z * motion.rotation.col(2);
  angle_[0].update(math::atan2(force.y(), force.z()));
  angle_[1].update(math::atan2(force.x(), force.z()));
}

void UnderwaterForce::apply(double time_s, const mjModel&, mjData& data) {
  const FreeMotion motion(data.qpos + qpos_, data.qvel + dof_);
  const AttitudeTrig attitude(motion.euler);
  Vector6d velocity;
  velocity << motion.velocity, attitude_rates(attitude, motion.body_rates);
  Vector6d load = wave_load(time_s, motion);
  // The engine adds the weight of its body, which has the added mass too. Neither counts twice.
  load.head<3>() -= still_water_.weight_and_coriolis(attitude, velocity);
  load(2) += parameters_.moving_mass_kg() * parameters_.gravity_m_s2;
  Vector6d drag_velocity;
  drag_velocity << motion.velocity, motion.body_rates;
  const Vector6d drag = parameters_.drag(drag_velocity);
  load.head<3>() -= drag.head<3>();
  load.tail<3>() -= motion.rotation * drag.tail<3>();
  Eigen::Map<Vector6d>(data.xfrc_applied + static_cast<std::ptrdiff_t>(6) * body_) += load;
}

}  // namespace breakwater
