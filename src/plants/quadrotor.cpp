#include <breakwater/plants/quadrotor.h>

#include <algorithm>
#include <cmath>

#include <breakwater/math/functions.h>

namespace breakwater {

Vector6d QuadrotorParameters::inertia6() const {
  Vector6d inertia;
  inertia << Eigen::Vector3d::Constant(moving_mass_kg()), inertia_kgm2;
  return inertia;
}

Vector6d QuadrotorParameters::drag(const Vector6d& velocity) const {
  return linear_drag.cwiseProduct(velocity) +
         quadratic_drag.cwiseProduct(velocity.cwiseAbs()).cwiseProduct(velocity);
}

AttitudeTrig::AttitudeTrig(const Eigen::Ref<const Eigen::Vector3d>& roll_pitch_yaw) {
  const auto set = [](double angle, double& sine, double& cosine) {
    const math::SineCosine both = math::sincos(angle);
    sine = both.sine;
    cosine = both.cosine;
  };
  set(roll_pitch_yaw(0), sin_roll, cos_roll);
  set(roll_pitch_yaw(1), sin_pitch, cos_pitch);
  set(roll_pitch_yaw(2), sin_yaw, cos_yaw);
}

Eigen::Vector3d AttitudeTrig::thrust_axis() const {
  return {sin_roll * sin_yaw + cos_roll * sin_pitch * cos_yaw,
          -sin_roll * cos_yaw + cos_roll * sin_pitch * sin_yaw, cos_roll * cos_pitch};
}

Eigen::Vector3d QuadrotorModel::weight_and_coriolis(const AttitudeTrig& attitude,
                                                    const Vector6d& velocity) const {
  const double weight = parameters_.net_weight_N();
  if (physics_ == QuadrotorPhysics::physical) return {0.0, 0.0, weight};
  const Eigen::Vector3d v = velocity.head<3>();
  const Eigen::Vector3d w = velocity.tail<3>();
  const Eigen::Vector3d coriolis(v(2) * w(1) - v(1) * w(2), v(0) * w(2) - v(2) * w(0),
                                 v(1) * w(0) - v(0) * w(1));
  const Eigen::Vector3d gravity(-attitude.sin_pitch, attitude.sin_roll * attitude.cos_pitch,
                                attitude.cos_roll * attitude.cos_pitch);
  return coriolis + weight * gravity;
}

Vector6d QuadrotorModel::acceleration(const AttitudeTrig& attitude, const Vector6d& velocity,
                                      const Eigen::Vector4d& U, const Vector6d& outside) const {
  Vector6d force = outside - parameters_.drag(velocity);
  force.head<3>() += U(0) * attitude.thrust_axis() - weight_and_coriolis(attitude, velocity);
  const Eigen::Vector3d& I = parameters_.inertia_kgm2;
  const Eigen::Vector3d w = velocity.tail<3>();
  force.tail<3>() +=
      U.tail<3>() - Eigen::Vector3d((I(2) - I(1)) * w(1) * w(2), (I(0) - I(2)) * w(0) * w(2),
                                    (I(1) - I(0)) * w(0) * w(1));
  return inverse_inertia_.cwiseProduct(force);
}

Vector6d QuadrotorModel::rigid_acceleration(const AttitudeTrig& attitude, const Vector6d& velocity,
                                            const Eigen::Vector4d& U) const {
  const AttitudeTrig& a = attitude;
  const double cos_pitch = std::copysign(std::max(std::abs(a.cos_pitch), 1e-6), a.cos_pitch);
  const double roll_rate = velocity(3), pitch_rate = velocity(4), yaw_rate = velocity(5);
  Vector6d of_body = velocity;
  of_body.tail<3>() << roll_rate - yaw_rate * a.sin_pitch,
      pitch_rate * a.cos_roll + yaw_rate * a.cos_pitch * a.sin_roll,
      -pitch_rate * a.sin_roll + yaw_rate * a.cos_pitch * a.cos_roll;
  Vector6d result = acceleration(attitude, of_body, U);
  const Eigen::Vector3d w = result.tail<3>();  // ω̇
  // Derivatives of the relations of the rates; q sin φ + r cos φ = ψ̇ cos θ.
  const double turning = w(1) * a.sin_roll + w(2) * a.cos_roll + roll_rate * pitch_rate;
  const double yaw = (turning + yaw_rate * pitch_rate * a.sin_pitch) / cos_pitch;
  result(3) = w(0) + yaw * a.sin_pitch + yaw_rate * pitch_rate * a.cos_pitch;
  result(4) = w(1) * a.cos_roll - w(2) * a.sin_roll - roll_rate * yaw_rate * a.cos_pitch;
  result(5) = yaw;
  return result;
}

Eigen::Matrix4d thruster_matrix(double arm_m) {
  const double h = arm_m;
  Eigen::Matrix4d B;
  B << 1, 1, 1, 1, -h, 0, h, 0, 0, h, 0, -h, h, -h, h, -h;
  return B;
}

StateSpace quadrotor_axes(const QuadrotorParameters& parameters) {
  const Vector6d inverse_inertia = parameters.inertia6().cwiseInverse();
  StateSpace axes;
  axes.A.setZero(12, 12);
  axes.A.topRightCorner<6, 6>().setIdentity();
  axes.A.bottomRightCorner<6, 6>() =
      (-inverse_inertia.cwiseProduct(parameters.linear_drag)).asDiagonal();
  axes.B.setZero(12, 6);
  axes.B.bottomRows<6>() = inverse_inertia.asDiagonal();
  axes.C.setIdentity(6, 12);
  return axes;
}

Eigen::Vector3d roll_pitch_yaw(const Eigen::Ref<const Eigen::Vector4d>& quaternion) {
  const double w = quaternion(0), x = quaternion(1), y = quaternion(2), z = quaternion(3);
  return {math::atan2(2.0 * (w * x + y * z), 1.0 - 2.0 * (x * x + y * y)),
          math::asin(std::clamp(2.0 * (w * y - z * x), -1.0, 1.0)),
          math::atan2(2.0 * (w * z + x * y), 1.0 - 2.0 * (y * y + z * z))};
}

Eigen::Vector3d attitude_rates(const AttitudeTrig& attitude,
                               const Eigen::Ref<const Eigen::Vector3d>& body_rates) {
  const double p = body_rates(0), q = body_rates(1), r = body_rates(2);
  const double cos_pitch =
      std::copysign(std::max(std::abs(attitude.cos_pitch), 1e-6), attitude.cos_pitch);
  const double turning = (q * attitude.sin_roll + r * attitude.cos_roll) / cos_pitch;
  return {p + attitude.sin_pitch * turning, q * attitude.cos_roll - r * attitude.sin_roll, turning};
}

}  // namespace breakwater
