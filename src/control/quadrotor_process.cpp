#include <breakwater/control/quadrotor_process.h>

#include <stdexcept>

#include <breakwater/observers/resonator.h>

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
  return period_s_ * model_.acceleration(trig_, velocity, thruster_matrix_ * thrusts);
}

WaveResonators::WaveResonators(const QuadrotorModel& model, const ResonatorDesign& design,
                               double omega_rad_s, double period_s)
    : held_(model, period_s), design_(design) {
  const bool fits = design.damping > 0.0 && design.damping < 1.0 && design.force_std_N > 0.0 &&
                    design.velocity_std_m_s > 0.0 && design.rate_std_rad_s > 0.0 &&
                    design.bias_std_N > 0.0 && design.torque_std_Nm > 0.0;
  if (!fits) throw std::invalid_argument("resonators: damping 0 to 1, deviations positive");
  const auto square = [](double value) { return value * value; };
  A_.setIdentity();
  A_.block<6, 6>(0, 6).diagonal().setConstant(period_s);
  const Vector6d inverse_inertia = model.parameters().inertia6().cwiseInverse();
  A_.block<3, 3>(6, 12).diagonal() = period_s * inverse_inertia.head<3>();
  A_.block<3, 3>(6, 15).diagonal() = period_s * inverse_inertia.head<3>();
  A_.block<3, 3>(9, 18).diagonal() = period_s * inverse_inertia.tail<3>();
  Q_.setZero();
  Q_.diagonal().segment<3>(6).setConstant(square(design.velocity_std_m_s));
  Q_.diagonal().segment<3>(9).setConstant(square(design.rate_std_rad_s));
  Q_.diagonal().segment<3>(15).setConstant(square(design.bias_std_N));
  Q_.diagonal().segment<3>(18).setConstant(square(design.torque_std_Nm));
  set_frequency(omega_rad_s);
}

void WaveResonators::set_frequency(double omega_rad_s) {
  if (!(omega_rad_s > 0.0))
    throw std::invalid_argument("resonators: the frequency must be positive");
  const double period_s = held_.period_s();
  const Eigen::Matrix2d step = resonator_step(omega_rad_s, design_.damping, period_s);
  A_.block<3, 3>(12, 12).diagonal().setConstant(step(0, 0));
  A_.block<3, 3>(12, 21).diagonal().setConstant(step(0, 1));
  A_.block<3, 3>(21, 12).diagonal().setConstant(step(1, 0));
  A_.block<3, 3>(21, 21).diagonal().setConstant(step(1, 1));
  Q_.diagonal().segment<3>(21).setConstant(
      resonator_noise(omega_rad_s, design_.damping, design_.force_std_N, period_s));
}

}  // namespace breakwater
