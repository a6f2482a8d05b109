// A plant of axes under a controller.
#pragma once

#include <functional>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <breakwater/control/controller.h>
#include <breakwater/experiment/run_loop.h>
#include <breakwater/experiment/scenario.h>
#include <breakwater/record/held_reference.h>
#include <breakwater/rigs/axis_settings.h>
#include <breakwater/sim/contact.h>
#include <breakwater/sim/external_force.h>
#include <breakwater/sim/joint_friction.h>
#include <breakwater/sim/simulation.h>

namespace breakwater {

/// Additions of a scenario to a run of its rig.
struct RigRun {
  /// A reference that the run judges. `add` gives it the error of a sample.
  struct Judged {
    HeldReference held;
    std::function<void(HeldReference& held, double time_s)> add;
  };

  std::vector<Signal> signals;      ///< logged at the control rate
  std::vector<Signal> for_metrics;  ///< not logged; the first of a name counts
  std::vector<Signal> fine;         ///< logged at the physics rate from AxisPlant::fine_from_s on
  /// Otherwise those of the axes and of the tip, and the limits of the drives.
  std::optional<std::vector<Judged>> judged;
  std::vector<std::size_t> loops;  ///< the axes whose loops `breakwater analyze` knows
  std::function<void()> after_step;
  bool samples_end = true;  ///< with a sample at the end

  /// Adds a signal of `size` values, each of which is computed after a sample. Without a text it is
  /// for metrics alone.
  void compute(std::string name, std::string unit, std::string text,
               std::function<double(double time_s, std::size_t i)> value, std::size_t size = 1);

 private:
  friend class AxisRig;
  struct Computed {
    std::vector<double> now;
    std::function<double(double time_s, std::size_t i)> value;
  };
  std::vector<Computed> computed_;
};

/// A plant of axes under a controller, with the true values for log and metrics. The controller
/// gets the samples of AxisPlant::sensing() and commands the driven axes.
class AxisRig {
 public:
  /// The controller must outlive the rig.
  AxisRig(const AxisPlant& plant, Controller& controller);
  AxisRig(const AxisRig&) = delete;
  AxisRig& operator=(const AxisRig&) = delete;

  /// One physics step. The forces on the axes are held during it. A disturbance that begins at a
  /// step thus begins there exactly, for any integrator.
  void step();

  Simulation& simulation() { return *simulation_; }
  const Simulation& simulation() const { return *simulation_; }
  /// The generalised positions of the model's file, without added rotors.
  std::span<const double> positions() const {
    return simulation().qpos().first(positions_of_file_);
  }
  // The values of an axis at the beginning of the last step.
  const double& position(std::size_t axis = 0) const {
    return simulation_->qpos()[axes_[axis].qpos];
  }
  const double& velocity(std::size_t axis = 0) const {
    return simulation_->qvel()[axes_[axis].qvel];
  }
  const double& measured(std::size_t axis = 0) const {
    return simulation_->sample().y(static_cast<Eigen::Index>(axis));
  }
  /// The command, and the drive's force after saturation and rounding.
  const double& command(std::size_t axis = 0) const {
    return simulation_->command()(axes_[axis].actuator);
  }
  const double& actuation(std::size_t axis = 0) const {
    return simulation_->actuation()(axes_[axis].actuator);
  }
  /// The motor's joint of an elastic transmission; otherwise the axis itself.
  const double& motor_position(std::size_t axis = 0) const {
    return simulation_->qpos()[axes_[axis].motor_qpos];
  }
  const double& motor_velocity(std::size_t axis = 0) const {
    return simulation_->qvel()[axes_[axis].motor_qvel];
  }
  /// The motor's current; only where an axis has an electric drive.
  const double& current_A(std::size_t axis) const;
  /// The true force of the motor.
  const double& motor_force(std::size_t axis) const {
    return has_motors_ ? simulation_->drive_force()(axes_[axis].actuator) : actuation(axis);
  }
  /// The force of the transmission on the load, or of a rigid one's motor.
  const double& transmitted(std::size_t axis) const {
    return axes_[axis].transmission ? axes_[axis].torque : motor_force(axis);
  }
  /// The dry friction; 0 if there is none, or it is not known (AxisPlant::knows_disturbances).
  const double& friction(std::size_t axis) const {
    return axes_[axis].friction ? axes_[axis].friction->force() : kNothing;
  }
  /// 1 where a drive is at its limit.
  const double& saturated() const { return saturated_; }
  /// d: the axis' disturbance and the dry friction of its joint, without noise. No observer can
  /// tell the two apart.
  const double& disturbance(std::size_t axis = 0) const { return axes_[axis].disturbance; }
  const double& reference(std::size_t axis = 0) const { return axes_[axis].reference; }

