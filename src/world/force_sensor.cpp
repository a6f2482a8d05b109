#include <breakwater/world/force_sensor.h>

#include <algorithm>
#include <cmath>

#include <breakwater/math/functions.h>
#include <breakwater/math/refuse_unless.h>

namespace breakwater {
namespace {

// The whole number of steps in a time.
std::int64_t steps_in(double time_s, double step_s) {
  constexpr double kMostSteps = 1e9;
  const double steps = std::round(time_s / step_s);
  refuse_unless(
      time_s >= 0.0 && steps <= kMostSteps && std::abs(steps * step_s - time_s) <= 1e-6 * step_s,
      "sensor: own period and delay must be multiples of the timestep");
  return static_cast<std::int64_t>(steps);
}

}  // namespace

Resonance::Resonance(const SensorBody& body, double step_s) : is_on_(body.is_on()) {
  const double omega = body.resonance_rad_s;
  const double zeta = body.damping_ratio;
  refuse_unless(is_not_negative(omega) && is_not_negative(zeta) && step_s > 0.0,
                "needs a resonance and a damping ratio >= 0, and a step > 0");
  if (!is_on_) return;
  const double sigma = zeta * omega;
  if (zeta >= 1.0) {
    overdamp(sigma, omega, step_s);
    return;
  }
  const double damped = omega * std::sqrt(1.0 - zeta * zeta);
  const double decay = math::exp(-sigma * step_s);
  const math::SineCosine turn = math::sincos(damped * step_s);
  ee_ = decay * (turn.cosine + sigma / damped * turn.sine);
  ev_ = decay * turn.sine / damped;
  ve_ = -decay * omega * omega / damped * turn.sine;
  vv_ = decay * (turn.cosine - sigma / damped * turn.sine);
}

// e^(−σ h) cosh(δ h) and e^(−σ h) sinh(δ h)/δ, with δ² = σ² − ω².
void Resonance::overdamp(double sigma, double omega, double step_s) {
  const double delta = std::sqrt((sigma - omega) * (sigma + omega));
  const double slow = math::exp((delta - sigma) * step_s);
  const double fast = math::exp(-(delta + sigma) * step_s);
  const double even = 0.5 * (slow + fast);
  const double odd = delta * step_s < 1e-6 ? step_s * even : 0.5 * (slow - fast) / delta;
  ee_ = even + sigma * odd;
  ev_ = odd;
  ve_ = -omega * omega * odd;
  vv_ = even - sigma * odd;
}

void Resonance::set(double value, double speed) {
  value_ = value;
  speed_ = speed;
}

double Resonance::update(double input) {
  if (!is_on_) return input;
  const double deviation = value_ - input;
  value_ = input + ee_ * deviation + ev_ * speed_;
  speed_ = ve_ * deviation + vv_ * speed_;
  return value_;
}

SampledReading::SampledReading(const SensorElectronics& electronics, double step_s,
                               std::uint64_t seed, const std::string& name)
    : setup_(electronics),
      sample_s_(std::max(electronics.period_s, step_s)),
      steps_per_sample_(std::max<std::int64_t>(steps_in(electronics.period_s, step_s), 1)),
      noise_(seed, name + " drift"),
      delay_(static_cast<int>(steps_in(electronics.delay_s, step_s))) {
  refuse_unless(std::isfinite(electronics.bias) && is_not_negative(electronics.drift_per_sqrt_s) &&
                    electronics.range >= 0.0 && is_not_negative(electronics.quantum),
                "sensor: drift, range and quantum must be finite and not negative");
}

double SampledReading::convert(double value) {
  double reading = value + setup_.bias + drift_;
  if (setup_.range > 0.0) reading = std::clamp(reading, -setup_.range, setup_.range);
  if (setup_.quantum > 0.0) reading = setup_.quantum * std::round(reading / setup_.quantum);
  return reading;
}

void SampledReading::reset(double value) {
  step_ = 0;
  drift_ = 0.0;
  value_ = held_ = convert(value);
}

void SampledReading::update(double value) {
  if (step_ % steps_per_sample_ == 0) {
    held_ = convert(value);
    const auto sample = static_cast<std::uint64_t>(step_ / steps_per_sample_);
    if (setup_.drift_per_sqrt_s > 0.0) {
      drift_ += setup_.drift_per_sqrt_s * std::sqrt(sample_s_) * noise_(sample);
    }
  }
  ++step_;
  value_ = delay_.update(held_);
}

}  // namespace breakwater
