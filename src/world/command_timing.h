// When the commands of a controller reach the drive.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include <breakwater/world/noise.h>

namespace breakwater {

/// Each part is off at 0 or empty.
struct CommandDelays {
  double delay_s = 0.0;           ///< every command has it
  double jitter_s = 0.0;          ///< a further delay of each command, uniform from 0 to this
  std::vector<double> jitters_s;  ///< in its place, the further delay of each sample, repeated
  double drop_probability = 0.0;  ///< a lost command: the drive holds the one before

  bool is_on() const {
    return delay_s > 0.0 || jitter_s > 0.0 || !jitters_s.empty() || drop_probability > 0.0;
  }
  /// The mean delay of the commands that are not lost.
  double mean_s() const;
};

/// The way from the controller to the drive. A command that arrives within a physics step counts
/// from there on. The output of that step is the mean over it, with the same impulse. A delay of a
/// whole number of steps, within 1e-6 of a step, is that number. A command that a later one
/// overtakes is lost. Before the first command arrives the output is 0.
///
/// The numbers are those of the seed's streams "command jitter" and "command drop", one of each for
/// a sample.
class CommandTiming {
 public:
  /// `width` is the number of values in a command. Throws std::invalid_argument if a delay is
  /// negative, not finite or above 1e6 steps, or the probability is not in [0, 1).
  CommandTiming(CommandDelays delays, std::uint64_t seed, double step_s, int steps_per_sample,
                std::size_t width);

  /// Sends the command of sample k, which is taken at step k steps_per_sample.
  void send(std::int64_t k, std::span<const double> command);
  /// The command over a step. Call it once in each step, after send().
  void receive(std::int64_t step, std::span<double> output);

 private:
  double delay_in_steps(std::int64_t k) const;

  CommandDelays delays_;
  double step_s_;
  int steps_per_sample_;
  std::size_t width_;
  Noise jitter_;
  Noise drop_;
  // The commands on their way, a ring: at_[i] is the arrival in steps, rising from first_ on.
  std::vector<double> at_;
  std::vector<double> values_;
  std::size_t first_ = 0;
  std::size_t count_ = 0;
  std::vector<double> held_;
};

}  // namespace breakwater
