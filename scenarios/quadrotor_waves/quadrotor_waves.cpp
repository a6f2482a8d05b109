#include "quadrotor_waves/quadrotor_waves.h"

#include <fmt/format.h>

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <numbers>

#include <breakwater/control/backstepping.h>
#include <breakwater/experiment/run_loop.h>
#include <breakwater/record/held_reference.h>
#include <breakwater/record/window_metrics.h>
#include <breakwater/signals/thread_time.h>

namespace breakwater {
namespace {

// A run counts as converged if it holds this close in the window (per axis, and at worst).
constexpr double kConvergedRmse_m = 0.5;
constexpr double kConvergedPeak_m = 2.0;
constexpr int kOutputs = 6;
constexpr const char* kChannels[] = {"x", "y", "z", "roll", "pitch", "yaw"};

Eigen::Vector3d vector3(const std::vector<double>& values) {
  return {values[0], values[1], values[2]};
}

double wrapped(double angle_rad) {
  return std::remainder(angle_rad, 2.0 * std::numbers::pi);
}

// RMS per axis of a vector: √(mean |e|²/axes).
class VectorStatistics {
 public:
  VectorStatistics(const TimeWindow& window, double axes) : squares_(window), axes_(axes) {}
  template <typename Vector>
  void add(double time_s, const Vector& e) {
    squares_.add(time_s, e.squaredNorm() / axes_);
  }
  std::optional<double> rms() const {
    const auto mean = squares_.mean();
    if (!mean) return std::nullopt;
    return std::sqrt(*mean);
  }

 private:
  WindowStatistics squares_;
  double axes_;
};

// The truth about a sample, for the log and the metrics.
struct Truth {
  Eigen::Matrix<double, 12, 1> motion = Eigen::Matrix<double, 12, 1>::Zero();
  Eigen::Vector3d wave_force = Eigen::Vector3d::Zero();
  Eigen::Vector3d wave_torque = Eigen::Vector3d::Zero();
  Eigen::Vector3d error = Eigen::Vector3d::Zero();
  double elevation_m = 0.0;
  double saturated = 0.0;

  void observe(const Simulation& sim, const UnderwaterForce& water,
               const Eigen::Vector3d& reference) {
    const FreeMotion free(sim.qpos().data(), sim.qvel().data());
    motion << free.position, free.euler, free.velocity,
        attitude_rates(AttitudeTrig(free.euler), free.body_rates);
    error = reference - free.position;
    const Vector6d load = water.wave_load(sim.time_s(), free);
    wave_force = load.head<3>();
    wave_torque = load.tail<3>();
    elevation_m = water.elevation(sim.time_s(), free.position.x(), free.position.y());
    saturated = sim.saturated() ? 1.0 : 0.0;
  }
};

class StationMetrics {
 public:
  explicit StationMetrics(const TimeWindow& window)
      : tracking_(window, 3.0),
        axes_{WindowStatistics(window), WindowStatistics(window), WindowStatistics(window)},
        error_(window),
        position_(window, 3.0),
        attitude_(window, 3.0),
        measured_position_(window, 3.0),
        roll_rate_(window),
        roll_rate_of_zero_(window),
        vertical_(window),
        vertical_of_zero_(window),
        horizontal_(window, 2.0),
        horizontal_of_zero_(window, 2.0),
        thrust_(window, 4.0),
        saturated_(window),
        nees_(window) {}

  void after_sample(double t, const Truth& truth, const Simulation& sim) {
    tracking_.add(t, truth.error);
    for (int i = 0; i < 3; ++i) axes_[static_cast<std::size_t>(i)].add(t, truth.error(i));
    error_.add(t, truth.error.norm());
    measured_position_.add(t, sim.sample().y.head<3>() - truth.motion.head<3>());
    roll_rate_of_zero_.add(t, truth.motion(9));
    const Eigen::Vector3d& force = truth.wave_force;
    vertical_of_zero_.add(t, force.z());
    horizontal_of_zero_.add(t, force.head<2>());
    thrust_.add(t, sim.actuation());
    saturated_.add(t, truth.saturated);
  }

  void after_estimate(double t, const Truth& truth, const QuadrotorEstimator& estimator) {
    Eigen::Matrix<double, 12, 1> off = estimator.motion() - truth.motion;
    for (int i = 3; i < 6; ++i) off(i) = wrapped(off(i));
    position_.add(t, off.head<3>());
    attitude_.add(t, off.segment<3>(3));
    roll_rate_.add(t, off(9));
    const Eigen::Vector3d force_off = estimator.force() - truth.wave_force;
    vertical_.add(t, force_off.z());
    horizontal_.add(t, force_off.head<2>());
    nees_.add(t, off.dot(estimator.motion_covariance().llt().solve(off)));
  }

