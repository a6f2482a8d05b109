#include <breakwater/observers/stf.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace breakwater {
namespace {

constexpr double kPriorShare = 0.01;
constexpr double kNoiseShare = 5.0;
constexpr double kUncertaintyShare = 2.0;
constexpr double kInflationGain = 4.0;
constexpr double kLargestInflation = 1e6;

}  // namespace

KalmanDesign stf_design(const ExtendedPlant& plant, const SensorError& error, double period_s) {
  check(error, plant.outputs());
  if (!(period_s > 0.0)) throw std::invalid_argument("STF: the sampling period must be positive");
  const Eigen::VectorXd variance = error.variance().cwiseMax(kSmallestVariance);
  Eigen::VectorXd prior =
      Eigen::VectorXd::Constant(plant.states(), kPriorShare * variance.maxCoeff());
  prior.tail(plant.states() - plant.plant_states) /= period_s * period_s;
  return {plant, Eigen::MatrixXd::Zero(plant.states(), plant.states()), variance.asDiagonal(),
          prior.asDiagonal()};
}

Stf::Stf(const KalmanDesign& design, const SensorError& error) : KalmanEstimator(design) {
  check(error, design.plant.outputs());
  gate_ = error.quantum + kNoiseShare * error.noise_std;
}

void Stf::update(const Vector& held_input, const Vector& y) {
  predict(held_input, y);
  const double factor = inflation();
  lambda_ = 1.0;
  if (factor > 1.0) {
    lambda_ = 1.0 / factor;
    covariance_ *= factor;
    compute_output_covariance();
  }
  correct(R_);
}

double Stf::inflation() const {
  double factor = 1.0;
  for (Eigen::Index i = 0; i < gate_.size(); ++i) {
    const double e = std::abs(innovation_(i));
    const double P_ii = output_covariance_(i, i);
    const double gate = gate_(i) + kNoiseShare * instant_error_(i);
    if (e > gate + kUncertaintyShare * std::sqrt(P_ii)) {
      factor = std::max(factor, kInflationGain * e * e / (P_ii + R_(i, i)));
    }
  }
  return std::min(factor, kLargestInflation);
}

}  // namespace breakwater
