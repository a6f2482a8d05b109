// How strong the waves' force is and where it has its energy, from how they push on one axis.
#pragma once

#include <Eigen/Core>
#include <vector>

#include <breakwater/observers/resonator.h>

namespace breakwater {

struct WaveForceBankDesign {
  /// The force's spectrum at each candidate period, in the order of the periods, as pairs of
  /// variance 1. One: the period is known.
  std::vector<ResonatorPair> shapes;
  double mass_kg = 1.0;
  double bias_std_N = 5e-4;        ///< walk of the constant force at each sample
  double velocity_std_m_s = 2e-4;  ///< walk of the velocity at each sample
  double position_std_m = 0.1;     ///< of the measurement's noise
  /// Candidates of the force's standard deviation, in equal ratios. One: it is `weakest_N`.
  double weakest_N = 0.03;
  double strongest_N = 1.0;
  int strengths = 9;
  double memory_s = 60.0;    ///< how long a sample counts, by e
  double settling_s = 15.0;  ///< for which it only listens
  double period_s = 0.01;
};

/// Likelihood of candidate seas: for each shape and each strength a Kalman filter of the axis
///     m p̈ = F_known + f₁ + f₂ + b,  f̈ᵢ + 2 ζᵢ ωᵢ ḟᵢ + ωᵢ² fᵢ = white,  b walks,  p measured,
/// with its stationary gain. A filter's innovations e have variance S, so its log likelihood grows
/// by −(ln S + e²/S)/2 a sample, forgotten exponentially. The estimate is the mean of the
/// logarithms of the pair's ω, ζ and σ under the candidates' likelihoods.
class WaveForceBank {
 public:
  /// Throws std::invalid_argument if there is no shape, a value is not positive, or the strengths
  /// are out of order.
  explicit WaveForceBank(const WaveForceBankDesign& design);

  void reset(double position_m);
  /// One sample: the known force that was held since the last one, and the position measured now.
  /// Allocates nothing.
  void update(double known_force_N, double position_m);
  /// Of the waves' force [N].
  const ResonatorPair& resonators() const { return resonators_; }

 private:
  using State = Eigen::Matrix<double, 7, 1>;       // p, ṗ, b, f₁, h₁, f₂, h₂; h = ḟ/ω
  using Logarithms = Eigen::Matrix<double, 6, 1>;  // of ω, ζ, σ of both
  struct Shape {
    Eigen::Matrix2d first, second;  // the resonators' steps
    Logarithms logarithms;
  };
  struct Candidate {
    std::size_t shape = 0;
    double log_strength = 0.0;
    State gain = State::Zero();
    double variance = 0.0;  // S
    double log_variance = 0.0;
    State x = State::Zero();
    double log_likelihood = 0.0;
  };

  void average(double best);

  WaveForceBankDesign design_;
  std::vector<Shape> shapes_;
  std::vector<Candidate> candidates_;
  ResonatorPair resonators_;
  double elapsed_s_ = 0.0;
};

/// The standard deviation of a pair's force [N].
double total_std(const ResonatorPair& pair);
/// The mean frequency of a pair's force [rad/s], its resonators weighted by their variances.
double mean_frequency(const ResonatorPair& pair);

}  // namespace breakwater
