#include "plant/plant.h"

#include <algorithm>
#include <limits>
#include <optional>
#include <stdexcept>
#include <utility>

#include <breakwater/control/axes_control.h>
#include <breakwater/math/float_environment.h>
#include <breakwater/record/hdf5_log.h>
#include <breakwater/rigs/plant_parts.h>

namespace breakwater {

void Plant::learn(const Config& config) {
  Scenario::learn(config);
  plant_.learn(config);
  for (std::size_t i = 0; i < plant_.axes.size(); ++i) {
    axis_parts_.emplace_back(catalogue_, "none", "none");
  }
}

Fields Plant::fields() {
  Fields fields;
  plant_.bind_named(fields);
  parts_.bind(fields);
  for (std::size_t i = 0; i < axis_parts_.size(); ++i) {
    const Fields::Under under(fields, plant_.axes[i].axis.prefix());
    axis_parts_[i].bind(fields);
  }
  for (const AxisSettings& one : plant_.axes) {
    fields.only_for({one.axis.prefix() + "controller.name", one.axis.prefix() + "observer.name"},
                    "controller.name", {"axes"});
  }
  rows_.bind(fields);
  return fields;
}

PlantTask Plant::task() const {
  PlantTask task = plant_task(plant_);
  task.observes_axes = parts_.moves_tip();
  task.tip = [this, found = std::make_shared<std::optional<TipTask>>()] {
    if (!*found) *found = tip_task(plant_);
    return **found;
  };
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
    // A tip leaves its pose when it presses; its force is judged then.
    const bool holds = parts_.controller_name() != "axes" && !parts_.moves_tip();
    plant_.axes[i].is_controlled = holds || has_own_loop(i);
  }
  const PlantTask task = this->task();
  if (parts_.controller_name() == "axes") {
    for (std::size_t i = 0; i < axis_parts_.size(); ++i) {
      axis_parts_[i].check(config.under(plant_.axes[i].axis.prefix()), task.axes[i]);
    }
  } else if (!task.observes_axes && parts_.estimator_name() != "none" &&
             !task.why_not_linear.empty()) {
    config.fail("controller.name", task.why_not_linear);
  }
  parts_.check(config, task);
  if (parts_.moves_tip()) warn_of_free_coordinates(task.tip().kinematics->coordinates);
  const auto loop = parts_.make(task);
  const AxisRig rig(plant_, *loop.controller);
  const std::vector<Signal> signals = rig.signals();
  // A contact is shorter than a sample.
  MetricContext context{.fast_signals = {"force_true_N", "force_sensor_N", "force_filtered_N"}};
  for (const ContactSettings& one : plant_.contacts) {
    for (const char* what :
         {"N", "penetration_m", "approach_m_s", "mass_kg", "transient_N", "friction_N"}) {
      context.fast_signals.push_back(one.signal(what));
    }
  }
  const bool has_contact = plant_.tip && plant_.tip->contact != TipSettings::kNone;
  if (has_contact) context.events = {"first_contact"};
  rows_.check(
      config, [this] { return fields(); }, plant_.physics, context);
  for (const MetricRow& row : rows_.rows()) {
    const std::string missing = config.under(row.prefix()).blame("of", [&] {
      return missing_signal(row, rows_.kind_of(row), signals);
    });
    // Another case may have a controller or an estimator that publishes it.
    if (!missing.empty()) warnings_.push_back(missing + ": the metric is absent");
  }
}

void Plant::warn_of_free_coordinates(const std::vector<TipCoordinate>& held) {
  constexpr std::size_t kAll = 6;
  if (held.size() == kAll) return;
  std::string names;
  for (const TipCoordinate& one : held) names += (names.empty() ? "" : ", ") + one.name;
  warnings_.push_back("the tip holds " + names +
                      " of the contact's frame: its joints move no other coordinate independently");
}

bool Plant::has_own_loop(std::size_t i) const {
  return parts_.controller_name() == "axes" && axis_parts_[i].controller_name() != "none";
}

Recording Plant::run(const RunControl& control) const {
  const math::FloatEnvironment floats;
  const PlantTask task = this->task();
  const auto loop = parts_.make(task);
  AxisRig rig(plant_, *loop.controller);
  for (std::size_t i : task.driven) {
    if (has_own_loop(i)) rig.know_loop(axis_parts_[i], task.axes[i], i);
  }
  std::vector<Signal> signals = rig.signals();
  double first_contact_s = std::numeric_limits<double>::infinity();
  MetricExpression::Events events;
  if (plant_.tip) events = {{"first_contact", &first_contact_s}};
  MetricValues values(rows_, signals, plant_.run.duration_s, events);
  const double from_s = plant_.tip ? plant_.tip->reference.from_s : 0.0;
  const auto step = [&](std::int64_t) {
    rig.step();
    const double time_s = rig.simulation().time_s();
    if (rig.contact_force_N() > 0.0 && time_s >= from_s && time_s < first_contact_s) {
      first_contact_s = time_s;
    }
  };
  return rig.run(
      control, std::move(signals), step, [](double) {}, &values);
}

}  // namespace breakwater
