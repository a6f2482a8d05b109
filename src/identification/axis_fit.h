// Output-error fit of an axis to records, by maximum likelihood.
#pragma once

#include <Eigen/Core>
#include <array>
#include <limits>
#include <vector>

#include <breakwater/identification/axis_model.h>

namespace breakwater {

using FreeParameters = std::array<bool, kAxisParameters>;

/// The free ones, in their order.
inline std::vector<AxisParameter> listed(const FreeParameters& free) {
  std::vector<AxisParameter> all;
  for (std::size_t p = 0; p < kAxisParameters; ++p) {
    if (free[p]) all.push_back(static_cast<AxisParameter>(p));
  }
  return all;
}

struct AxisFit {
  AxisValues values{};
  std::vector<AxisStart> starts;  ///< one for each stretch
  double noise_std = 0.0;         ///< σ of the white noise before the encoder
  double deviance = std::numeric_limits<double>::infinity();  ///< −2 ln L
  bool is_converged = false;
};

/// Maximises the likelihood of the measured positions over the free parameters and the starts, from
/// `start`, with its σ:
///     L = Π P(y_k),   P(y) = Φ((y₊ − q)/σ) − Φ((y₋ − q)/σ),
/// where [y₋, y₊] are the positions with the code y. Without an encoder the errors are Gaussian.
///
/// The Levenberg–Marquardt algorithm (Ceres' TinySolver) minimises the squares of the deviance
/// residuals ±√(2 ln P(centre) − 2 ln P(y)). Half of their sum is −ln L, up to a constant.
/// A weak prior, three scales wide around `start`, holds what the records do not show: parameters,
/// and twists of the starts. The sizes of the drifts have their normal distribution, which counts
/// as likelihood. Friction and inertia stay positive. A backlash that begins at 0 stays there: a
/// spring without play also pulls, so the likelihood jumps at 0 and has no derivative.
AxisFit fit_axis(const AxisData& data, FreeParameters free, const AxisFit& start,
                 int most_iterations);

/// The same with the most likely σ, in turns.
AxisFit fit_axis_and_noise(const AxisData& data, const FreeParameters& free, AxisFit start);

/// Fits only the starts, for other records. Beside a backlash the search begins on both flanks, in
/// the play, and at the starts of `model` if it has one for each stretch. Each stretch keeps its
/// best one.
AxisFit fit_starts(const AxisData& data, const AxisFit& model);

/// The largest motion of a stretch.
double range_of(const AxisData& data);

/// The RMS torque of the drive by the stiffness: about the twist of the spring.
double rms_twist(const AxisData& data, const AxisFit& fit);

/// Least standard deviation that a fit to an encoder assumes, in Δ.
inline constexpr double kLeastNoise = 0.03;

/// The positions of the fit, one stretch after another.
std::vector<double> fitted_positions(const AxisData& data, const AxisFit& fit);

/// Natural sizes of changes of the parameters: 1 of logarithms, and what follows from the period,
/// the RMS input and the RMS speed.
AxisValues parameter_scales(const AxisData& data);

/// Standard deviations of the prior, in the scales: of a fit, and one that hardly counts.
inline constexpr double kPriorStd = 3.0;
inline constexpr double kHardlyAnyPrior = 3e3;

/// The covariance of the free parameters, in their scales and order, from the curvature of the
/// likelihood and a prior.
Eigen::MatrixXd covariance_of(const AxisData& data, const FreeParameters& free, const AxisFit& fit,
                              double prior_std = kPriorStd);

}  // namespace breakwater
