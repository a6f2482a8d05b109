#include <breakwater/observers/mdob_estimator.h>

namespace breakwater {

MdobEstimator::MdobEstimator(const MdobDesign& design, double period_s) : mdob_(design, period_s) {}

void MdobEstimator::reset(const Vector& x) {
  mdob_.reset(x(0));
  has_begun_ = false;
  follow({});
  publish();
}

bool MdobEstimator::follow(const SampleInterval& interval) {
  mdob_.over(interval.length_s);
  return true;
}

void MdobEstimator::update(const Vector& held_input, const Vector& y) {
  if (has_begun_) {
    mdob_.update(held_input(0), y(0));
  } else {
    mdob_.reset(y(0));  // a difference needs two samples
  }
  has_begun_ = true;
  publish();
}

void MdobEstimator::publish() {
  estimate_ << mdob_.angle(), mdob_.velocity(), mdob_.disturbance();
}

void MdobEstimator::pole_matrix(Eigen::Ref<Eigen::MatrixXd> F) const {
  F.setZero();
  F(0, 0) = mdob_.low_pass_pole();
  if (poles() == 2) F(1, 1) = mdob_.derivative_pole();
}

}  // namespace breakwater
