#include <breakwater/observers/sensor_error.h>

#include <cmath>

#include <breakwater/math/refuse_unless.h>

namespace breakwater {

Eigen::VectorXd SensorError::variance() const {
  const double of_a_uniform_error = rounding == EncoderRounding::truncate ? 3.0 : 12.0;
  return quantum.cwiseAbs2() / of_a_uniform_error + noise_std.cwiseAbs2();
}

CodeRange code_range(double y, double quantum, EncoderRounding rounding) {
  const double half = 0.5 * quantum;
  if (rounding == EncoderRounding::nearest) return {-half, half};
  if (std::abs(y) < half) return {-quantum, quantum};
  return y > 0.0 ? CodeRange{0.0, quantum} : CodeRange{-quantum, 0.0};
}

void check(const SensorError& error, Eigen::Index outputs) {
  const auto fits = [outputs](const Eigen::VectorXd& values) {
    return values.size() == outputs && values.allFinite() && values.minCoeff() >= 0.0;
  };
  refuse_unless(fits(error.quantum) && fits(error.noise_std),
                "sensor error: needs a quantum and a standard deviation >= 0 for each output");
}

}  // namespace breakwater
