#include <breakwater/observers/kalman_estimator.h>

#include <stdexcept>
#include <string>

#include <breakwater/linear/riccati.h>
#include <breakwater/linear/small_products.h>

namespace breakwater {

// The operations on matrices that are stored by columns. P is symmetric, before and after.
struct OneOutputKernel {
  // x ← A x + b u, P ← A P Aᵀ + Q.
  void (*predict)(const double* A, const double* b, const double* Q, double u, double* x,
                  double* P);
  // cᵀ x.
  double (*output)(const double* c, const double* x);
  // h ← P c. Returns cᵀ P c. If `is_first`, c = (1, 0, …).
  double (*measure)(const double* P, const double* c, bool is_first, double* h);
  // K ← h/D, x ← x + K e. Replaces P(k|k−1) by P(k|k), multiplied by `inflation`, for h = P c and
  // the noise variance R.
  void (*correct)(const double* h, const double* c, bool is_first, double e, double R,
                  double D_inverse, double inflation, double* K, double* x, double* P);
};

namespace {

/// Σ term(i), summed in pairs for speed.
template <int N, typename Term>
double sum(const Term& term) {
  double terms[N];
  for (int i = 0; i < N; ++i) terms[i] = term(i);
  for (int width = 1; width < N; width *= 2) {
    for (int i = 0; i + width < N; i += 2 * width) terms[i] += terms[i + width];
  }
  return terms[0];
}

template <int N>
void predict(const double* A, const double* b, const double* Q, double u, double* __restrict x,
             double* __restrict P) {
  double Ax[N];
  multiply<N>(A, x, Ax);
  for (int i = 0; i < N; ++i) x[i] = Ax[i] + b[i] * u;

  double AP[N][N];
  for (int i = 0; i < N; ++i) {
    for (int j = 0; j < N; ++j) {
      AP[i][j] = sum<N>([&](int k) { return A[i + k * N] * P[k + j * N]; });
    }
  }
  for (int i = 0; i < N; ++i) {
    for (int j = 0; j <= i; ++j) {
      P[i + j * N] = P[j + i * N] =
          Q[i + j * N] + sum<N>([&](int k) { return AP[i][k] * A[j + k * N]; });
    }
  }
}

template <int N>
void times(const double* __restrict P, const double* c, bool is_first, double* __restrict result) {
  for (int i = 0; i < N; ++i) {
    result[i] = is_first ? P[i] : sum<N>([&](int k) { return P[i + k * N] * c[k]; });
  }
}

template <int N>
double measure(const double* __restrict P, const double* c, bool is_first, double* __restrict h) {
  times<N>(P, c, is_first, h);
  return is_first ? h[0] : sum<N>([&](int k) { return h[k] * c[k]; });
}

// Joseph's form is
//     (I − K cᵀ) P (I − K cᵀ)ᵀ + K R Kᵀ = M + w Kᵀ + K wᵀ   with   M = P − K hᵀ,
//     w = (K R − M c)/2.
template <int N>
void correct(const double* __restrict h, const double* c, bool is_first, double e, double R,
             double D_inverse, double inflation, double* __restrict gain, double* __restrict x,
             double* __restrict P) {
  double K[N], M[N * N], w[N];
  for (int i = 0; i < N; ++i) {
    gain[i] = K[i] = h[i] * D_inverse;
    x[i] += K[i] * e;
  }
  for (int i = 0; i < N; ++i) {
    for (int j = 0; j <= i; ++j) M[i + j * N] = M[j + i * N] = P[i + j * N] - K[i] * h[j];
  }
  times<N>(M, c, is_first, w);
  for (int i = 0; i < N; ++i) w[i] = 0.5 * (K[i] * R - w[i]);
  for (int i = 0; i < N; ++i) {
    for (int j = 0; j <= i; ++j) {
      P[i + j * N] = P[j + i * N] = (M[i + j * N] + (w[i] * K[j] + w[j] * K[i])) * inflation;
    }
  }
}

template <int N>
constexpr OneOutputKernel kKernel = {predict<N>, dot<N>, measure<N>, correct<N>};
constexpr const OneOutputKernel* kKernels[] = {&kKernel<2>, &kKernel<3>, &kKernel<4>, &kKernel<5>,
                                               &kKernel<6>};

constexpr double kLargest = 1e100;  // products of larger covariances overflow

void require(bool fulfilled, Eigen::Index size, const std::string& what) {
  if (fulfilled) return;
  throw std::invalid_argument("Kalman filter: " + what + " and " + std::to_string(size) + "×" +
                              std::to_string(size));
}

}  // namespace

void check(const KalmanDesign& design) {
  const Eigen::Index N = design.plant.states();
  const Eigen::Index p = design.plant.outputs();
  require(design.Q.rows() == N && is_positive_semidefinite(design.Q), N,
          "Q must be symmetric positive semidefinite");
  require(design.R.rows() == p && is_positive_definite(design.R), p,
          "R must be symmetric positive definite");
  require(design.P0.rows() == N && is_positive_definite(design.P0), N,
          "P0 must be symmetric positive definite");
  for (const Eigen::MatrixXd* covariance : {&design.Q, &design.R, &design.P0}) {
    if (covariance->cwiseAbs().maxCoeff() <= kLargest) continue;
    throw std::invalid_argument("Kalman filter: Q, R and P0 must be at most 1e100");
  }
}

KalmanEstimator::KalmanEstimator(const KalmanDesign& design, bool is_symmetric)
    : kernel_(nullptr), regular_(design) {
  check(design);
  if (is_symmetric && design.plant.inputs() == 1 && design.plant.outputs() == 1) {
    const Eigen::Index states = design.plant.states();
    if (states >= 2 && states <= 6) kernel_ = kKernels[states - 2];
  }
  A_ = design.plant.sampled.A;
  B_ = design.plant.sampled.B;
  C_ = design.plant.sampled.C;
  interval_s_ = design.plant.period_s;
  instant_error_.setZero(C_.rows());
  if (const auto& plant = design.plant.continuous) {
    output_rate_.setZero(C_.rows(), A_.cols());
    output_rate_.leftCols(plant_states()) = plant->C * plant->A;
    input_rate_ = plant->C * plant->B;
    output_rate_.middleCols(plant_states(), B_.cols()) = -input_rate_;
  }
  measures_first_ = C_ == Eigen::MatrixXd::Identity(C_.rows(), C_.cols());
  Q_ = design.Q;
  R_ = design.R;
  extended_state_.setZero(A_.rows());
  predicted_ = extended_state_;
  gain_.setZero(A_.rows(), C_.rows());
  slope_ = gain_;
  output_cross_.setZero(C_.rows(), A_.rows());
  solved_ = output_cross_;
  innovation_.setZero(C_.rows());
  output_covariance_ = R_;
  covariance_ = work_ = design.P0;
  signals_ = {{"innovation", "", "e = y - C x(k|k-1) (Eq. 4.15)", view(innovation_)},
              {"lambda", "1", "forgetting factor: P was divided by it", view(lambda_)}};
  reset(Eigen::VectorXd::Zero(plant_states()));
}

void KalmanEstimator::reset(const Vector& x) {
  extended_state_.setZero();
  extended_state_.head(x.size()) = x;
  covariance_ = regular_.P0;
  gain_.setZero();
  innovation_.setZero();
  has_prior_ = true;
  if (regular_.plant.continuous) follow({});
}

bool KalmanEstimator::follow(const SampleInterval& interval) {
  const ExtendedPlant& regular = regular_.plant;
  if (!regular.continuous) return false;
  const double period_s = regular.period_s;
  const double length_s = interval.length_s > 0.0 ? interval.length_s : period_s;
  instant_std_s_ = interval.instant_std_s;
  instant_error_.setZero();
  R_ = regular_.R;
  weight_ = interval.output_std > 0.0
                ? regular_.R(0, 0) / (interval.output_std * interval.output_std)
                : 1.0;
  interval_s_ = length_s;
  pieces_ = pieces_of(length_s, period_s);
  if (length_s == period_s) {
    A_ = regular.sampled.A;
    B_ = regular.sampled.B;
  } else {
    const Eigen::Index n = plant_states();
    const Eigen::Index inputs = B_.cols();
    const double piece_s = length_s / pieces_;
    const StateSpace sampled = zero_order_hold(*regular.continuous, piece_s);
    A_.topLeftCorner(n, n) = sampled.A;
    A_.block(0, n, n, inputs) = -sampled.B;
    for (Eigen::Index i = n; i + inputs < A_.cols(); ++i) A_(i, i + inputs) = piece_s;
    B_.topRows(n) = sampled.B;
  }
  Q_ = regular_.Q * (length_s / (pieces_ * period_s));
  // The noise is white from piece to piece: the mean over all pieces has the given variance.
  const double variance = interval.input_std * interval.input_std * pieces_ * weight_;
  for (Eigen::Index i = 0; variance > 0.0 && i < B_.cols(); ++i) {
    Q_.noalias() += variance * B_.col(i) * B_.col(i).transpose();
  }
  return true;
}

void KalmanEstimator::predict(const Vector& held_input, const Vector& y) {
  // NOLINTNEXTLINE(cert-flp30-c): pieces are whole numbers
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
  output(C_, innovation_);
  for (Eigen::Index i = 0; i < y.size(); ++i) innovation_(i) = y(i) - innovation_(i);
  compute_output_covariance();
  if (!(instant_std_s_ > 0.0)) return;
  // Adds the effect of the uncertain time to R.
  output(output_rate_, instant_error_);
  instant_error_.noalias() += input_rate_ * held_input;
  instant_error_ = instant_error_.cwiseAbs() * instant_std_s_;
  R_ = regular_.R;
  R_.diagonal() += weight_ * instant_error_.cwiseAbs2();
}

void KalmanEstimator::output(const Eigen::MatrixXd& C, Eigen::VectorXd& result) const {
  if (kernel_) {
    result(0) = kernel_->output(C.data(), extended_state_.data());
  } else {
    result.noalias() = C * extended_state_;
  }
}

void KalmanEstimator::compute_output_covariance() {
  if (kernel_) {
    output_covariance_(0) =
        kernel_->measure(covariance_.data(), C_.data(), measures_first_, output_cross_.data());
  } else {
    output_cross_.noalias() = C_ * covariance_;
    output_covariance_.noalias() = output_cross_ * C_.transpose();
  }
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
