#include <breakwater/observers/observer_poles.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <cstring>
#include <limits>
#include <utility>

#include <breakwater/math/functions.h>
#include <breakwater/math/refuse_unless.h>

namespace breakwater {

ObserverPoles::ObserverPoles(const DisturbanceEstimator& estimator, double period_s)
    : estimator_(estimator),
      period_s_(period_s),
      matrix_(Eigen::MatrixXd::Zero(estimator.poles(), estimator.poles())),
      solved_(Eigen::MatrixXd::Constant(estimator.poles(), estimator.poles(),
                                        std::numeric_limits<double>::quiet_NaN())),
      solver_(estimator.poles()),
      discrete_(Eigen::VectorXcd::Zero(estimator.poles())),
      parts_(Eigen::MatrixX4d::Zero(estimator.poles(), 4)) {
  refuse_unless(period_s > 0.0, "observer poles: the sampling period must be positive");
  if (estimator.poles() == 0) return;
  const auto part = [this](Eigen::Index column) -> std::span<const double> {
    return {parts_.col(column).data(), static_cast<std::size_t>(parts_.rows())};
  };
  signals_ = {{"poles_discrete_re", "1", "eigenvalues of A - K C: real part", part(0)},
              {"poles_discrete_im", "1", "their imaginary part", part(1)},
              {"poles_continuous_re_rad_s", "rad/s", "ln(p_d)/T_s: real part", part(2)},
              {"poles_continuous_im_rad_s", "rad/s", "their imaginary part", part(3)}};
}

void ObserverPoles::update() {
  if (discrete_.size() == 0) return;
  estimator_.pole_matrix(matrix_);
  // Compares the bits: the sign of a zero may change a pole.
  const auto bytes = static_cast<std::size_t>(matrix_.size()) * sizeof(double);
  if (std::memcmp(matrix_.data(), solved_.data(), bytes) == 0) return;
  solved_ = matrix_;
  discrete_ = solver_.solve(matrix_);
  std::sort(discrete_.begin(), discrete_.end(), [](const auto& a, const auto& b) {
    return std::pair(a.real(), a.imag()) < std::pair(b.real(), b.imag());
  });
  for (Eigen::Index i = 0; i < discrete_.size(); ++i) {
    // A pole at 0 has no continuous pole. The smallest positive number replaces it.
    const bool is_zero = std::abs(discrete_(i)) < std::numeric_limits<double>::min();
    const std::complex<double> p = is_zero ? std::numeric_limits<double>::min() : discrete_(i);
    const std::complex<double> continuous = math::log(p) / period_s_;
    parts_.row(i) << discrete_(i).real(), discrete_(i).imag(), continuous.real(), continuous.imag();
  }
}

}  // namespace breakwater
