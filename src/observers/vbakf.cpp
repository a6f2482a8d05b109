#include <breakwater/observers/vbakf.h>

namespace breakwater {
namespace {

template <int N>
class Vbakf final : public GuardedKalman<N> {
 public:
  Vbakf(const KalmanDesign& design, const VariationalDesign& variational)
      : GuardedKalman<N>(design), variational_(variational) {
    refuse_unless(variational.forgetting > 0.0 && variational.forgetting <= 1.0 &&
                      variational.prior_samples > 0.0 && variational.iterations >= 1,
                  "VBAKF: needs a forgetting factor within (0, 1], a positive weight of the "
                  "prediction and at least one iteration");
    this->signals_.push_back({"noise_variance", "",
                              "estimate of R, in the unit of the output squared",
                              view(noise_variance_)});
  }

 private:
  using typename GuardedKalman<N>::Vector;
  using typename GuardedKalman<N>::State;
  using typename GuardedKalman<N>::Covariance;

  void step(const Vector& held_input, const Vector& y) override {
    const double rho = variational_.forgetting;
    const bool adapts = rho < 1.0;
    if (this->has_prior_) {
      noise_variance_ = this->R_(0, 0);
      degrees_ = adapts ? 1.0 / (1.0 - rho) : 0.0;
      scale_ = degrees_ * noise_variance_;
    }
    this->predict_sample(held_input, y);
    if (!this->is_measured_) return;
    auto& x = this->extended_state_;
    auto& P = this->covariance_;
    const State predicted = x;
    const Covariance nominal = P;
    const double tau = variational_.prior_samples;
    const double degrees = rho * degrees_;
    const double scale = rho * scale_;
    double square = 0.0;
    for (int i = 0; i < variational_.iterations; ++i) {
      const State moved = x - predicted;
      const Covariance prior =
          (nominal + (P + moved * moved.transpose() - nominal) / (tau + 1.0)).eval();
      const double e = y(0) - x(0);
      square = e * e + P(0, 0);
      const double R = adapts ? (scale + square) / (degrees + 1.0) : this->R_(0, 0);
      x = predicted;
      P = prior;
      this->compute_output_covariance();
      this->correct(R);
      noise_variance_ = R;
    }
    degrees_ = degrees + 1.0;
    scale_ = scale + square;
    if (!std::isfinite(scale_)) noise_variance_ = this->R_(0, 0);  // the filter starts again
  }

  bool is_sound() const override { return std::isfinite(scale_) && GuardedKalman<N>::is_sound(); }

  VariationalDesign variational_;
  double degrees_ = 0.0;  // ν
  double scale_ = 0.0;    // T
  double noise_variance_ = 0.0;
};

}  // namespace

std::unique_ptr<KalmanEstimator> sized_vbakf(const KalmanDesign& design,
                                             const VariationalDesign& variational) {
  return of_axis_size<Vbakf>(design, variational);
}

}  // namespace breakwater
