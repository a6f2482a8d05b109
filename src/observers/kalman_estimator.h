// The Kalman recursion that all Kalman filters with disturbance estimation share.
#pragma once

#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <optional>
#include <stdexcept>
#include <vector>

#include <breakwater/linear/variable_hold.h>
#include <breakwater/observers/disturbance_estimator.h>
#include <breakwater/observers/kalman_design.h>
#include <breakwater/observers/one_output.h>
#include <breakwater/observers/record_intervals.h>

namespace breakwater {

/// The Kalman filter of an extended plant (Eqs. 4.11–4.17). An adaptive filter reads the innovation
/// between predict() and correct(). The sizes N (of x̄), m and p may be fixed at compile time.
template <int N = Eigen::Dynamic, int m = Eigen::Dynamic, int p = Eigen::Dynamic>
class KalmanEstimator : public DisturbanceEstimator {
 public:
  void reset(const Vector& x) final {
    extended_state_.setZero();
    extended_state_.head(x.size()) = x;
    covariance_ = initial_covariance_;
    gain_.setZero();
    innovation_.setZero();
    has_prior_ = true;
    if (hold_) follow({});
  }

  /// For another interval h, samples the plant anew and scales Q by h/T_s. Predicts once for each
  /// missing sample. input_std enters as process noise through B̅. instant_std_s enters as an
  /// output error, multiplied by the output's rate. Returns false without a continuous plant.
  bool follow(const SampleInterval& interval) final {
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

  View state() const final { return {extended_state_.data(), plant_states_}; }
  View disturbance() const final { return {extended_state_.data() + plant_states_, B_.cols()}; }
  std::span<const Signal> signals() const final { return signals_; }

  Eigen::Index poles() const final { return A_.rows(); }
  void pole_matrix(Eigen::Ref<Eigen::MatrixXd> F) const final {
    F = A_;
    F.noalias() -= gain_ * C_;
  }

  /// x̄(k|k), P(k|k), K(k), ê(k) and the forgetting factor λ(k), which divided P at this sample.
  const auto& extended_state() const { return extended_state_; }
  const auto& P() const { return covariance_; }
  const auto& K() const { return gain_; }
  const auto& innovation() const { return innovation_; }
  double lambda() const { return lambda_; }

 protected:
  using Outputs = Eigen::Matrix<double, p, 1>;
  using OutputCovariance = Eigen::Matrix<double, p, p>;
  using Covariance = Eigen::Matrix<double, N, N>;
  /// For one output and a few states, scalar operations take half the time of matrix products.
  static constexpr bool kOneOutput = p == 1 && N != Eigen::Dynamic && N <= 6;

  /// Throws std::invalid_argument if the design is invalid or its sizes differ from N, m and p.
  explicit KalmanEstimator(const KalmanDesign& design) : plant_states_(design.plant.plant_states) {
    check(design);
    const auto fits = [](int fixed, Eigen::Index size) {
      return fixed == Eigen::Dynamic || fixed == size;
    };
    if (!fits(N, design.plant.states()) || !fits(m, design.plant.inputs()) ||
        !fits(p, design.plant.outputs())) {
      throw std::invalid_argument("Kalman filter: the sizes of the plant do not fit");
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
    measures_first_ = C_ == Eigen::Matrix<double, p, N>::Identity(C_.rows(), C_.cols());
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
    work_ = initial_covariance_;
    signals_ = {{"innovation", "", "e = y - C x(k|k-1) (Eq. 4.15)", view(innovation_)},
                {"lambda", "1", "forgetting factor: P was divided by it", view(lambda_)}};
    reset(Eigen::VectorXd::Zero(plant_states_));
  }

  /// Computes x̄(k|k−1), P(k|k−1) (Eqs. 4.11, 4.12), ê(k) (Eq. 4.15) and C̅ P(k|k−1) C̅ᵀ.
  void predict(const Vector& held_input, const Vector& y) {
    for (double piece = 0.0; !has_prior_ && piece < pieces_; piece += 1.0) {
      predicted_.noalias() = A_ * extended_state_;
      predicted_.noalias() +=
          B_ * Eigen::Map<const Eigen::Matrix<double, m, 1>>(held_input.data(), held_input.size());
      extended_state_ = predicted_;
      if constexpr (kOneOutput) {
        one_output::predict_covariance<N>(A_, Q_, covariance_);
      } else {
        work_.noalias() = A_ * covariance_;
        covariance_.noalias() = work_ * A_.transpose();
        covariance_ += Q_;
      }
    }
    has_prior_ = false;
    innovation_ = Eigen::Map<const Outputs>(y.data(), y.size());
    innovation_.noalias() -= C_ * extended_state_;
    compute_output_covariance();
    if (instant_std_s_ > 0.0) correct_for_instant(held_input);
  }

  /// Adds the effect of the uncertain time to R.
  void correct_for_instant(const Vector& held_input) {
    instant_error_.noalias() = output_rate_ * extended_state_;
    instant_error_.noalias() += input_rate_ * held_input;
    instant_error_ = instant_error_.cwiseAbs() * instant_std_s_;
    R_ = regular_R_;
    R_.diagonal() += weight_ * instant_error_.cwiseAbs2();
  }

  /// Computes C̅ P and C̅ P C̅ᵀ.
  void compute_output_covariance() {
    if constexpr (kOneOutput) {
      output_cross_ =
          one_output::times<N>(covariance_, C_.transpose(), measures_first_).transpose();
      output_covariance_(0, 0) =
          measures_first_ ? output_cross_(0, 0) : one_output::product<N>(output_cross_, C_);
    } else {
      output_cross_.noalias() = C_ * covariance_;
      output_covariance_.noalias() = output_cross_ * C_.transpose();
    }
  }

  /// D = C̅ P C̅ᵀ + R, K = P C̅ᵀ D⁻¹, x̄(k|k) and P(k|k) (Eqs. 4.13, 4.14, 4.16, 4.17). Joseph's
  /// form keeps the covariance positive definite, unlike (I − K C̅) P:
  ///     (I − K C̅) P (I − K C̅)ᵀ + K R Kᵀ = M + (K R − M C̅ᵀ) Kᵀ   with   M = P − K (C̅ P).
  void correct(const OutputCovariance& R) {
    if constexpr (kOneOutput) {
      correct_one(R(0, 0), 1.0 / (output_covariance_(0, 0) + R(0, 0)),
                  [](int, int) { return 1.0; });
      return;
    }
    if constexpr (p == 1) {
      gain_ = output_cross_.transpose() / (output_covariance_(0, 0) + R(0, 0));
    } else {
      output_covariance_ += R;
      factor_.compute(output_covariance_);
      solved_ = output_cross_;
      factor_.solveInPlace(solved_);
      gain_ = solved_.transpose();
    }
    extended_state_.noalias() += gain_ * innovation_;

    work_ = covariance_;
    work_.noalias() -= gain_ * output_cross_;  // M
    slope_.noalias() = gain_ * R;
    slope_.noalias() -= work_ * C_.transpose();
    work_.noalias() += slope_ * gain_.transpose();
    covariance_ = 0.5 * (work_ + work_.transpose());
  }

  /// The same for one output, with 1/D given. Multiplies P(k|k) by inflation(i, j).
  template <typename Inflation>
  void correct_one(double R, double D_inverse, const Inflation& inflation) {
    gain_ = output_cross_.transpose() * D_inverse;
    extended_state_ += gain_ * innovation_(0);
    one_output::correct<N>(covariance_, gain_, output_cross_.transpose(), C_.transpose(),
                           measures_first_, R, inflation);
  }

  Eigen::Index plant_states_;
  bool has_prior_ = true;  // before the first sample after a reset: P0 is P(k|k−1)
  Covariance A_;
  Eigen::Matrix<double, N, m> B_;
  Eigen::Matrix<double, p, N> C_;
  bool measures_first_ = false;  // C̅ = (1, 0, …)
  Covariance Q_;
  OutputCovariance R_;
  Covariance initial_covariance_;

  Eigen::Matrix<double, N, 1> extended_state_;
  Covariance covariance_;
  Eigen::Matrix<double, N, p> gain_;
  Outputs innovation_;
  OutputCovariance output_covariance_;
  double lambda_ = 1.0;
  Outputs instant_error_;  // a standard deviation
  double interval_s_ = 0.0;
  std::vector<Signal> signals_;

 private:
  // The matrices for one period. A̅, B̅, Q and R are those of the last interval.
  Covariance regular_A_;
  Eigen::Matrix<double, N, m> regular_B_;
  Covariance regular_Q_;
  OutputCovariance regular_R_;
  double period_s_ = 0.0;
  std::optional<VariableHold> hold_;
  Eigen::Matrix<double, p, N> output_rate_;  // ẏ = output_rate_ x̄ + input_rate_ u
  Eigen::Matrix<double, p, m> input_rate_;
  double instant_std_s_ = 0.0;
  double weight_ = 1.0;  // R in units of the output's variance
  double pieces_ = 1.0;  // number of predictions in an interval

  Eigen::Matrix<double, N, 1> predicted_;
  Eigen::Matrix<double, p, N> output_cross_;  // C̅ P(k|k−1)
  Eigen::Matrix<double, p, N> solved_;        // D⁻¹ C̅ P(k|k−1) = Kᵀ
  Eigen::Matrix<double, N, p> slope_;         // K R − M C̅ᵀ
  Covariance work_;
  Eigen::LLT<OutputCovariance> factor_;
};

}  // namespace breakwater
