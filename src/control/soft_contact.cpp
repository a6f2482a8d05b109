#include <breakwater/control/soft_contact.h>

#include <algorithm>
#include <cmath>

#include <breakwater/math/functions.h>
#include <breakwater/math/refuse_unless.h>

namespace breakwater {
namespace {

constexpr double kPriorStiffness_N_m = 1000.0;
constexpr double kStiffnessStd_N_m = 3000.0;
constexpr double kDampingStd_Ns_m = 30.0;
constexpr double kForceStd_N = 0.05;
constexpr double kLowestStiffness_N_m = 200.0;
constexpr double kHighestStiffness_N_m = 2e5;
constexpr double kHighestDamping_Ns_m = 60.0;
constexpr double kLearnsFrom_s = 0.004;
constexpr double kLearnsTo_s = 0.35;

constexpr double kAuthorityShare = 0.85;  // used share of the authority in contact
constexpr double kSmoothing = 0.05;       // weight of the newest sample in the identification
constexpr double kIdentifyFrom_s = 0.1;   // after this time and above this speed
constexpr double kIdentifyFrom_m_s = 0.05;
constexpr double kDetection_s = 0.005;
constexpr double kSlowest_m_s = 0.02;  // lower bound of the approach speed
constexpr double kSlowestInContact_m_s = 0.05;
constexpr double kFastest_m_s = 2.0;  // upper bound of contact_speed()
constexpr int kBisections = 30;
constexpr int kNewtonSteps = 8;

}  // namespace

ContactStiffness::ContactStiffness(double lag_s, double period_s) : period_s_(period_s) {
  refuse_unless(period_s > 0.0 && lag_s >= 0.0,
                "contact stiffness: needs a period > 0 and a lag >= 0");
  forget_ = lag_s > 0.0 ? math::exp(-period_s / lag_s) : 0.0;
  reset();
}

void ContactStiffness::reset() {
  contact_s_ = depth_f_ = rate_f_ = force_ = 0.0;
  information_.setZero();
  information_(0, 0) = 1.0 / (kStiffnessStd_N_m * kStiffnessStd_N_m);
  information_(1, 1) = 1.0 / (kDampingStd_Ns_m * kDampingStd_Ns_m);
  vector_ << kPriorStiffness_N_m * information_(0, 0), 0.0;
  stiffness_ = kPriorStiffness_N_m;
  damping_ = 0.0;
}

void ContactStiffness::update(double depth_m, double rate_m_s, double force_N) {
  depth_f_ += (1.0 - forget_) * (depth_m - depth_f_);
  rate_f_ += (1.0 - forget_) * (rate_m_s - rate_f_);
  if (contact_s_ >= kLearnsFrom_s && contact_s_ <= kLearnsTo_s) {
    constexpr double weight = 1.0 / (kForceStd_N * kForceStd_N);
    const Eigen::Vector2d regressor(depth_f_, rate_f_);
    information_.noalias() += weight * regressor * regressor.transpose();
    vector_ += weight * force_N * regressor;
    const double determinant =
        information_(0, 0) * information_(1, 1) - information_(0, 1) * information_(1, 0);
    stiffness_ = (information_(1, 1) * vector_(0) - information_(0, 1) * vector_(1)) / determinant;
    damping_ = (information_(0, 0) * vector_(1) - information_(1, 0) * vector_(0)) / determinant;
    stiffness_ = std::clamp(stiffness_, kLowestStiffness_N_m, kHighestStiffness_N_m);
    damping_ = std::clamp(damping_, 0.0, kHighestDamping_Ns_m);
  }
  contact_s_ += period_s_;
  force_ = stiffness_ * (depth_m - depth_f_) + force_N;
}

double contact_peak_N(double speed_m_s, double stiffness_N_m, double braking_m_s2, double lag_s) {
  // The function is convex above the root, so Newton's method decreases to it.
  const double total_s = lag_s + speed_m_s / braking_m_s2;
  double t = total_s;
  if (lag_s > 0.0) {
    for (int i = 0; i < kNewtonSteps; ++i) {
      const double rest = math::exp(-t / lag_s);
      const double slope = 1.0 - total_s / lag_s * rest;
      if (!(slope > 0.0)) break;
      t -= (t - total_s * (1.0 - rest)) / slope;
    }
  }
  return stiffness_N_m * t * (speed_m_s - 0.5 * braking_m_s2 * t);
}

double contact_speed(double stiffness_N_m, double braking_m_s2, double lag_s, double detection_s,
                     double allowed_N) {
  double slow = 0.0, fast = kFastest_m_s;
  for (int i = 0; i < kBisections; ++i) {
    const double v = 0.5 * (slow + fast);
    const double peak_N = contact_peak_N(v, stiffness_N_m, braking_m_s2, lag_s);
    (peak_N + stiffness_N_m * v * detection_s <= allowed_N ? slow : fast) = v;
  }
  return slow;
}

double servo_speed(double way_m, double acceleration_m_s2, double lambda) {
  const double near = acceleration_m_s2 / (2.0 * lambda * lambda);
  if (way_m < near) return lambda * way_m;
  return std::sqrt(2.0 * acceleration_m_s2 * way_m) - acceleration_m_s2 / (2.0 * lambda);
}

SoftContact::SoftContact(const ArmSetup& arm, const SoftContactDesign& design)
    : PathControl(arm, design.path),
      design_(design),
      elbow_(std::min<Eigen::Index>(1, inertia_.size() - 1)),
      elbow_inertia_(inertia_(elbow_)),
      stiffness_(arm.task.force_lag_s, arm.period_s) {
  publish({"contact_stiffness_hat_N_m", "N/m", "K of the contact, estimated; 0: none yet",
           view(stiffness_N_m_)});
  publish({"way_to_go_m", "m", "epsilon = (F^ref - F)/K, in contact", view(way_to_go_m_)});
  publish({"speed_cap_m_s", "m/s", "allowed impact velocity", view(speed_cap_m_s_)});
  publish({"authority_m_s2", "m/s^2, m/s^2", "available path acceleration to brake, to drive",
           view(authority_)});
  publish({"phase", "1", "0 positioning, 1 hold, 2 approach, 3 contact", view(phase_number_)});
}

void SoftContact::decide(Eigen::Ref<Eigen::VectorXd> a) {
  PathControl::decide(a);
  if (!force_control_) {
    phase_ = path().positioning == Positioning::joint ? Phase::positioning : Phase::hold;
  }
  // The impulse of the limited torque on the elbow until the next sample.
  elbow_impulse_ += (inertia_(elbow_) * a(elbow_) + d_hat_(elbow_)) * arm().period_s;
  if (force_control_) X_ref_[0] = X_hat_[0] + way_to_go_m_;
  phase_number_ = static_cast<double>(phase_);
}

double SoftContact::path_acceleration() {
  if (phase_ != Phase::contact) phase_ = Phase::approach;
  follow_stiffness();
  if (phase_ == Phase::contact) return contact_acceleration();
  identify_elbow();
  return approach_acceleration();
}

// The path deceleration that the elbow's torque limit allows, for this inertia of the elbow.
double SoftContact::braking_of_elbow(double inertia_kgm2) const {
  const double share = along_(elbow_);
  if (std::abs(share) < kSmallestShare) return authority_(0);
  const double to_joint = inertia_(elbow_) / inertia_kgm2;
  const double one = (joints().lower(elbow_) * to_joint - otherwise_(elbow_)) / share;
  const double other = (joints().upper(elbow_) * to_joint - otherwise_(elbow_)) / share;
  return std::max(kLeastAuthority_m_s2, -std::min(one, other));
}

// From the momentum: I (q̇ − q̇(0)) = ∫τ dt − f t, with the mean friction f.
void SoftContact::identify_elbow() {
  if (!has_started_) {
    has_started_ = true;
    approach_s_ = elbow_impulse_ = 0.0;
    elbow_speed_at_start_ = dq_hat_(elbow_);
    elbow_friction_ = d_hat_(elbow_);
    speed_cap_m_s_ = 0.0;
    return;
  }
  approach_s_ += arm().period_s;
  elbow_friction_ += kSmoothing * (d_hat_(elbow_) - elbow_friction_);
  if (approach_s_ < kIdentifyFrom_s || velocity_[0] < kIdentifyFrom_m_s) return;
  const double found =
      (elbow_impulse_ - elbow_friction_ * approach_s_) / (dq_hat_(elbow_) - elbow_speed_at_start_);
  const double nominal = inertia_(elbow_);
  if (!std::isfinite(found)) return;
  elbow_inertia_ += kSmoothing * (std::clamp(found, 0.5 * nominal, 2.0 * nominal) - elbow_inertia_);
}

double SoftContact::approach_acceleration() {
  const bool is_identified =
      !joints().is_coupled() && approach_s_ >= kIdentifyFrom_s && velocity_[0] >= kIdentifyFrom_m_s;
  const double braking = is_identified ? braking_of_elbow(elbow_inertia_) : authority_(0);
  const double cap = std::max(
      kSlowest_m_s, contact_speed(path().impact.stiffness_N_m, braking, task().force_lag_s,
                                  kDetection_s, path().impact.allowed_N(task().force_reference_N)));
  speed_cap_m_s_ =
      speed_cap_m_s_ > 0.0 ? speed_cap_m_s_ + kSmoothing * (cap - speed_cap_m_s_) : cap;
  return path().approach.k_d() * (speed_cap_m_s_ - velocity_[0]);
}

void SoftContact::follow_stiffness() {
  if (phase_ == Phase::approach) {
    if (!touches()) return;
    phase_ = Phase::contact;
    stiffness_.reset();
  }
  stiffness_.update(X_hat_[0] - contact_x_m(), velocity_[0], force_N_);
  if (!touches()) {
    phase_ = Phase::approach;
    has_started_ = false;
    way_to_go_m_ = 0.0;
    return;
  }
  stiffness_N_m_ = stiffness_.stiffness_N_m();
  way_to_go_m_ = (task().force_reference_N - stiffness_.force_N()) / stiffness_N_m_;
}

double SoftContact::contact_acceleration() const {
  const bool is_ahead = way_to_go_m_ > 0.0;
  const bool is_approaching = velocity_[0] * way_to_go_m_ > 0.0;
  // authority_(0) decelerates a forward motion and accelerates a backward one.
  const bool needs_braking = is_ahead == is_approaching;
  const double a = kAuthorityShare * authority_(needs_braking ? 0 : 1);
  const double speed =
      servo_speed(std::abs(way_to_go_m_), a, design_.contact.k_p() / design_.contact.k_d());
  const double wanted = std::min(speed, std::max(speed_cap_m_s_, kSlowestInContact_m_s));
  return design_.contact.k_d() * (std::copysign(wanted, way_to_go_m_) - velocity_[0]);
}

}  // namespace breakwater
