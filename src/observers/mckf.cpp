#include <breakwater/observers/mckf.h>

#include <algorithm>

#include <breakwater/math/functions.h>
#include <breakwater/math/refuse_unless.h>

namespace breakwater {
namespace {

constexpr int kIterations = 5;
constexpr double kSmallestWeight = 1e-4;

template <int N>
class Mckf final : public GuardedKalman<N> {
 public:
  Mckf(const KalmanDesign& design, const SensorError& sensor, const CorrentropyDesign& correntropy)
      : GuardedKalman<N>(design),
        kernel_width_(correntropy.kernel_width),
        likelihood_(correntropy.likelihood),
        sensor_(sensor) {
    refuse_unless(kernel_width_ > 0.0, "MCKF: the width of the kernel must be positive");
    this->signals_.push_back(
        {"lambda", "1", "c: weight of the predicted disturbance", view(this->lambda_)});
  }

 private:
  using typename GuardedKalman<N>::Vector;
  using typename GuardedKalman<N>::State;
  using typename GuardedKalman<N>::Covariance;

  void step(const Vector& held_input, const Vector& y) override {
    if (this->has_prior_) {
      sensor_.reset();
      outside_ = 1.0;
    }
    this->predict_sample(held_input, y);
    if (!this->is_measured_) {
      sensor_.reset();  // an edge passed in a gap has no date
      return;
    }
    const CodeSensor::Observation observed = sensor_.observe(y(0));
    sensor_.add_noise(this->instant_error_(0));
    const State predicted = this->extended_state_;
    Covariance P = this->covariance_;
    if (likelihood_ == Likelihood::code) {
      P *= sensor_.consistency(predicted(0), P(0, 0), observed).inflation;
    }
    const State p_d = P.col(N - 1);
    const double variance = p_d(N - 1);
    CodeSensor::Update found{};
    double R = this->R_(0, 0);
    for (int i = 0; i < kIterations; ++i) {
      const double moved = this->extended_state_(N - 1) - predicted(N - 1);
      const double weight =
          variance > 0.0
              ? math::exp(-0.5 * moved * moved / (kernel_width_ * kernel_width_ * variance))
              : 1.0;
      this->lambda_ = std::max(kSmallestWeight, weight);  // also if the weight is not a number
      // The first and the second column and variance of P′ are enough.
      const double raised = variance > 0.0 ? (1.0 / this->lambda_ - 1.0) / variance : 0.0;
      const State cross = P.col(0) + raised * p_d(0) * p_d;
      const double velocity_variance = P(1, 1) + raised * p_d(1) * p_d(1);
      if (likelihood_ == Likelihood::gauss) {
        found = {cross(0) + R, this->innovation_(0), 1.0, 0.0, true};
      } else {
        found = sensor_.update({predicted(0), cross(0), predicted(1), velocity_variance, outside_},
                               observed, this->interval_s_);
        if (!(found.fall > kSmallestFall)) found.fall = 0.0;
        R = found.fall > 0.0 ? found.S / found.fall - cross(0) : 0.0;
      }
      this->extended_state_ = predicted + cross * (found.shift / found.S);
      this->gain_ = cross * (found.fall / found.S);
    }
    Covariance error = Covariance::Identity();
    error.col(0) -= this->gain_;
    const Covariance corrected =
        error * P * error.transpose() + R * this->gain_ * this->gain_.transpose();
    this->covariance_ = 0.5 * (corrected + corrected.transpose());
    if (likelihood_ == Likelihood::code) {
      outside_ = found.is_fine
                     ? 1.0
                     : sensor_.outside(this->extended_state_(0), this->covariance_(0, 0), observed);
    }
  }

  double kernel_width_;
  Likelihood likelihood_;
  CodeSensor sensor_;
  double outside_ = 1.0;
};

}  // namespace

std::unique_ptr<KalmanEstimator> sized_mckf(const KalmanDesign& design, const SensorError& sensor,
                                            const CorrentropyDesign& correntropy) {
  return of_axis_size<Mckf>(design, sensor, correntropy);
}

}  // namespace breakwater
