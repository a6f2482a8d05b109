#include <breakwater/sim/simulation.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <mutex>
#include <numeric>
#include <stdexcept>
#include <string>
#include <utility>

#include <breakwater/sim/engine_guard.h>

namespace breakwater {
namespace {

// mjcb_control is one pointer for the whole process, so it is set only once. The callback uses the
// simulation that steps on the calling thread, and ignores the data of any other.
thread_local Simulation* stepping = nullptr;

// Rounding allowance for a command at its limit, because the controller clips it too.
constexpr double kLimitSlack = 1e-9;

bool all_finite(const mjtNum* values, int count) {
  return std::all_of(values, values + count, [](mjtNum v) { return std::isfinite(v); });
}

Model with_listed_contacts(Model model) {
  model.list_contacts();
  return model;
}

// In the order of mjtWarning.
constexpr std::array<const char*, mjNWARNING> kWarnings = {
    "inertia matrix is nearly singular",
    "contact buffer is full",
    "constraint buffer is full",
    "too many geoms are drawn",
    "diverged: a position is not finite or huge",
    "diverged: a velocity is not finite or huge",
    "diverged: an acceleration is not finite or huge",
    "an actuator command is not finite or huge"};

}  // namespace

Simulation::Simulation(Model model, Controller& controller, const SensingSetup& sensing,
                       int steps_per_sample)
    : model_(with_listed_contacts(std::move(model))),
      data_(model_.make_data()),
      controller_(controller),
      sensing_(model_, sensing),
      steps_per_sample_(steps_per_sample) {
  if (steps_per_sample < 1)
    throw std::invalid_argument("simulation: needs 1 step per sample or more");
  const double unlimited = std::numeric_limits<double>::infinity();
  lower_limit_.setConstant(model_->nu, -unlimited);
  upper_limit_.setConstant(model_->nu, unlimited);
  for (int i = 0; i < model_->nu; ++i) {
    if (model_->actuator_ctrllimited[i] == 0) continue;
    lower_limit_(i) = model_->actuator_ctrlrange[2 * i];
    upper_limit_(i) = model_->actuator_ctrlrange[2 * i + 1];
  }
  pwm_.resize(static_cast<std::size_t>(model_->nu));
  sample_.y = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(sensing_.size()));
  qpos_.assign(static_cast<std::size_t>(model_->nq), 0.0);
  qvel_.assign(static_cast<std::size_t>(model_->nv), 0.0);
  commanded_.resize(static_cast<std::size_t>(model_->nu));
  std::iota(commanded_.begin(), commanded_.end(), Eigen::Index{0});
  given_.setZero(model_->nu);
  command_.setZero(model_->nu);
  actuation_.setZero(model_->nu);
  drive_force_.setZero(model_->nu);

  static std::once_flag once;
  std::call_once(once, [] { mjcb_control = &Simulation::control_callback; });
}

void Simulation::set_commanded(std::vector<Eigen::Index> actuators) {
  commanded_ = std::move(actuators);
  given_.setZero(static_cast<Eigen::Index>(commanded_.size()));
}

void Simulation::set_position(std::span<const double> qpos) {
  if (qpos.size() != static_cast<std::size_t>(model_->nq)) {
    throw std::invalid_argument(model_.file() + ": needs " + std::to_string(model_->nq) +
                                " start positions, got " + std::to_string(qpos.size()));
  }
  std::copy(qpos.begin(), qpos.end(), data_->qpos);
  std::fill_n(data_->qvel, model_->nv, 0.0);
}

void Simulation::set_velocity(std::span<const double> qvel) {
  if (qvel.size() != static_cast<std::size_t>(model_->nv)) {
    throw std::invalid_argument(model_.file() + ": needs " + std::to_string(model_->nv) +
                                " start velocities, got " + std::to_string(qvel.size()));
  }
  std::copy(qvel.begin(), qvel.end(), data_->qvel);
}

void Simulation::set_timing(const CommandDelays& delays, std::uint64_t seed) {
  timing_.emplace(delays, seed, timestep_s(), steps_per_sample_,
                  static_cast<std::size_t>(model_->nu));
}

void Simulation::set_drive(int actuator, const ElectricDrive& drive) {
  drives_.resize(static_cast<std::size_t>(model_->nu));
  drives_[static_cast<std::size_t>(actuator)].emplace(drive, timestep_s());
  model_.get()->actuator_ctrllimited[actuator] = 0;  // saturate() limits the command
}

void Simulation::control_callback(const mjModel*, mjData* data) {
  Simulation* simulation = stepping;
  if (simulation == nullptr || data != simulation->data_.get() ||
      simulation->thrown_in_callback_ != nullptr) {
    return;
  }
  // No exception may cross the engine's C frames: it is stored, and rethrown after the step.
  try {
    if (std::exchange(simulation->step_begins_, false)) simulation->begin_step(*data);
    simulation->act(*data);
  } catch (...) {
    simulation->thrown_in_callback_ = std::current_exception();
  }
}

void Simulation::begin_step(const mjData& data) {
  std::copy_n(data.qpos, qpos_.size(), qpos_.begin());
  std::copy_n(data.qvel, qvel_.size(), qvel_.begin());
  for (ExternalForce* force : forces_) force->begin_step();
  sampled_ = steps_ % steps_per_sample_ == 0;
  if (sampled_) sample(data);
  drive(data);
}

