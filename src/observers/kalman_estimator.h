// The design of a Kalman filter of a plant, and the recursion that all Kalman filters with
// disturbance estimation share.
#pragma once

#include <Eigen/Cholesky>
#include <Eigen/Core>

#include <breakwater/observers/disturbance_estimator.h>
#include <breakwater/observers/disturbance_model.h>

namespace breakwater {

/// The estimates depend on the ratios of Q, R and P0 alone.
struct KalmanDesign {
  ExtendedPlant plant;
  Eigen::MatrixXd Q;   ///< N×N: covariance of the process noise in one sample
  Eigen::MatrixXd R;   ///< p×p: covariance of the measurement noise (Eq. 3.6)
  Eigen::MatrixXd P0;  ///< N×N: P(0|−1), the covariance before the first measurement
};

/// Throws std::invalid_argument unless the shapes fit, Q is symmetric positive semidefinite, and R
/// and P0 are symmetric positive definite. No value may be above 1e100.
void check(const KalmanDesign& design);

/// The process noise of the KFD. It enters like the input: Q = B̅ q B̅ᵀ (Eqs. 3.5, 3.8, 4.12). The
/// disturbance has no process noise, so its gain falls as 1/k.
inline Eigen::MatrixXd input_noise(const ExtendedPlant& plant, double q) {
  return plant.sampled.B * q * plant.sampled.B.transpose();
}

/// The other process noise of a KFD, Q = q·I on every state.
inline Eigen::MatrixXd uniform_noise(const ExtendedPlant& plant, double q) {
  return q * Eigen::MatrixXd::Identity(plant.states(), plant.states());
}

/// The process noise of the disturbance Kalman filter (DKF): on d (order 0) or its highest
/// derivative alone.
inline Eigen::MatrixXd disturbance_noise(const ExtendedPlant& plant, double q) {
  Eigen::MatrixXd Q = Eigen::MatrixXd::Zero(plant.states(), plant.states());
  Q.diagonal().tail(plant.inputs()).setConstant(q);
  return Q;
}

/// The fixed-size operations of a filter with one output.
struct OneOutputKernel;

/// The Kalman filter of an extended plant (Eqs. 4.11–4.17). An adaptive filter reads the innovation
/// between predict() and correct(). A filter with one input, one output and up to six extended
/// states is several times faster than a larger one: docs/explanation/performance.md.
class KalmanEstimator : public DisturbanceEstimator {
 public:
  void reset(const Vector& x) final;

  /// For another interval h, samples the plant anew and scales Q by h/T_s. Predicts once for each
  /// missing sample. input_std enters as process noise through B̅. instant_std_s enters as an
  /// output error, multiplied by the output's rate. Returns false without a continuous plant.
  bool follow(const SampleInterval& interval) final;

  View state() const final { return {extended_state_.data(), plant_states()}; }
  View disturbance() const final { return {extended_state_.data() + plant_states(), B_.cols()}; }

  Eigen::Index poles() const final { return A_.rows(); }
  void pole_matrix(Eigen::Ref<Eigen::MatrixXd> F) const final {
    F = A_;
    F.noalias() -= gain_ * C_;
  }

  /// x̄(k|k), P(k|k), K(k), ê(k) and the forgetting factor λ(k), which divided P at this sample.
  const Eigen::VectorXd& extended_state() const { return extended_state_; }
  const Eigen::MatrixXd& P() const { return covariance_; }
  const Eigen::MatrixXd& K() const { return gain_; }
  const Eigen::VectorXd& innovation() const { return innovation_; }
  double lambda() const { return lambda_; }

 protected:
  /// Throws std::invalid_argument if the design is invalid. P need not be symmetric if
  /// `is_symmetric` is false.
  explicit KalmanEstimator(const KalmanDesign& design, bool is_symmetric = true);

  /// Computes x̄(k|k−1), P(k|k−1) (Eqs. 4.11, 4.12), ê(k) (Eq. 4.15) and C̅ P(k|k−1) C̅ᵀ.
  void predict(const Vector& held_input, const Vector& y);

  /// Computes C̅ P and C̅ P C̅ᵀ.
  void compute_output_covariance();

  /// D = C̅ P C̅ᵀ + R, K = P C̅ᵀ D⁻¹, x̄(k|k) and P(k|k) (Eqs. 4.13, 4.14, 4.16, 4.17). Joseph's
  /// form keeps the covariance positive definite, unlike (I − K C̅) P:
  ///     (I − K C̅) P (I − K C̅)ᵀ + K R Kᵀ = M + (K R − M C̅ᵀ) Kᵀ   with   M = P − K (C̅ P).
  void correct(const Eigen::MatrixXd& R);

  /// The same for one output, if there is a kernel_. Multiplies P(k|k) by `inflation`.
  void correct(double R) { correct(R, 1.0 / (output_covariance_(0, 0) + R), 1.0); }
  void correct(double R, double D_inverse, double inflation);

  const OneOutputKernel* kernel_;  // nullptr: matrix products
  bool has_prior_ = true;          // before the first sample after a reset: P0 is P(k|k−1)
  Eigen::MatrixXd A_;
  Eigen::MatrixXd B_;
  Eigen::MatrixXd C_;
  bool measures_first_ = false;  // C̅ = (1, 0, …)
  Eigen::MatrixXd Q_;
  Eigen::MatrixXd R_;

  Eigen::VectorXd extended_state_;
  Eigen::MatrixXd covariance_;
  Eigen::MatrixXd gain_;
  Eigen::VectorXd innovation_;
  Eigen::MatrixXd output_cross_;  // C̅ P(k|k−1)
  Eigen::MatrixXd output_covariance_;
  double lambda_ = 1.0;
  Eigen::VectorXd instant_error_;  // a standard deviation
  double interval_s_ = 0.0;

 private:
  // result = C x̄.
  void output(const Eigen::MatrixXd& C, Eigen::VectorXd& result) const;

  Eigen::Index plant_states() const { return regular_.plant.plant_states; }

  KalmanDesign regular_;         // for one period. A̅, B̅, Q and R are those of the last interval
  Eigen::MatrixXd output_rate_;  // ẏ = output_rate_ x̄ + input_rate_ u
  Eigen::MatrixXd input_rate_;
  double instant_std_s_ = 0.0;
  double weight_ = 1.0;  // R in units of the output's variance
  double pieces_ = 1.0;  // number of predictions in an interval

  Eigen::VectorXd predicted_;
  Eigen::MatrixXd solved_;  // D⁻¹ C̅ P(k|k−1) = Kᵀ
  Eigen::MatrixXd slope_;   // K R − M C̅ᵀ
  Eigen::MatrixXd work_;
  Eigen::LLT<Eigen::MatrixXd> factor_;
};

}  // namespace breakwater
