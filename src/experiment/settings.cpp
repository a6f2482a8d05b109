#include <breakwater/experiment/settings.h>

#include <algorithm>
#include <cmath>

#include <breakwater/shell/did_you_mean.h>

namespace breakwater {
namespace {

constexpr double kMostSteps = 1e11;
constexpr double kMostStepsPerSample = 1e6;

}  // namespace

void RunSettings::bind(Fields& fields) {
  fields.number("run.duration_s", duration_s, positive(), "simulated time");
  fields.count("run.seed", seed, not_negative(), "random seed of all noise");
  fields.optional_count(
      "record.compression", compression, between(0, 9),
      "compression of log.h5 by deflate: 0 is fastest, 9 gives the smallest file");
  fields.optional_flag(
      "record.stream", stream,
      "write log.h5 during the run, not from memory after it; after a kill it has the rows so far");
}

void bind_model(Fields& fields, ModelFile& model) {
  fields.file("model.mjcf", model.path, "MJCF file of the plant");
  fields.count("model.most_elements", model.most_elements, between(1, 1e9),
               "largest number of elements that the plant's file may have; a larger file is "
               "refused because it takes long");
  fields.standard("model.most_elements", {static_cast<std::int64_t>(ModelFile::kMostElements)});
}

void PhysicsSettings::bind(Fields& fields) {
  fields.number("physics.timestep_s", timestep_s, positive(), "the engine's step");
  fields.choice("physics.integrator", integrator,
                {{"euler", Integrator::euler},
                 {"rk4", Integrator::rk4},
                 {"implicit", Integrator::implicit},
                 {"Euler", Integrator::euler},  // the spelling of MJCF
                 {"RK4", Integrator::rk4}},
                "the engine's integrator");
  fields.number("control.period_s", control_period_s, positive(),
                "T_s: period of control and log, a multiple of the timestep");
}

void PhysicsSettings::check(const Config& config, const RunSettings& run) const {
  if (run.duration_s / timestep_s > kMostSteps) {
    config.fail("run.duration_s",
                "has too many steps of physics.timestep_s: shorten the run or lengthen the step");
  }
  if (std::llround(run.duration_s / timestep_s) < 1) {
    config.fail("run.duration_s", "must be at least one physics.timestep_s");
  }
  if (control_period_s / timestep_s > kMostStepsPerSample) {
    config.fail(
        "control.period_s",
        "has too many steps of physics.timestep_s: shorten the period or lengthen the step");
  }
  check_multiple(config, "control.period_s", control_period_s, timestep_s, "physics.timestep_s");
  if (run.stream && run.compression > 0) {
    config.fail("record.stream",
                "needs record.compression=0: the places of all rows must be known");
  }
}

int PhysicsSettings::steps_per_sample() const {
  return static_cast<int>(std::lround(control_period_s / timestep_s));
}

std::int64_t PhysicsSettings::step_at(double time_s) const {
  return std::llround(time_s / timestep_s);
}

double PhysicsSettings::sample_time_s(double time_s) const {
  const double samples = std::round(time_s / control_period_s);
  const double rate = std::round(1.0 / control_period_s);
  const bool is_whole = std::abs(rate * control_period_s - 1.0) < 1e-12;
  return is_whole ? samples / rate : samples * control_period_s;
}

void FaultSettings::bind(Fields& fields, const std::string& channels, const double& duration_s) {
  fields.optional_choice(
      "sensor.nan_policy", nan_policy, {{"stop", NanPolicy::stop}, {"drop", NanPolicy::drop}},
      "reaction to a measurement that is not a number: stop the run, or drop the measurement");
  fields.optional_text("fault.sensor", fault.channel, "none, or the channel to break: " + channels);
  fields.optional_number("fault.at_s", fault.at_s, not_negative(),
                         "time at which the sensor fails");
  fields.optional_count("fault.samples", fault.samples, between(1, 1e9),
                        "number of samples for which it fails");
  fields.optional_choice(
      "fault.kind", fault.kind,
      {{"nan", FaultKind::nan},
       {"infinity", FaultKind::infinity},
       {"frozen", FaultKind::frozen},
       {"dropped", FaultKind::dropped},
       {"spike", FaultKind::spike},
       {"bias", FaultKind::bias},
       {"delay", FaultKind::delay},
       {"stuck", FaultKind::stuck}},
      "readings of the broken sensor: nan, infinity, the last one (frozen; dropped: 50 ms), an "
      "error (spike, bias), late (delay) or rounded (stuck)");
  fields.optional_number(
      "fault.size", fault.size, any(),
      "error of a spike or bias, smallest step of a stuck quantiser, in the unit of the "
      "channel");
  fields.optional_count("fault.delay_samples", fault.delay_samples, between(1, 5),
                        "age of the readings of a delay");
  fields.only_where(
      {"fault.at_s", "fault.samples", "fault.kind", "fault.size", "fault.delay_samples"},
      "fault.sensor names a channel", [this] { return fault.channel != kNone; });
  fields.only_where({"fault.at_s"}, "it is not after run.duration_s",
                    [this, &duration_s] { return fault.at_s <= duration_s; });
  fields.only_for({"fault.samples"}, "fault.kind",
                  {"nan", "infinity", "frozen", "spike", "bias", "delay", "stuck"});
  fields.only_for({"fault.size"}, "fault.kind", {"spike", "bias", "stuck"});
  fields.only_for({"fault.delay_samples"}, "fault.kind", {"delay"});
}

void FaultSettings::check(const Config& config, const std::vector<SensorChannel>& channels) const {
  std::vector<std::string> names = {kNone};
  for (const SensorChannel& channel : channels) names.push_back(channel.name);
  if (std::find(names.begin(), names.end(), fault.channel) == names.end()) {
    config.fail("fault.sensor", must_be_one_of(names, fault.channel));
  }
  if (fault.channel == kNone) return;
  const bool has_error = fault.kind == FaultKind::spike || fault.kind == FaultKind::bias;
  const bool is_stuck = fault.kind == FaultKind::stuck;
  const bool is_wrong = is_stuck ? fault.size <= 0.0 : has_error && fault.size == 0.0;
  if (!is_wrong) return;
  if (config.find("fault.size") == nullptr) config.fail("fault.kind", "needs fault.size");
  config.fail("fault.size", is_stuck ? "must be positive for fault.kind = \"stuck\""
                                     : "must not be 0 for this fault.kind");
}

void FaultSettings::apply(SensingSetup& setup) const {
  setup.nan_policy = nan_policy;
  if (fault.channel != kNone) setup.fault = fault;
}

void bind_encoder_rounding(Fields& fields, EncoderRounding& rounding) {
  fields.optional_choice(
      "encoder.rounding", rounding,
      {{"nearest", EncoderRounding::nearest}, {"truncate", EncoderRounding::truncate}},
      "how the encoder rounds: to the nearest count, or towards 0 (truncate)");
}

bool is_multiple(double time_s, double step_s) {
  const double steps = time_s / step_s;
  return !(std::abs(steps - std::round(steps)) > 1e-6 || (time_s > 0.0 && std::round(steps) < 1.0));
}

void check_multiple(const Config& config, const std::string& key, double time_s, double step_s,
                    const std::string& step_name) {
  if (!is_multiple(time_s, step_s)) config.fail(key, "must be a whole multiple of " + step_name);
}

}  // namespace breakwater