void Simulation::sample(const mjData& data) {
  hash_.update(qpos_);
  hash_.update(qvel_);
  sample_.time_s = time_s_;
  sensing_.take(steps_ / steps_per_sample_, data, sample_);
  if (steps_ == 0) controller_.reset(sample_);
  try {
    controller_.update(sample_, given_);
  } catch (const ControlFailure& failure) {
    fail(failure.what());
  }
  for (std::size_t i = 0; i < commanded_.size(); ++i) {
    command_(commanded_[i]) = given_(static_cast<Eigen::Index>(i));
  }
  saturate();
}

void Simulation::saturate() {
  saturated_ = false;
  for (Eigen::Index i = 0; i < command_.size(); ++i) {
    if (!std::isfinite(command_(i))) {
      fail("command of actuator " + std::to_string(i + 1) + " is not finite");
    }
    const double slack = kLimitSlack * std::abs(command_(i));
    saturated_ |= command_(i) <= lower_limit_(i) + slack || command_(i) >= upper_limit_(i) - slack;
    actuation_(i) = pwm_[static_cast<std::size_t>(i)].output(
        std::clamp(command_(i), lower_limit_(i), upper_limit_(i)));
  }
}

void Simulation::drive(const mjData& data) {
  if (timing_) {
    if (sampled_) timing_->send(steps_ / steps_per_sample_, view(actuation_));
    timing_->receive(steps_, {actuation_.data(), static_cast<std::size_t>(actuation_.size())});
  }
  for (std::size_t i = 0; i < drives_.size(); ++i) {
    if (!drives_[i]) continue;
    const auto row = static_cast<Eigen::Index>(i);
    drives_[i]->update(actuation_(row), data.actuator_velocity[i]);
    drive_force_(row) = drives_[i]->force(data.actuator_length[i]);
  }
}

void Simulation::act(mjData& data) const {
  std::copy_n(actuation_.data(), actuation_.size(), data.ctrl);
  for (std::size_t i = 0; i < drives_.size(); ++i) {
    if (drives_[i]) data.ctrl[i] = drives_[i]->force(data.actuator_length[i]);
  }
  if (forces_.empty()) return;
  std::fill_n(data.xfrc_applied, static_cast<std::ptrdiff_t>(6) * model_->nbody, 0.0);
  std::fill_n(data.qfrc_applied, model_->nv, 0.0);
  const double stage_time = time_s_ + (data.time - engine_time_at_step_s_);
  for (ExternalForce* force : forces_) force->apply(stage_time, *model_.get(), data);
}

double Simulation::time_of(std::int64_t k) const {
  const double rate = std::round(1.0 / timestep_s());
  const bool is_whole = std::abs(rate * timestep_s() - 1.0) < 1e-12;
  return is_whole ? static_cast<double>(k) / rate : static_cast<double>(k) * timestep_s();
}

// Computes all sensors for the first sample. The callback does nothing: `stepping` is not set yet.
void Simulation::start() {
  const std::string fatal = call_engine([this] { mj_forward(model_.get(), data_.get()); });
  if (!fatal.empty()) fail(fatal);
  sensing_.reset(*data_);
}

void Simulation::step() {
  mjData& data = *data_;
  time_s_ = time_of(steps_);
  if (steps_ == 0) start();
  engine_time_at_step_s_ = data.time;
  step_begins_ = true;

  Simulation* const outer = std::exchange(stepping, this);
  const std::string fatal = call_engine([this] { mj_step(model_.get(), data_.get()); });
  stepping = outer;

  if (thrown_in_callback_) std::rethrow_exception(std::exchange(thrown_in_callback_, nullptr));
  if (!fatal.empty()) fail(fatal);
  check_engine(engine_time_at_step_s_);
  for (ExternalForce* force : forces_) force->end_step(*model_.get(), data);
  sensing_.after_step(data);
  ++steps_;
}

void Simulation::check_engine(double time_before_s) {
  for (int i = 0; i < mjNWARNING; ++i) {
    if (data_->warning[i].number > 0) {
      const std::string text = take_engine_warning();
      fail(kWarnings[static_cast<std::size_t>(i)] + (text.empty() ? "" : " (" + text + ")"));
    }
  }
  if (!(data_->time > time_before_s)) fail("time does not advance");
  if (!all_finite(data_->qpos, model_->nq) || !all_finite(data_->qvel, model_->nv)) {
    fail("diverged: the state is not finite");
  }
}

void Simulation::fail(const std::string& reason) const {
  throw RunFailure(time_s_, reason);
}

const double& Simulation::sensor(const std::string& name) const {
  return data_->sensordata[model_->sensor_adr[model_.id(mjOBJ_SENSOR, name)]];
}

std::uint64_t Simulation::state_hash() const {
  StateHash hash = hash_;
  hash.update({data_->qpos, static_cast<std::size_t>(model_->nq)});
  hash.update({data_->qvel, static_cast<std::size_t>(model_->nv)});
  return hash.digest();
}

}  // namespace breakwater
