// Estimates strength and spectrum of the wave force from the motion of one axis.
#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

#include <breakwater/observers/resonator.h>

namespace breakwater {

struct WaveForceBankDesign {
  /// The force's spectrum at each candidate period, in increasing order, as pairs of variance 1. A
  /// single pair: the period is known.
  std::vector<ResonatorPair> shapes;
  double mass_kg = 1.0;
  double bias_std_N = 5e-4;        ///< process noise of the constant force
  double velocity_std_m_s = 2e-4;  ///< process noise of the velocity
  double position_std_m = 0.1;     ///< measurement noise
  /// Candidates of the force's standard deviation, in equal ratios. A single one: `weakest_N`.
  double weakest_N = 0.03;
  double strongest_N = 1.0;
  int strengths = 9;
  double memory_s = 60.0;    ///< time constant of the exponential forgetting
  double settling_s = 15.0;  ///< the estimate stays constant until then
  double period_s = 0.01;
};

/// Maximum likelihood among sea states: for each shape and strength a Kalman filter of the axis
///     m p̈ = F_known + f₁ + f₂ + b,  f̈ᵢ + 2 ζᵢ ωᵢ ḟᵢ + ωᵢ² fᵢ = white,  b random walk, p measured,
/// with its stationary gain. Innovations e of variance S add −(ln S + e²/S)/2 to the filter's
/// log-likelihood in each sample, with exponential forgetting. The estimate is the mean of ln ω, ln
/// ζ and ln σ of the candidates, weighted by their likelihoods.
class WaveForceBank {
 public:
  /// Throws std::invalid_argument if there is no shape, a value is not positive, or the strengths
  /// are not in increasing order.
  explicit WaveForceBank(const WaveForceBankDesign& design);

  void reset(double position_m);
  /// One sample: the known force held since the last sample, and the position measured now.
  /// Allocates nothing.
  void update(double known_force_N, double position_m);
  /// Whether the estimate still is that of all candidates together.
  bool is_settling() const { return elapsed_s_ < design_.settling_s; }
  /// The resonators of the wave force [N].
  const ResonatorPair& resonators() const { return resonators_; }

 private:
  using State = Eigen::Matrix<double, 7, 1>;       // p, ṗ, b, f₁, h₁, f₂, h₂; h = ḟ/ω
  using Logarithms = Eigen::Matrix<double, 6, 1>;  // ω, ζ, σ of both resonators
  struct Shape {
    Eigen::Matrix2d first, second;  // one-sample matrices of the resonators
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

/// The candidate periods of a sea whose period is not known [s]: 15 from 4 to 14 s, in equal
/// ratios.
std::vector<double> candidate_periods();

/// The standard deviation of the force of some resonators [N].
double total_std(std::span<const Resonator> resonators);
/// Their mean frequency [rad/s], weighted by their variances.
double mean_frequency(std::span<const Resonator> resonators);

}  // namespace breakwater
