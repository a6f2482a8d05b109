#include "plant/plant.h"

#include <algorithm>
#include <stdexcept>
#include <utility>

#include <breakwater/control/axes_control.h>
#include <breakwater/math/float_environment.h>
#include <breakwater/record/hdf5_log.h>

namespace breakwater {

void Plant::learn(const Config& config) {
  plant_.learn(config);
  for (std::size_t i = 0; i < plant_.axes.size(); ++i) {
    axis_parts_.emplace_back(catalogue_, "none", "none");
  }
  for (const std::string& name : config.names_in("metric")) metrics_.emplace_back().name = name;
}

Fields Plant::fields() {
  Fields fields;
  plant_.bind(fields);
  parts_.bind(fields);
  for (std::size_t i = 0; i < axis_parts_.size(); ++i) {
    const Fields::Under under(fields, plant_.axes[i].axis.prefix());
    axis_parts_[i].bind(fields);
  }
  for (const AxisSettings& one : plant_.axes) {
    fields.only_for({one.axis.prefix() + "controller.name", one.axis.prefix() + "observer.name"},
                    "controller.name", {"axes"});
  }
  for (DeclaredMetric& metric : metrics_) metric.bind(fields);
  return fields;
}

std::vector<std::string> Plant::main_metrics() const {
  std::vector<std::string> names;
  for (const DeclaredMetric& metric : metrics_) names.push_back(metric.definition().name);
  return names;
}

std::vector<MetricDefinition> Plant::metric_definitions() const {
  std::vector<MetricDefinition> definitions;
  for (const DeclaredMetric& metric : metrics_) definitions.push_back(metric.definition());
  return definitions;
}

PlantTask Plant::task() const {
  PlantTask task = plant_task(plant_);
  task.own_controllers = [this, axes = task.axes] { return axes_control(axes); };
  return task;
}

std::unique_ptr<Controller> Plant::axes_control(const std::vector<AxisTask>& tasks,
                                                std::unique_ptr<Controller> other,
                                                std::size_t replaced) const {
  std::vector<AxisControl> controls;
  for (std::size_t i = 0; i < tasks.size(); ++i) {
    const Axis& axis = plant_.axes[i].axis;
    const bool is_other = other != nullptr && i == replaced;
    controls.push_back({axis.name,
                        is_other ? std::move(other) : axis_parts_[i].make(tasks[i]).controller,
                        axis.is_driven()});
  }
  return std::make_unique<AxesControl>(std::move(controls), plant_.senses_true_state ? 3 : 1);
}

std::vector<AxisOfPlant> Plant::loops() const {
  if (parts_.controller_name() != "axes") {
    throw std::invalid_argument("controller.name: \"" + parts_.controller_name() +
                                "\" controls all axes at once, so an axis has no loop of its own; "
                                "analyze needs \"axes\". Python has the eigenvalues of the whole "
                                "loop: setup.A, setup.B and K of bw.lqr()");
  }
  AxisPlant held = plant_;
  for (AxisSettings& axis : held.axes) axis.reference.kind = ReferenceShape::hold;
  const std::vector<AxisTask> tasks = plant_task(held).axes;
  std::vector<AxisOfPlant> loops;
  for (std::size_t i = 0; i < tasks.size(); ++i) {
    if (!held.axes[i].axis.is_driven() || !has_own_loop(i)) continue;
    loops.push_back(
        {held, tasks[i], &axis_parts_[i], i, [this, tasks, i](std::unique_ptr<Controller> own) {
           return axes_control(tasks, std::move(own), i);
         }});
  }
  return loops;
}

void Plant::check(const Config& config) {
  check_plant(plant_, config);
  warnings_ = plant_.warnings();
  for (std::size_t i = 0; i < axis_parts_.size(); ++i) {
    plant_.axes[i].is_controlled = parts_.controller_name() != "axes" || has_own_loop(i);
  }
  const PlantTask task = this->task();
  if (parts_.controller_name() == "axes") {
    for (std::size_t i = 0; i < axis_parts_.size(); ++i) {
      axis_parts_[i].check(config.under(plant_.axes[i].axis.prefix()), task.axes[i]);
    }
  } else if (parts_.estimator_name() != "none" && !task.why_not_linear.empty()) {
    config.fail("controller.name", task.why_not_linear);
  }
  parts_.check(config, task);
  const auto loop = parts_.make(task);
  const AxisRig rig(plant_, *loop.controller);
  const std::vector<Signal> signals = rig.signals();
  for (const DeclaredMetric& metric : metrics_) {
    const Config own = config.under(metric.prefix());
    const std::string missing = own.blame("of", [&] { return missing_signal(metric, signals); });
    // Another case may have a controller or an estimator that publishes it.
    if (!missing.empty()) {
      warnings_.push_back(missing + ": the metric is absent");
    } else {
      own.blame("cutoff_Hz",
                [&] { DeclaredValue(metric, signals, plant_.run.duration_s, period_of(metric)); });
    }
    if (metric.to_s != 0.0 && metric.to_s <= metric.from_s) {
      own.fail("to_s", "must be later than from_s, or 0 for the end of the run");
    }
  }
}

bool Plant::has_own_loop(std::size_t i) const {
  return parts_.controller_name() == "axes" && axis_parts_[i].controller_name() != "none";
}

bool Plant::is_fast(const DeclaredMetric& metric) const {
  return std::any_of(
      plant_.contacts.begin(), plant_.contacts.end(),
      [&](const ContactSettings& one) { return one.signal() == signal_name(metric.of).name; });
}

double Plant::period_of(const DeclaredMetric& metric) const {
  return is_fast(metric) ? plant_.physics.timestep_s : plant_.physics.control_period_s;
}

Recording Plant::run(const RunControl& control) const {
  const math::FloatEnvironment floats;
  const PlantTask task = this->task();
  const auto loop = parts_.make(task);
  AxisRig rig(plant_, *loop.controller);
  for (std::size_t i : task.driven) {
    if (has_own_loop(i)) rig.know_loop(axis_parts_[i], task.axes[i], i);
  }
  const Simulation& sim = rig.simulation();
  const std::vector<Signal> signals = rig.signals();
  std::vector<DeclaredValue> at_samples, at_steps;
  std::vector<std::pair<bool, std::size_t>> order;
  std::vector<AbsentMetric> absent;
  for (const DeclaredMetric& metric : metrics_) {
    if (const std::string missing = missing_signal(metric, signals); !missing.empty()) {
      const MetricDefinition definition = metric.definition();
      absent.push_back({definition.name, definition.unit, missing});
      continue;
    }
    const bool fast = is_fast(metric);
    std::vector<DeclaredValue>& values = fast ? at_steps : at_samples;
    order.emplace_back(fast, values.size());
    values.emplace_back(metric, signals, plant_.run.duration_s, period_of(metric));
  }
  const auto step = [&](std::int64_t) {
    rig.step();
    for (DeclaredValue& value : at_steps) value.add(sim.time_s());
  };
  const auto sample = [&](double time_s) {
    for (DeclaredValue& value : at_samples) value.add(time_s);
  };
  const auto measured = [&] {
    std::vector<Metric> metrics;
    for (const auto& [is_at_step, i] : order) {
      const DeclaredValue& value = (is_at_step ? at_steps : at_samples)[i];
      const MetricDefinition definition = value.metric().definition();
      add(metrics, definition.name, definition.unit, value.value());
    }
    return metrics;
  };
  Recording recording = rig.run(control, signals, step, sample, measured);
  for (const auto& [is_at_step, i] : order) {
    const DeclaredValue& value = (is_at_step ? at_steps : at_samples)[i];
    const MetricDefinition definition = value.metric().definition();
    if (recording.failure || recording.metric(definition.name)) continue;
    absent.push_back({definition.name, definition.unit, value.why_absent()});
  }
  recording.absent = std::move(absent);
  return recording;
}

}  // namespace breakwater
