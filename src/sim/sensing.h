// From the engine's sensors to the controller's samples.
#pragma once

#include <mujoco/mujoco.h>

#include <Eigen/Core>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include <breakwater/signals/signal.h>
#include <breakwater/sim/model.h>
#include <breakwater/world/delay_line.h>
#include <breakwater/world/disturbance.h>
#include <breakwater/world/encoder.h>
#include <breakwater/world/force_sensor.h>
#include <breakwater/world/low_pass.h>
#include <breakwater/world/noise.h>
#include <breakwater/world/sensor_fault.h>

namespace breakwater {

/// The reading of a sensor's values in a channel.
enum class Reading {
  component,  ///< one of the values
  roll,       ///< angles of a frame quaternion, continuous over whole turns
  pitch,
  yaw,
  joint_position,  ///< position of the hinge or slide that `sensor` names
  joint_velocity
};

/// One entry of a sample, from a MuJoCo sensor. The value passes these stages: true → body →
/// low-pass (both analogue, at every physics step) → electronics (if any) → weight → tare.
/// Then: scale error → disturbance → quantisation → noise → delay → fault → hold.
///
/// Position and velocity sensors without a low-pass have the value of the sampling instant. Force,
/// touch and acceleration sensors, and all sensors with a low-pass, have the value of the last
/// physics step. The engine computes them only at the end of a step. The weight is that of the
/// sampling instant's pose, behind no filter.
struct SensorChannel {
  static constexpr double kNever = -1.0;
  static constexpr double kAllBeyond =
      -1.0;  ///< as any negative weighed_kg: all mass of the model beyond it

  std::string name;                ///< name for the user: "q1", "force"
  std::string sensor;              ///< name of the MJCF sensor, or of the joint
  const double* source = nullptr;  ///< in place of a sensor: a value that each step computes
  int component = 0;               ///< index in the sensor's values
  Reading reading = Reading::component;
  SensorBody body;          ///< body of a force sensor; default: no resonance
  double low_pass_s = 0.0;  ///< time constant [s]; 0: none
  SensorElectronics electronics;
  double weighed_kg = 0.0;  ///< mass beyond a <force> sensor whose weight is taken off each sample
  double tare_at_s = kNever;  ///< the value of the first sample from then on is taken off
  Disturbance disturbance;    ///< output disturbance, added at each sample, in the value's unit
  Encoder encoder;
  double noise_std =
      0.0;  ///< standard deviation of white noise at each sample, in the value's unit
  int delay_samples = 0;
};

/// The reaction to a measurement that is not finite.
enum class NanPolicy {
  stop,  ///< the first one stops the run
  drop   ///< holds the channel's last good value; three in a row stop the run
};

struct SensingSetup {
  std::vector<SensorChannel> channels;
  NanPolicy nan_policy = NanPolicy::stop;
  SensorFault fault;
  std::uint64_t seed = 1;
};

/// All sensor channels of a run.
class Sensing {
 public:
  /// Throws std::invalid_argument if a sensor or channel does not exist, or as its parts do.
  Sensing(const Model& model, const SensingSetup& setup);

  /// Sets every filter to steady state at the sensors' values in `data`.
  void reset(const mjData& data);

  /// Call it when the engine has computed the sensors of a physics step.
  void after_step(const mjData& data);

  /// Takes sample number `k`; sample.time_s must be set. Throws RunFailure as the policy requires.
  void take(std::int64_t k, const mjData& data, Sample& sample);

  /// The channel after its low-pass, at the physics rate, before quantisation and noise.
  const double& filtered(std::size_t channel) const { return channels_[channel].value; }

  std::int64_t dropped() const { return dropped_; }
  std::size_t size() const { return channels_.size(); }

 private:
  struct Channel {
    // The present value of the sensor.
    double read(const mjData& data) const;
    // The same behind the electronics, without the weight and the tare.
    double corrected(double time_s, const mjData& data);

    SensorChannel setup;
    int address;   // index in sensordata, or in the state
    bool is_late;  // computed only at the end of a step
    Resonance body;
    LowPass filter;
    SampledReading electronics;
    Noise noise;
    DelayLine delay;
    Eigen::Vector3d weight_N = Eigen::Vector3d::Zero();  // weight of weighed_kg, in the world
    int site = -1;                                       // the sensor's; -1: there is no weight
    std::optional<double> tare = {};
    double value = 0.0;
    double last_good = 0.0;
    int dropped_in_a_row = 0;
  };

  std::vector<Channel> channels_;
  NanPolicy nan_policy_;
  FaultySensor fault_;
  std::size_t broken_;  // the index of its channel; size(): none
  std::int64_t dropped_ = 0;
};

}  // namespace breakwater
