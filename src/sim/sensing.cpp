#include <breakwater/sim/sensing.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>
#include <utility>

#include <breakwater/plants/quadrotor.h>
#include <breakwater/sim/engine_guard.h>

namespace breakwater {
namespace {

constexpr int kDropsInARowAllowed = 2;

bool is_of_joint(Reading reading) {
  return reading == Reading::joint_position || reading == Reading::joint_velocity;
}

// The place of a channel's value in the engine's data, and whether it is computed only at the end
// of a step. Throws if the model does not have it.
std::pair<int, bool> place(const Model& model, const SensorChannel& channel) {
  if (channel.source != nullptr) return {0, true};
  if (is_of_joint(channel.reading)) {
    const int joint = model.axis(channel.sensor);
    return {channel.reading == Reading::joint_position ? model->jnt_qposadr[joint]
                                                       : model->jnt_dofadr[joint],
            false};
  }
  const int id = model.id(mjOBJ_SENSOR, channel.sensor);
  if (channel.component < 0 || channel.component >= model->sensor_dim[id]) {
    throw std::invalid_argument(model.file() + ": sensor \"" + channel.sensor + "\" has no value " +
                                std::to_string(channel.component));
  }
  if (channel.reading != Reading::component &&
      (model->sensor_dim[id] != 4 || channel.component != 0)) {
    throw std::invalid_argument(model.file() + ": sensor \"" + channel.sensor +
                                "\" is no quaternion");
  }
  return {model->sensor_adr[id] + channel.component, model->sensor_needstage[id] == mjSTAGE_ACC};
}

}  // namespace

Sensing::Sensing(const Model& model, const SensingSetup& setup)
    : nan_policy_(setup.nan_policy), fault_(setup.fault, model->opt.timestep) {
  const double step_s = model->opt.timestep;
  channels_.reserve(setup.channels.size());
  for (const SensorChannel& channel : setup.channels) {
    const auto [address, is_of_acceleration] = place(model, channel);
    const bool is_late = is_of_acceleration || channel.low_pass_s > 0.0 || channel.body.is_on() ||
                         channel.electronics.is_on();
    channels_.push_back({channel, address, is_late, Resonance(channel.body, step_s),
                         LowPass(channel.low_pass_s, step_s),
                         SampledReading(channel.electronics, step_s, setup.seed, channel.name),
                         Noise(setup.seed, channel.name), DelayLine(channel.delay_samples)});
    if (channel.weighed_kg == 0.0 || channel.source != nullptr) continue;
    const int id = model.id(mjOBJ_SENSOR, channel.sensor);
    if (model->sensor_type[id] != mjSENS_FORCE) {
      throw std::invalid_argument(model.file() + ": sensor \"" + channel.sensor +
                                  "\" is no <force>: no weight can be taken off");
    }
    Channel& weighed = channels_.back();
    weighed.site = model->sensor_objid[id];
    if ((model->opt.disableflags & mjDSBL_GRAVITY) != 0) continue;
    const double mass_kg = channel.weighed_kg < 0.0
                               ? model->body_subtreemass[model->site_bodyid[weighed.site]]
                               : channel.weighed_kg;
    weighed.weight_N = mass_kg * Eigen::Map<const Eigen::Vector3d>(model->opt.gravity);
  }
  const std::string& broken = setup.fault.channel;
  const auto found = std::find_if(channels_.begin(), channels_.end(),
                                  [&](const Channel& c) { return c.setup.name == broken; });
  if (!broken.empty() && found == channels_.end()) {
    throw std::invalid_argument("sensor fault: there is no channel \"" + broken + "\"");
  }
  broken_ = static_cast<std::size_t>(found - channels_.begin());
}

double Sensing::Channel::read(const mjData& data) const {
  if (setup.source != nullptr) return *setup.source;
  if (setup.reading == Reading::joint_position) return data.qpos[address];
  if (setup.reading == Reading::joint_velocity) return data.qvel[address];
  const mjtNum* values = data.sensordata + address;
  if (setup.reading == Reading::component) return *values;
  const Eigen::Vector3d angles = roll_pitch_yaw(Eigen::Map<const Eigen::Vector4d>(values));
  const double angle = setup.reading == Reading::roll    ? angles(0)
                       : setup.reading == Reading::pitch ? angles(1)
                                                         : angles(2);
  const double turn = 2.0 * std::numbers::pi;
  return angle + turn * std::round((value - angle) / turn);
}

double Sensing::Channel::corrected(double time_s, const mjData& data) {
  double reading = setup.electronics.is_on() ? electronics.value() : value;
  // The sensor reads the force that holds what is beyond it, in the axes of its site.
  if (site >= 0) {
    const mjtNum* axes = data.site_xmat + static_cast<std::ptrdiff_t>(9) * site;
    for (int i = 0; i < 3; ++i) reading += axes[3 * i + setup.component] * weight_N(i);
  }
  if (!tare && setup.tare_at_s >= 0.0 && time_s >= setup.tare_at_s) tare = reading;
  return reading - tare.value_or(0.0);
}

void Sensing::reset(const mjData& data) {
  for (Channel& channel : channels_) {
    channel.tare.reset();
    channel.value = channel.read(data);
    channel.last_good = channel.value;
    channel.body.reset(channel.value);
    channel.filter.reset(channel.value);
    channel.electronics.reset(channel.value);
  }
}

void Sensing::after_step(const mjData& data) {
  for (Channel& channel : channels_) {
    if (!channel.is_late) continue;
    channel.value = channel.filter.update(channel.body.update(channel.read(data)));
    channel.electronics.update(channel.value);
  }
}

void Sensing::take(std::int64_t k, const mjData& data, Sample& sample) {
  for (std::size_t i = 0; i < channels_.size(); ++i) {
    Channel& channel = channels_[i];
    if (!channel.is_late) channel.value = channel.read(data);
    const double reading = channel.corrected(sample.time_s, data);
    const double disturbed = reading + channel.setup.encoder.error(reading) +
                             channel.setup.disturbance.value(sample.time_s);
    double measured = channel.setup.encoder.measure(disturbed);
    if (channel.setup.noise_std > 0.0) {
      measured += channel.setup.noise_std * channel.noise(static_cast<std::uint64_t>(k));
    }
    measured = channel.delay.update(measured);
    if (i == broken_) measured = fault_.update(sample.time_s, measured);

    if (std::isfinite(measured)) {
      channel.last_good = measured;
      channel.dropped_in_a_row = 0;
    } else {
      if (nan_policy_ == NanPolicy::stop) {
        throw RunFailure(sample.time_s, "sensor " + channel.setup.name + " is not finite");
      }
      ++dropped_;
      if (++channel.dropped_in_a_row > kDropsInARowAllowed) {
        throw RunFailure(sample.time_s,
                         "sensor " + channel.setup.name + " is not finite three times in a row");
      }
    }
    sample.y(static_cast<Eigen::Index>(i)) = channel.last_good;
  }
}

}  // namespace breakwater
