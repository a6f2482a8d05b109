#include <breakwater/control/arm_controller.h>

#include <stdexcept>
#include <utility>

namespace breakwater {
ArmController::ArmController(const PlanarChain& chain, const AccelerationControlDesign& design,
                             ArmTask task)
    : chain_(chain),
      acceleration_control_(design),
      q_hat_(acceleration_control_.q_hat()),
      dq_hat_(acceleration_control_.dq_hat()),
      d_hat_(acceleration_control_.d_hat()),
      J_(3, chain.joints()),
      task_(std::move(task)),
      half_period_s_(0.5 * design.period_s),
      acceleration_ref_(Eigen::VectorXd::Zero(chain.joints())) {
  if (design.nominal_inertia_kgm2.size() != chain.joints() ||
      task_.start_angles_rad.size() != chain.joints()) {
    throw std::invalid_argument("arm controller: needs one inertia and start angle per joint");
  }
  if (!(task_.convert_gain_N_m > 0.0)) {
    throw std::invalid_argument("arm controller: the convert gain K_f must be positive");
  }
  publish({"q_hat_rad", "rad", "joint angles, estimated (Eq. 2.54)", view(q_hat_)});
  publish({"dq_hat_rad_s", "rad/s", "joint velocities, estimated", view(dq_hat_)});
  publish({"d_hat_Nm", "N m", "disturbance torques, estimated, opposing motion (Eq. 2.53)",
           view(d_hat_)});
  publish({"x_hat_m", "m", "tip x, from the estimated angles", view(X_hat_[0])});
  publish({"y_hat_m", "m", "tip y, from the estimated angles", view(X_hat_[1])});
  publish({"phi_hat_rad", "rad", "tip angle, from the estimated angles", view(X_hat_[2])});
  publish({"x_ref_m", "m", "tip x reference (Eq. 2.62 in force control)", view(X_ref_[0])});
  publish({"y_ref_m", "m", "tip y reference", view(X_ref_[1])});
  publish({"phi_ref_rad", "rad", "tip angle reference", view(X_ref_[2])});
  publish({"ddq_ref_rad_s2", "rad/s^2", "joint acceleration references", view(acceleration_ref_)});
  for (const Signal& signal : signals_of(joints().observer(), "rad")) publish(signal);
}

void ArmController::reset(const Sample&) {
  acceleration_control_.reset(task_.start_angles_rad);
  restart();
}

void ArmController::update(const Sample& y, Eigen::Ref<Eigen::VectorXd> u) {
  const Eigen::Index n = chain_.joints();
  force_control_ = y.time_s >= task_.force_control_from_s - half_period_s_;
  force_N_ = y.y(n);
  raw_force_N_ = y.y.size() > n + 1 ? y.y(n + 1) : force_N_;
  acceleration_control_.update(y.y.head(n));
  X_hat_ = chain_.tip_pose(q_hat_);
  chain_.tip_jacobian(q_hat_, J_);
  X_ref_ = task_.start_pose;
  if (force_control_) X_ref_[0] = implicit_force_reference_m(task_, X_hat_[0], force_N_);

  decide(acceleration_ref_);
  acceleration_control_.command(acceleration_ref_, u);
}

}  // namespace breakwater
