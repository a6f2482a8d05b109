#include <breakwater/rigs/axis_scenario.h>

#include <breakwater/math/float_environment.h>
#include <breakwater/rigs/predictive_settings.h>

namespace breakwater {
namespace {

// The signals for metrics. The first one of a name counts.
std::vector<Signal> metric_signals(const AxisAdditions& own, const AxisRig& rig,
                                   const AxisLoop& loop, const AxisUnits& units) {
  std::vector<Signal> signals = own.unlogged;
  const auto add = [&](const std::string& name, const std::string& unit, const double& value) {
    signals.push_back({name, unit, "", view(value)});
  };
  add("reference_" + units.position_suffix, units.position, rig.reference());
  if (loop.estimates()) {
    const auto part = [](const DisturbanceEstimator::View& values,
                         Eigen::Index i) -> const double& { return *(values.data() + i); };
    const DisturbanceEstimator& estimator = *loop.estimator;
    add("position_hat_" + units.position_suffix, units.position, part(estimator.state(), 0));
    add("velocity_hat_" + units.velocity_suffix, units.velocity, part(estimator.state(), 1));
    add("d_hat_" + units.force_suffix, units.force, part(estimator.disturbance(), 0));
  }
  return signals;
}

}  // namespace

AxisScenario::AxisScenario(const Catalogue& catalogue, AxisScenarioDesign design)
    : LoopScenario(MetricRows(catalogue, design.name, design.reductions)),
      plant_(design.axis, catalogue),
      parts_(catalogue, design.controller),
      design_(std::move(design)) {}

Fields AxisScenario::fields() {
  Fields fields;
  plant_.bind(fields);
  parts_.bind(fields);
  bind(fields);
  rows_.bind(fields);
  return fields;
}

void AxisScenario::bind_step(Fields& fields) {
  Reference& reference = plant_.axis().reference;
  const AxisUnits& units = plant_.axis().axis.units;
  fields.number("task.reference_" + units.position_suffix, reference.value, any(),
                "y_ref: reference of the position [" + units.position + "]");
  fields.number("task.reference_from_s", reference.from_s, not_negative(),
                "time of the step to the reference [s]");
}

void AxisScenario::check(const Config& config) {
  plant_.judged_to_s = config.number("metrics.to_s").value_or(0.0);
  check_plant(plant_, config);
  parts_.check(config, task());
  const MetricContext context = complete(config);
  rows_.check(
      config, [this] { return fields(); }, plant().physics, context);
}

AxisTask AxisScenario::task() const {
  const AxisPlant plant = this->plant();
  return {.axis = plant.nominal(), .reference = plant.axis().reference};
}

std::vector<MetricDefinition> AxisScenario::metric_definitions() const {
  return design_.optimises ? with_qp_metrics(rows_.definitions()) : rows_.definitions();
}

Recording AxisScenario::run(const RunControl& control) const {
  const math::FloatEnvironment floats;
  const AxisPlant plant = this->plant();
  const AxisTask task = this->task();
  const AxisLoop loop = parts_.make(task);
  AxisRig rig(plant, *loop.controller);
  rig.know_loop(parts_, task);
  const AxisAdditions own = additions(rig, loop);
  std::vector<Signal> logged = rig.signals();
  logged.insert(logged.end(), own.logged.begin(), own.logged.end());
  std::vector<Signal> signals = metric_signals(own, rig, loop, plant.axis().axis.units);
  signals.insert(signals.end(), logged.begin(), logged.end());
  MetricValues values(rows_, signals, plant.run.duration_s);
  const auto step = [&](std::int64_t k) {
    loop.controller->set_watched(control.logs || values.watches(rig.simulation().time_of(k)));
    rig.step();
    if (own.step) own.step();
  };
  const auto sample = [&](double time_s) {
    if (own.sample) own.sample(time_s);
  };
  Recording recording = rig.run(control, std::move(logged), step, sample, &values);
  if (design_.optimises && !recording.failure) {
    add_qp_metrics(*loop.controller, recording);
  }
  return recording;
}

}  // namespace breakwater
