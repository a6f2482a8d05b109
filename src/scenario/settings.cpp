#include "scenario/settings.h"

#include <cmath>

namespace breakwater {

void RunSettings::bind(Fields& fields) {
  fields.number("run.duration_s", duration_s, positive(), "how long it is simulated [s]");
  fields.count("run.seed", seed, not_negative(), "of all noise");
  fields.count("record.compression", compression, between(0, 9),
               "of log.h5, by deflate: 0 fastest, 9 smallest");
}

void PhysicsSettings::bind(Fields& fields) {
  fields.number("physics.timestep_s", timestep_s, positive(), "the engine's step [s]");
  fields.choice(
      "physics.integrator", integrator,
      {{"euler", Integrator::euler}, {"rk4", Integrator::rk4}, {"implicit", Integrator::implicit}},
      "euler, rk4 or implicit");
  fields.number("control.period_s", control_period_s, positive(),
                "T_s, of control and log; a multiple of the timestep [s]");
}

void PhysicsSettings::check(const Config& config) const {
  check_multiple(config, "control.period_s", control_period_s, timestep_s, "physics.timestep_s");
}

int PhysicsSettings::steps_per_sample() const {
  return static_cast<int>(std::lround(control_period_s / timestep_s));
}

std::int64_t PhysicsSettings::step_at(double time_s) const {
  return std::llround(time_s / timestep_s);
}

void FaultSettings::bind(Fields& fields, const std::string& channels) {
  fields.choice("sensor.nan_policy", nan_policy,
                {{"stop", NanPolicy::stop}, {"drop", NanPolicy::drop}},
                "a measurement that is no number: stop the run, or drop it");
  fields.text("fault.sensor", fault.channel, "none, or the channel to break: " + channels);
  fields.number("fault.at_s", fault.at_s, not_negative(), "when it breaks [s]");
  fields.count("fault.samples", fault.samples, between(1, 1e9), "for how many samples");
}

void FaultSettings::apply(SensingSetup& setup) const {
  setup.nan_policy = nan_policy;
  setup.fault = fault;
  if (setup.fault.channel == "none") setup.fault.channel.clear();
}

void check_multiple(const Config& config, const std::string& key, double time_s, double step_s,
                    const std::string& step_name) {
  const double steps = time_s / step_s;
  if (std::abs(steps - std::round(steps)) > 1e-6 || (time_s > 0.0 && std::round(steps) < 1.0)) {
    config.fail(key, "must be a whole multiple of " + step_name);
  }
}

}  // namespace breakwater
