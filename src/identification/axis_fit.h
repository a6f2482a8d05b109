// Output-error fit of an axis with friction to records, by maximum likelihood.
#pragma once

#include <Eigen/Core>
#include <array>
#include <limits>
#include <vector>

#include <breakwater/identification/friction_axis.h>
#include <breakwater/signals/encoder_rounding.h>

namespace breakwater {

/// Records of one axis with one encoder.
struct AxisData {
  std::vector<AxisStretch> stretches;
  double period_s = 0.0;
  double quantum = 0.0;  ///< Δ; 0: not quantised
  EncoderRounding rounding = EncoderRounding::nearest;
  double least_delay_s = -std::numeric_limits<double>::infinity();  ///< bounds of a fitted delay
  double largest_delay_s = std::numeric_limits<double>::infinity();

  std::size_t rows() const;
};

/// Whether a parameter is positive and scaled by its own size.
bool is_logarithmic(AxisParameter parameter);
/// Whether a parameter is friction, which is at least 0.
bool is_positive(AxisParameter parameter);

using FreeParameters = std::array<bool, kAxisParameters>;

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
/// A weak prior, three scales wide around `start`, holds what the records do not show. Differences
/// in the parameters give the sensitivities. Friction and inertia stay positive, since
/// the solver sees their magnitude and logarithm.
AxisFit fit_axis(const AxisData& data, const FreeParameters& free, const AxisFit& start,
                 int most_iterations);

/// The same with the most likely σ, in turns.
AxisFit fit_axis_and_noise(const AxisData& data, const FreeParameters& free, AxisFit start);

/// Fits only the starts, for other records.
AxisFit fit_starts(const AxisData& data, const AxisFit& model);

/// Least standard deviation that a fit to an encoder assumes, in Δ.
inline constexpr double kLeastNoise = 0.03;

/// The positions of the fit, one stretch after another.
std::vector<double> fitted_positions(const AxisData& data, const AxisFit& fit);

/// Natural sizes of changes of the parameters: 1 for J, v_s and k (logarithms), T_s for the delay,
/// and the RMS input for torques. For the viscous friction it is the RMS input by the RMS speed.
AxisValues parameter_scales(const AxisData& data);

/// The covariance of the free parameters, in their scales and order, from the curvature of the
/// likelihood and the prior.
Eigen::MatrixXd covariance_of(const AxisData& data, const FreeParameters& free, const AxisFit& fit);

}  // namespace breakwater
