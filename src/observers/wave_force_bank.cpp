#include <breakwater/observers/wave_force_bank.h>

#include <algorithm>
#include <cmath>

#include <breakwater/linear/riccati.h>
#include <breakwater/math/functions.h>
#include <breakwater/math/refuse_unless.h>

namespace breakwater {
namespace {

constexpr double kForgotten = 40.0;  // a log-likelihood this far below the best has no weight

bool fits(const ResonatorPair& pair) {
  return std::ranges::all_of(pair, &Resonator::is_sound);
}

}  // namespace

WaveForceBank::WaveForceBank(const WaveForceBankDesign& design) : design_(design) {
  refuse_unless(!design.shapes.empty() && std::ranges::all_of(design.shapes, fits) &&
                    design.mass_kg > 0.0 && design.bias_std_N > 0.0 &&
                    design.velocity_std_m_s > 0.0 && design.position_std_m > 0.0 &&
                    design.weakest_N > 0.0 && design.strengths > 0 &&
                    (design.strengths == 1 || design.strongest_N > design.weakest_N) &&
                    design.memory_s > 0.0 && design.settling_s >= 0.0 && design.period_s > 0.0,
                "wave force bank: every value must be positive");
  const double dt = design.period_s;
  const double lowest = math::log(design.weakest_N);
  const double span = design.strengths > 1 ? math::log(design.strongest_N / design.weakest_N) : 0.0;
  for (const ResonatorPair& pair : design.shapes) {
    Shape shape{resonator_step(pair[0].omega_rad_s, pair[0].damping, dt),
                resonator_step(pair[1].omega_rad_s, pair[1].damping, dt), Logarithms::Zero()};
    Eigen::MatrixXd A = Eigen::MatrixXd::Identity(7, 7);
    A(0, 1) = dt;
    A(1, 2) = A(1, 3) = A(1, 5) = dt / design.mass_kg;
    A.block<2, 2>(3, 3) = shape.first;
    A.block<2, 2>(5, 5) = shape.second;
    int next = 0;
    for (const Resonator& r : pair) {
      shape.logarithms(next++) = math::log(r.omega_rad_s);
      shape.logarithms(next++) = math::log(r.damping);
      shape.logarithms(next++) = math::log(r.std);
    }
    for (int i = 0; i < design.strengths; ++i) {
      Candidate c;
      c.shape = shapes_.size();
      c.log_strength = lowest + (design.strengths > 1 ? span * i / (design.strengths - 1) : 0.0);
      const double strength = math::exp(c.log_strength);
      const auto noise = [&](const Resonator& r) {
        return resonator_noise(r.omega_rad_s, r.damping, strength * r.std, dt);
      };
      State q;
      q << 0.0, design.velocity_std_m_s * design.velocity_std_m_s,
          design.bias_std_N * design.bias_std_N, 0.0, noise(pair[0]), 0.0, noise(pair[1]);
      const double r = design.position_std_m * design.position_std_m;
      const Eigen::MatrixXd P =
          solve_dare(A.transpose(), Eigen::MatrixXd::Identity(7, 1),
                     Eigen::MatrixXd(q.asDiagonal()), Eigen::MatrixXd::Constant(1, 1, r));
      c.variance = P(0, 0) + r;
      c.log_variance = math::log(c.variance);
      c.gain = P.col(0) / c.variance;
      candidates_.push_back(c);
    }
    shapes_.push_back(shape);
  }
  reset(0.0);
}

void WaveForceBank::reset(double position_m) {
  for (Candidate& c : candidates_) {
    c.x.setZero();
    c.x(0) = position_m;
    c.log_likelihood = 0.0;
  }
  elapsed_s_ = 0.0;
  average(0.0);
}

void WaveForceBank::update(double known_force_N, double position_m) {
  elapsed_s_ += design_.period_s;
  const double keep = 1.0 - design_.period_s / design_.memory_s;
  const double step = design_.period_s / design_.mass_kg;
  double best = -1e300;
  for (Candidate& c : candidates_) {
    const Shape& shape = shapes_[c.shape];
    State x;
    x(0) = c.x(0) + design_.period_s * c.x(1);
    x(1) = c.x(1) + step * (known_force_N + c.x(2) + c.x(3) + c.x(5));
    x(2) = c.x(2);
    x.segment<2>(3).noalias() = shape.first * c.x.segment<2>(3);
    x.segment<2>(5).noalias() = shape.second * c.x.segment<2>(5);
    const double innovation = position_m - x(0);
    c.x = x + c.gain * innovation;
    if (is_settling()) continue;
    c.log_likelihood =
        keep * c.log_likelihood - 0.5 * (c.log_variance + innovation * innovation / c.variance);
    best = std::max(best, c.log_likelihood);
  }
  if (!is_settling()) average(best);
}

void WaveForceBank::average(double best) {
  double weights = 0.0;
  Logarithms sum = Logarithms::Zero();
  for (const Candidate& c : candidates_) {
    const double behind = best - c.log_likelihood;
    if (behind > kForgotten) continue;
    const double weight = math::exp(-behind);
    const Logarithms& of_shape = shapes_[c.shape].logarithms;
    weights += weight;
    sum += weight * of_shape;
    sum(2) += weight * c.log_strength;
    sum(5) += weight * c.log_strength;
  }
  sum /= weights;
  const auto resonator = [&](int from) {
    return Resonator{math::exp(sum(from)), math::exp(sum(from + 1)), math::exp(sum(from + 2))};
  };
  resonators_ = {resonator(0), resonator(3)};
}

std::vector<double> candidate_periods() {
  constexpr double kShortest_s = 4.0, kLongest_s = 14.0;
  constexpr int kPeriods = 15;
  std::vector<double> periods_s;
  for (int i = 0; i < kPeriods; ++i) {
    periods_s.push_back(kShortest_s * math::pow(kLongest_s / kShortest_s, i / (kPeriods - 1.0)));
  }
  return periods_s;
}

double total_std(std::span<const Resonator> resonators) {
  double variance = 0.0;
  for (const Resonator& r : resonators) variance += r.std * r.std;
  return std::sqrt(variance);
}

double mean_frequency(std::span<const Resonator> resonators) {
  if (resonators.size() == 1) return resonators.front().omega_rad_s;  // without rounding
  double variance = 0.0, moment = 0.0;
  for (const Resonator& r : resonators) {
    variance += r.std * r.std;
    moment += r.std * r.std * r.omega_rad_s;
  }
  return moment / variance;
}

}  // namespace breakwater