  /// The signals of the log at the control rate: true, measured, estimated and commanded.
  std::vector<Signal> signals() const;

  /// The forces of the tip among them and their reference. A tip without a contact lacks the true
  /// force.
  std::vector<Signal> tip_signals() const;

  /// The force of the tip's sensor behind its low-pass.
  const double& filtered_force_N() const {
    return simulation_->sensing().filtered(simulation_->sensing().size() - 2);
  }
  /// The first contact, if it is there and not the engine's alone.
  const WallContact* wall() const { return contacts_.empty() ? nullptr : contacts_.front().wall; }
  /// The time of the tip's first contact since its reference counts; infinite: there was none.
  const double& first_contact_s() const { return first_contact_s_; }
  /// Judges the tip's true force in a window, or the measured one if it has none.
  RigRun::Judged judged_force(const TimeWindow& window) const;

  /// Runs for the duration of the settings. It warns if a reference is not held, or if a drive is
  /// at its limit in most samples.
  Recording run(const RunControl& control, const MetricRows& rows, RigRun run);

 private:
  struct DrivenAxis {
    std::size_t qpos;  // index in the state
    std::size_t qvel;
    Eigen::Index actuator;
    std::unique_ptr<JointForce> force;           // null: there is no disturbance
    std::unique_ptr<JointFriction> friction;     // null: there is none
    bool rubs_load;                              // the friction is that of the axis' joint
    std::unique_ptr<Transmission> transmission;  // nullptr: rigid
    std::size_t motor_qpos;                      // the axis itself, if it is rigid
    std::size_t motor_qvel;
    Noise input_noise;
    double input_noise_value = 0.0;
    double disturbance = 0.0;
    double torque = 0.0;  // torque of the transmission, if it is elastic
    double reference = 0.0;
  };

  // A force on a body.
  struct Push {
    Disturbance disturbance;
    std::unique_ptr<BodyForce> force;
    double value = 0.0;
  };

  struct Contact {
    std::unique_ptr<ExternalForce> part;
    const double* force_N;
    WallContact* wall;  // null: the contact is the engine's alone
  };

  std::vector<RigRun::Judged> judged() const;
  // After the first step: the contacts that began with a force.
  std::vector<std::string> overlaps() const;

  static constexpr double kNothing = 0.0;

  AxisPlant plant_;
  int steps_per_sample_;
  std::int64_t solid_from_ = -1;  // step at which a contact is switched on ...
  std::optional<int> collides_;   // ... and its wall, if it is the engine's
  Controller& controller_;
  std::vector<DrivenAxis> axes_;
  std::vector<Push> pushes_;
  std::vector<Contact> contacts_;
  const double* contact_force_ = nullptr;  // the tip's; null: not known
  const double* touch_ = &kNothing;        // positive in a step in which the tip touches
  double force_reference_ = 0.0;
  double first_contact_s_ = std::numeric_limits<double>::infinity();
  double first_separation_s_ = first_contact_s_;
  std::unique_ptr<Simulation> simulation_;
  bool has_motors_;                // with electric parts: then each drive has one
  std::size_t positions_of_file_;  // added rotors come behind them; pictures do not have them
  std::string qpos_units_;
  double saturated_ = 0.0;
};

}  // namespace breakwater
