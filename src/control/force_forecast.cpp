#include <breakwater/control/force_forecast.h>

#include <algorithm>

#include <breakwater/math/refuse_unless.h>

namespace breakwater {

void EstimatorForecast::update(double, const QuadrotorEstimator& estimator, ForceTable& forces) {
  for (Eigen::Index i = 0; i < forces.cols(); ++i) {
    forces.col(i) =
        foresees_ ? estimator.force_ahead(period_s_ * static_cast<double>(i)) : estimator.force();
  }
}

void AutoregressiveForecast::reset(double) {
  for (AutoregressiveModel& axis : axes_) axis.reset();
}

void AutoregressiveForecast::update(double, const QuadrotorEstimator& estimator,
                                    ForceTable& forces) {
  forces.col(0) = estimator.force();
  for (Eigen::Index i = 0; i < 3; ++i) {
    AutoregressiveModel& axis = axes_[static_cast<std::size_t>(i)];
    axis.update(forces(i, 0));
    axis.forecast(forces.row(i).tail(forces.cols() - 1));
  }
}

namespace {

constexpr double kFirstVariance = 1e6;  // variance of a coefficient, over that of e/largest
// Forgetting pauses at this trace of P, for a signal that is at rest tells nothing.
constexpr double kLargestTrace = 1e9;

}  // namespace

AutoregressiveModel::AutoregressiveModel(const AutoregressiveDesign& design) : design_(design) {
  refuse_unless(
      design.order > 0 && design.spacing > 0 && design.memory >= 1.0 && design.largest > 0.0,
      "autoregressive model: every value must be positive, the memory at least 1 sample");
  past_.resize(static_cast<Eigen::Index>(design.order) * design.spacing);
  regressor_.setZero(design.order + 1);
  step_ = gain_ = regressor_;
  reset();
}

void AutoregressiveModel::reset() {
  past_.setZero();
  samples_ = 0;
  coefficients_ = Eigen::VectorXd::Unit(regressor_.size(), 1);
  P_ = kFirstVariance * Eigen::MatrixXd::Identity(regressor_.size(), regressor_.size());
}

void AutoregressiveModel::update(double value) {
  const double y = std::clamp(value, -design_.largest, design_.largest);
  if (samples_ == past_.size()) {
    regressor_(0) = 1.0;
    for (int i = 1; i <= design_.order; ++i) {
      regressor_(i) = past_(i * design_.spacing - 1) / design_.largest;
    }
    const double forget = 1.0 - 1.0 / design_.memory;
    step_.noalias() = P_ * regressor_;
    const double uncertainty = regressor_.dot(step_);
    if (uncertainty >= 0.0) {
      const double scale = forget + uncertainty;
      const double error = y / design_.largest - regressor_.dot(coefficients_);
      coefficients_ += error / scale * step_;
      gain_ = step_ / scale;
      P_.noalias() -= gain_ * step_.transpose();
      if (P_.trace() < kLargestTrace) P_ /= forget;
    } else {  // rounding has made P indefinite
      P_.setIdentity();
      P_ *= kFirstVariance;
    }
  } else {
    ++samples_;
  }
  std::copy_backward(past_.begin(), past_.end() - 1, past_.end());
  past_(0) = y;
}

void AutoregressiveModel::forecast(Eigen::Ref<Eigen::RowVectorXd> values) const {
  for (Eigen::Index k = 0; k < values.size(); ++k) {
    double sum = coefficients_(0) * design_.largest;
    for (int i = 1; i <= design_.order; ++i) {
      const Eigen::Index at = k - static_cast<Eigen::Index>(i) * design_.spacing;
      sum += coefficients_(i) * (at >= 0 ? values(at) : past_(-at - 1));
    }
    values(k) = std::clamp(sum, -design_.largest, design_.largest);
  }
}

}  // namespace breakwater
