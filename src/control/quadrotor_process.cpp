#include <breakwater/control/quadrotor_process.h>

#include <breakwater/math/refuse_unless.h>

namespace breakwater {

Vector6d HeldThrust::velocity_step(
    const Eigen::Ref<const Eigen::Matrix<double, 12, 1>>& pose_and_velocity,
    const Eigen::Vector4d& thrusts) const {
  const Eigen::Vector3d angles = pose_and_velocity.segment<3>(3);
  if (angles != angles_) {
    angles_ = angles;
    trig_ = AttitudeTrig(angles);
  }
  const Vector6d velocity = pose_and_velocity.tail<6>();
  const Eigen::Vector4d U = thruster_matrix_ * thrusts;
  return period_s_ * (kinematics_ == AttitudeKinematics::exact
                          ? model_.rigid_acceleration(trig_, velocity, U)
                          : model_.acceleration(trig_, velocity, U));
}

template <int K, int Order>
WaveForces<K, Order>::WaveForces(const QuadrotorModel& model, const ProcessNoiseStd& noise,
                                 const Resonators& resonators, double horizontal_share,
                                 double period_s, AttitudeKinematics kinematics)
    : held_(model, period_s, kinematics), horizontal_share_(horizontal_share) {
  refuse_unless(noise.velocity_std_m_s > 0.0 && noise.rate_std_rad_s > 0.0 &&
                    noise.bias_std_N > 0.0 && horizontal_share > 0.0,
                "resonators: the standard deviations must be positive");
  const auto square = [](double value) { return value * value; };
  A_.setIdentity();
  A_.template block<6, 6>(0, 6).diagonal().setConstant(period_s);
  const Vector6d inverse_inertia = model.parameters().inertia6().cwiseInverse();
  const Eigen::Vector3d push = period_s * inverse_inertia.head<3>();
  for (int i = 0; i < K; ++i) A_.template block<3, 3>(6, force_row(i)).diagonal() = push;
  A_.template block<3, 3>(6, kBias).diagonal() = push;
  A_.template block<3, 3>(9, kTorque).diagonal() = period_s * inverse_inertia.tail<3>();
  if constexpr (Order == 2) {
    A_.template topRightCorner<6, kStates - 12>() =
        0.5 * period_s * A_.template block<6, kStates - 12>(6, 12);
  }
  Q_.setZero();
  Q_.diagonal().template segment<3>(6).setConstant(square(noise.velocity_std_m_s));
  Q_.diagonal().template segment<3>(9).setConstant(square(noise.rate_std_rad_s));
  Q_.diagonal().template segment<3>(kBias).setConstant(square(noise.bias_std_N));
  set_torque_noise(noise.torque_std_Nm);
  set_resonators(resonators);
}

template <int K, int Order>
void WaveForces<K, Order>::set_resonators(const Resonators& resonators) {
  const double period_s = held_.period_s();
  for (int i = 0; i < K; ++i) {
    const Resonator& r = resonators[static_cast<std::size_t>(i)];
    refuse_unless(
        r.omega_rad_s > 0.0 && r.damping > 0.0 && r.damping < 1.0 && r.std > 0.0,
        "resonators: frequency and deviation must be positive, the damping between 0 and 1");
    const int f = force_row(i), h = rate_row(i);
    const Eigen::Matrix2d step = resonator_step(r.omega_rad_s, r.damping, period_s);
    A_.template block<3, 3>(f, f).diagonal().setConstant(step(0, 0));
    A_.template block<3, 3>(f, h).diagonal().setConstant(step(0, 1));
    A_.template block<3, 3>(h, f).diagonal().setConstant(step(1, 0));
    A_.template block<3, 3>(h, h).diagonal().setConstant(step(1, 1));
    const double noise = resonator_noise(r.omega_rad_s, r.damping, r.std, period_s);
    Q_.diagonal().template segment<3>(h) << horizontal_share_ * noise, horizontal_share_ * noise,
        noise;
  }
}

template <int K, int Order>
void WaveForces<K, Order>::set_torque_noise(double std_Nm) {
  refuse_unless(std_Nm > 0.0, "resonators: the torques' walk must be positive");
  Q_.diagonal().template segment<3>(kTorque).setConstant(std_Nm * std_Nm);
}

template class WaveForces<1, 1>;
template class WaveForces<2, 2>;

}  // namespace breakwater
