// Settings that scenarios share.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include <breakwater/config/fields.h>
#include <breakwater/sim/model.h>
#include <breakwater/sim/sensing.h>

namespace breakwater {

/// The keys that all scenarios have.
struct RunSettings {
  double duration_s = 0.0;
  std::uint64_t seed = 1;
  int compression = 0;  ///< deflate level of log.h5
  bool stream = false;  ///< whether a run with a folder writes log.h5 during the run

  void bind(Fields& fields);
};

/// The keys of the plant's model: model.mjcf, model.most_elements.
void bind_model(Fields& fields, ModelFile& model);

/// The physics step and the control period.
struct PhysicsSettings {
  double timestep_s = 0.0;
  Integrator integrator = Integrator::euler;
  double control_period_s = 0.0;

  void bind(Fields& fields);
  /// Throws std::invalid_argument `ORIGIN: KEY: reason` unless the control period is a whole
  /// multiple of the timestep, and the number of steps is reasonable.
  void check(const Config& config, const RunSettings& run) const;

  /// Physics steps per control sample.
  int steps_per_sample() const;
  /// The number of the physics step that begins at `time_s` [s].
  std::int64_t step_at(double time_s) const;
  /// The sampling instant nearest to `time_s` [s].
  double sample_time_s(double time_s) const;
};

/// The reaction to measurements that are not numbers, and a fault that makes some.
struct FaultSettings {
  static constexpr const char* kNone = "none";

  NanPolicy nan_policy = NanPolicy::stop;
  SensorFault fault = {.channel = kNone};

  /// `channels` lists the possible channels: "q1, q2, ..., force". `duration_s` must outlive
  /// `fields`.
  void bind(Fields& fields, const std::string& channels, const double& duration_s);
  /// Throws std::invalid_argument if there is no such channel, or if the kind needs another size.
  void check(const Config& config, const std::vector<SensorChannel>& channels) const;
  void apply(SensingSetup& setup) const;
};

/// Binds encoder.rounding. The default value is the nearest count.
void bind_encoder_rounding(Fields& fields, EncoderRounding& rounding);

/// Whether `time_s` is a whole multiple of `step_s`, except for rounding errors.
bool is_multiple(double time_s, double step_s);

/// Throws std::invalid_argument for `key` unless `time_s` is a whole multiple of `step_s`.
void check_multiple(const Config& config, const std::string& key, double time_s, double step_s,
                    const std::string& step_name);

}  // namespace breakwater
