// Estimates the frequency of the wave force from the motion of one axis.
#pragma once

#include <Eigen/Core>
#include <vector>

namespace breakwater {

struct WaveFrequencyDesign {
  double mass_kg = 1.0;
  double damping = 0.15;           ///< ζ_r of the resonators
  double force_std_N = 0.3;        ///< stationary standard deviation of the wave force
  double bias_std_N = 2e-3;        ///< process noise of the constant force
  double velocity_std_m_s = 3e-3;  ///< process noise of the velocity
  double position_std_m = 0.1;     ///< measurement noise
  double shortest_period_s = 4.0;
  double longest_period_s = 14.0;
  int candidates = 15;       ///< number of frequencies, in equal ratios
  double memory_s = 60.0;    ///< time constant of the exponential forgetting
  double settling_s = 15.0;  ///< the estimate stays constant until then
  double period_s = 0.01;
};

/// Maximum likelihood among candidate frequencies: for each one a Kalman filter of the axis
///     m p̈ = F_known + f + b,  f̈ + 2 ζ_r ω ḟ + ω² f = white,  b random walk, p measured,
/// with its stationary gain. Innovations e of variance S add −(ln S + e²/S)/2 to the filter's
/// log-likelihood in each sample, with exponential forgetting. The estimate is the mean of ln ω,
/// weighted by the candidates' likelihoods.
class WaveFrequency {
 public:
  /// Throws std::invalid_argument unless all values are positive and the periods increase.
  WaveFrequency(const WaveFrequencyDesign& design, double first_guess_rad_s);

  void reset(double position_m);
  /// One sample: the known force held since the last sample, and the position measured now.
  void update(double known_force_N, double position_m);
  double omega_rad_s() const { return omega_rad_s_; }

 private:
  using State = Eigen::Matrix<double, 5, 1>;  // p, ṗ, f, h = ḟ/ω, b
  struct Candidate {
    double log_omega = 0.0;
    Eigen::Matrix<double, 5, 5> A = Eigen::Matrix<double, 5, 5>::Identity();
    State gain = State::Zero();
    double variance = 0.0;  // S
    State x = State::Zero();
    double log_likelihood = 0.0;
  };

  WaveFrequencyDesign design_;
  double first_guess_rad_s_;
  double omega_rad_s_;
  double elapsed_s_ = 0.0;
  std::vector<Candidate> candidates_;
};

}  // namespace breakwater
