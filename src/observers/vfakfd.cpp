#include <breakwater/observers/vfakfd.h>

#include <algorithm>
#include <cmath>

#include <breakwater/math/refuse_unless.h>

namespace breakwater {
namespace {

constexpr double kQuantumShare = 1.0;
constexpr double kSigmaShare = 4.5;  // also of the error of an uncertain time
constexpr double kQuantumThreshold = 0.5;
constexpr double kNoiseThreshold = 1.5;
constexpr double kSmallestAlpha = 1e-22;  // the error of the arithmetic in place of the sensor's

}  // namespace

Vfakfd::Vfakfd(const KalmanDesign& design, const VfakfdDesign& adaptation)
    : KalmanEstimator(design),
      lambda_min_(adaptation.lambda_min),
      lambda_max_(adaptation.lambda_max) {
  const Eigen::Index outputs = design.plant.outputs();
  refuse_unless(adaptation.alpha.size() == outputs && adaptation.dead_zone.size() == outputs &&
                    adaptation.alpha.minCoeff() > 0.0 && adaptation.dead_zone.minCoeff() >= 0.0 &&
                    adaptation.alpha.allFinite() && adaptation.dead_zone.allFinite(),
                "VFAKFD: needs alpha > 0 and a dead zone >= 0 for each output, all finite");
  refuse_unless(lambda_min_ > 0.0 && lambda_min_ <= lambda_max_ && lambda_max_ <= 1.0,
                "VFAKFD: needs 0 < lambda_min <= lambda_max <= 1");
  dead_zone_ = adaptation.dead_zone;
  weight_ = adaptation.alpha.cwiseSqrt().cwiseInverse();
  weighted_.setZero(outputs);
  solved_ = weighted_;
  one_plus_output_covariance_ = design.R;
  observation_covariance_.setZero(outputs, outputs);
}

void Vfakfd::update(const Vector& held_input, const Vector& y) {
  predict(held_input, y);
  if (kernel_) return correct_and_forget();
  lambda_ = std::clamp(lambda_max_ - nis(), lambda_min_, lambda_max_);
  observation_covariance_.diagonal().setConstant(lambda_);
  correct(observation_covariance_);
  covariance_ *= 1.0 / lambda_;
}

// For one output, with a single division: s = C̅ P C̅ᵀ, b = 1 + s and a = λ b give
//     1/D = 1/(s + λ) = b a r   and   1/λ = b (s b + a) r   with   r = 1/(a (s b + a)).
void Vfakfd::correct_and_forget() {
  const double s = output_covariance_(0, 0);
  const double dead_zone = dead_zone_(0) + kSigmaShare * instant_error_(0);
  const double error = std::max(std::abs(innovation_(0)) - dead_zone, 0.0) * weight_(0);
  const double b = 1.0 + s;
  const double a = std::clamp(lambda_max_ * b - error * error, lambda_min_ * b, lambda_max_ * b);
  const double rest = s * b + a;
  const double br = b / (a * rest);
  const double forgetting = br * rest;
  lambda_ = std::clamp(a / b, lambda_min_, lambda_max_);
  correct(lambda_, br * a, forgetting);
}

// ẽᵀ (I + C̅ P C̅ᵀ)⁻¹ ẽ
double Vfakfd::nis() {
  weighted_ = (innovation_.cwiseAbs() - dead_zone_ - kSigmaShare * instant_error_)
                  .cwiseMax(0.0)
                  .cwiseProduct(weight_);
  weighted_ = (innovation_.array() < 0.0).select(-weighted_, weighted_);
  one_plus_output_covariance_ = output_covariance_;
  one_plus_output_covariance_.diagonal().array() += 1.0;
  factor_.compute(one_plus_output_covariance_);
  solved_ = weighted_;
  factor_.solveInPlace(solved_);
  return weighted_.dot(solved_);
}

VfakfdDesign qvff_design(const SensorError& error) {
  check(error, error.quantum.size());
  VfakfdDesign design;
  design.dead_zone = kQuantumShare * error.quantum + kSigmaShare * error.noise_std;
  design.alpha = (kQuantumThreshold * error.quantum)
                     .cwiseAbs2()
                     .cwiseMax((kNoiseThreshold * error.noise_std).cwiseAbs2())
                     .cwiseMax(kSmallestAlpha);
  return design;
}

KalmanDesign variable_forgetting_design(const ExtendedPlant& plant, double p0) {
  const Eigen::Index N = plant.states();
  return {plant, Eigen::MatrixXd::Zero(N, N),
          Eigen::MatrixXd::Identity(plant.outputs(), plant.outputs()),
          p0 * Eigen::MatrixXd::Identity(N, N)};
}

}  // namespace breakwater
