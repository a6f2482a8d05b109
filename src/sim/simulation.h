// The simulation step: sense, control, act, step.
#pragma once

#include <mujoco/mujoco.h>

#include <Eigen/Core>
#include <cstdint>
#include <exception>
#include <optional>
#include <span>
#include <vector>

#include <breakwater/control/controller.h>
#include <breakwater/sim/external_force.h>
#include <breakwater/sim/model.h>
#include <breakwater/sim/sensing.h>
#include <breakwater/sim/state_hash.h>
#include <breakwater/world/command_timing.h>
#include <breakwater/world/motor_drive.h>

namespace breakwater {

/// One plant with one controller. MuJoCo's mjcb_control calls the controller every
/// `steps_per_sample` physics steps. Its command is limited to the actuators' ctrlrange, if they
/// have one, and held. The result is deterministic: equal set-ups give equal bits on any thread.
///
/// After step(), the getters refer to the beginning of the step. They return the state, samples and
/// command at that time, and the sensors that the engine computed for it, forces included.
class Simulation {
 public:
  /// The controller must outlive the simulation. Throws std::invalid_argument if a channel does not
  /// fit the model, steps_per_sample is not positive or the engine cannot simulate the model.
  Simulation(Model model, Controller& controller, const SensingSetup& sensing,
             int steps_per_sample);
  Simulation(const Simulation&) = delete;
  Simulation& operator=(const Simulation&) = delete;

  /// The actuators that the controller commands, in the order of its commands. The others get 0.
  /// Without this call it commands all.
  void set_commanded(std::vector<Eigen::Index> actuators);

  /// Makes an actuator round its command after saturation.
  void set_pwm(int actuator, const Pwm& pwm) { pwm_[static_cast<std::size_t>(actuator)] = pwm; }

  /// Puts a delay between the commands, saturated and rounded, and the drives. Throws
  /// std::invalid_argument if the delays are wrong.
  void set_timing(const CommandDelays& delays, std::uint64_t seed);

  /// Gives an actuator a motor with an electric part. Its force may exceed the actuator's
  /// ctrlrange, which then limits only the command. Throws std::invalid_argument if the drive is
  /// wrong.
  void set_drive(int actuator, const ElectricDrive& drive);

  /// Adds an external force. It must outlive the simulation.
  void add(ExternalForce& force) { forces_.push_back(&force); }

  /// Sets the plant at rest at `qpos`.
  void set_position(std::span<const double> qpos);

  /// Sets the velocity; call it after set_position().
  void set_velocity(std::span<const double> qvel);

  /// Lets a geom collide with the geoms whose contype has bit 1, or with nothing.
  void set_collidable(int geom, bool collidable) { model_.set_collidable(geom, collidable); }

  /// One physics step. Throws RunFailure if the engine reports a warning or an error or the time
  /// does not advance. Throws it too if a measurement, a command or the state is not finite. The
  /// getters then refer to the failed step.
  void step();

  const Model& model() const { return model_; }
  double timestep_s() const { return model_->opt.timestep; }
  /// The number of steps taken.
  std::int64_t steps() const { return steps_; }
  /// The time at the beginning of step k: k/(1/timestep) if 1/timestep is a whole number. This
  /// gives round times.
  double time_of(std::int64_t k) const;

  double time_s() const { return time_s_; }
  /// Whether a sample was taken at this time.
  bool sampled() const { return sampled_; }
  std::span<const double> qpos() const { return qpos_; }
  std::span<const double> qvel() const { return qvel_; }
  const Sample& sample() const { return sample_; }
  /// The controller's command, and what reaches the drives after saturation, rounding and delay.
  const Eigen::VectorXd& command() const { return command_; }
  const Eigen::VectorXd& actuation() const { return actuation_; }
  /// The force of each drive with an electric part; of the others, it is 0.
  const Eigen::VectorXd& drive_force() const { return drive_force_; }
  /// The motor of an actuator with an electric part.
  const MotorDrive& motor(int actuator) const {
    return *drives_[static_cast<std::size_t>(actuator)];
  }
  /// Whether a command reached or exceeded its limit.
  bool saturated() const { return saturated_; }
  /// The first value of a sensor, at an address that does not change.
  const double& sensor(const std::string& name) const;
  const Sensing& sensing() const { return sensing_; }
  const mjData& data() const { return *data_; }

  /// Hash of all states at the sampling instants so far and of the present state.
  std::uint64_t state_hash() const;

 private:
  static void control_callback(const mjModel* model, mjData* data);
  void start();
  void begin_step(const mjData& data);
  void sample(const mjData& data);
  void act(mjData& data) const;
  void saturate();
  void drive(const mjData& data);
  void check_engine(double time_before_s);
  [[noreturn]] void fail(const std::string& reason) const;

  Model model_;
  DataPointer data_;
  Controller& controller_;
  Sensing sensing_;
  int steps_per_sample_;
  std::vector<ExternalForce*> forces_;

  std::int64_t steps_ = 0;
  double time_s_ = 0.0;
  double engine_time_at_step_s_ = 0.0;
  bool step_begins_ = false;  // the next callback is the first one of its step
  bool sampled_ = false;
  bool saturated_ = false;
  Sample sample_;
  std::vector<double> qpos_;
  std::vector<double> qvel_;
  Eigen::VectorXd lower_limit_;
  Eigen::VectorXd upper_limit_;
  std::vector<Pwm> pwm_;
  std::optional<CommandTiming> timing_;
  std::vector<std::optional<MotorDrive>> drives_;  // one for each actuator; empty: none has a drive
  std::vector<Eigen::Index> commanded_;
  Eigen::VectorXd given_;  // the controller's commands of these actuators
  Eigen::VectorXd command_;
  Eigen::VectorXd actuation_;
  Eigen::VectorXd drive_force_;
  std::exception_ptr thrown_in_callback_;
  StateHash hash_;
};

}  // namespace breakwater
