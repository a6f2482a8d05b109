#include <breakwater/control/contact_stiffness.h>

#include <algorithm>
#include <stdexcept>

#include <breakwater/math/functions.h>

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

}  // namespace

ContactStiffness::ContactStiffness(double lag_s, double period_s) : period_s_(period_s) {
  if (!(period_s > 0.0) || !(lag_s >= 0.0)) {
    throw std::invalid_argument("contact stiffness: needs a period > 0 and a lag >= 0");
  }
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

}  // namespace breakwater
