#include <breakwater/control/acceleration_control.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include <breakwater/math/refuse_unless.h>
#include <breakwater/observers/idob.h>
#include <breakwater/observers/stacked_estimator.h>
#include <breakwater/plants/damped_inertia.h>

namespace breakwater {

std::unique_ptr<DisturbanceEstimator> joint_idobs(const Eigen::VectorXd& nominal_inertia_kgm2,
                                                  const std::vector<PoleGroup>& poles,
                                                  double period_s) {
  refuse_unless(static_cast<Eigen::Index>(poles.size()) == nominal_inertia_kgm2.size(),
                "acceleration control: needs one group of poles per joint");
  // Eqs. 2.56–2.58 decouple the joints: each has its own observer.
  std::vector<std::unique_ptr<DisturbanceEstimator>> joints;
  for (std::size_t i = 0; i < poles.size(); ++i) {
    const double inertia = nominal_inertia_kgm2(static_cast<Eigen::Index>(i));
    joints.push_back(std::make_unique<Idob>(damped_inertia(inertia, 0.0),
                                            std::vector<PoleGroup>{poles[i]}, period_s));
  }
  return std::make_unique<StackedEstimator>(std::move(joints));
}

AccelerationControl::AccelerationControl(const AccelerationControlDesign& design)
    : nominal_inertia_(design.nominal_inertia_kgm2),
      torque_limit_(design.torque_limit_Nm),
      mass_matrix_(design.nominal_mass_matrix_kgm2),
      factor_(mass_matrix_),
      held_(Eigen::VectorXd::Zero(nominal_inertia_.size())),
      torque_(held_),
      more_(held_),
      feed_(design.feed),
      observer_(design.observer),
      fed_torque_(Eigen::VectorXd::Zero(nominal_inertia_.size())),
      start_(Eigen::VectorXd::Zero(2 * nominal_inertia_.size())) {
  refuse_unless(joints() != 0 && torque_limit_.size() == joints(),
                "acceleration control: needs one inertia and limit per joint");
  refuse_unless((nominal_inertia_.array() > 0.0).all() && (torque_limit_.array() > 0.0).all(),
                "acceleration control: inertias and limits must be positive");
  refuse_unless(observer_ && observer_->state().size() == 2 * joints() &&
                    observer_->disturbance().size() == joints(),
                "acceleration control: needs an observer of all joints");
  refuse_unless(
      !is_coupled() || (mass_matrix_.rows() == joints() && factor_.info() == Eigen::Success),
      "acceleration control: the mass matrix is not positive definite");
}

void AccelerationControl::reset(const Eigen::Ref<const Eigen::VectorXd>& q_rad) {
  start_.head(joints()) = q_rad;
  observer_->reset(start_);
}

void AccelerationControl::update(const Eigen::Ref<const Eigen::VectorXd>& measured_q_rad) {
  observer_->update(fed_torque_, measured_q_rad);
  if (!is_coupled()) return;
  torque_ = d_hat().cwiseQuotient(nominal_inertia_);
  held_.noalias() = mass_matrix_ * torque_;
}

double AccelerationControl::bound(Eigen::Index joint, double torque_Nm) const {
  return is_coupled() ? torque_Nm - held_(joint)
                      : (torque_Nm - d_hat()(joint)) / nominal_inertia_(joint);
}

void AccelerationControl::limited_part(const Eigen::Ref<const Eigen::VectorXd>& a_rad_s2,
                                       Eigen::Ref<Eigen::VectorXd> part) const {
  if (is_coupled()) {
    part.noalias() = mass_matrix_ * a_rad_s2;
  } else {
    part = a_rad_s2;
  }
}

void AccelerationControl::limit(Eigen::Ref<Eigen::VectorXd> a_rad_s2) {
  limited_part(a_rad_s2, torque_);
  for (Eigen::Index i = 0; i < joints(); ++i) {
    a_rad_s2(i) = std::clamp(torque_(i), lower(i), upper(i));
  }
  if (is_coupled()) divide_by_mass(a_rad_s2);
}

double AccelerationControl::share_within_limits(
    const Eigen::Ref<const Eigen::VectorXd>& a_rad_s2,
    const Eigen::Ref<const Eigen::VectorXd>& more_rad_s2) {
  limited_part(a_rad_s2, torque_);
  limited_part(more_rad_s2, more_);
  double share = 1.0;
  for (Eigen::Index i = 0; i < joints(); ++i) {
    const double room = more_(i) > 0.0 ? upper(i) - torque_(i) : torque_(i) - lower(i);
    if (more_(i) != 0.0) share = std::min(share, std::max(0.0, room) / std::abs(more_(i)));
  }
  return share;
}

void AccelerationControl::command(const Eigen::Ref<const Eigen::VectorXd>& a_rad_s2,
                                  Eigen::Ref<Eigen::VectorXd> torque_Nm) {
  if (is_coupled()) {
    torque_Nm.noalias() = mass_matrix_ * a_rad_s2;
    torque_Nm += held_;
  } else {
    torque_Nm = nominal_inertia_.cwiseProduct(a_rad_s2) + d_hat();
  }
  if (feed_ == ObserverFeed::clipped) {
    fed_torque_ = torque_Nm.cwiseMax(-torque_limit_).cwiseMin(torque_limit_);
  } else {
    fed_torque_ = torque_Nm;
  }
  if (!is_coupled()) return;
  divide_by_mass(fed_torque_);
  fed_torque_ = fed_torque_.cwiseProduct(nominal_inertia_);
}

}  // namespace breakwater