  std::vector<Metric> metrics(bool models_disturbance) const {
    std::vector<Metric> list;
    add(list, "tracking_rmse_m", "m", tracking_.rms());
    add(list, "max_error_m", "m", error_.largest());
    if (error_.largest()) {
      const bool converged = *error_.largest() < kConvergedPeak_m &&
                             std::all_of(axes_.begin(), axes_.end(), [](const auto& axis) {
                               return *axis.rms() < kConvergedRmse_m;
                             });
      list.push_back({"converged", "1", converged ? 1.0 : 0.0});
    }
    add(list, "position_estimate_rmse_m", "m", position_.rms());
    add(list, "position_measurement_rmse_m", "m", measured_position_.rms());
    add(list, "attitude_estimate_rmse_rad", "rad", attitude_.rms());
    add(list, "roll_rate_rmse_rad_s", "rad/s", roll_rate_.rms());
    add(list, "roll_rate_rmse_of_zero_rad_s", "rad/s", roll_rate_of_zero_.rms());
    if (models_disturbance) {
      add(list, "vertical_force_rmse_N", "N", vertical_.rms());
      add(list, "horizontal_force_rmse_N", "N", horizontal_.rms());
    }
    add(list, "vertical_force_rmse_of_zero_N", "N", vertical_of_zero_.rms());
    add(list, "horizontal_force_rmse_of_zero_N", "N", horizontal_of_zero_.rms());
    add(list, "thrust_rms_N", "N", thrust_.rms());
    add(list, "saturated_fraction", "1", saturated_.mean());
    add(list, "nees_mean", "1", nees_.mean());
    return list;
  }

