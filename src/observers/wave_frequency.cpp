#include <breakwater/observers/wave_frequency.h>

#include <algorithm>
#include <numbers>
#include <stdexcept>

#include <breakwater/linear/riccati.h>
#include <breakwater/math/functions.h>
#include <breakwater/observers/resonator.h>

namespace breakwater {

WaveFrequency::WaveFrequency(const WaveFrequencyDesign& design, double first_guess_rad_s)
    : design_(design), first_guess_rad_s_(first_guess_rad_s), omega_rad_s_(first_guess_rad_s) {
  const bool fits = design.mass_kg > 0.0 && design.damping > 0.0 && design.damping < 1.0 &&
                    design.force_std_N > 0.0 && design.bias_std_N > 0.0 &&
                    design.velocity_std_m_s > 0.0 && design.position_std_m > 0.0 &&
                    design.shortest_period_s > 0.0 &&
                    design.longest_period_s > design.shortest_period_s && design.candidates > 1 &&
                    design.memory_s > 0.0 && design.period_s > 0.0 && first_guess_rad_s > 0.0;
  if (!fits) throw std::invalid_argument("wave frequency: every value must be positive");
  const double lowest = math::log(2.0 * std::numbers::pi / design.longest_period_s);
  const double highest = math::log(2.0 * std::numbers::pi / design.shortest_period_s);
  const double dt = design.period_s;
  for (int i = 0; i < design.candidates; ++i) {
    Candidate c;
    c.log_omega = lowest + (highest - lowest) * i / (design.candidates - 1);
    const double omega = math::exp(c.log_omega);
    c.A(0, 1) = dt;
    c.A(1, 2) = c.A(1, 4) = dt / design.mass_kg;
    c.A.block<2, 2>(2, 2) = resonator_step(omega, design.damping, dt);
    Eigen::Matrix<double, 5, 1> q;
    q << 0.0, design.velocity_std_m_s * design.velocity_std_m_s, 0.0,
        resonator_noise(omega, design.damping, design.force_std_N, dt),
        design.bias_std_N * design.bias_std_N;
    const double r = design.position_std_m * design.position_std_m;
    const Eigen::MatrixXd P =
        solve_dare(c.A.transpose(), Eigen::MatrixXd::Identity(5, 1),
                   Eigen::MatrixXd(q.asDiagonal()), Eigen::MatrixXd::Constant(1, 1, r));
    c.variance = P(0, 0) + r;
    c.gain = P.col(0) / c.variance;
    candidates_.push_back(c);
  }
  reset(0.0);
}

void WaveFrequency::reset(double position_m) {
  for (Candidate& c : candidates_) {
    c.x.setZero();
    c.x(0) = position_m;
    c.log_likelihood = 0.0;
  }
  omega_rad_s_ = first_guess_rad_s_;
  elapsed_s_ = 0.0;
}

void WaveFrequency::update(double known_force_N, double position_m) {
  elapsed_s_ += design_.period_s;
  const bool is_settling = elapsed_s_ < design_.settling_s;
  const double keep = 1.0 - design_.period_s / design_.memory_s;
  double best = -1e300;
  for (Candidate& c : candidates_) {
    State x = c.A * c.x;
    x(1) += design_.period_s / design_.mass_kg * known_force_N;
    const double innovation = position_m - x(0);
    c.x = x + c.gain * innovation;
    if (is_settling) continue;
    c.log_likelihood = keep * c.log_likelihood -
                       0.5 * (math::log(c.variance) + innovation * innovation / c.variance);
    best = std::max(best, c.log_likelihood);
  }
  if (is_settling) return;
  double weights = 0.0;
  double sum = 0.0;
  for (const Candidate& c : candidates_) {
    const double weight = math::exp(c.log_likelihood - best);
    weights += weight;
    sum += weight * c.log_omega;
  }
  omega_rad_s_ = math::exp(sum / weights);
}

}  // namespace breakwater
