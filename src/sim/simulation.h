// The simulation step: sense, control, act, step.
#pragma once

#include <mujoco/mujoco.h>

#include <Eigen/Core>
#include <cstdint>
#include <exception>
#include <memory>
#include <span>
#include <vector>

#include <breakwater/control/controller.h>
#include <breakwater/sim/external_force.h>
#include <breakwater/sim/model.h>
#include <breakwater/sim/sensing.h>
#include <breakwater/sim/state_hash.h>
#include <breakwater/world/pwm.h>

namespace breakwater {

/// One plant under one controller. The controller is called every `steps_per_sample` physics
/// steps, through MuJoCo's mjcb_control; its command is saturated at the actuators' ctrlrange and
/// held; an actuator without ctrlrange is not limited. All of it is deterministic: the same set-up
/// gives the same bits on any thread.
///
/// After step(), what it tells is the step's beginning: state, samples and command of that time,
/// and the sensors, forces included, that the engine computed for it.
class Simulation {
 public:
  /// The controller outlives the simulation. Throws std::invalid_argument if a channel does not
  /// fit the model, steps_per_sample is not positive or the engine cannot simulate the model.
  Simulation(Model model, Controller& controller, const SensingSetup& sensing,
             int steps_per_sample);
  ~Simulation();
  Simulation(const Simulation&) = delete;
  Simulation& operator=(const Simulation&) = delete;

  /// Makes an actuator round its command, once saturated.
  void set_pwm(int actuator, const Pwm& pwm) { pwm_[static_cast<std::size_t>(actuator)] = pwm; }

  /// Adds a force from outside, which outlives the simulation.
  void add(const ExternalForce& force) { forces_.push_back(&force); }
  void add(StagedForce& force) { staged_.push_back(&force); }

  /// Puts the plant at rest at `qpos`.
  void set_position(std::span<const double> qpos);

  /// Sets it moving; after set_position().
  void set_velocity(std::span<const double> qvel);

  /// Makes a geom collide with those whose contype has bit 1, or with nothing.
  void set_collidable(int geom, bool collidable);

  /// One physics step. Throws RunFailure if the engine warns, errs, or does not advance, or if a
  /// measurement, a command or the state is not finite; what it tells then is the failed step's.
  void step();

  const Model& model() const { return model_; }
  double timestep_s() const { return model_->opt.timestep; }
  /// The number of steps taken.
  std::int64_t steps() const { return steps_; }
  /// When step number k begins: k/(1/timestep) where that is a whole number, so that times are as
  /// round as they can be.
  double time_of(std::int64_t k) const;

  double time_s() const { return time_s_; }
  /// Whether a sample was taken at this time.
  bool sampled() const { return sampled_; }
  std::span<const double> qpos() const { return qpos_; }
  std::span<const double> qvel() const { return qvel_; }
  const Sample& sample() const { return sample_; }
  /// What the controller asked for, and what the actuators did after saturation and rounding.
  const Eigen::VectorXd& command() const { return command_; }
  const Eigen::VectorXd& actuation() const { return actuation_; }
  /// Whether any command was at or beyond its limit.
  bool saturated() const { return saturated_; }
  /// A sensor's first value, at an address that does not change.
  const double& sensor(const std::string& name) const;
  const Sensing& sensing() const { return sensing_; }
  const mjData& data() const { return *data_; }

  /// Of all states at sampling instants so far and the state now.
  std::uint64_t state_hash() const;

 private:
  static void control_callback(const mjModel* model, mjData* data);
  void start();
  void begin_step(const mjData& data);
  void act(mjData& data) const;
  void saturate();
  void check_engine(double time_before_s);
  [[noreturn]] void fail(const std::string& reason) const;

  Model model_;
  DataPointer data_;
  Controller& controller_;
  Sensing sensing_;
  int steps_per_sample_;
  std::vector<const ExternalForce*> forces_;
  std::vector<StagedForce*> staged_;

  std::int64_t steps_ = 0;
  double time_s_ = 0.0;
  double engine_time_at_step_s_ = 0.0;
  bool step_begins_ = false;  // the next callback is the first of its step
  bool sampled_ = false;
  bool saturated_ = false;
  Sample sample_;
  std::vector<double> qpos_;
  std::vector<double> qvel_;
  Eigen::VectorXd lower_limit_;
  Eigen::VectorXd upper_limit_;
  std::vector<Pwm> pwm_;
  Eigen::VectorXd command_;
  Eigen::VectorXd actuation_;
  std::exception_ptr thrown_in_callback_;
  StateHash hash_;
};

}  // namespace breakwater
