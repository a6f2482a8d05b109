#include <breakwater/rigs/axis_scenario.h>

#include <algorithm>
#include <stdexcept>
#include <utility>

#include <breakwater/control/axes_control.h>
#include <breakwater/math/float_environment.h>

namespace breakwater {

AxisScenario::AxisScenario(const Catalogue& catalogue, AxisScenarioDesign design)
    : Scenario(design.axis || design.is_arm ? MetricRows(catalogue, design.name, design.reductions)
                                            : MetricRows()),
      design_(std::move(design)),
      catalogue_(design_.has_nameless_axis() ? Catalogue() : with_none(catalogue, design_.is_arm)),
      plant_(catalogue_) {
  if (design_.axis) {
    plant_.axes.emplace_back(*design_.axis, catalogue).disturbance.shape.kind = design_.disturbance;
  }
  if (design_.is_arm) {
    plant_.keyframe = "home";
    plant_.tip = {.touch = "tip_touch", .sensor = "tip_force"};
  }
  if (design_.has_nameless_axis()) {
    axis_parts_.emplace_back(catalogue, design_.controller);
  } else {
    whole_.emplace(catalogue_, design_.is_arm ? "" : "axes", design_.is_arm ? "idob" : "none");
  }
}

void AxisScenario::learn(const Config& config) {
  if (design_.is_arm && !config.text("model.urdf")) {
    config.fail("model.urdf", "is missing: the URDF file of the arm");
  }
  Scenario::learn(config);
  if (whole_) plant_.learn(config);
}

Fields AxisScenario::fields() {
  while (!design_.is_arm && axis_parts_.size() < plant_.axes.size()) {
    axis_parts_.emplace_back(catalogue_, "none", "none");
  }
  Fields fields;
  plant_.bind(fields);
  if (whole_) whole_->bind(fields);
  for (std::size_t i = 0; i < axis_parts_.size(); ++i) {
    const Fields::Under under(fields, plant_.axes[i].axis.prefix());
    axis_parts_[i].bind(fields);
  }
  for (std::size_t i = 0; whole_ && i < axis_parts_.size(); ++i) {
    const std::string axis = plant_.axes[i].axis.prefix();
    fields.only_for({axis + "controller.name", axis + "observer.name"}, "controller.name",
                    {"axes"});
  }
  bind(fields);
  rows_.bind(fields);
  return fields;
}

AxisTask AxisScenario::task() const {
  const AxisPlant plant = this->plant();
  return {.axis = plant.nominal(),
          .reference = plant.axis().reference,
          .start_state = start_estimate_,
          .senses_true_state = plant.senses_true_state};
}

PlantTask AxisScenario::whole_task() const {
  if (!whole_) return {.axes = {task()}, .driven = {0}};
  // A controller of the tip has an estimator for each axis.
  PlantTask task = plant_task(plant_, !moves_tip());
  task.observes_axes = moves_tip();
  task.tip = [this, found = std::make_shared<std::optional<ArmSetup>>()] {
    if (!*found) *found = tip();
    return **found;
  };
  task.own_controllers = [this, axes = task.axes] { return axes_control(axes); };
  return task;
}

AxisLoop AxisScenario::make_loop(const PlantTask& task) const {
  return whole_ ? whole_->make(task) : parts().make(task.axes.front());
}

std::unique_ptr<Controller> AxisScenario::axes_control(const std::vector<AxisTask>& tasks,
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

std::vector<AxisOfPlant> AxisScenario::loops() const {
  if (!whole_) return {{plant(), task(), &parts()}};
  if (whole_->controller_name() != "axes") {
    throw std::invalid_argument(
        "controller.name: \"" + whole_->controller_name() +
        "\" controls all axes at once, so an axis has no loop of its own" +
        (design_.is_arm ? ""
                        : "; analyze needs \"axes\". Python has the eigenvalues of the "
                          "whole loop: setup.A, setup.B and K of bw.lqr()"));
  }
  AxisPlant held = plant_;
  for (AxisSettings& axis : held.axes) axis.reference.kind = ReferenceShape::hold;
  const std::vector<AxisTask> tasks = plant_task(held, false).axes;
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

void AxisScenario::check(const Config& config, const Fields& fields) {
  plant_.judged_to_s = config.number("metrics.to_s").value_or(0.0);
  plant_.check(config);
  PlantTask task;
  if (whole_) {
    task = check_whole(config);
  } else {
    parts().check(config, this->task());
  }
  MetricContext context = complete(config);
  // A contact is shorter than a sample.
  context.fast_signals = {"force_true_N", "force_sensor_N", "force_filtered_N"};
  for (const ContactSettings& one : plant_.contacts) {
    context.fast_signals.push_back(one.signal(""));
  }
  const bool has_contact = plant_.tip && plant_.tip->contact != Axis::kNone;
  if (has_contact) context.events = {"first_contact", "first_separation"};
  rows_.check(config, fields, plant_.physics, context);
  warnings_ = plant().warnings();
  if (!whole_) return;
  constexpr Eigen::Index kAllCoordinates = 6;
  if (moves_tip() && !plant_.chain && task.tip().chain->held() < kAllCoordinates) {
    warnings_.push_back("the tip holds " + task.tip().chain->names() +
                        " of the contact's frame: its joints move no other coordinate "
                        "independently");
  }
  warn_of_missing_signals(config, task);
  if (!design_.is_arm) return;
  // A log with the friction of one joint has that of all.
  plant_.knows_disturbances = std::ranges::any_of(plant_.axes, [](const AxisSettings& one) {
    const Disturbance& d = one.disturbance.shape;
    return d.kind != DisturbanceKind::none || d.offset != 0.0 || one.input_noise() > 0.0 ||
           one.drive.friction.make(1.0) != nullptr;
  });
}

PlantTask AxisScenario::check_whole(const Config& config) {
  for (std::size_t i = 0; i < axis_parts_.size(); ++i) {
    // A tip leaves its pose when it presses; its force is judged then.
    const bool holds = whole_->controller_name() != "axes" && !moves_tip();
    plant_.axes[i].is_controlled = holds || has_own_loop(i);
  }
  PlantTask task = whole_task();
  if (whole_->controller_name() == "axes") {
    for (std::size_t i = 0; i < axis_parts_.size(); ++i) {
      axis_parts_[i].check(config.under(plant_.axes[i].axis.prefix()), task.axes[i]);
    }
  } else if (!task.observes_axes && whole_->estimator_name() != "none" &&
             !task.why_not_linear.empty()) {
    config.fail("controller.name", task.why_not_linear);
  }
  whole_->check(config, task);
  return task;
}

void AxisScenario::warn_of_missing_signals(const Config& config, const PlantTask& task) {
  const AxisLoop loop = make_loop(task);
  AxisRig rig(plant_, *loop.controller);
  const RigRun run = make_run(rig, loop);
  std::vector<Signal> signals = run.signals;
  for (const std::vector<Signal>* more : {&run.for_metrics, &run.fine}) {
    signals.insert(signals.end(), more->begin(), more->end());
  }
  for (const MetricRow& row : rows_.rows()) {
    const std::string missing = config.under(row.prefix()).blame("of", [&] {
      return missing_signal(row, rows_.kind_of(row), signals);
    });
    // Another case may have a controller or an estimator that publishes it.
    const std::string what = row.is_signal ? "signal" : "metric";
    if (!missing.empty()) warnings_.push_back(missing + ": the " + what + " is absent");
  }
}

bool AxisScenario::has_own_loop(std::size_t i) const {
  return !whole_ ||
         (whole_->controller_name() == "axes" && axis_parts_[i].controller_name() != "none");
}

std::vector<MetricDefinition> AxisScenario::metric_definitions() const {
  std::vector<MetricDefinition> all = rows_.definitions();
  if (design_.totals == nullptr) return all;
  for (const ControllerTotal& one : design_.totals(nullptr)) all.push_back(one.definition);
  return all;
}

RigRun AxisScenario::make_run(AxisRig& rig, const AxisLoop& loop) const {
  RigRun run;
  for (std::size_t i = 0; i < plant_.axes.size(); ++i) {
    if (plant_.axes[i].axis.is_driven() && has_own_loop(i)) run.loops.push_back(i);
  }
  run.signals = rig.signals();
  if (!whole_) {
    const AxisUnits& units = plant_.axis().axis.units;
    if (loop.estimates()) run.for_metrics = estimate_signals(*loop.estimator, units);
    run.for_metrics.push_back(
        {"reference_" + units.position, units.position, "", view(rig.reference())});
  }
  extend(run, rig, loop);
  return run;
}

Recording AxisScenario::run(const RunControl& control) const {
  const math::FloatEnvironment floats;
  const PlantTask task = whole_task();
  const AxisLoop loop = make_loop(task);
  AxisRig rig(plant(), *loop.controller);
  Recording recording = rig.run(control, rows_, make_run(rig, loop));
  if (design_.totals == nullptr || recording.failure) return recording;
  for (const ControllerTotal& one : design_.totals(loop.controller.get())) {
    add(one.is_cost ? recording.costs : recording.metrics, one.definition.name, one.definition.unit,
        one.value);
  }
  return recording;
}

}  // namespace breakwater
