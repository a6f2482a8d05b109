#include <breakwater/control/arm_controller.h>

#include <cmath>

#include <breakwater/linear/pseudo_inverse.h>
#include <breakwater/math/refuse_unless.h>

namespace breakwater {
namespace {

constexpr double kSingularValueFloor = 0.02;

}  // namespace

ArmController::ArmController(const ArmSetup& arm)
    : arm_(arm),
      acceleration_control_(arm.acceleration),
      q_hat_(acceleration_control_.q_hat()),
      dq_hat_(acceleration_control_.dq_hat()),
      d_hat_(acceleration_control_.d_hat()),
      X_hat_(TipVector::Zero(chain().held())),
      X_ref_(X_hat_),
      J_(chain().held(), chain().joints()),
      acceleration_ref_(Eigen::VectorXd::Zero(chain().joints())),
      posture_(acceleration_ref_),
      J_damped_(Eigen::MatrixXd::Zero(chain().joints(), chain().held())) {
  refuse_unless(
      joints().joints() == chain().joints() && task().start_angles_rad.size() == chain().joints(),
      "arm controller: needs one inertia and start angle per joint");
  refuse_unless(task().start_pose.size() == chain().held() && chain().joints() >= chain().held(),
                "arm controller: needs a start pose with the coordinates of the chain, and a joint "
                "for each");
  refuse_unless(task().convert_gain_N_m > 0.0,
                "arm controller: the convert gain K_f must be positive");
  publish({"q_hat_rad", "rad", "joint angles, estimated (Eq. 2.54)", view(q_hat_)});
  publish({"dq_hat_rad_s", "rad/s", "joint velocities, estimated", view(dq_hat_)});
  publish({"d_hat_Nm", "N m", "disturbance torques, estimated, opposing motion (Eq. 2.53)",
           view(d_hat_)});
  const auto publish_tip = [&](const char* kind, const char* what, const TipVector& values) {
    for (Eigen::Index i = 0; i < chain().held(); ++i) {
      const TipCoordinate& one = chain().coordinates[static_cast<std::size_t>(i)];
      publish({one.name + kind + one.unit, one.unit, one.meaning + what, view(values[i])});
    }
  };
  publish_tip("_hat_", ", from the estimated angles", X_hat_);
  publish_tip("_ref_", " reference (Eq. 2.62 along the force, in force control)", X_ref_);
  publish({"ddq_ref_rad_s2", "rad/s^2", "joint acceleration references", view(acceleration_ref_)});
  for (const Signal& signal : signals_of(joints().observer(), "rad")) publish(signal);
}

void ArmController::reset(const Sample&) {
  acceleration_control_.reset(task().start_angles_rad);
  restart();
}

void ArmController::update(const Sample& y, Eigen::Ref<Eigen::VectorXd> u) {
  const Eigen::Index n = chain().joints();
  force_control_ = y.time_s >= task().force_control_from_s - 0.5 * arm_.period_s;
  force_N_ = y.y(n);
  raw_force_N_ = y.y.size() > n + 1 ? y.y(n + 1) : force_N_;
  acceleration_control_.update(y.y.head(n));
  X_hat_ = chain().tip_pose(q_hat_);
  chain().tip_jacobian(q_hat_, J_);
  has_inverse_ = false;
  X_ref_ = task().start_pose;
  if (force_control_) {
    X_ref_[0] = X_hat_[0] + (task().force_reference_N - force_N_) / task().convert_gain_N_m;
  }

  decide(acceleration_ref_);
  if (n > chain().held()) hold_posture();
  acceleration_control_.command(acceleration_ref_, u);
}

const Eigen::MatrixXd& ArmController::damped_inverse() {
  if (!has_inverse_) damped_pseudo_inverse(J_, kSingularValueFloor, J_damped_);
  has_inverse_ = true;
  return J_damped_;
}

// N (k (q_0 − q̂) − 2 √k q̇̂), N = I − J⁺ J, as far as the torques suffice. Away from singular
// postures the tip does not feel it.
void ArmController::hold_posture() {
  posture_ = task().k_posture * (task().start_angles_rad - q_hat_) -
             2.0 * std::sqrt(task().k_posture) * dq_hat_;
  const TipVector felt = J_ * posture_;
  posture_.noalias() -= damped_inverse() * felt;
  acceleration_ref_ +=
      acceleration_control_.share_within_limits(acceleration_ref_, posture_) * posture_;
}

}  // namespace breakwater