 private:
  VectorStatistics tracking_;
  std::array<WindowStatistics, 3> axes_;
  WindowStatistics error_;
  VectorStatistics position_;
  VectorStatistics attitude_;
  VectorStatistics measured_position_;
  WindowStatistics roll_rate_;
  WindowStatistics roll_rate_of_zero_;
  WindowStatistics vertical_;
  WindowStatistics vertical_of_zero_;
  VectorStatistics horizontal_;
  VectorStatistics horizontal_of_zero_;
  VectorStatistics thrust_;
  WindowStatistics saturated_;
  WindowStatistics nees_;
};

// What one update of the filter costs, on the run's own samples: measured after the run, so that
// the run depends on no clock.
double filter_time_us(const Track& log, QuadrotorEstimator& estimator) {
  const std::vector<double> poses = log.values("pose_measured");
  const std::vector<double> thrusts = log.values("thrust_applied_N");
  const std::size_t samples = std::min<std::size_t>(log.rows(), 2000);
  const double begin = thread_time_s();
  estimator.reset(Eigen::Map<const Vector6d>(poses.data()));
  for (std::size_t k = 0; k < samples; ++k) {
    const std::size_t held = k > 0 ? k - 1 : 0;
    estimator.update(Eigen::Map<const Eigen::Vector4d>(&thrusts[4 * held]),
                     Eigen::Map<const Vector6d>(&poses[kOutputs * k]));
  }
  return 1e6 * (thread_time_s() - begin) / static_cast<double>(samples);
}

}  // namespace

double QuadrotorWaves::deviation(double V) const {
  return interpretation_ == NoiseInterpretation::variance ? std::sqrt(V) : V;
}

QuadrotorTask QuadrotorWaves::task() const {
  return {.plant = plant(),
          .period_s = physics_.control_period_s,
          .reference_m = vector3(reference_m_),
          .position_std_m = deviation(V_m_),
          .angle_std_rad = deviation(V_p_),
          .position_noise = V_m_,
          .angle_noise = V_p_,
          .sea = wave_setup().sea};
}

WaveLoadSetup QuadrotorWaves::wave_setup() const {
  WaveLoadSetup setup = waves_;
  setup.sea.seed = run_.seed;
  setup.sea.gravity_m_s2 = parameters_.gravity_m_s2;
  setup.current_m_s = vector3(current_m_s_);
  return setup;
}

SensingSetup QuadrotorWaves::sensing_setup() const {
  SensingSetup setup;
  for (int i = 0; i < 3; ++i) {
    setup.channels.push_back(
        {.name = kChannels[i], .sensor = "position", .component = i, .noise_std = deviation(V_m_)});
  }
  constexpr Reading kAngles[] = {Reading::roll, Reading::pitch, Reading::yaw};
  for (int i = 0; i < 3; ++i) {
    setup.channels.push_back({.name = kChannels[3 + i],
                              .sensor = "attitude",
                              .reading = kAngles[i],
                              .noise_std = deviation(V_p_)});
  }
  faults_.apply(setup);
  setup.seed = run_.seed;
  return setup;
}

Fields QuadrotorWaves::fields() {
  Fields fields;
  bind_model(fields, mjcf_);
  fields.choice(
      "plant.model", physics_kind_,
      {{"physical", QuadrotorPhysics::physical}, {"thesis", QuadrotorPhysics::thesis}},
      "physical, or thesis: with G and C as printed; the estimator's and controller's too");
  physics_.bind(fields);
  run_.bind(fields);
  fields.numbers("task.start_m", start_m_, any(), "where it starts, at rest: x, y, z [m]");
  fields.numbers("task.reference_m", reference_m_, any(), "where it is to be: x, y, z [m]");

  fields.choice("wave.mode", waves_.mode,
                {{"physical", WaveMode::physical}, {"thesis", WaveMode::thesis}},
                "physical: Morison's force; thesis: one force through E, torques by atan2");
  fields.number("wave.significant_height_m", waves_.sea.significant_height_m, not_negative(),
                "H_s; 0: still water [m]");
  fields.number("wave.peak_period_s", waves_.sea.peak_period_s, positive(), "T_p [s]");
  fields.number("wave.gamma", waves_.sea.gamma, between(1, 20), "peak enhancement");
  fields.number("wave.heading_rad", waves_.sea.heading_rad, any(),
                "where the waves go, from x towards y [rad]");
  fields.number("wave.water_depth_m", waves_.sea.water_depth_m, not_negative(),
                "of the bottom; 0: deep water [m]");
  fields.count("wave.components", waves_.sea.components, between(1, 1000),
               "of the sea's realisation");
  fields.numbers("wave.current_m_s", current_m_s_, any(), "steady current: x, y, z [m/s]");
  fields.number("wave.inertia_coefficient", waves_.inertia_coefficient, not_negative(), "C_m");
  fields.number("wave.buoyancy_arm_m", waves_.buoyancy_arm_m, any(),
                "physical: z_B, where the pressure acts above the mass [m]");
  fields.number("wave.torque_low_pass_s", waves_.low_pass_s, positive(),
                "of the slope (physical) or the angle (thesis) [s]");
  fields.number("wave.torque_per_angle_Nm_rad", waves_.torque_per_angle_Nm_rad, any(),
                "thesis: torque for each radian of atan2 [N m/rad]");
  fields.number("wave.change_at_s", waves_.change_at_s, not_negative(),
                "when T_p changes, over 10 s; 0: never [s]");
  fields.number("wave.change_to_period_s", waves_.change_to_period_s, positive(),
                "T_p after the change [s]");

  fields.number("noise.position", V_m_, positive(), "V_m [m or m^2]");
  fields.number("noise.angle", V_p_, positive(), "V_p [rad or rad^2]");
  fields.choice("noise.interpretation", interpretation_,
                {{"variance", NoiseInterpretation::variance},
                 {"standard_deviation", NoiseInterpretation::standard_deviation}},
                "what V_m and V_p are: variance or standard_deviation");
  faults_.bind(fields, "x, y, z, roll, pitch, yaw");

  parts_.bind(fields);
  fields.only_for({"wave.current_m_s", "wave.buoyancy_arm_m"}, "wave.mode", {"physical"});
  fields.only_for({"wave.torque_per_angle_Nm_rad"}, "wave.mode", {"thesis"});
  fields.only_where({"wave.change_to_period_s"}, "wave.change_at_s is not 0",
                    [this] { return waves_.change_at_s > 0.0; });
  fields.number("metrics.window_s", window_s_, positive(), "the metrics' window: the last … [s]");
  return fields;
}

void QuadrotorWaves::check(const Config& config) {
  physics_.check(config, run_);
  const auto is_point = [&](const char* key, const std::vector<double>& point) {
    if (point.size() != 3) config.fail(key, "must have 3 numbers: x, y and z");
  };
  const auto is_under_water = [&](const char* key, double z) {
    if (z > 0.0) config.fail(key, "z must not be above the surface, z = 0");
    const double depth_m = waves_.sea.water_depth_m;
    if (depth_m > 0.0 && z <= -depth_m) config.fail(key, "z must be above the water's bottom");
  };
  is_point("task.start_m", start_m_);
  is_point("task.reference_m", reference_m_);
  is_point("wave.current_m_s", current_m_s_);
  is_under_water("task.start_m", start_m_[2]);
  is_under_water("task.reference_m", reference_m_[2]);
  const Model model = Model::load_physics(mjcf_);
  if (model->nu != 4) throw std::invalid_argument(mjcf_.path + ": needs 4 thrusters");
  for (int i = 1; i <= 4; ++i) model.id(mjOBJ_SITE, "t" + std::to_string(i));
  water(model);
  parts_.check(config, task());
  const SensingSetup sensing = sensing_setup();
  faults_.check(config, sensing.channels);
  const Sensing check_only(model, sensing);
}

UnderwaterForce QuadrotorWaves::water(const Model& model) const {
  return {model, parameters_, physics_kind_, wave_setup(), vector3(start_m_)};
}

std::vector<std::string> QuadrotorWaves::warnings() const {
  const QuadrotorLoop loop = parts_.make(task());
  const auto* controller = dynamic_cast<const QuadrotorController*>(loop.controller.get());
  const double pole = controller != nullptr ? slowest_pole(controller->law(), plant()) : 0.0;
  if (pole <= 0.0) return {};
  return {
      fmt::format("controller.gains are unstable on this plant.model (a pole at {:+.3f}/s)", pole)};
}

std::vector<WavingSurface> QuadrotorWaves::waving_surfaces(const Model& model) const {
  if (model.geoms_named("surface").empty()) return {};  // a model of the user's own
  return {{"surface", water(model).surface_waves()}};
}

Recording QuadrotorWaves::run(const RunControl& control) const {
  const QuadrotorLoop loop = parts_.make(task());
  Model model = Model::load_physics(mjcf_);
  model.set_physics(physics_.timestep_s, physics_.integrator);
  Simulation sim(std::move(model), *loop.controller, sensing_setup(), physics_.steps_per_sample());
  UnderwaterForce waves = water(sim.model());
  sim.add(waves);
  sim.set_position(std::vector<double>{start_m_[0], start_m_[1], start_m_[2], 1, 0, 0, 0});

  Truth truth;
  std::vector<Signal> signals = {
      {"qpos", "m, m, m, 1, 1, 1, 1", "the engine's generalised positions", sim.qpos()},
      {"motion_true", kMotionUnits, "zeta and its rate, true", view(truth.motion)},
      {"pose_measured", kPoseUnits, "x, y, z, roll, pitch, yaw as sampled", view(sim.sample().y)},
      {"thrust_command_N", "N", "thrusts asked for", view(sim.command())},
      {"thrust_applied_N", "N", "thrusts after saturation", view(sim.actuation())},
      {"saturated", "1", "1 where any thrust is at its limit", view(truth.saturated)},
      {"error_m", "m", "reference less position, true", view(truth.error)},
      {"wave_force_N", "N", "of the waves, in the world, true", view(truth.wave_force)},
      {"wave_torque_Nm", "N m", "of the waves, in the world, true", view(truth.wave_torque)},
      {"surface_elevation_m", "m", "of the surface above the vehicle", view(truth.elevation_m)}};
  for (const Signal& signal : loop.controller->signals()) signals.push_back(signal);
  const std::int64_t steps = physics_.step_at(run_.duration_s);
  const TimeWindow window{run_.duration_s - window_s_, run_.duration_s};
  StationMetrics metrics(window.within(run_.duration_s));
  const Eigen::Vector3d reference = vector3(reference_m_);
  HeldReference held({0.0, run_.duration_s >= window_s_ ? run_.duration_s : 0.0}, "the position",
                     "m");
  held.ask((reference - vector3(start_m_)).norm());

  const auto step = [&](std::int64_t) {
    if (sim.steps() > 0) {
      waves.advance(sim.time_of(sim.steps()), FreeMotion(sim.data().qpos, sim.data().qvel));
    }
    sim.step();
  };
  const auto sample = [&](double time_s) {
    truth.observe(sim, waves, reference);
    metrics.after_sample(time_s, truth, sim);
    held.add(time_s, truth.error.norm());
    if (loop.estimates()) metrics.after_estimate(time_s, truth, *loop.estimator);
  };
  const auto measured = [&] {
    return metrics.metrics(loop.estimates() && loop.estimator->models_disturbance());
  };
  Recording recording =
      record_run(sim, physics_, steps, std::move(signals), control, step, sample, measured);
  if (!recording.failure) held.warn(recording.warnings);
  if (!recording.failure && loop.estimates() && control.logs) {
    add(recording.costs, "filter_time_us", "us",
        filter_time_us(recording.tracks.front(), *parts_.make_estimator(task())));
  }
  return recording;
}

}  // namespace breakwater
