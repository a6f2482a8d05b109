#include <breakwater/control/path_control.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include <breakwater/linear/pseudo_inverse.h>
#include <breakwater/math/refuse_unless.h>

namespace breakwater {
namespace {

constexpr double kLargest_m_s2 = 30.0;  // bound of a_x if the authority is empty
constexpr double kContact_N = 0.15;     // threshold of contact detection
constexpr double kLost_s = 0.08;

}  // namespace

PathControl::PathControl(const ArmSetup& arm, const PathDesign& design)
    : ArmController(arm),
      inertia_(arm.acceleration.nominal_inertia_kgm2),
      along_(Eigen::VectorXd::Zero(arm.chain->joints())),
      otherwise_(along_),
      recoil_(along_),
      wanted_(TipVector::Zero(arm.chain->held())),
      velocity_(wanted_),
      path_(design),
      share_(along_),
      rest_(along_) {
  refuse_unless(static_cast<Eigen::Index>(design.joints.size()) == arm.chain->joints(),
                "path control: needs a PFC for each joint");
  refuse_unless(design.impact.stiffness_N_m > 0.0 && design.impact.peak_margin_N > 0.0,
                "impact: the wall's stiffness and the margin must be positive");
}

void PathControl::decide(Eigen::Ref<Eigen::VectorXd> a) {
  look_along_path();
  if (force_control_) {
    follow_contact();
  } else {
    touches_ = false;
  }
  measure_authority();
  if (!force_control_ && path_.positioning == Positioning::joint) {
    for (Eigen::Index i = 0; i < a.size(); ++i) {
      a(i) = path_.joints[static_cast<std::size_t>(i)].acceleration(task().start_angles_rad(i),
                                                                    q_hat_(i), dq_hat_(i));
    }
  } else {
    double along = force_control_
                       ? path_acceleration()
                       : path_.hold.acceleration(task().start_pose[0], X_hat_[0], velocity_[0]);
    along = is_possible_ ? std::clamp(along, lower_, upper_)
                         : std::clamp(along, -kLargest_m_s2, kLargest_m_s2);
    a = along_ * along + otherwise_;
  }
  joints().limit(a);
}

// Computes g and r.
void PathControl::look_along_path() {
  const Eigen::MatrixXd& J_plus = damped_inverse();
  velocity_.noalias() = J_ * dq_hat_;
  const TipVector& start = task().start_pose;
  wanted_ = -chain().tip_bias_acceleration(q_hat_, dq_hat_);
  for (Eigen::Index i = 1; i < start.size(); ++i) {
    wanted_[i] += path_.across.acceleration(start[i], X_hat_[i], velocity_[i]);
  }
  along_ = J_plus.col(0);
  multiply(J_plus, wanted_, otherwise_);
}

void PathControl::measure_authority() {
  // Finite where no joint limits it, since the log has it.
  upper_ = std::numeric_limits<double>::max();
  lower_ = -upper_;
  joints().limited_part(along_, share_);
  joints().limited_part(otherwise_, rest_);
  for (Eigen::Index i = 0; i < along_.size(); ++i) {
    if (std::abs(share_(i)) < kSmallestShare) continue;
    const double one = (joints().lower(i) - rest_(i)) / share_(i);
    const double other = (joints().upper(i) - rest_(i)) / share_(i);
    lower_ = std::max(lower_, std::min(one, other));
    upper_ = std::min(upper_, std::max(one, other));
  }
  is_possible_ = lower_ <= upper_;
  authority_ << std::max(kLeastAuthority_m_s2, is_possible_ ? -lower_ : 0.0),
      std::max(kLeastAuthority_m_s2, is_possible_ ? upper_ : 0.0);
}

void PathControl::follow_contact() {
  if (!touches_) {
    if (raw_force_N_ <= kContact_N) return;
    touches_ = true;
    contact_x_m_ = X_hat_[0];
    unloaded_s_ = 0.0;
  }
  const bool is_loaded = raw_force_N_ > kContact_N || force_N_ > kContact_N;
  unloaded_s_ = is_loaded ? 0.0 : unloaded_s_ + arm().period_s;
  if (unloaded_s_ > kLost_s) touches_ = false;
}

double PathControl::effective_mass_kg() {
  if (joints().is_coupled()) {
    recoil_ = J_.row(0).transpose();
    joints().divide_by_mass(recoil_);
    return 1.0 / J_.row(0).dot(recoil_);
  }
  double recoil = 0.0;
  for (Eigen::Index i = 0; i < inertia_.size(); ++i) recoil += J_(0, i) * J_(0, i) / inertia_(i);
  return 1.0 / recoil;
}

}  // namespace breakwater
