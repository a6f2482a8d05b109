// The links between a force and its samples: body, drift, range, steps, own period, delay.
#pragma once

#include <cstdint>
#include <string>

#include <breakwater/world/delay_line.h>
#include <breakwater/world/noise.h>

namespace breakwater {

/// The elastic body of a force sensor: y'' + 2 ζ ω y' + ω² y = ω² u.
struct SensorBody {
  double resonance_rad_s = 0.0;  ///< ω; 0: rigid
  double damping_ratio = 0.0;    ///< ζ

  bool is_on() const { return resonance_rad_s > 0.0; }
};

/// A SensorBody, discretised exactly for an input that is held over each step. A rigid one passes
/// the input on, with the same bits.
class Resonance {
 public:
  /// Throws std::invalid_argument if ω or ζ is negative, or the step not positive.
  Resonance(const SensorBody& body, double step_s);

  void reset(double value) { set(value, 0.0); }
  void set(double value, double speed);
  double update(double input);

 private:
  void overdamp(double sigma, double omega, double step_s);

  bool is_on_;
  double ee_ = 0.0, ev_ = 0.0, ve_ = 0.0, vv_ = 0.0;  // deviation and speed over a step
  double value_ = 0.0;
  double speed_ = 0.0;
};

/// The electronics of a sensor, in this order. Each link is off at 0.
struct SensorElectronics {
  double bias = 0.0;              ///< [unit]
  double drift_per_sqrt_s = 0.0;  ///< standard deviation of a random walk after 1 s [unit/√s]
  double range = 0.0;             ///< the reading is clipped to ± this [unit]
  double quantum = 0.0;           ///< one step of the converter [unit]
  double period_s = 0.0;          ///< own sampling period; 0: at every physics step
  double delay_s = 0.0;

  bool is_on() const {
    return bias != 0.0 || drift_per_sqrt_s != 0.0 || range != 0.0 || quantum != 0.0 ||
           period_s != 0.0 || delay_s != 0.0;
  }
};

/// The reading that SensorElectronics make from an analogue value.
class SampledReading {
 public:
  /// `name` is of the noise stream of the drift. Throws std::invalid_argument if a value but the
  /// bias is negative or not finite, or period or delay is no multiple of the step.
  SampledReading(const SensorElectronics& electronics, double step_s, std::uint64_t seed,
                 const std::string& name);

  void reset(double value);
  /// To be called once in each physics step.
  void update(double value);
  double value() const { return value_; }

 private:
  double convert(double value);

  SensorElectronics setup_;
  double sample_s_;
  std::int64_t steps_per_sample_;
  Noise noise_;
  DelayLine delay_;
  std::int64_t step_ = 0;
  double drift_ = 0.0;
  double held_ = 0.0;
  double value_ = 0.0;
};

}  // namespace breakwater
