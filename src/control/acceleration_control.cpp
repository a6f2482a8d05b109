#include <breakwater/control/acceleration_control.h>

#include <stdexcept>

namespace breakwater {
namespace {

// n decoupled joints J_n q̈ = τ with their angles measured (Eqs. 2.56–2.58).
StateSpace nominal_plant(const AccelerationControlDesign& design) {
  const Eigen::Index n = design.nominal_inertia_kgm2.size();
  if (n == 0 || design.torque_limit_Nm.size() != n) {
    throw std::invalid_argument("acceleration control: needs one inertia and limit per joint");
  }
  if (!(design.nominal_inertia_kgm2.array() > 0.0).all() ||
      !(design.torque_limit_Nm.array() > 0.0).all()) {
    throw std::invalid_argument("acceleration control: inertias and limits must be positive");
  }
  StateSpace plant{Eigen::MatrixXd::Zero(2 * n, 2 * n), Eigen::MatrixXd::Zero(2 * n, n),
                   Eigen::MatrixXd::Zero(n, 2 * n)};
  plant.A.topRightCorner(n, n).setIdentity();
  plant.B.bottomRows(n).diagonal() = design.nominal_inertia_kgm2.cwiseInverse();
  plant.C.leftCols(n).setIdentity();
  return plant;
}

}  // namespace

AccelerationControl::AccelerationControl(const AccelerationControlDesign& design)
    : nominal_inertia_(design.nominal_inertia_kgm2),
      torque_limit_(design.torque_limit_Nm),
      feed_(design.feed),
      observer_(nominal_plant(design), design.observer_poles, design.period_s),
      fed_torque_(Eigen::VectorXd::Zero(nominal_inertia_.size())),
      start_(Eigen::VectorXd::Zero(2 * nominal_inertia_.size())) {}

void AccelerationControl::reset(const Eigen::Ref<const Eigen::VectorXd>& q_rad) {
  start_.head(joints()) = q_rad;
  observer_.reset(start_);
}

void AccelerationControl::update(const Eigen::Ref<const Eigen::VectorXd>& measured_q_rad) {
  observer_.update(fed_torque_, measured_q_rad);
}

double AccelerationControl::lower_acceleration(Eigen::Index joint) const {
  return (-torque_limit_(joint) - d_hat()(joint)) / nominal_inertia_(joint);
}

double AccelerationControl::upper_acceleration(Eigen::Index joint) const {
  return (torque_limit_(joint) - d_hat()(joint)) / nominal_inertia_(joint);
}

void AccelerationControl::command(const Eigen::Ref<const Eigen::VectorXd>& a_rad_s2,
                                  Eigen::Ref<Eigen::VectorXd> torque_Nm) {
  torque_Nm = nominal_inertia_.cwiseProduct(a_rad_s2) + d_hat();
  if (feed_ == ObserverFeed::clipped) {
    fed_torque_ = torque_Nm.cwiseMax(-torque_limit_).cwiseMin(torque_limit_);
  } else {
    fed_torque_ = torque_Nm;
  }
}

}  // namespace breakwater
