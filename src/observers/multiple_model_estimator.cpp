#include <breakwater/observers/multiple_model_estimator.h>

#include <algorithm>
#include <cmath>

#include <breakwater/linear/eigenvalues.h>
#include <breakwater/math/functions.h>
#include <breakwater/math/refuse_unless.h>

namespace breakwater {
namespace {

constexpr double kSlowest_rad_s = 0.5;    // the smallest bandwidth
constexpr double kBandwidthRatio = 3.0;   // ratio of neighbouring bandwidths
constexpr double kFastestSamples = 12.0;  // upper bound of w T_s: poles near −1 let estimates ring
constexpr double kInertiaStd = 0.25;      // prior of θ
constexpr double kSmallestGain = 0.5;     // bounds of 1 + θ
constexpr double kLargestGain = 2.0;
constexpr double kGainVariance = 1e-3;  // variance of the pseudo-measurement that bounds 1 + θ
constexpr double kChances_per_s = 0.5;  // how often each model restarts
constexpr double kForgotten = 6.0;      // margin of a log-weight below that of a restart
constexpr double kAtRest = 1e-9;        // largest rate of a plant at rest, relative to A
constexpr double kCounts = 3.0;         // models within this log-weight of the best form the mean

// ẋ = A x + E d.
StateSpace disturbed(const MultipleModelDesign& design) {
  StateSpace plant = design.plant;
  if (design.E.size() > 0) plant.B = design.E;
  return plant;
}

// Rounding can make P indefinite: d and θ are hardly distinguishable while the input is constant.
template <typename Model>
bool is_degenerate(const Model& model) {
  return !std::isfinite(model.log_weight) || !model.x.allFinite() || !model.P.allFinite() ||
         !(model.P.diagonal().minCoeff() >= 0.0);
}

}  // namespace

template <int n>
MultipleModelBank<n>::MultipleModelBank(const MultipleModelDesign& design)
    : period_s_(design.period_s),
      plant_(design.plant),
      disturbed_plant_(disturbed(design)),
      piece_s_(design.period_s),
      sensor_(design.sensor) {
  check(design.plant);
  const StateSpace& plant = design.plant;
  const bool is_axis = plant.states() == n && plant.inputs() == 1 && plant.outputs() == 1 &&
                       plant.A.row(0) == Eigen::RowVectorXd::Unit(n, 1) && plant.B(0, 0) == 0.0 &&
                       (n > 2 || plant.B(1, 0) > 0.0) && disturbed_plant_.B(0, 0) == 0.0 &&
                       plant.C == Eigen::RowVectorXd::Unit(n, 0);
  if (is_axis) {
    at_rest_.setUnit(0);
    if constexpr (n > 2) {
      at_rest_.template tail<n - 1>() = least_squares(plant.A.rightCols(n - 1), -plant.A.col(0));
    }
  }
  refuse_unless(
      is_axis && (plant.A * at_rest_).norm() <= kAtRest * plant.A.norm(),
      "QBANK: needs a plant of one axis, [position; velocity] first, with measured position");
  refuse_unless(is_positive(design.largest_d), "QBANK: the largest disturbance must be positive");
  sample();
  const double quantum = design.sensor.quantum(0);
  const double sigma = design.sensor.noise_std(0);
  prior_variance_ =
      std::max(quantum * quantum / 12.0 + sigma * sigma, kCodeRounding * kCodeRounding);
  chance_ = std::max(math::log(1.0 / (kChances_per_s * period_s_)), 0.0);

  const double J = design.inertia > 0.0 ? design.inertia : 1.0 / plant.B(1, 0);
  const double rho = std::sqrt(prior_variance_);
  const double fastest =
      std::min(math::pow(design.largest_d / (J * rho * std::sqrt(period_s_)), 0.4) / 1.5,
               kFastestSamples / period_s_);
  models_ = {{Kind::constant}, {Kind::inertia}};
  double w = kSlowest_rad_s;
  while (w <= fastest) {
    const double per_sample = w * w * w * rho * period_s_ * J;
    models_.push_back({Kind::walk, w, per_sample * per_sample});
    models_.push_back({Kind::ramp, w, w * w * per_sample * per_sample});
    w *= kBandwidthRatio;
  }
  shares_.setZero(static_cast<Eigen::Index>(models_.size()));
  signals_ = {{"innovation", "", "e = y - q(k|k-1) of the best model", view(innovation_)},
              {"bank_weight", "1",
               "probability of each model: constant, inertia, then walk "
               "and ramp of each bandwidth",
               view(shares_)},
              {"bank_best", "1", "number of the most probable model, from 0", view(best_number_)},
              {"bank_bandwidth_rad_s", "rad/s", "bandwidth of this model; 0: constant or inertia",
               view(best_bandwidth_)}};
  start(PlantState::Zero());
}

template <int n>
void MultipleModelBank<n>::reset(const Vector& x) {
  follow({});
  sensor_.add_noise(0.0);
  start(x.head<n>());
}

template <int n>
bool MultipleModelBank<n>::follow(const SampleInterval& interval) {
  const double length_s = interval.length_s > 0.0 ? interval.length_s : period_s_;
  instant_std_s_ = interval.instant_std_s;
  if (instant_std_s_ == 0.0) sensor_.add_noise(0.0);
  pieces_ = pieces_of(length_s, period_s_);
  input_variance_ = interval.input_std * interval.input_std * pieces_;
  if (const double piece_s = length_s / pieces_; piece_s != piece_s_) {
    piece_s_ = piece_s;
    sample();
  }
  return true;
}

// The plant over a piece of the interval.
template <int n>
void MultipleModelBank<n>::sample() {
  const StateSpace sampled = zero_order_hold(plant_, piece_s_);
  A_ = sampled.A;
  B_ = sampled.B;
  E_ = n > 2 ? zero_order_hold(disturbed_plant_, piece_s_).B : sampled.B;
}

template <int n>
void MultipleModelBank<n>::start(const PlantState& x) {
  has_begun_ = false;
  sensor_.reset();
  last_input_ = 0.0;
  for (Model& model : models_) {
    model.x << x, 0.0, 0.0;
    model.P = prior_variance_ * Covariance::Identity();
    model.P(kLast, kLast) = 0.0;
    if (model.kind == Kind::inertia) model.P(kLast, kLast) = kInertiaStd * kInertiaStd;
    if (model.kind == Kind::ramp) {
      model.P(kLast, kLast) = model.bandwidth_rad_s * model.bandwidth_rad_s * prior_variance_;
    }
    model.log_weight = 0.0;
    model.outside = 1.0;
  }
  best_ = 0;
  innovation_ = 0.0;
  combine();
}

template <int n>
void MultipleModelBank<n>::update(const Vector& held_input, const Vector& y) {
  if (std::isfinite(held_input(0))) last_input_ = held_input(0);
  if (has_begun_) {
    for (Model& model : models_) predict(model, last_input_);
  }
  if (instant_std_s_ > 0.0) sensor_.add_noise(models_[best_].x(1) * instant_std_s_);
  has_begun_ = true;
  innovation_ = 0.0;
  if (std::isfinite(y(0))) {
    innovation_ = y(0) - models_[best_].x(0);
    const CodeSensor::Observation observed = sensor_.observe(y(0));
    for (Model& model : models_) model.log_weight += observe(model, observed);
    weigh();
  }
  combine();
}

// x̄ ← F x̄ + [B u; 0; 0], P ← F P Fᵀ + Q.
template <int n>
void MultipleModelBank<n>::predict(Model& model, double u) const {
  Covariance F = Covariance::Identity();
  F.template topLeftCorner<n, n>() = A_;
  F.template block<n, 1>(0, kD) = -E_;
  if (model.kind == Kind::inertia) F.template block<n, 1>(0, kLast) = B_ * u;
  if (model.kind == Kind::ramp) F(kD, kLast) = piece_s_;
  const double step_variance = model.step_variance * (piece_s_ / period_s_);
  for (int piece = 0; piece < pieces_; ++piece) {
    model.x = (F * model.x).eval();
    model.x.template head<n>() += B_ * u;
    const Covariance FP = F * model.P;
    model.P.noalias() = FP * F.transpose();
    if (model.kind == Kind::walk) model.P(kD, kD) += step_variance;
    if (model.kind == Kind::ramp) model.P(kLast, kLast) += step_variance;
    if (input_variance_ > 0.0) {
      model.P.template topLeftCorner<n, n>() += input_variance_ * B_ * B_.transpose();
    }
  }
}

// Corrects one model. Returns the log-likelihood of the observation.
template <int n>
double MultipleModelBank<n>::observe(Model& model, const CodeSensor::Observation& observed) const {
  const auto [inflation, charged] = sensor_.consistency(model.x(0), model.P(0, 0), observed);
  if (inflation > 1.0) model.P *= inflation;
  const CodeSensor::Update update =
      sensor_.update({model.x(0), model.P(0, 0), model.x(1), model.P(1, 1), model.outside},
                     observed, pieces_ * piece_s_);
  correct_along(model.x, model.P, 0, update.S, update.shift, update.fall);
  const double found = update.log_likelihood + keep_inertia(model);
  model.outside = update.is_fine ? 1.0 : sensor_.outside(model.x(0), model.P(0, 0), observed);
  return std::min(found, charged);
}

// Bounds 1 + θ by a pseudo-measurement. Returns its log-likelihood.
template <int n>
double MultipleModelBank<n>::keep_inertia(Model& model) {
  if (model.kind != Kind::inertia) return 0.0;
  const double gain = 1.0 + model.x(kLast);
  const double e = std::clamp(gain, kSmallestGain, kLargestGain) - gain;
  if (e == 0.0) return 0.0;
  const double S = model.P(kLast, kLast) + kGainVariance;
  correct_along(model.x, model.P, kLast, S, e, 1.0);
  return -0.5 * e * e / S;
}

template <int n>
void MultipleModelBank<n>::weigh() {
  double largest = -INFINITY;
  for (std::size_t i = 0; i < models_.size(); ++i) {
    Model& model = models_[i];
    if (is_degenerate(model)) model.log_weight = -INFINITY;
    if (model.log_weight > largest) {
      largest = model.log_weight;
      best_ = i;
    }
  }
  if (std::isinf(largest)) return start(sensor_.last_output() * at_rest_);
  for (Model& model : models_) {
    model.log_weight -= largest;
    if (model.log_weight < -(chance_ + kForgotten)) seed(model, models_[best_]);
  }
}

// Restarts `model` from the estimate of `from`, as far as the states agree, with the weight −L₀.
template <int n>
void MultipleModelBank<n>::seed(Model& model, const Model& from) const {
  const Kind had = from.kind;
  State x = from.x;
  Covariance P = from.P;
  const double u = last_input_;
  if (had != model.kind) {
    if (had == Kind::inertia) {
      // (1 + θ) u − d′ equals u − d for d = d′ − θ u.
      Covariance T = Covariance::Identity();
      T(kD, kLast) = -u;
      x = (T * x).eval();
      P = (T * P * T.transpose()).eval();
    }
    x(kLast) = 0.0;
    P.row(kLast).setZero();
    P.col(kLast).setZero();
    if (model.kind == Kind::inertia) {
      constexpr double variance = kInertiaStd * kInertiaStd;
      P(kLast, kLast) = variance;
      P(kD, kLast) = P(kLast, kD) = variance * u;
      P(kD, kD) += variance * u * u;
    } else if (model.kind == Kind::ramp) {
      P(kLast, kLast) = model.bandwidth_rad_s * model.bandwidth_rad_s * P(kD, kD);
    }
  }
  model.x = x;
  model.P = P;
  model.outside = from.outside;
  model.log_weight = -chance_;
}

template <int n>
void MultipleModelBank<n>::combine() {
  estimate_.setZero();
  shares_.setZero();
  double sum = 0.0;
  for (std::size_t i = 0; i < models_.size(); ++i) {
    const Model& model = models_[i];
    const double share = math::exp(model.log_weight);
    shares_(static_cast<Eigen::Index>(i)) = share;
    if (model.log_weight <= -kCounts) continue;
    const double gain = model.kind == Kind::inertia
                            ? std::clamp(1.0 + model.x(kLast), kSmallestGain, kLargestGain)
                            : 1.0;
    auto values = model.x.template head<n + 1>().eval();
    values(kD) /= gain;
    estimate_ += share * values;
    sum += share;
  }
  estimate_ /= sum;
  shares_ /= shares_.sum();
  best_number_ = static_cast<double>(best_);
  best_bandwidth_ = models_[best_].bandwidth_rad_s;
}

template class MultipleModelBank<2>;
template class MultipleModelBank<4>;

std::unique_ptr<DisturbanceEstimator> sized_multiple_model(const MultipleModelDesign& design) {
  if (design.plant.states() == 4) return std::make_unique<MultipleModelBank<4>>(design);
  return std::make_unique<MultipleModelBank<2>>(design);
}

}  // namespace breakwater
