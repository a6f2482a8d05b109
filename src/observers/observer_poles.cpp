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
      continuous_(discrete_),
      discrete_real_(discrete_.real()),
      discrete_imaginary_(discrete_real_),
      continuous_real_(discrete_real_),
      continuous_imaginary_(discrete_real_),
      signals_(
          {{"poles_discrete_re", "1", "eigenvalues of A - K C: real part", view(discrete_real_)},
           {"poles_discrete_im", "1", "their imaginary part", view(discrete_imaginary_)},
           {"poles_continuous_re_rad_s", "rad/s", "ln(p_d)/T_s: real part", view(continuous_real_)},
           {"poles_continuous_im_rad_s", "rad/s", "their imaginary part",
            view(continuous_imaginary_)}}) {
  refuse_unless(period_s > 0.0, "observer poles: the sampling period must be positive");
  if (estimator.poles() == 0) signals_.clear();
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
    continuous_(i) = math::log(p) / period_s_;
  }
  discrete_real_ = discrete_.real();
  discrete_imaginary_ = discrete_.imag();
  continuous_real_ = continuous_.real();
  continuous_imaginary_ = continuous_.imag();
}

}  // namespace breakwater
