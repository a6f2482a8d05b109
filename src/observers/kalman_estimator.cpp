#include <breakwater/observers/kalman_estimator.h>

#include <breakwater/observers/record_intervals.h>

namespace breakwater {

KalmanEstimator::KalmanEstimator(const KalmanDesign& design, bool is_symmetric)
    : kernel_(nullptr), plant_states_(design.plant.plant_states) {
  check(design);
  if (is_symmetric && design.plant.inputs() == 1 && design.plant.outputs() == 1) {
    kernel_ = one_output::kernel(design.plant.states());
  }
  A_ = design.plant.sampled.A;
  B_ = design.plant.sampled.B;
  C_ = design.plant.sampled.C;
  regular_A_ = A_;
  regular_B_ = B_;
  regular_Q_ = design.Q;
  regular_R_ = design.R;
  interval_s_ = period_s_ = design.plant.period_s;
  instant_error_.setZero(C_.rows());
  if (const auto& plant = design.plant.continuous) {
    hold_.emplace(*plant);
    output_rate_.setZero(C_.rows(), A_.cols());
    output_rate_.leftCols(plant_states_) = plant->C * plant->A;
    input_rate_ = plant->C * plant->B;
    output_rate_.middleCols(plant_states_, B_.cols()) = -input_rate_;
  }
  measures_first_ = C_ == Eigen::MatrixXd::Identity(C_.rows(), C_.cols());
  Q_ = design.Q;
  R_ = design.R;
  initial_covariance_ = design.P0;
  extended_state_.setZero(A_.rows());
  predicted_ = extended_state_;
  gain_.setZero(A_.rows(), C_.rows());
  slope_ = gain_;
  output_cross_.setZero(C_.rows(), A_.rows());
  solved_ = output_cross_;
  innovation_.setZero(C_.rows());
  output_covariance_ = R_;
  covariance_ = work_ = initial_covariance_;
  signals_ = {{"innovation", "", "e = y - C x(k|k-1) (Eq. 4.15)", view(innovation_)},
              {"lambda", "1", "forgetting factor: P was divided by it", view(lambda_)}};
  reset(Eigen::VectorXd::Zero(plant_states_));
}

void KalmanEstimator::reset(const Vector& x) {
  extended_state_.setZero();
  extended_state_.head(x.size()) = x;
  covariance_ = initial_covariance_;
  gain_.setZero();
  innovation_.setZero();
  has_prior_ = true;
  if (hold_) follow({});
}

bool KalmanEstimator::follow(const SampleInterval& interval) {
  if (!hold_) return false;
  const double length_s = interval.length_s > 0.0 ? interval.length_s : period_s_;
  instant_std_s_ = interval.instant_std_s;
  instant_error_.setZero();
  R_ = regular_R_;
  weight_ = interval.output_std > 0.0
                ? regular_R_(0, 0) / (interval.output_std * interval.output_std)
                : 1.0;
  interval_s_ = length_s;
  pieces_ = pieces_of(length_s, period_s_);
  if (length_s == period_s_) {
    A_ = regular_A_;
    B_ = regular_B_;
  } else {
    const Eigen::Index n = plant_states_;
    const Eigen::Index inputs = B_.cols();
    const double piece_s = length_s / pieces_;
    hold_->over(piece_s);
    A_.topLeftCorner(n, n) = hold_->A();
    A_.block(0, n, n, inputs) = -hold_->B();
    for (Eigen::Index i = n; i + inputs < A_.cols(); ++i) A_(i, i + inputs) = piece_s;
    B_.topRows(n) = hold_->B();
  }
  Q_ = regular_Q_ * (length_s / (pieces_ * period_s_));
  // The noise is white from piece to piece: the mean over all pieces has the given variance.
  const double variance = interval.input_std * interval.input_std * pieces_ * weight_;
  for (Eigen::Index i = 0; variance > 0.0 && i < B_.cols(); ++i) {
    Q_.noalias() += variance * B_.col(i) * B_.col(i).transpose();
  }
  return true;
}

void KalmanEstimator::pole_matrix(Eigen::Ref<Eigen::MatrixXd> F) const {
  F = A_;
  F.noalias() -= gain_ * C_;
}

void KalmanEstimator::predict(const Vector& held_input, const Vector& y) {
  for (double piece = 0.0; !has_prior_ && piece < pieces_; piece += 1.0) {
    if (kernel_) {
      kernel_->predict(A_.data(), B_.data(), Q_.data(), held_input(0), extended_state_.data(),
                       covariance_.data());
      continue;
    }
    predicted_.noalias() = A_ * extended_state_;
    predicted_.noalias() += B_ * held_input;
    extended_state_ = predicted_;
    work_.noalias() = A_ * covariance_;
    covariance_.noalias() = work_ * A_.transpose();
    covariance_ += Q_;
  }
  has_prior_ = false;
  if (kernel_) {
    innovation_(0) = y(0) - measure();
  } else {
    innovation_ = y;
    innovation_.noalias() -= C_ * extended_state_;
    compute_output_covariance();
  }
  if (instant_std_s_ > 0.0) correct_for_instant(held_input);
}

// Adds the effect of the uncertain time to R.
void KalmanEstimator::correct_for_instant(const Vector& held_input) {
  if (kernel_) {
    instant_error_(0) = kernel_->output(output_rate_.data(), extended_state_.data());
  } else {
    instant_error_.noalias() = output_rate_ * extended_state_;
  }
  instant_error_.noalias() += input_rate_ * held_input;
  instant_error_ = instant_error_.cwiseAbs() * instant_std_s_;
  R_ = regular_R_;
  R_.diagonal() += weight_ * instant_error_.cwiseAbs2();
}

void KalmanEstimator::compute_output_covariance() {
  if (kernel_) {
    measure();
  } else {
    output_cross_.noalias() = C_ * covariance_;
    output_covariance_.noalias() = output_cross_ * C_.transpose();
  }
}

// The same with the kernel_. Returns C̅ x̄.
double KalmanEstimator::measure() {
  return kernel_->measure(covariance_.data(), extended_state_.data(), C_.data(), measures_first_,
                          output_cross_.data(), output_covariance_.data());
}

void KalmanEstimator::correct(const Eigen::MatrixXd& R) {
  if (kernel_) return correct(R(0, 0));
  output_covariance_ += R;
  factor_.compute(output_covariance_);
  solved_ = output_cross_;
  factor_.solveInPlace(solved_);
  gain_ = solved_.transpose();
  extended_state_.noalias() += gain_ * innovation_;

  work_ = covariance_;
  work_.noalias() -= gain_ * output_cross_;  // M
  slope_.noalias() = gain_ * R;
  slope_.noalias() -= work_ * C_.transpose();
  work_.noalias() += slope_ * gain_.transpose();
  covariance_ = 0.5 * (work_ + work_.transpose());
}

void KalmanEstimator::correct(double R, double D_inverse, double inflation) {
  kernel_->correct(output_cross_.data(), C_.data(), measures_first_, innovation_(0), R, D_inverse,
                   inflation, gain_.data(), extended_state_.data(), covariance_.data());
}

}  // namespace breakwater
