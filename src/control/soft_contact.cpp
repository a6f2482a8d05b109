#include <breakwater/control/soft_contact.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include <breakwater/linear/pseudo_inverse.h>
#include <breakwater/math/functions.h>

namespace breakwater {
namespace {

constexpr double kSingularValueFloor = 0.02;
constexpr double kSmallestShare = 1e-6;       // smallest |g_i| of a joint that bounds a_x
constexpr double kLeastAuthority_m_s2 = 0.3;  // lower bound for planning
constexpr double kLargest_m_s2 = 30.0;        // bound of a_x if the authority is empty
constexpr double kAuthorityShare = 0.85;      // used share of the authority in contact
constexpr double kSmoothing = 0.05;           // weight of the newest sample in the identification
constexpr double kIdentifyFrom_s = 0.1;       // after this time and above this speed
constexpr double kIdentifyFrom_m_s = 0.05;
constexpr double kDetection_s = 0.005;
constexpr double kSlowest_m_s = 0.02;  // lower bound of the approach speed
constexpr double kSlowestInContact_m_s = 0.05;
constexpr double kContact_N = 0.15;  // threshold of contact detection
constexpr double kLost_s = 0.08;
constexpr double kFastest_m_s = 2.0;  // upper bound of contact_speed()
constexpr int kBisections = 30;
constexpr int kNewtonSteps = 8;
constexpr Eigen::Index kElbow = 1;

}  // namespace

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

SoftContact::SoftContact(const PlanarChain& chain, const AccelerationControlDesign& acceleration,
                         const ArmTask& task, const SoftContactDesign& design)
    : ArmController(chain, acceleration, task),
      design_(design),
      joint_pfc_(design.joints.begin(), design.joints.end()),
      hold_(design.hold),
      across_(design.across),
      approach_(design.approach),
      contact_(design.contact),
      inertia_(acceleration.nominal_inertia_kgm2),
      period_s_(acceleration.period_s),
      J_plus_(chain.joints(), 3),
      along_(Eigen::VectorXd::Zero(chain.joints())),
      otherwise_(along_),
      elbow_inertia_(0.0),
      stiffness_(task.force_lag_s, acceleration.period_s) {
  if (chain.joints() < 3 || static_cast<Eigen::Index>(joint_pfc_.size()) != chain.joints()) {
    throw std::invalid_argument("TLSC: needs three joints or more, and a PFC for each");
  }
  if (!(design.wall_stiffness_N_m > 0.0) || !(design.peak_margin_N > 0.0)) {
    throw std::invalid_argument("TLSC: the wall's stiffness and the margin must be positive");
  }
  elbow_inertia_ = inertia_(kElbow);
  publish({"contact_stiffness_hat_N_m", "N/m", "K of the contact, estimated; 0: none yet",
           view(stiffness_N_m_)});
  publish({"way_to_go_m", "m", "epsilon = (F^ref - F)/K, in contact", view(way_to_go_m_)});
  publish({"speed_cap_m_s", "m/s", "allowed impact velocity", view(speed_cap_m_s_)});
  publish({"authority_m_s2", "m/s^2, m/s^2", "available path acceleration to brake, to drive",
           view(authority_)});
  publish({"phase", "1", "0 positioning, 1 hold, 2 approach, 3 contact", view(phase_number_)});
}

void SoftContact::decide(Eigen::Ref<Eigen::VectorXd> a) {
  if (!force_control_) {
    phase_ = design_.positioning == Positioning::joint ? Phase::positioning : Phase::hold;
  } else if (phase_ != Phase::contact) {
    phase_ = Phase::approach;
  }
  look_along_path();
  if (phase_ == Phase::approach || phase_ == Phase::contact) detect_contact();
  const Authority bounds = authority();
  const bool is_possible = bounds.lower <= bounds.upper;
  authority_ << std::max(kLeastAuthority_m_s2, is_possible ? -bounds.lower : 0.0),
      std::max(kLeastAuthority_m_s2, is_possible ? bounds.upper : 0.0);

  double along = 0.0;
  switch (phase_) {
    case Phase::positioning:
      for (Eigen::Index i = 0; i < a.size(); ++i) {
        a(i) = joint_pfc_[static_cast<std::size_t>(i)].acceleration(task().start_angles_rad(i),
                                                                    q_hat_(i), dq_hat_(i));
      }
      break;
    case Phase::hold:
      along = hold_.acceleration(task().start_pose[0], X_hat_[0], velocity_[0]);
      break;
    case Phase::approach:
      identify_elbow();
      along = approach_acceleration();
      break;
    case Phase::contact:
      along = contact_acceleration();
      break;
  }
  if (phase_ != Phase::positioning) {
    along = is_possible ? std::clamp(along, bounds.lower, bounds.upper)
                        : std::clamp(along, -kLargest_m_s2, kLargest_m_s2);
    a = along_ * along + otherwise_;
  }
  for (Eigen::Index i = 0; i < a.size(); ++i) {
    a(i) = std::clamp(a(i), joints().lower_acceleration(i), joints().upper_acceleration(i));
  }
  // The impulse of the limited torque on the elbow until the next sample.
  elbow_impulse_ += (inertia_(kElbow) * a(kElbow) + d_hat_(kElbow)) * period_s_;
  if (force_control_) X_ref_[0] = X_hat_[0] + way_to_go_m_;
  phase_number_ = static_cast<double>(phase_);
}

// Computes g and r.
void SoftContact::look_along_path() {
  damped_pseudo_inverse(J_, kSingularValueFloor, J_plus_);
  velocity_.noalias() = J_ * dq_hat_;
  const TipPose& start = task().start_pose;
  TipPose wanted = -chain().tip_bias_acceleration(q_hat_, dq_hat_);
  for (const int i : {1, 2}) {
    wanted[i] += across_.acceleration(start[i], X_hat_[i], velocity_[i]);
  }
  along_ = J_plus_.col(0);
  otherwise_.noalias() = J_plus_ * wanted;
}

SoftContact::Authority SoftContact::authority() const {
  Authority bounds{-INFINITY, INFINITY};
  for (Eigen::Index i = 0; i < along_.size(); ++i) {
    if (std::abs(along_(i)) < kSmallestShare) continue;
    const double one = (joints().lower_acceleration(i) - otherwise_(i)) / along_(i);
    const double other = (joints().upper_acceleration(i) - otherwise_(i)) / along_(i);
    bounds.lower = std::max(bounds.lower, std::min(one, other));
    bounds.upper = std::min(bounds.upper, std::max(one, other));
  }
  return bounds;
}

// The path deceleration that the elbow's torque limit allows, for this inertia of the elbow.
double SoftContact::braking_of_elbow(double inertia_kgm2) const {
  const double share = along_(kElbow);
  if (std::abs(share) < kSmallestShare) return authority_(0);
  const double to_joint = inertia_(kElbow) / inertia_kgm2;
  const double one = (joints().lower_acceleration(kElbow) * to_joint - otherwise_(kElbow)) / share;
  const double other =
      (joints().upper_acceleration(kElbow) * to_joint - otherwise_(kElbow)) / share;
  return std::max(kLeastAuthority_m_s2, -std::min(one, other));
}

// From the momentum: I (q̇ − q̇(0)) = ∫τ dt − f t, with the mean friction f.
void SoftContact::identify_elbow() {
  if (!has_started_) {
    has_started_ = true;
    approach_s_ = elbow_impulse_ = 0.0;
    elbow_speed_at_start_ = dq_hat_(kElbow);
    elbow_friction_ = d_hat_(kElbow);
    speed_cap_m_s_ = 0.0;
    return;
  }
  approach_s_ += period_s_;
  elbow_friction_ += kSmoothing * (d_hat_(kElbow) - elbow_friction_);
  if (approach_s_ < kIdentifyFrom_s || velocity_[0] < kIdentifyFrom_m_s) return;
  const double found =
      (elbow_impulse_ - elbow_friction_ * approach_s_) / (dq_hat_(kElbow) - elbow_speed_at_start_);
  const double nominal = inertia_(kElbow);
  if (!std::isfinite(found)) return;
  elbow_inertia_ += kSmoothing * (std::clamp(found, 0.5 * nominal, 2.0 * nominal) - elbow_inertia_);
}

double SoftContact::approach_acceleration() {
  const bool is_identified = approach_s_ >= kIdentifyFrom_s && velocity_[0] >= kIdentifyFrom_m_s;
  const double braking = is_identified ? braking_of_elbow(elbow_inertia_) : authority_(0);
  const double cap = std::max(
      kSlowest_m_s, contact_speed(design_.wall_stiffness_N_m, braking, task().force_lag_s,
                                  kDetection_s, design_.peak_margin_N + task().force_reference_N));
  speed_cap_m_s_ =
      speed_cap_m_s_ > 0.0 ? speed_cap_m_s_ + kSmoothing * (cap - speed_cap_m_s_) : cap;
  return approach_.k_d() * (speed_cap_m_s_ - velocity_[0]);
}

void SoftContact::detect_contact() {
  if (phase_ == Phase::approach) {
    if (raw_force_N_ <= kContact_N) return;
    phase_ = Phase::contact;
    contact_x_m_ = X_hat_[0];
    unloaded_s_ = 0.0;
    stiffness_.reset();
  }
  stiffness_.update(X_hat_[0] - contact_x_m_, velocity_[0], force_N_);
  const bool is_loaded = raw_force_N_ > kContact_N || force_N_ > kContact_N;
  unloaded_s_ = is_loaded ? 0.0 : unloaded_s_ + period_s_;
  if (unloaded_s_ > kLost_s) {
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
  const double speed = servo_speed(std::abs(way_to_go_m_), a, contact_.k_p() / contact_.k_d());
  const double wanted = std::min(speed, std::max(speed_cap_m_s_, kSlowestInContact_m_s));
  return contact_.k_d() * (std::copysign(wanted, way_to_go_m_) - velocity_[0]);
}

}  // namespace breakwater
