// An axis (motor or cart) with its controller and simulation, shared by its scenarios.
#pragma once

#include <concepts>
#include <memory>
#include <string>
#include <vector>

#include <breakwater/control/controller.h>
#include <breakwater/control/step_reference.h>
#include <breakwater/experiment/run_loop.h>
#include <breakwater/experiment/scenario.h>
#include <breakwater/record/held_reference.h>
#include <breakwater/rigs/axis_parts.h>
#include <breakwater/sim/joint_force.h>
#include <breakwater/sim/simulation.h>
#include <breakwater/world/disturbance.h>

namespace breakwater {

/// The names and units of an axis in its model.
struct Axis {
  std::string joint;
  std::string actuator;
  std::string position_sensor;
  std::string velocity_sensor;
  std::string channel;          ///< name of the position's sensor channel
  bool counts_pulses;           ///< the key of its encoder is pulses per revolution
  std::string inertia_name;     ///< "inertia", "mass"
  std::string inertia_suffix;   ///< "kgm2"
  std::string friction_suffix;  ///< suffix of the viscous friction: "Nms_rad"
  AxisUnits units;
};

/// The axes of models/motor.xml and models/cart.xml.
Axis motor_axis();
Axis cart_axis();

/// The keys of all scenarios on one axis.
struct AxisSettings {
  explicit AxisSettings(Axis which) : axis(std::move(which)) {}

  Axis axis;
  ModelFile mjcf;
  PhysicsSettings physics;
  RunSettings run;

  // The start, and whether the controller also gets the true state. Not all scenarios have these
  // keys.
  double start_position = 0.0;
  double start_velocity = 0.0;
  StepReference reference;         ///< reference of the position
  double judged_to_s = 0.0;        ///< end of the metrics' windows: a shorter run has no metrics
  bool senses_true_state = false;  ///< samples are [measured position; position; velocity]

  double inertia_ratio = 1.0;     ///< ratio of the plant's inertia to that of its model file
  double viscous_friction = 0.0;  ///< friction of the plant
  double coulomb_friction = 0.0;
  double nominal_inertia = 0.0;  ///< for the controller and the observer
  double nominal_friction = 0.0;

  double drive_limit = 0.0;       ///< 0: none
  double drive_resolution = 0.0;  ///< step of the PWM; 0: not quantised

  int encoder_bits = 0;  ///< 0: not quantised
  double encoder_multiplication = 1.0;
  double encoder_gear_ratio = 1.0;
  double encoder_resolution = 0.0;  ///< one count, in place of pulses; 0: not quantised
  double encoder_phase = 0.0;
  EncoderOrigin encoder_origin = EncoderOrigin::counted;
  EncoderRounding encoder_rounding = EncoderRounding::nearest;
  double noise_std = 0.0;  ///< noise of the measurement
  double input_noise_std =
      0.0;  ///< standard deviation of a random force that is drawn at each control sample
  int delay_samples = 0;
  FaultSettings faults;

  void bind(Fields& fields);

  double quantum() const;                ///< Δ of the encoder; 0: not quantised
  double pulses_per_revolution() const;  ///< b_reso, or counts per metre; 0: not quantised
  double force_limit() const;            ///< limit of the drive; infinity: none
  NominalAxis nominal() const;  ///< the nominal model, for the estimator and the controller
};

/// Further inputs of the axis besides drive and friction, and of its sensor (Eqs. 2.5, 2.36, 2.37).
struct AxisDisturbances {
  Disturbance force;     ///< d, which opposes the drive
  Disturbance position;  ///< d_o, added to the measurement
};

/// Checks what the single fields cannot: the names in the model file, periods. Throws
/// std::invalid_argument `ORIGIN: KEY: reason`.
void check_axis(const AxisSettings& settings, const Config& config);

/// The linear part of the plant, continuous: its inertia and its viscous friction.
StateSpace linear_axis(const AxisSettings& settings);

/// The plant of one axis under a controller, with the true values for log and metrics.
class AxisRig {
 public:
  /// The controller must outlive the rig.
  AxisRig(const AxisSettings& settings, const AxisDisturbances& disturbances,
          Controller& controller);
  AxisRig(const AxisRig&) = delete;
  AxisRig& operator=(const AxisRig&) = delete;

  /// One physics step. The forces on the axis are held during it. A disturbance that begins at a
  /// step thus begins there exactly, for any integrator.
  void step();

  const Simulation& simulation() const { return *simulation_; }
  /// d at the beginning of the last step, without noise and friction.
  double disturbance() const { return disturbance_; }

  /// The signals of the log at the control rate: true, measured, estimated and commanded.
  std::vector<Signal> signals() const;

  /// Runs for the duration of the settings, with a sample at the end. It is record_run(), where
  /// each step is `step(k)` or one step of this rig. It warns if the measured position misses its
  /// reference.
  template <typename Step, typename Sample>
  requires std::invocable<Sample&, double> Recording run(const RunControl& control,
                                                         const AxisSettings& settings,
                                                         std::vector<Signal> signals, Step&& step,
                                                         Sample&& sample,
                                                         const MetricsSoFar& measured = {}) {
    const double end_s = settings.run.duration_s;
    HeldReference held({reference_.from_s, end_s >= settings.judged_to_s ? end_s : 0.0},
                       "the position", units_.position);
    held.ask(reference_.value - simulation_->qpos()[0]);
    const auto watched_sample = [&](double time_s) {
      held.add(time_s, reference_.at(time_s) - simulation_->sample().y(0));
      sample(time_s);
    };
    Recording recording = record_run(
        *simulation_, settings.physics, settings.physics.step_at(settings.run.duration_s) + 1,
        std::move(signals), control, std::forward<Step>(step), watched_sample, measured);
    if (!recording.failure) held.warn(recording.warnings);
    return recording;
  }
  template <typename Sample>
  requires std::invocable<Sample&, double> Recording run(const RunControl& control,
                                                         const AxisSettings& settings,
                                                         std::vector<Signal> signals,
                                                         Sample&& sample,
                                                         const MetricsSoFar& measured = {}) {
    return run(
        control, settings, std::move(signals), [this](std::int64_t) { this->step(); },
        std::forward<Sample>(sample), measured);
  }

 private:
  AxisUnits units_;
  StepReference reference_;
  AxisDisturbances disturbances_;
  Noise input_noise_;
  double input_noise_std_;
  int steps_per_sample_;
  Controller& controller_;
  std::unique_ptr<JointForce> force_;
  std::unique_ptr<Simulation> simulation_;
  const double* position_;
  const double* velocity_;
  double disturbance_ = 0.0;
  double input_noise_value_ = 0.0;
  double saturated_ = 0.0;
};

}  // namespace breakwater
