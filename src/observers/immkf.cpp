#include <breakwater/observers/immkf.h>

#include <algorithm>

#include <breakwater/math/functions.h>
#include <breakwater/math/refuse_unless.h>

namespace breakwater {
namespace {

template <int N>
class Immkf final : public GuardedKalman<N> {
 public:
  Immkf(const KalmanDesign& design, const SensorError& sensor, const ImmDesign& imm)
      : GuardedKalman<N>(design),
        noise_ratio_{1.0, imm.noise_ratio},
        likelihood_(imm.likelihood),
        sensor_(sensor) {
    refuse_unless(is_positive(imm.noise_ratio), "IMMKF: the ratio of the noises must be positive");
    for (const double stays : {imm.stays_quiet, imm.stays_busy}) {
      refuse_unless(stays >= 0.0 && stays <= 1.0, "IMMKF: a probability must be within 0 and 1");
    }
    transition_ << imm.stays_quiet, 1.0 - imm.stays_quiet, 1.0 - imm.stays_busy, imm.stays_busy;
    weights_.setConstant(1.0 / kModels);
    this->signals_.push_back(
        {"model_weight", "1", "probability of the quiet and of the busy model", view(weights_)});
  }

 private:
  using typename GuardedKalman<N>::Vector;
  using typename GuardedKalman<N>::State;
  using typename GuardedKalman<N>::Covariance;
  static constexpr int kModels = 2;

  struct Model {
    State x;
    Covariance P;
    double outside;
  };

  void step(const Vector& held_input, const Vector& y) override {
    const bool begins = this->has_prior_;
    Eigen::Vector2d prior = weights_;
    if (begins) {
      sensor_.reset();
      prior.setConstant(1.0 / kModels);
      mixed_.fill({this->extended_state_, this->covariance_, 1.0});
    } else {
      const Eigen::Vector2d before = weights_;
      prior = transition_.transpose() * before;
      for (int j = 0; j < kModels; ++j) {
        mixed_[j] = models_[j];
        if (prior(j) > 0.0) {
          const Eigen::Vector2d shares = transition_.col(j).cwiseProduct(before) / prior(j);
          mix(models_, shares, mixed_[j].x, mixed_[j].P);
          mixed_[j].outside = shares(0) * models_[0].outside + shares(1) * models_[1].outside;
        }
      }
    }
    CodeSensor::Observation observed{};
    if (this->is_measured_) {
      observed = sensor_.observe(y(0));
    } else {
      sensor_.reset();  // an edge passed in a gap has no date
    }
    const double quiet_noise = this->Q_(N - 1, N - 1);
    Eigen::Vector2d log_likelihoods = Eigen::Vector2d::Zero();
    double innovation = 0.0;
    State gain = State::Zero();
    std::array<State, kModels> gains;
    for (int j = 0; j < kModels; ++j) {
      this->extended_state_ = mixed_[j].x;
      this->covariance_ = mixed_[j].P;
      this->has_prior_ = begins;
      this->Q_(N - 1, N - 1) = noise_ratio_[j] * quiet_noise;
      this->predict_sample(held_input, y);
      if (this->is_measured_) log_likelihoods(j) = correct_model(mixed_[j].outside, observed);
      innovation += prior(j) * this->innovation_(0);
      gains[j] = this->gain_;
      models_[j] = {this->extended_state_, this->covariance_, mixed_[j].outside};
    }
    this->Q_(N - 1, N - 1) = quiet_noise;
    const double best = log_likelihoods.maxCoeff();
    for (int j = 0; j < kModels; ++j) {
      weights_(j) = prior(j) * math::exp(log_likelihoods(j) - best);
    }
    if (const double sum = weights_.sum(); sum > 0.0 && std::isfinite(sum)) {
      weights_ /= sum;
    } else {
      weights_ = prior;
    }
    mix(models_, weights_, this->extended_state_, this->covariance_);
    for (int j = 0; j < kModels; ++j) gain += weights_(j) * gains[j];
    this->gain_ = gain;
    this->innovation_(0) = innovation;
  }

  // Corrects extended_state_ and covariance_ and returns the log-likelihood.
  double correct_model(double& outside, const CodeSensor::Observation& observed) {
    auto& x = this->extended_state_;
    auto& P = this->covariance_;
    if (likelihood_ == Likelihood::gauss) {
      const double e = this->innovation_(0);
      const double S = P(0, 0) + this->R_(0, 0);
      this->correct(this->R_);
      return log_density(e, S);
    }
    sensor_.add_noise(this->instant_error_(0));
    const auto [inflation, charged] = sensor_.consistency(x(0), P(0, 0), observed);
    P *= inflation;
    const CodeSensor::Update found =
        sensor_.update({x(0), P(0, 0), x(1), P(1, 1), outside}, observed, this->interval_s_);
    this->gain_ = P.col(0) * (found.fall / found.S);
    correct_along(x, P, 0, found.S, found.shift, found.fall);
    outside = found.is_fine ? 1.0 : sensor_.outside(x(0), P(0, 0), observed);
    return std::min(found.log_likelihood, charged);
  }

  Eigen::Matrix2d transition_;  // T
  std::array<double, kModels> noise_ratio_;
  Likelihood likelihood_;
  CodeSensor sensor_;
  std::array<Model, kModels> models_;
  std::array<Model, kModels> mixed_;
  Eigen::Vector2d weights_;  // μ
};

}  // namespace

std::unique_ptr<KalmanEstimator> sized_immkf(const KalmanDesign& design, const SensorError& sensor,
                                             const ImmDesign& imm) {
  return of_axis_size<Immkf>(design, sensor, imm);
}

}  // namespace breakwater
