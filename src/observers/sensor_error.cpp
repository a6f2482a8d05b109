#include <breakwater/observers/sensor_error.h>

#include <stdexcept>

namespace breakwater {

void check(const SensorError& error, Eigen::Index outputs) {
  const auto fits = [outputs](const Eigen::VectorXd& values) {
    return values.size() == outputs && values.allFinite() && values.minCoeff() >= 0.0;
  };
  if (!fits(error.quantum) || !fits(error.noise_std)) {
    throw std::invalid_argument(
        "sensor error: needs a quantum and a standard deviation >= 0 for each output");
  }
}

}  // namespace breakwater
