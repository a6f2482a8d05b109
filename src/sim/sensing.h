// From the engine's sensors to a controller's samples.
#pragma once

#include <mujoco/mujoco.h>

#include <cstdint>
#include <string>
#include <vector>

#include <breakwater/signals/sample.h>
#include <breakwater/sim/model.h>
#include <breakwater/world/delay_line.h>
#include <breakwater/world/disturbance.h>
#include <breakwater/world/encoder.h>
#include <breakwater/world/force_sensor.h>
#include <breakwater/world/low_pass.h>
#include <breakwater/world/noise.h>

namespace breakwater {

/// What a channel makes of its sensor's values.
enum class Reading {
  component,  ///< one of them
  roll,       ///< angles of a frame quaternion, continuous over whole turns
  pitch,
  yaw
};

/// One entry of a sample: which MuJoCo sensor it reads and what happens to the value on its way:
/// true → body → low-pass (both analogue, at every physics step) → electronics (if it has any) →
/// disturb → quantise → noise → delay → hold.
///
/// Position and velocity sensors without a low-pass are read fresh at the sampling instant. Force,
/// touch and acceleration sensors, and all behind a low-pass, give the value of the physics step
/// before: the engine computes them only at the end of a step.
struct SensorChannel {
  std::string name;    ///< how the user calls it: "q1", "force"
  std::string sensor;  ///< name of the MJCF sensor
  int component = 0;   ///< of the sensor's values
  Reading reading = Reading::component;
  SensorBody body;          ///< of a force sensor; without a resonance: none
  double low_pass_s = 0.0;  ///< time constant [s]; 0: none
  SensorElectronics electronics;
  Disturbance disturbance;  ///< added at each sample (an output disturbance), in the value's unit
  Encoder encoder;
  double noise_std =
      0.0;  ///< standard deviation of white noise at each sample, in the value's unit
  int delay_samples = 0;
};

/// What to do when a sensor gives no number.
enum class NanPolicy {
  stop,  ///< the first one ends the run
  drop   ///< hold the channel's last good value, and count; three in a row end the run
};

/// Replaces samples of one channel by NaN, so that NanPolicy can be tried.
struct SensorFault {
  std::string channel;  ///< empty: no fault
  double at_s = 0.0;    ///< from the first sample at or after this time
  int samples = 1;      ///< how many
};

struct SensingSetup {
  std::vector<SensorChannel> channels;
  NanPolicy nan_policy = NanPolicy::stop;
  SensorFault fault;
  std::uint64_t seed = 1;
};

/// All channels of a run.
class Sensing {
 public:
  /// Throws std::invalid_argument if a sensor or the faulty channel is not there, or a setting is
  /// negative.
  Sensing(const Model& model, const SensingSetup& setup);

  /// Settles every filter at the sensors' values in `data`.
  void reset(const mjData& data);

  /// To be called once the sensors of a physics step are there.
  void after_step(const mjData& data);

  /// Takes sample number `k`; sample.time_s is set already. Throws RunFailure as the policy says.
  void take(std::int64_t k, const mjData& data, Sample& sample);

  /// The channel behind its low-pass, at the physics rate, before quantisation and noise.
  const double& filtered(std::size_t channel) const { return channels_[channel].value; }

  std::int64_t dropped() const { return dropped_; }
  std::size_t size() const { return channels_.size(); }

 private:
  struct Channel {
    // The sensor's value now.
    double read(const mjData& data) const;

    SensorChannel setup;
    int address;   // in sensordata
    bool is_late;  // known only after the step
    Resonance body;
    LowPass filter;
    SampledReading electronics;
    Noise noise;
    DelayLine delay;
    double value = 0.0;
    double last_good = 0.0;
    int dropped_in_a_row = 0;
  };

  bool is_faulty(const Channel& channel, double time_s);

  std::vector<Channel> channels_;
  NanPolicy nan_policy_;
  SensorFault fault_;
  double step_s_;
  std::int64_t dropped_ = 0;
};

}  // namespace breakwater
