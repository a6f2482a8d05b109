// Multiple-model estimator with the encoder's exact likelihood (QBANK).
#pragma once

#include <Eigen/Core>
#include <memory>
#include <vector>

#include <breakwater/linear/state_space.h>
#include <breakwater/observers/code_sensor.h>
#include <breakwater/observers/disturbance_estimator.h>

namespace breakwater {

struct MultipleModelDesign {
  /// Continuous, one input and the measured position q as its first state, q̇ as its second. With
  /// two states J q̈ = u − d − c q̇. With four states the other two belong to a second inertia.
  StateSpace plant;
  double period_s = 0.0;   ///< T_s
  SensorError sensor;      ///< error of q; the noise is added to the code, not before rounding
  double largest_d = 0.0;  ///< D > 0, the largest disturbance; it bounds the bandwidths
  Eigen::VectorXd E = {};  ///< ẋ = A x + B u − E d; empty: E = B
  double inertia = 0.0;    ///< J, that of the whole plant at its measured position; 0: 1/B₂
};

/// Several Kalman filters on x̄ = [x, d, ·], x = [q, v] or [q, v, q₂, v₂], with different
/// disturbance models, weighed by their probabilities. With ρ² = Δ²/12 + σ² and the held input u:
///     constant: d(k+1) = d(k);
///     inertia:  d′ constant and the plant's inertia J/(1 + θ), θ ~ N(0, ¼²), so that
///               q̈ = ((1 + θ) u − d′ − c q̇)/J and d̂ = d′/(1 + θ̂); 1 + θ̂ is bounded to [½, 2]
///               (with four states 1 + θ divides both inertias and the stiffness);
///     walk:     d(k+1) = d(k) + N(0, w⁶ρ²T_sJ²T_s), with the bandwidth w;
///     ramp:     d(k+1) = d(k) + T_s ḋ(k), ḋ(k+1) = ḋ(k) + N(0, w⁸ρ²T_s²J²);
/// The bandwidths are w = ½·3ⁱ [1/s] up to (D/(J ρ √T_s))^0.4/1.5, and at most 30/T_s.
///
/// Each code y corrects each model (CodeSensor), and the log-likelihoods add up to log-weights, of
/// which the best is 0. A model below −(L₀ + 6), L₀ = ln(2/T_s), restarts from the best one with
/// −L₀, so it gets a new chance about every two seconds. x̂ and d̂ are the weighted means of the
/// models above −3. If y is not finite, the models only predict. Derivation:
/// docs/explanation/methods/multiple-model-estimator.md.
///
/// `n` is the number of the plant's states, 2 or 4. update() allocates nothing.
template <int n>
class MultipleModelBank final : public DisturbanceEstimator {
 public:
  using PlantState = Eigen::Matrix<double, n, 1>;
  using PlantMatrix = Eigen::Matrix<double, n, n>;
  using State = Eigen::Matrix<double, n + 2, 1>;
  using Covariance = Eigen::Matrix<double, n + 2, n + 2>;

  enum class Kind { constant, inertia, walk, ramp };

  /// One Kalman filter with its disturbance model.
  struct Model {
    Kind kind = Kind::constant;
    double bandwidth_rad_s = 0.0;  ///< w; 0 for constant and inertia
    double step_variance = 0.0;    ///< process noise of the last state in one sample
    State x = State::Zero();       ///< [q, v, d, θ or ḋ], [q, v, q₂, v₂, d, θ or ḋ]
    Covariance P = Covariance::Zero();
    double log_weight = 0.0;
    double outside = 1.0;  ///< probability outside the code's interval after the last update
  };

  /// The plant must have n states and one axis with measured position, and must be able to rest at
  /// every position. T_s and D must be positive, and the sensor's errors not negative. Throws
  /// std::invalid_argument otherwise.
  explicit MultipleModelBank(const MultipleModelDesign& design);

  void reset(const Vector& x) override;
  void update(const Vector& held_input, const Vector& y) override;
  bool follow(const SampleInterval& interval) override;

  View state() const override { return {estimate_.data(), n}; }
  View disturbance() const override { return {estimate_.data() + n, 1}; }

  const std::vector<Model>& models() const { return models_; }

 private:
  static constexpr int kD = n, kLast = n + 1;  // indices in x̄

  void sample();
  void start(const PlantState& x);
  void predict(Model& model, double u) const;
  double observe(Model& model, const CodeSensor::Observation& observed) const;
  static double keep_inertia(Model& model);
  void weigh();
  void seed(Model& model, const Model& from) const;
  void combine();

  double period_s_;
  StateSpace plant_;
  StateSpace disturbed_plant_;  // [A E]
  PlantMatrix A_;               // the sampled plant
  PlantState B_;
  PlantState E_;
  PlantState at_rest_;  // the state at rest at q = 1
  // The prediction of the last interval: number and length of its pieces, variance of the input in
  // each, and standard deviation of the measurement's time.
  double pieces_ = 1.0;
  double piece_s_;
  double input_variance_ = 0.0;
  double instant_std_s_ = 0.0;
  CodeSensor sensor_;
  double prior_variance_;  // ρ² = Δ²/12 + σ², the variance within a code's interval
  double chance_;          // L₀
  double last_input_ = 0.0;
  bool has_begun_ = false;

  std::vector<Model> models_;
  std::size_t best_ = 0;
  Eigen::Matrix<double, n + 1, 1> estimate_ = Eigen::Matrix<double, n + 1, 1>::Zero();
  double innovation_ = 0.0;
  Eigen::VectorXd shares_;
  double best_number_ = 0.0;
  double best_bandwidth_ = 0.0;
};

using MultipleModelEstimator = MultipleModelBank<2>;

/// The bank of the plant's size. Throws as its class does.
std::unique_ptr<DisturbanceEstimator> sized_multiple_model(const MultipleModelDesign& design);

}  // namespace breakwater
